// SPDX-License-Identifier: BSD-3-Clause
// What every sampling method offers to FieldSampler.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "roughmesh/field.hpp"
#include "roughmesh/white_noise.hpp"

namespace roughmesh::detail {

using PointPair = std::pair<Index, Index>;

/// A prepared linear map from white noise to the heights of n points.
class FieldMethod {
 public:
  explicit FieldMethod(Correlation correlation) : correlation_(std::move(correlation)) {}
  virtual ~FieldMethod() = default;
  FieldMethod(const FieldMethod&) = delete;
  FieldMethod& operator=(const FieldMethod&) = delete;

  /// Length n, in the order of the points.
  virtual std::vector<double> heights(const NoiseStream& stream) const = 0;

  /// Of each pair, by the tables that heights() reads.
  virtual std::vector<double> covariances(std::span<const PointPair> pairs) const = 0;

  /// What covariances() should be.
  virtual double target(Index i, Index j) const { return correlation_(i, j); }

  const Correlation& correlation() const { return correlation_; }

 private:
  Correlation correlation_;
};

struct PreparedField {
  std::unique_ptr<const FieldMethod> method;
  FieldSummary summary;
  std::vector<std::string> citations;  ///< of the method
};

}  // namespace roughmesh::detail
