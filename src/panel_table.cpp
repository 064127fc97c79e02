// SPDX-License-Identifier: BSD-3-Clause
#include "panel_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace roughmesh::detail {
namespace {

constexpr std::size_t n = PanelTable::n_terms;

double chebyshev_node(std::size_t i) {
  return std::cos((static_cast<double>(i) + 0.5) / n * std::numbers::pi);
}

void chebyshev_polynomials(double t, std::array<double, n>& values) {
  values[0] = 1;
  values[1] = t;
  for (std::size_t k = 2; k < n; ++k) values[k] = 2 * t * values[k - 1] - values[k - 2];
}

// Row k: weights of the values at the nodes in coefficient k.
std::array<std::array<double, n>, n> value_to_coefficient() {
  std::array<std::array<double, n>, n> matrix{};
  for (std::size_t i = 0; i < n; ++i) {
    std::array<double, n> polynomials{};
    chebyshev_polynomials(chebyshev_node(i), polynomials);
    for (std::size_t k = 0; k < n; ++k) matrix[k][i] = polynomials[k] * (k == 0 ? 1.0 : 2.0) / n;
  }
  return matrix;
}

}  // namespace

PanelTable::PanelTable(Ends ends) : ends_(std::move(ends)) {}

std::vector<double> PanelTable::nodes(std::size_t axis) const {
  const std::vector<double>& ends = ends_[axis];
  if (ends.empty()) return {0};
  std::vector<double> result;
  for (std::size_t p = 1; p < ends.size(); ++p)
    for (std::size_t k = 0; k < n; ++k)
      result.push_back((ends[p - 1] + ends[p] + chebyshev_node(k) * (ends[p] - ends[p - 1])) / 2);
  return result;
}

void PanelTable::set_values(std::vector<double> values, double tolerance) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!ends_[axis].empty()) transform_along(axis, values);
  cells_.clear();
  coefficients_.clear();
  for (std::size_t p = 0; p < n_panels(0); ++p)
    for (std::size_t q = 0; q < n_panels(1); ++q)
      for (std::size_t r = 0; r < n_panels(2); ++r) add_cell(values, {p, q, r}, tolerance);
}

void PanelTable::transform_along(std::size_t axis, std::vector<double>& values) const {
  static const auto matrix = value_to_coefficient();
  std::size_t stride = 1;
  for (std::size_t a = axis + 1; a < 3; ++a) stride *= n_nodes(a);
  std::array<double, n> line{};
  for (std::size_t block = 0; block < values.size(); block += n * stride)
    for (std::size_t offset = 0; offset < stride; ++offset) {
      double* const first = values.data() + block + offset;
      for (std::size_t k = 0; k < n; ++k) line[k] = first[k * stride];
      for (std::size_t k = 0; k < n; ++k) {
        double sum = 0;
        for (std::size_t i = 0; i < n; ++i) sum += matrix[k][i] * line[i];
        first[k * stride] = sum;
      }
    }
}

double PanelTable::coefficient(std::span<const double> values, const Place& cell,
                               const Place& degrees) const {
  std::size_t at = 0;
  for (std::size_t a = 0; a < 3; ++a)
    at = at * n_nodes(a) + cell[a] * n_coefficients(a) + degrees[a];
  return values[at];
}

// Leaves out the highest degrees along each axis whose coefficients together are below a third of
// the tolerance; of a negligible cell nothing remains.
void PanelTable::add_cell(std::span<const double> values, const Place& place, double tolerance) {
  const Place all = {n_coefficients(0), n_coefficients(1), n_coefficients(2)};
  const auto for_each_degree = [](const Place& n_degrees, const auto& visit) {
    for (std::size_t i = 0; i < n_degrees[0]; ++i)
      for (std::size_t j = 0; j < n_degrees[1]; ++j)
        for (std::size_t k = 0; k < n_degrees[2]; ++k) visit(Place{i, j, k});
  };
  std::array<std::array<double, n>, 3> size_of_degree{};
  for_each_degree(all, [&](const Place& degrees) {
    const double size = std::abs(coefficient(values, place, degrees));
    for (std::size_t a = 0; a < 3; ++a) size_of_degree[a][degrees[a]] += size;
  });
  Cell cell{coefficients_.size(), all};
  for (std::size_t a = 0; a < 3; ++a) {
    double dropped = 0;
    while (cell.n[a] > 0 && (dropped += size_of_degree[a][cell.n[a] - 1]) < tolerance / 3)
      --cell.n[a];
  }
  for_each_degree(cell.n, [&](const Place& degrees) {
    coefficients_.push_back(coefficient(values, place, degrees));
  });
  cells_.push_back(cell);
}

// The panel, and the polynomials at the place in it.
std::size_t PanelTable::locate(std::size_t axis, double x, Polynomials& polynomials) const {
  const std::vector<double>& ends = ends_[axis];
  polynomials[0] = 1;
  if (ends.empty()) return 0;
  x = std::clamp(x, ends.front(), ends.back());
  const auto end = std::lower_bound(ends.begin() + 1, ends.end() - 1, x);
  const double begin = *(end - 1);
  chebyshev_polynomials((2 * x - begin - *end) / (*end - begin), polynomials);
  return static_cast<std::size_t>(end - ends.begin() - 1);
}

double PanelTable::operator()(const Vec3& x) const {
  std::array<Polynomials, 3> polynomials;
  std::size_t cell = 0;
  for (std::size_t a = 0; a < 3; ++a)
    cell = cell * n_panels(a) + locate(a, x[static_cast<Eigen::Index>(a)], polynomials[a]);
  const auto& [first, counts] = cells_[cell];
  const auto [n0, n1, n2] = counts;
  const double* coefficient = coefficients_.data() + first;
  Polynomials sums{};  // independent of each other, so that they can be added side by side
  for (std::size_t i = 0; i < n0; ++i)
    for (std::size_t j = 0; j < n1; ++j, coefficient += n2) {
      const double factor = polynomials[0][i] * polynomials[1][j];
      for (std::size_t k = 0; k < n2; ++k) sums[k] += factor * coefficient[k];
    }
  double sum = 0;
  for (std::size_t k = 0; k < n2; ++k) sum += sums[k] * polynomials[2][k];
  return sum;
}

}  // namespace roughmesh::detail
