// SPDX-License-Identifier: BSD-3-Clause
// The linear map from noise to heights of the method `lattice`, written out number by number.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include "roughmesh/correlation.hpp"
#include "roughmesh/field.hpp"

#include "lattice_coarse.hpp"
#include "lattice_gather.hpp"
#include "lattice_level.hpp"
#include "lattice_noise.hpp"
#include "lattice_terms.hpp"
#include "normal_transform.hpp"

namespace roughmesh::test {

/// Rows of heights over the numbers of white noise that they are made of: one column for each
/// lattice point of each level, and for each nugget.
class NoiseRows {
 public:
  NoiseRows(std::vector<detail::LatticeLevel> levels, std::size_t n_rows)
      : levels_(std::move(levels)), n_rows_(static_cast<int>(n_rows)) {}

  const std::vector<detail::LatticeLevel>& levels() const { return levels_; }

  /// The product of one row for each axis, times the root of the weight of the level.
  void add_level(std::size_t row, std::size_t number, const std::array<detail::AxisRow, 3>& along) {
    const detail::LatticeLevel& level = levels_[number];
    const auto index = [&](std::size_t a, int p) {
      return level.axes[a].wrapped(along[a].first + p);
    };
    const auto value = [&](std::size_t a, int p) {
      return along[a].value[static_cast<std::size_t>(p)];
    };
    for (int i = 0; i < along[0].size; ++i)
      for (int j = 0; j < along[1].size; ++j)
        for (int k = 0; k < along[2].size; ++k)
          add(row, {static_cast<std::int64_t>(number), index(0, i), index(1, j), index(2, k)},
              std::sqrt(level.weight) * value(0, i) * value(1, j) * value(2, k));
  }

  /// Of a place in units of 2^-30 correlation lengths.
  void add_nugget(std::size_t row, double value, const Vec3& place) {
    Key key{-1};
    for (std::size_t a = 0; a < 3; ++a)
      key[a + 1] = static_cast<std::int64_t>(std::floor(place[static_cast<int>(a)] + 0.618));
    add(row, key, value);
  }

  /// Heights of a stream, by one noise number at a time.
  std::vector<double> heights(const NoiseStream& stream) const {
    std::vector<detail::LatticeNoise> noise;
    for (const detail::LatticeLevel& level : levels_) noise.emplace_back(stream, level.key);
    Eigen::VectorXd numbers(static_cast<int>(column_of_.size()));
    for (const auto& [key, column] : column_of_)
      numbers[column] = key[0] < 0
                            ? nugget_noise(stream, key)
                            : noise[static_cast<std::size_t>(key[0])](key[1], key[2], key[3]);
    const Eigen::VectorXd product = matrix() * numbers;
    return {product.begin(), product.end()};
  }

  /// Of all pairs.
  Eigen::MatrixXd covariance() const {
    const Eigen::SparseMatrix<double> rows = matrix();
    const Eigen::SparseMatrix<double> product = rows * rows.transpose();
    return Eigen::MatrixXd(product);
  }

 private:
  using Key = std::array<std::int64_t, 4>;  ///< number of the level, or -1, and indices

  struct KeyHash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t hash = 0;
      for (const std::int64_t part : key)
        hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9e3779b97f4a7c15U + (hash >> 29);
      return hash;
    }
  };

  static double nugget_noise(const NoiseStream& stream, const Key& key) {
    std::array<std::uint64_t, 4> counter{0, 0, 0, 4};
    std::copy(key.begin() + 1, key.end(), counter.begin());
    const auto words = random_words(stream, counter);
    return detail::box_muller(words[0], words[1])[0];
  }

  void add(std::size_t row, const Key& key, double value) {
    const auto next = static_cast<int>(column_of_.size());
    const int column = column_of_.try_emplace(key, next).first->second;
    entries_.emplace_back(static_cast<int>(row), column, value);  // entries of one place add up
  }

  Eigen::SparseMatrix<double> matrix() const {
    Eigen::SparseMatrix<double> result(n_rows_, static_cast<int>(column_of_.size()));
    result.setFromTriplets(entries_.begin(), entries_.end());
    return result;
  }

  std::vector<detail::LatticeLevel> levels_;
  int n_rows_;
  std::unordered_map<Key, int, KeyHash> column_of_;
  std::vector<Eigen::Triplet<double>> entries_;
};

/// The kernel at a place as a row.
inline detail::AxisRow kernel_row(const detail::LatticeAxis& axis, double place) {
  const detail::AxisWeights weights = detail::kernel_weights(axis, place);
  detail::AxisRow row{weights.first, axis.n_points(), {}};
  std::copy_n(weights.weight.begin(), axis.n_points(), row.value.begin());
  return row;
}

/// Node i of n of a cell, on [0, 1].
inline double node_of(int n, int i) {
  return 0.5 - 0.5 * std::cos(std::numbers::pi * (2 * i + 1) / (2 * n));
}

/// Weight of node i of n at a position in a cell, a product over all other nodes.
inline double lagrange(int n, int i, double position) {
  double weight = 1;
  for (int j = 0; j < n; ++j)
    if (j != i) weight *= (position - node_of(n, j)) / (node_of(n, i) - node_of(n, j));
  return weight;
}

/// The kernels at the nodes of the cell that holds a place, under Lagrange's weights: passing on
/// from cell to cell changes no polynomial.
inline detail::AxisRow polynomial_row(const detail::LatticeAxis& axis, int n_nodes, double edge,
                                      double place) {
  if (!axis.varies()) return kernel_row(axis, place);
  const double corner = std::floor(place / edge) * edge;
  detail::AxisRow row{
      detail::kernel_weights(axis, corner + edge * node_of(n_nodes, 0)).first, 0, {}};
  for (int i = 0; i < n_nodes; ++i) {
    const detail::AxisRow kernel = kernel_row(axis, corner + edge * node_of(n_nodes, i));
    const auto shift = static_cast<std::size_t>(kernel.first - row.first);
    const auto size = static_cast<std::size_t>(kernel.size);
    const double weight = lagrange(n_nodes, i, (place - corner) / edge);
    row.size = static_cast<int>(shift + size);
    for (std::size_t p = 0; p < size; ++p) row.value[shift + p] += weight * kernel.value[p];
  }
  return row;
}

/// Edge of the cells of a level, a power of 2 above the smallest and at most the scale.
inline double coarse_edge(double scale, double cell, int n_stages) {
  const double doublings = std::floor(std::log2(scale / cell) + 1e-9);
  return cell * std::exp2(std::min<double>(doublings, n_stages - 1));
}

inline std::vector<Vec3> stretched(const Correlation& correlation,
                                   const detail::LatticeSpace& space) {
  std::vector<Vec3> result;
  for (const Vec3& x : correlation.places()) result.push_back(space(x));
  return result;
}

/// How many levels of a field are summed over cells.
inline std::size_t n_coarse_levels(const Correlation& correlation, const FieldOptions& options) {
  const detail::LatticeSpace space(correlation.distance(), options.dimension);
  const detail::SortedPlaces sorted(stretched(correlation, space),
                                    correlation.autocorrelation().length());
  const detail::LatticeTerms terms = detail::choose_terms(correlation, options, space, sorted);
  return terms.mixture.terms.size() - terms.coarse.first;
}

/// Rows of a field: kernels of the fine levels, polynomials of the coarse ones.
class LatticeRows {
 public:
  LatticeRows(const Correlation& correlation, const FieldOptions& options)
      : space_(correlation.distance(), options.dimension),
        unit_(correlation.autocorrelation().length() * 0x1p-30),
        sorted_(stretched(correlation, space_), correlation.autocorrelation().length()),
        terms_(detail::choose_terms(correlation, options, space_, sorted_)),
        rows_(detail::make_levels(terms_.mixture.terms, space_, terms_.lattice_error,
                                  terms_.distance),
              sorted_.size()) {
    for (std::size_t i = 0; i < sorted_.size(); ++i) add_place(i);
  }

  std::size_t n_levels() const { return rows_.levels().size(); }
  std::size_t n_coarse() const { return n_levels() - terms_.coarse.first; }
  std::vector<double> heights(const NoiseStream& stream) const { return rows_.heights(stream); }
  Eigen::MatrixXd covariance() const { return rows_.covariance(); }

  /// Places for which some fine levels, but not all, are nugget.
  std::size_t n_partly_skipped() const {
    return static_cast<std::size_t>(
        std::count_if(terms_.n_skipped.begin(), terms_.n_skipped.end(),
                      [&](std::size_t n) { return n > 0 && n < terms_.coarse.first; }));
  }

 private:
  void add_place(std::size_t number) {
    const std::size_t row = sorted_.order()[number];
    const Vec3& place = sorted_.places()[number];
    const std::size_t n_skipped = terms_.n_skipped.empty() ? 0 : terms_.n_skipped[number];
    double nugget = terms_.mixture.nugget;
    for (std::size_t k = 0; k < n_skipped; ++k) nugget += rows_.levels()[k].weight;
    for (std::size_t k = n_skipped; k < n_levels(); ++k)
      rows_.add_level(row, k,
                      {row_along(k, 0, place), row_along(k, 1, place), row_along(k, 2, place)});
    if (nugget > 0) rows_.add_nugget(row, std::sqrt(nugget), place / unit_);
  }

  detail::AxisRow row_along(std::size_t number, std::size_t axis, const Vec3& place) const {
    const detail::CoarseTerms& coarse = terms_.coarse;
    const detail::LatticeLevel& level = rows_.levels()[number];
    const double x = place[static_cast<int>(axis)];
    if (number < coarse.first) return kernel_row(level.axes[axis], x);
    return polynomial_row(level.axes[axis],
                          detail::polynomial_nodes(coarse.error / std::max(1, space_.n_varying())),
                          coarse_edge(level.scale, coarse.cell, coarse.n_stages), x);
  }

  detail::LatticeSpace space_;
  double unit_;  ///< of the keys of nuggets
  detail::SortedPlaces sorted_;
  detail::LatticeTerms terms_;
  NoiseRows rows_;
};

}  // namespace roughmesh::test
