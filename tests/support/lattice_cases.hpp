// SPDX-License-Identifier: BSD-3-Clause
// Autocorrelation functions and bodies on which the method `lattice` has to keep its promises.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "roughmesh/correlation.hpp"
#include "roughmesh/field.hpp"

#include "support/meshes.hpp"
#include "support/points.hpp"

namespace roughmesh::test {

struct NamedAutocorrelation {
  std::string name;
  AutocorrelationOptions options;
};

/// Pairs of 0.7 exp(-r^2 / 2) + 0.3 exp(-r^2 / (2 * 0.3^2)), times a length.
inline std::vector<CorrelationPair> table_of_two_gaussians(double length) {
  std::vector<CorrelationPair> pairs;
  for (int k = 0; k <= 60; ++k) {
    const double r = 0.08 * k;
    pairs.push_back({r * length, 0.7 * std::exp(-r * r / 2) + 0.3 * std::exp(-r * r / 0.18)});
  }
  pairs.front().rho = 1;
  return pairs;
}

/// Every family, from rough to smooth, with the correlation length given.
inline std::vector<NamedAutocorrelation> all_autocorrelations(double length) {
  using enum Family;
  return {
      {"gaussian", {.family = gaussian, .length = length}},
      {"exponential", {.family = exponential, .length = length}},
      {"stretched 0.5", {.family = stretched, .length = length, .power = 0.5}},
      {"stretched 1.4", {.family = stretched, .length = length, .power = 1.4}},
      {"stretched 1.9", {.family = stretched, .length = length, .power = 1.9}},
      {"matern 0.3", {.family = matern, .length = length, .nu = 0.3}},
      {"matern 0.8", {.family = matern, .length = length, .nu = 0.8}},
      {"matern 2.5", {.family = matern, .length = length, .nu = 2.5}},
      {"self-affine 0.2", {.family = self_affine, .length = length, .hurst = 0.2}},
      {"self-affine 0.8", {.family = self_affine, .length = length, .hurst = 0.8}},
      {"rational-quadratic 0.4", {.family = rational_quadratic, .length = length, .alpha = 0.4}},
      {"rational-quadratic 5", {.family = rational_quadratic, .length = length, .alpha = 5.0}},
      {"table", {.family = table, .table = table_of_two_gaussians(length)}}};
}

/// The rough, the smooth and the heavy-tailed.
inline std::vector<NamedAutocorrelation> some_autocorrelations(double length) {
  using enum Family;
  return {
      {"gaussian", {.family = gaussian, .length = length}},
      {"exponential", {.family = exponential, .length = length}},
      {"matern 2.5", {.family = matern, .length = length, .nu = 2.5}},
      {"rational-quadratic 0.4", {.family = rational_quadratic, .length = length, .alpha = 0.4}}};
}

/// Nodes of a surface and a correlation length that suits them.
struct Body {
  std::string name;
  std::vector<Vec3> nodes;
  double length = 1;
};

inline std::vector<Vec3> moved(std::vector<Vec3> points, const Vec3& shift) {
  for (Vec3& x : points) x += shift;
  return points;
}

inline std::vector<Vec3> scaled(std::vector<Vec3> points, double factor) {
  for (Vec3& x : points) x *= factor;
  return points;
}

/// Two square sheets, much closer to each other than the nodes of either.
inline std::vector<Vec3> thin_shell() {
  std::vector<Vec3> nodes = plate(16).nodes;
  for (const Vec3& x : plate(16).nodes) nodes.emplace_back(x + Vec3(1e-3, 2e-3, 4e-3));
  return nodes;
}

/// Square plate whose edges grow a hundredfold from one corner to the opposite one.
inline std::vector<Vec3> graded_plate(int n_edges = 22) {
  std::vector<Vec3> nodes = plate(n_edges).nodes;
  for (Vec3& x : nodes)
    for (int axis = 0; axis < 2; ++axis) x[axis] = (std::pow(100.0, x[axis]) - 1) / 99;
  return nodes;
}

inline Body sphere_body() { return {"sphere", icosphere(3).nodes, 0.4}; }

inline std::vector<Body> other_bodies() {
  const std::vector<Vec3> ball = icosphere(2).nodes;
  return {{"plate", plate(20).nodes, 0.125},
          {"thin shell", thin_shell(), 0.15},
          {"graded plate", graded_plate(), 0.3},
          {"far from the origin", moved(ball, Vec3(5e5, -4e5, 3e5)), 0.5},
          {"nanometres", scaled(ball, 1e-9), 0.5e-9},
          {"gigametres", scaled(ball, 1e9), 0.5e9}};
}

inline FieldSampler lattice_sampler(const std::vector<Vec3>& places, const Autocorrelation& rho,
                                    const Distance& distance, FieldOptions options = {}) {
  options.method = Method::lattice;
  return FieldSampler(Correlation(places, rho, distance), options);
}

}  // namespace roughmesh::test
