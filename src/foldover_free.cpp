// SPDX-License-Identifier: BSD-3-Clause
#include "foldover_free.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <LBFGS.h>

#include "distortion.hpp"

namespace roughmesh::detail {
namespace {

// The simplices that can change, on nodes of their own: the free ones first.
struct Patch {
  std::vector<Simplex> simplices;
  std::vector<Index> nodes;
  Index n_free = 0;
};

std::span<const Index> corners(const Simplex& simplex) {
  return std::span(simplex).first(simplex[3] < 0 ? 3 : 4);
}

bool has_free_corner(const Simplex& simplex, const NodeFlags& is_free) {
  const auto nodes = corners(simplex);
  return std::any_of(nodes.begin(), nodes.end(), [&](Index n) { return is_free[n] != 0; });
}

Patch make_patch(const Simplices& simplices, const NodeFlags& is_free) {
  Patch patch;
  for (const Simplex& s : simplices.all)
    if (has_free_corner(s, is_free) && !is_flat(simplices.rest, s)) patch.simplices.push_back(s);
  std::vector<Index> number(simplices.rest.size(), -1);
  for (const Simplex& s : patch.simplices)
    for (const Index node : corners(s)) number[node] = 0;
  for (const bool free : {true, false}) {
    for (std::size_t node = 0; node < number.size(); ++node)
      if (number[node] >= 0 && (is_free[node] != 0) == free)
        patch.nodes.push_back(static_cast<Index>(node));
    if (free) patch.n_free = static_cast<Index>(patch.nodes.size());
  }
  for (std::size_t i = 0; i < patch.nodes.size(); ++i)
    number[patch.nodes[i]] = static_cast<Index>(i);
  for (Simplex& s : patch.simplices)
    for (Index& node : s) node = node < 0 ? -1 : number[node];
  return patch;
}

// A power of two near the mean length of the edges: coordinates over it lose no bit.
double unit_of(const Patch& patch, std::span<const Vec3> rest) {
  double sum = 0;
  for (const Simplex& s : patch.simplices)
    sum += (rest[patch.nodes[s[1]]] - rest[patch.nodes[s[0]]]).norm();
  return std::exp2(std::round(std::log2(sum / static_cast<double>(patch.simplices.size()))));
}

template <int dim>
using Frame = Eigen::Matrix<double, dim, 3>;

// Rows: the axes of the coordinates that count.
template <int dim>
Frame<dim> frame_of(const std::optional<Vec3>& plane_normal) {
  Frame<dim> frame = Frame<dim>::Identity();
  if constexpr (dim == 2) {
    const Vec3 first = plane_normal->unitOrthogonal();
    frame.row(0) = first;
    frame.row(1) = plane_normal->cross(first);
  }
  return frame;
}

template <int space>
std::vector<Eigen::Matrix<double, space, 1>> in_frame(const Frame<space>& frame, const Patch& patch,
                                                      std::span<const Vec3> positions) {
  std::vector<Eigen::Matrix<double, space, 1>> result;
  result.reserve(patch.nodes.size());
  for (const Index node : patch.nodes) result.push_back(frame * positions[node]);
  return result;
}

// The regular tetrahedron with the mean edge of this one, on the same side as it.
Eigen::Matrix3d regular(const Eigen::Matrix3d& shape) {
  double sum = shape.colwise().norm().sum();
  for (int k = 0; k < 3; ++k) sum += (shape.col((k + 1) % 3) - shape.col(k)).norm();
  Eigen::Matrix3d unit;
  unit << 1, 0.5, 0.5, 0, std::sqrt(3.0) / 2, std::sqrt(3.0) / 6, 0, 0, std::sqrt(2.0 / 3);
  unit.row(2) *= shape.determinant() < 0 ? -1 : 1;
  return sum / 6 * unit;
}

// Edges from the first corner, one a column.
template <int dim, int space>
Eigen::Matrix<double, space, dim> rest_edges(const Frame<space>& frame, const Patch& patch,
                                             const Simplex& simplex, const Simplices& simplices) {
  Eigen::Matrix<double, space, dim> edges;
  for (std::size_t k = 1; k <= dim; ++k)
    edges.col(static_cast<Eigen::Index>(k) - 1) =
        frame * (simplices.rest[patch.nodes[simplex[k]]] - simplices.rest[patch.nodes[simplex[0]]]);
  return edges;
}

// Of a triangle in space, the axes of its plane.
Frame<2> frame_of(const Eigen::Matrix<double, 3, 2>& edges) {
  Frame<2> frame;
  frame.row(0) = edges.col(0).normalized();
  frame.row(1) = edges.col(0).cross(edges.col(1)).normalized().cross(Vec3(frame.row(0)));
  return frame;
}

template <int dim, int space>
Distortion<dim, space> make_distortion(const Frame<space>& frame, const Patch& patch,
                                       const Simplices& simplices,
                                       std::span<const Vec3> positions) {
  std::vector<typename Distortion<dim, space>::Corners> corners_of;
  std::vector<Eigen::Matrix<double, dim, dim>> shapes;
  std::vector<Eigen::Matrix<double, dim, space>> frames;
  for (const Simplex& simplex : patch.simplices) {
    std::copy_n(simplex.begin(), dim + 1, corners_of.emplace_back().begin());
    const auto edges = rest_edges<dim, space>(frame, patch, simplex, simplices);
    if constexpr (dim != space) frames.push_back(frame_of(edges));
    if constexpr (dim != space) shapes.push_back(frames.back() * edges);
    if constexpr (dim == space) shapes.push_back(edges);
    const auto is_new = [&](Index i) { return patch.nodes[i] >= simplices.first_new_node; };
    if constexpr (dim == 3)
      if (std::any_of(simplex.begin(), simplex.end(), is_new))
        shapes.back() = regular(shapes.back());
  }
  return {shapes, std::move(corners_of), in_frame<space>(frame, patch, positions), patch.n_free,
          std::move(frames)};
}

LBFGSpp::LBFGSParam<double> parameters(const UntangleOptions& options) {
  LBFGSpp::LBFGSParam<double> result;
  result.m = 8;
  result.linesearch = LBFGSpp::LBFGS_LINESEARCH_BACKTRACKING_WOLFE;
  result.max_iterations = options.most_iterations;
  result.epsilon = 0;
  result.epsilon_rel = 1e-10;
  // Stop where ten iterations gain less than a thousandth.
  result.past = 10;
  result.delta = 1e-3;
  return result;
}

// A function of the numbers that the coordinates of tied nodes depend on.
template <int dim, int space>
class TiedDistortion {
 public:
  TiedDistortion(Distortion<dim, space>& distortion, const TiedPoints<space>& tied)
      : distortion_(distortion), tied_(tied), start_(distortion.free_points()) {}

  void set_epsilon(double epsilon) { distortion_.set_epsilon(epsilon); }
  double operator()(const Eigen::VectorXd& q, Eigen::VectorXd& gradient) {
    Eigen::VectorXd by_points;
    const double value = distortion_(points(q), by_points);
    gradient = tied_.reduced(by_points);
    return value;
  }
  Determinants determinants(const Eigen::VectorXd& q) {
    return distortion_.determinants(points(q));
  }

 private:
  Eigen::VectorXd points(const Eigen::VectorXd& q) const { return start_ + tied_.shifts(q); }

  Distortion<dim, space>& distortion_;
  const TiedPoints<space>& tied_;
  Eigen::VectorXd start_;
};

// Minimizes from x on; false where the line search fails, which it tells by exceptions of these
// kinds.
template <class Energy>
bool minimize(LBFGSpp::LBFGSSolver<double>& solver, Energy& distortion, Eigen::VectorXd& x) {
  double value = 0;
  try {
    solver.minimize(distortion, x, value);
  } catch (const std::runtime_error&) {
    return false;
  } catch (const std::logic_error&) {
    return false;
  }
  return true;
}

// One round of L-BFGS. Where it fails, it has gone as far as it can.
template <class Energy>
void descend(Energy& distortion, const UntangleOptions& options, Eigen::VectorXd& x) {
  const auto parameter = parameters(options);
  LBFGSpp::LBFGSSolver<double> solver(parameter);
  Eigen::VectorXd start = x, gradient;
  const double value_at_start = distortion(start, gradient);
  if (minimize(solver, distortion, x)) return;
  if (!x.allFinite() || !(distortion(x, gradient) <= value_at_start)) x = std::move(start);
}

// Eq. 52.
double epsilon_for(double smallest_determinant) {
  const double negative = std::min(0.0, smallest_determinant);
  return std::sqrt(1e-12 + 0.04 * negative * negative);
}

// A round that starts without inverted simplices keeps them so, and is the last. Rounds in vain
// tell that there may be no solution.
template <class Energy>
bool minimize(Energy& distortion, const UntangleOptions& options, Eigen::VectorXd& x) {
  Determinants now = distortion.determinants(x);
  int in_vain = 0;
  for (int round = 0; round < options.most_rounds && in_vain < options.most_in_vain; ++round) {
    if (!std::isfinite(now.smallest)) return false;
    distortion.set_epsilon(epsilon_for(now.smallest));
    descend(distortion, options, x);
    if (now.n_negative == 0) break;
    const Determinants next = distortion.determinants(x);
    in_vain = next.n_negative < now.n_negative ? 0 : in_vain + 1;
    now = next;
  }
  return distortion.determinants(x).n_negative == 0;
}

// Moves the free nodes of a patch; returns how far, and whether none of its simplices is inverted.
template <int dim, int space>
std::pair<Eigen::VectorXd, bool> solve(Distortion<dim, space>& distortion, const Patch& patch,
                                       const Simplices& simplices, const Frame<space>& axes,
                                       const UntangleOptions& options) {
  const std::span free_nodes = std::span(patch.nodes).first(static_cast<std::size_t>(patch.n_free));
  const Eigen::VectorXd before = distortion.free_points();
  if (std::none_of(free_nodes.begin(), free_nodes.end(),
                   [&](Index node) { return simplices.ties.is_tied(node); })) {
    Eigen::VectorXd x = before;
    const bool is_valid = minimize(distortion, options, x);
    return {x - before, is_valid};
  }
  const TiedPoints<space> tied(simplices.ties, free_nodes, axes, before);
  TiedDistortion<dim, space> energy(distortion, tied);
  Eigen::VectorXd q = tied.start();
  const bool is_valid = minimize(energy, options, q);
  return {tied.shifts(q), is_valid};
}

template <int dim, int space>
bool untangle_patch(const Patch& patch, const Simplices& simplices, std::vector<Vec3>& positions,
                    const UntangleOptions& options) {
  const double unit = unit_of(patch, simplices.rest);
  const Frame<space> axes = frame_of<space>(simplices.plane_normal);
  Distortion<dim, space> distortion =
      make_distortion<dim, space>(axes / unit, patch, simplices, positions);
  const auto [shifts, is_valid] = solve<dim, space>(distortion, patch, simplices, axes, options);
  for (Index i = 0; i < patch.n_free; ++i) {
    const Eigen::Index at = static_cast<Eigen::Index>(i) * space;
    positions[patch.nodes[i]] += unit * axes.transpose() * shifts.template segment<space>(at);
  }
  return is_valid;
}

}  // namespace

bool untangle(const Simplices& simplices, const NodeFlags& is_free, std::vector<Vec3>& positions,
              const UntangleOptions& options) {
  const Patch patch = make_patch(simplices, is_free);
  if (patch.simplices.empty()) return true;
  const auto run = patch.simplices.front()[3] >= 0 ? untangle_patch<3, 3>
                   : simplices.plane_normal        ? untangle_patch<2, 2>
                                                   : untangle_patch<2, 3>;
  return run(patch, simplices, positions, options);
}

}  // namespace roughmesh::detail
