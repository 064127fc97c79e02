// SPDX-License-Identifier: BSD-3-Clause
#include "smooth_extension.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/SparseCholesky>
#include <fmt/format.h>

#include "roughmesh/error.hpp"

#include "free_memory.hpp"

namespace roughmesh::detail {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Entries = std::vector<Eigen::Triplet<double>>;
using Triangle = std::array<Index, 3>;

// Two areas over the square of the longest edge below which a triangle counts as flat.
constexpr double flat = 1e-10;

constexpr double largest_residual = 1e-6;  // relative; round-off leaves some 1e-10 of good meshes

// The cotangents of the angles are the stiffness of the edges opposite to them, and each corner has
// a third of the area. Lengths in units of `scale` suit any unit of the mesh.
void add_triangle(std::span<const Vec3> nodes, const Triangle& t, double scale, Entries& stiffness,
                  std::vector<double>& areas) {
  std::array<Vec3, 3> sides;  // opposite to each corner
  for (std::size_t k = 0; k < 3; ++k)
    sides[k] = (nodes[t[(k + 2) % 3]] - nodes[t[(k + 1) % 3]]) / scale;
  const double area2 = sides[0].cross(sides[1]).norm();
  const double longest =
      std::max({sides[0].squaredNorm(), sides[1].squaredNorm(), sides[2].squaredNorm()});
  if (!(area2 > flat * longest)) return;
  for (std::size_t k = 0; k < 3; ++k) {
    const Index i = t[(k + 1) % 3], j = t[(k + 2) % 3];
    const double half_cotangent = -sides[(k + 1) % 3].dot(sides[(k + 2) % 3]) / area2 / 2;
    stiffness.emplace_back(i, i, half_cotangent);
    stiffness.emplace_back(j, j, half_cotangent);
    stiffness.emplace_back(i, j, -half_cotangent);
    stiffness.emplace_back(j, i, -half_cotangent);
    areas[t[k]] += area2 / 6;
  }
}

double mean_edge(std::span<const Vec3> nodes, std::span<const Triangle> triangles) {
  double sum = 0;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) sum += (nodes[t[(k + 1) % 3]] - nodes[t[k]]).norm();
  return sum > 0 ? sum / (3 * static_cast<double>(triangles.size())) : 1;
}

// Columns of the Laplacian of some of the nodes, rows being those of all of them times the square
// root of their areas.
Matrix columns_of(const Matrix& laplacian, std::span<const Index> nodes) {
  Matrix columns(laplacian.rows(), static_cast<Eigen::Index>(nodes.size()));
  Entries entries;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (Matrix::InnerIterator at(laplacian, nodes[k]); at; ++at)
      entries.emplace_back(static_cast<Index>(at.row()), static_cast<Index>(k), at.value());
  columns.setFromTriplets(entries.begin(), entries.end());
  return columns;
}

void require_room(double n_entries, std::size_t n_sought) {
  constexpr double bytes_per_entry = sizeof(double) + sizeof(int);
  require_memory(bytes_per_entry * n_entries,
                 fmt::format("smooth displacement of {} nodes beside sharp edges", n_sought),
                 "choose --edges average");
}

// Of the product of a matrix with its transpose: a node of very many triangles would fill it.
double most_entries_of_square(const Matrix& columns) {
  std::vector<double> n_of_row(static_cast<std::size_t>(columns.rows()), 0.0);
  for (Eigen::Index k = 0; k < columns.nonZeros(); ++k) ++n_of_row[columns.innerIndexPtr()[k]];
  double sum = 0;
  for (const double n : n_of_row) sum += n * n;
  return sum;
}

class Factor : public Eigen::SimplicialLDLT<Matrix> {
 public:
  /// That it will have; after analyzePattern().
  double n_entries() const { return static_cast<double>(m_matrix.nonZeros()); }
};

[[noreturn]] void refuse(std::size_t n_sought) {
  throw NumericalError(
      fmt::format("the {} nodes of the faces beside sharp edges have no smooth displacement; "
                  "improve the worst faces of the input mesh, or choose --edges average",
                  n_sought));
}

}  // namespace

struct SmoothExtension::Plan {
  std::vector<Index> given, sought;
  Matrix coupling;  // sought by given
  Matrix stiffness;
  Factor factor;

  void factorize(const Matrix& columns) {
    require_room(most_entries_of_square(columns), sought.size());
    stiffness = columns.transpose() * columns;
    factor.analyzePattern(stiffness);
    require_room(factor.n_entries(), sought.size());
    factor.factorize(stiffness);
    if (factor.info() != Eigen::Success) refuse(sought.size());
  }
};

SmoothExtension::SmoothExtension(std::span<const Vec3> nodes, std::span<const Triangle> triangles,
                                 std::span<const NodeRole> roles) {
  auto plan = std::make_unique<Plan>();
  const double scale = mean_edge(nodes, triangles);
  Entries entries;
  std::vector<double> areas(nodes.size(), 0.0);
  for (const Triangle& t : triangles) add_triangle(nodes, t, scale, entries, areas);
  for (std::size_t i = 0; i < areas.size(); ++i) {
    if (!(areas[i] > 0)) continue;
    if (roles[i] == NodeRole::given) plan->given.push_back(static_cast<Index>(i));
    if (roles[i] == NodeRole::sought) plan->sought.push_back(static_cast<Index>(i));
  }
  const auto n = static_cast<Eigen::Index>(nodes.size());
  Matrix laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  for (Eigen::Index column = 0; column < n; ++column)
    for (Matrix::InnerIterator at(laplacian, column); at; ++at)
      at.valueRef() /= std::sqrt(areas[at.row()]);
  const Matrix sought = columns_of(laplacian, plan->sought);
  plan->coupling = sought.transpose() * columns_of(laplacian, plan->given);
  plan->factorize(sought);
  plan_ = std::move(plan);
}

SmoothExtension::~SmoothExtension() = default;

const std::vector<Index>& SmoothExtension::given() const { return plan_->given; }
const std::vector<Index>& SmoothExtension::sought() const { return plan_->sought; }

std::vector<Vec3> SmoothExtension::extend(std::span<const Vec3> values) const {
  std::vector<Vec3> result(plan_->sought.size());
  if (result.empty()) return result;
  Eigen::MatrixX3d given(static_cast<Eigen::Index>(values.size()), 3);
  for (std::size_t i = 0; i < values.size(); ++i)
    given.row(static_cast<Eigen::Index>(i)) = values[i].transpose();
  const Eigen::MatrixX3d load = -(plan_->coupling * given);
  const Eigen::MatrixX3d solution = plan_->factor.solve(load);
  if (!((plan_->stiffness * solution - load).norm() <= largest_residual * load.norm()))
    refuse(result.size());
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = solution.row(static_cast<Eigen::Index>(i)).transpose();
  return result;
}

}  // namespace roughmesh::detail
