// SPDX-License-Identifier: BSD-3-Clause
#include "curved_repair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>

#include "parallel.hpp"
#include "plane.hpp"

namespace roughmesh::detail {
namespace {

// Poor is below this, or below this share of what it was in the input. What an element can be is
// mostly far above what the harmonic extension makes of it, and cheap to have.
constexpr double enough = 0.85;
constexpr double share = 0.995;
constexpr int rounds_of_poor_only = 3;  // then their neighbours move as well
constexpr int rounds_of_quality = 6;    // then only what is inverted is worth more of them

void make_unique(std::vector<Index>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

// -1/beta log sum exp(-beta (c_k + g_k . y)) - |y|^2 / 1000, smooth and concave: below the least by
// log(n) / beta at most, and it stays where nothing is to be gained.
struct SoftLeast {
  double value = 0;
  Vec3 gradient = Vec3::Zero();
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();  // minus the Hessian

  SoftLeast(const LinearFunctions& functions, double beta, const Vec3& y) {
    constexpr double tether = 1e-3, negligible = 40;
    const double least = functions.least(y);
    double sum = 0;
    for (std::size_t k = 0; k < functions.values.size(); ++k) {
      const Vec3& g = functions.gradients[k];
      const double exponent = beta * (functions.values[k] + g.dot(y) - least);
      if (exponent > negligible) continue;
      const double weight = std::exp(-exponent);
      sum += weight;
      gradient += weight * g;
      curvature += weight * g * g.transpose();
    }
    gradient /= sum;
    curvature = beta * (curvature / sum - gradient * gradient.transpose());
    curvature.diagonal().array() += 2 * tether;
    gradient -= 2 * tether * y;
    value = least - std::log(sum) / beta - tether * y.squaredNorm();
  }
};

// Newton's method from y = 0 for sharper and sharper ones, until the least is large enough.
Vec3 raise(const LinearFunctions& functions, double goal) {
  Vec3 y = Vec3::Zero();
  for (double beta = 8; beta < 2000; beta *= 2)
    for (int step = 0; step < 4; ++step) {
      if (functions.least(y) >= goal) return y;
      const SoftLeast at(functions, beta, y);
      const Vec3 direction = at.curvature.ldlt().solve(at.gradient);
      double size = 1;
      while (size > 1e-3 && !(SoftLeast(functions, beta, y + size * direction).value > at.value))
        size /= 2;
      if (size > 1e-3) y += size * direction;
    }
  return y;
}

}  // namespace

double LinearFunctions::least(const Vec3& y) const {
  double result = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < values.size(); ++k)
    result = std::min(result, values[k] + gradients[k].dot(y));
  return result;
}

CurvedRepair::CurvedRepair(const Mesh& mesh, int cell_dimension, NodeFlags is_free)
    : mesh_(mesh), is_free_(std::move(is_free)) {
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const ElementType& type = mesh.blocks[b].type;
    if (dimension(type.shape) != cell_dimension || JacobianPolynomial::of(type) == nullptr)
      continue;
    for (Index e = 0; e < mesh.blocks[b].size(); ++e) cells_.push_back({static_cast<Index>(b), e});
  }
  if (cell_dimension == 2) plane_normal_ = fit_plane(mesh).normal;
}

ElementOrientation CurvedRepair::orientation(const ElementOfMesh& cell) const {
  ElementOrientation result;
  if (plane_normal_) result.normal = *plane_normal_;
  const double straight =
      straight_jacobian(cell.type(mesh_).shape, cell.nodes(mesh_), mesh_.nodes, result);
  if (straight < 0) {
    result.sign = plane_normal_ ? 1 : -1;
    result.normal = -result.normal;
  }
  return result;
}

bool CurvedRepair::has(Defect defect, const ElementOfMesh& cell,
                       std::span<const Vec3> positions) const {
  const ElementOrientation orientation = this->orientation(cell);
  const auto at = [&](std::span<const Vec3> where) {
    return curved_quality(cell.type(mesh_), cell.nodes(mesh_), where, orientation);
  };
  const auto after = at(positions);
  if (!after) return false;
  if (after->is_positive && (defect == Defect::inverted || after->value >= enough)) return false;
  const auto before = at(mesh_.nodes);
  if (!before || !before->is_positive) return false;
  return !after->is_positive || after->value < share * before->value;
}

std::vector<Index> CurvedRepair::poor_cells(std::span<const Index> among,
                                            std::span<const Vec3> positions, Defect defect) const {
  constexpr std::size_t grain = 1024;
  std::vector<std::uint8_t> flags(among.size(), 0);
  parallel_for(among.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      flags[i] = has(defect, cells_[static_cast<std::size_t>(among[i])], positions);
  });
  std::vector<Index> poor;
  for (std::size_t i = 0; i < among.size(); ++i)
    if (flags[i] != 0) poor.push_back(among[i]);
  return poor;
}

std::vector<std::vector<Index>> CurvedRepair::cells_at_free_nodes() const {
  std::vector<std::vector<Index>> result(mesh_.nodes.size());
  for (std::size_t c = 0; c < cells_.size(); ++c)
    for (const Index node : cells_[c].nodes(mesh_))
      if (is_free_[node] != 0) result[node].push_back(static_cast<Index>(c));
  return result;
}

// Values on a grid, where Bernstein coefficients would ask for more than what is needed.
std::vector<double> CurvedRepair::values(const ElementOfMesh& cell,
                                         std::span<const Vec3> positions) const {
  const ElementOrientation orientation = this->orientation(cell);
  const ElementType& type = cell.type(mesh_);
  const JacobianPolynomial& polynomial = *JacobianPolynomial::of(type);
  const double straight = straight_jacobian(type.shape, cell.nodes(mesh_), positions, orientation);
  if (!(straight > 0)) return {};
  std::vector<double> result = polynomial.values(
      jacobian_coefficients(polynomial, cell.nodes(mesh_), positions, orientation));
  for (double& each : result) each /= straight;
  return result;
}

// Of what is not proven to be positive, the least value on the grid, and at most 0.
double CurvedRepair::least_quality(std::span<const Index> cells,
                                   std::span<const Vec3> positions) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Index c : cells) {
    const ElementOfMesh& cell = cells_[static_cast<std::size_t>(c)];
    const auto quality =
        curved_quality(cell.type(mesh_), cell.nodes(mesh_), positions, orientation(cell));
    if (!quality) continue;
    least = std::min(least, quality->value);
    if (quality->is_positive) continue;
    const std::vector<double> on_grid = values(cell, positions);
    least = std::min({least, 0.0, *std::min_element(on_grid.begin(), on_grid.end())});
  }
  return least;
}

// The determinant of an element is a linear function of the place of one node that is no corner,
// and the straight element does not depend on it.
LinearFunctions CurvedRepair::functions_of(Index node, double size, std::span<const Index> around,
                                           std::span<Vec3> positions) const {
  LinearFunctions functions;
  const Vec3 start = positions[node];
  for (const Index c : around) {
    const ElementOfMesh& cell = cells_[static_cast<std::size_t>(c)];
    const std::vector<double> here = values(cell, positions);
    const std::size_t first = functions.values.size();
    functions.values.insert(functions.values.end(), here.begin(), here.end());
    functions.gradients.resize(functions.values.size());
    for (int axis = 0; axis < 3; ++axis) {
      positions[node] = start + size * Vec3::Unit(axis);
      const std::vector<double> there = values(cell, positions);
      for (std::size_t k = 0; k < here.size(); ++k)
        functions.gradients[first + k][axis] = there[k] - here[k];
    }
    positions[node] = start;
  }
  return functions;
}

// What the grid promises has to hold everywhere, if need be for less of a step.
void CurvedRepair::improve(Index node, std::span<const Index> around,
                           std::span<Vec3> positions) const {
  const auto nodes = cells_[static_cast<std::size_t>(around.front())].nodes(mesh_);
  const double size = (positions[nodes[0]] - positions[nodes[1]]).norm();
  const Vec3 start = positions[node];
  const double before = least_quality(around, positions);
  const Vec3 step = raise(functions_of(node, size, around, positions), enough);
  for (const double part : {1.0, 0.5, 0.25}) {
    positions[node] = start + part * size * step;
    if (least_quality(around, positions) > before) return;
  }
  positions[node] = start;
}

// Sorted, each once.
std::vector<Index> CurvedRepair::free_nodes_of(std::span<const Index> cells) const {
  std::vector<Index> nodes;
  for (const Index c : cells)
    for (const Index node : cells_[static_cast<std::size_t>(c)].nodes(mesh_))
      if (is_free_[node] != 0) nodes.push_back(node);
  make_unique(nodes);
  return nodes;
}

void CurvedRepair::mend(std::span<Vec3> positions) const {
  std::vector<Index> all(cells_.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<Index> poor = poor_cells(all, positions, Defect::poor);
  if (poor.empty()) return;
  const std::vector<std::vector<Index>> cells_at = cells_at_free_nodes();
  const auto cells_around = [&](std::span<const Index> nodes) {
    std::vector<Index> cells;
    for (const Index node : nodes)
      cells.insert(cells.end(), cells_at[node].begin(), cells_at[node].end());
    make_unique(cells);
    return cells;
  };
  for (int round = 0; round < most_rounds && !poor.empty(); ++round) {
    std::vector<Index> nodes = free_nodes_of(poor);
    if (round >= rounds_of_poor_only) nodes = free_nodes_of(cells_around(nodes));
    for (const Index node : nodes) improve(node, cells_at[node], positions);
    poor = poor_cells(cells_around(nodes), positions,
                      round + 1 < rounds_of_quality ? Defect::poor : Defect::inverted);
  }
}

}  // namespace roughmesh::detail
