// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_coarse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lattice_gather.hpp"
#include "lattice_noise.hpp"
#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

// Largest error of the covariance along one axis, of a Gaussian whose scale is the edge of the
// cells, for 3, 4, ... nodes: computed over all places in two cells, and again by a test.
constexpr std::array node_errors = {1.4e-2, 1.9e-3, 1.8e-4,  2.0e-5,  1.7e-6,
                                    1.6e-7, 1.2e-8, 9.8e-10, 6.8e-11, 5.2e-12};
constexpr int fewest_nodes = 3;
constexpr int most_nodes = fewest_nodes + static_cast<int>(node_errors.size()) - 1;

std::vector<double> chebyshev_nodes(int n) {
  std::vector<double> nodes;
  nodes.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i)
    nodes.push_back(0.5 - 0.5 * std::cos(std::numbers::pi * (2 * i + 1) / (2 * n)));
  return nodes;
}

SmallMatrix identity_of_one() { return {1, 1, {1.0}}; }

}  // namespace

int polynomial_nodes(double error) {
  int n = fewest_nodes;
  while (n < most_nodes && node_errors[static_cast<std::size_t>(n - fewest_nodes)] > error) ++n;
  return n;
}

CoarseLevels::CoarseLevels(std::vector<LatticeLevel> levels, const LatticeSpace& space, double cell,
                           int n_stages, double error)
    : levels_(std::move(levels)), cell_(cell) {
  if (levels_.empty()) return;
  for (int a = 0; a < 3; ++a) varies_[static_cast<std::size_t>(a)] = space.varies(a);
  n_nodes_ = polynomial_nodes(error / std::max(1, space.n_varying()));
  nodes_ = chebyshev_nodes(n_nodes_);
  for (const double node : nodes_) {
    double product = 1;
    for (const double other : nodes_)
      if (other != node) product *= node - other;
    node_factors_.push_back(1 / product);
  }
  for (int half = 0; half < 2; ++half) {
    SmallMatrix& matrix = halves_[static_cast<std::size_t>(half)];
    matrix = {n_nodes_, n_nodes_, {}};
    for (const double node : nodes_) {
      const auto row = interpolation((half + node) / 2);
      matrix.entries.insert(matrix.entries.end(), row.begin(), row.begin() + n_nodes_);
    }
  }
  for (const LatticeLevel& level : levels_) {
    const int stage = static_cast<int>(std::floor(std::log2(level.scale / cell_) + 1e-9));
    stage_of_level_.push_back(std::clamp(stage, 0, n_stages - 1));
    n_stages_ = std::max(n_stages_, stage_of_level_.back() + 1);
  }
}

std::size_t CoarseLevels::n_values() const {
  std::size_t n = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) n *= static_cast<std::size_t>(n_nodes(axis));
  return n;
}

CoarseLevels::Cell CoarseLevels::cell_of(const Vec3& place, int stage) const {
  Cell corner{};
  for (int a = 0; a < 3; ++a)
    if (varies_[static_cast<std::size_t>(a)])
      corner[static_cast<std::size_t>(a)] = std::floor(place[a] / edge(stage)) * edge(stage);
  return corner;
}

// Lagrange's polynomials of the nodes at a position in [0, 1], without divisions that could fail.
NodeWeights CoarseLevels::interpolation(double position) const {
  NodeWeights weights{};
  double before = 1;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    weights[i] = before * node_factors_[i];
    before *= position - nodes_[i];
  }
  double after = 1;
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    weights[i] *= after;
    after *= position - nodes_[i];
  }
  return weights;
}

/// A row for each node of a cell, over the lattice points that any of them reaches.
SmallMatrix CoarseLevels::kernel_rows(const LatticeAxis& axis, double corner, double edge,
                                      std::int64_t& first) const {
  std::array<double, most_nodes> places{};
  std::array<AxisWeights, most_nodes> rows;
  const auto n = static_cast<std::size_t>(n_nodes_);
  for (std::size_t i = 0; i < n; ++i) places[i] = corner + edge * nodes_[i];
  kernel_weights(axis, std::span(places).first(n), std::span(rows).first(n));
  first = rows[0].first;  // nodes and rows ascend
  const auto width = static_cast<int>(rows[n - 1].first - first) + axis.n_points();
  SmallMatrix matrix = zero_matrix(n_nodes_, width);
  for (int i = 0; i < n_nodes_; ++i) {
    const AxisWeights& row = rows[static_cast<std::size_t>(i)];
    std::copy_n(row.weight.begin(), axis.n_points(),
                &matrix(i, static_cast<int>(row.first - first)));
  }
  return matrix;
}

void CoarseLevels::add_level_to(const LatticeLevel& level, const NoiseStream& stream,
                                const Cell& corner, double edge, Values& values) const {
  std::array<SmallMatrix, 3> rows;
  std::array<std::int64_t, 3> first{};
  std::size_t n_values = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    rows[a] =
        varies_[a] ? kernel_rows(level.axes[a], corner[a], edge, first[a]) : identity_of_one();
    n_values *= static_cast<std::size_t>(rows[a].n_columns);
  }
  std::vector<double> noise(n_values);
  std::vector<NoiseRun> runs;
  double* column = noise.data();
  for (std::int64_t x = 0; x < rows[0].n_columns; ++x)
    for (std::int64_t y = 0; y < rows[1].n_columns; ++y, column += rows[2].n_columns)
      append_runs(level.axes, {first[0] + x, first[1] + y, first[2]}, rows[2].n_columns, column,
                  runs);
  LatticeNoise(stream, level.key).fill(runs);
  for (double& entry : rows[0].entries) entry *= std::sqrt(level.weight);
  add_tensor_product(rows, noise, values);
}

/// One walk from the largest cells to the places.
class CoarseLevels::Descent {
 public:
  Descent(const CoarseLevels& levels, const NoiseStream& stream, const SortedPlaces& places,
          std::span<double> heights)
      : levels_(levels), stream_(stream), places_(places), heights_(heights) {}

  void visit(SortedPlaces::Range range, int stage, const Values* parent) const {
    const Vec3& place = places_.places()[range.first];
    const Cell corner = levels_.cell_of(place, stage);
    Values values(levels_.n_values() + tensor_lanes - 1, 0.0);  // as interpolate() reads them
    if (parent != nullptr)
      add_parent(*parent, corner, levels_.cell_of(place, stage + 1), stage, values);
    for (std::size_t k = 0; k < levels_.levels_.size(); ++k)
      if (levels_.stage_of_level_[k] == stage)
        levels_.add_level_to(levels_.levels_[k], stream_, corner, levels_.edge(stage), values);
    if (stage == 0) return add_to_places(range, corner, values);
    const auto children = places_.cells(range, levels_.edge(stage - 1));
    parallel_for(children.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) visit(children[c], stage - 1, &values);
    });
  }

 private:
  void add_parent(const Values& parent, const Cell& corner, const Cell& parent_corner, int stage,
                  Values& values) const {
    std::array<SmallMatrix, 3> halves;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool is_upper = corner[a] - parent_corner[a] > levels_.edge(stage) / 2;
      halves[a] = levels_.varies_[a] ? levels_.halves_[is_upper ? 1 : 0] : identity_of_one();
    }
    add_tensor_product(halves, parent, values);
  }

  void add_to_places(SortedPlaces::Range range, const Cell& corner, const Values& values) const {
    const int nx = levels_.n_nodes(0), ny = levels_.n_nodes(1), nz = levels_.n_nodes(2);
    std::array<NodeWeights, 3> w{};
    for (std::size_t i = range.first; i < range.second; ++i) {
      for (std::size_t a = 0; a < 3; ++a)
        w[a] = levels_.varies_[a]
                   ? levels_.interpolation((places_.places()[i][static_cast<int>(a)] - corner[a]) /
                                           levels_.edge(0))
                   : NodeWeights{1.0};
      heights_[places_.order()[i]] += interpolate(w, values.data(), {nx, ny, nz});
    }
  }

  const CoarseLevels& levels_;
  NoiseStream stream_;
  const SortedPlaces& places_;
  std::span<double> heights_;
};

void CoarseLevels::add(const NoiseStream& stream, const SortedPlaces& places,
                       std::span<double> heights) const {
  if (levels_.empty()) return;
  const Descent descent(*this, stream, places, heights);
  const auto cells = places.cells({0, places.size()}, edge(n_stages_ - 1));
  parallel_for(cells.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) descent.visit(cells[c], n_stages_ - 1, nullptr);
  });
}

/// The way of add() for one axis: from the place through the cells to the lattice.
AxisRow CoarseLevels::row(const LatticeLevel& level, int stage, std::size_t axis, double x) const {
  if (!varies_[axis]) return {0, 1, {1.0}};
  NodeWeights weights = interpolation(x / cell_ - std::floor(x / cell_));
  for (int s = 0; s < stage; ++s) {
    const double in_parent = x / edge(s + 1) - std::floor(x / edge(s + 1));
    const SmallMatrix& half = halves_[in_parent < 0.5 ? 0 : 1];
    NodeWeights up{};
    for (int i = 0; i < n_nodes_; ++i)
      for (int k = 0; k < n_nodes_; ++k)
        up[static_cast<std::size_t>(k)] += weights[static_cast<std::size_t>(i)] * half(i, k);
    weights = up;
  }
  AxisRow row{};
  const double corner = std::floor(x / edge(stage)) * edge(stage);
  const SmallMatrix kernels = kernel_rows(level.axes[axis], corner, edge(stage), row.first);
  row.size = kernels.n_columns;
  for (int i = 0; i < n_nodes_; ++i)
    for (int j = 0; j < kernels.n_columns; ++j)
      row.value[static_cast<std::size_t>(j)] +=
          weights[static_cast<std::size_t>(i)] * kernels(i, j);
  return row;
}

double CoarseLevels::covariance(const Vec3& x, const Vec3& y) const {
  double sum = 0;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    double product = levels_[k].weight;
    for (std::size_t a = 0; a < 3 && product != 0; ++a) {
      const int axis = static_cast<int>(a);
      product *= row_product(levels_[k].axes[a], row(levels_[k], stage_of_level_[k], a, x[axis]),
                             row(levels_[k], stage_of_level_[k], a, y[axis]));
    }
    sum += product;
  }
  return sum;
}

}  // namespace roughmesh::detail
