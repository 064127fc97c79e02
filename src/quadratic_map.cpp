// SPDX-License-Identifier: BSD-3-Clause
#include "quadratic_map.hpp"

#include <algorithm>
#include <map>
#include <memory>

#include <Eigen/LU>

#include "element_nodes.hpp"

namespace roughmesh::detail {
namespace {

using Variables = std::array<double, most_variables>;

std::vector<SimplexFactor> factors_of(ElementShape shape) {
  switch (shape) {
    case ElementShape::triangle:
      return {{0, 2}};
    case ElementShape::tetrahedron:
      return {{0, 3}};
    case ElementShape::quadrangle:
      return {{0, 1}, {2, 1}};
    case ElementShape::hexahedron:
      return {{0, 1}, {2, 1}, {4, 1}};
    case ElementShape::prism:
      return {{0, 2}, {3, 1}};
    default:
      return {};
  }
}

Variables corner_variables(ElementShape shape, int corner) {
  Variables variables{};
  const int in_face = shape == ElementShape::prism ? corner % 3 : corner % 4;
  if (shape == ElementShape::quadrangle || shape == ElementShape::hexahedron) {
    variables[in_face == 1 || in_face == 2 ? 1 : 0] = 1;
    variables[in_face >= 2 ? 3 : 2] = 1;
    if (shape == ElementShape::hexahedron) variables[corner >= 4 ? 5 : 4] = 1;
  } else {
    variables[static_cast<std::size_t>(in_face)] = 1;
    if (shape == ElementShape::prism) variables[corner >= 3 ? 4 : 3] = 1;
  }
  return variables;
}

// Appends the exponents of one factor to each monomial so far.
std::vector<Exponents> times_factor(const std::vector<Exponents>& so_far,
                                    const SimplexFactor& factor, int degree) {
  std::vector<Exponents> result = so_far;
  for (int d = 0; d < degree; ++d) {
    std::vector<Exponents> next;
    for (Exponents e : result)
      for (int v = factor.first; v <= factor.first + factor.dimension; ++v) {
        ++e[static_cast<std::size_t>(v)];
        next.push_back(e);
        --e[static_cast<std::size_t>(v)];
      }
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    result = std::move(next);
  }
  return result;
}

// The type with a node for every monomial, and its nodes as sums of those of `type`, `weights` by
// nodes of the former and the latter.
struct Complete {
  ElementType type;
  Eigen::MatrixXd weights;
};

Complete complete(const ElementType& type, int n_monomials) {
  Complete result{{type.shape, 2, n_monomials},
                  Eigen::MatrixXd::Identity(n_monomials, type.n_nodes)};
  for (const FollowingNode& middle : following_nodes(result.type)) {
    if (middle.node < type.n_nodes) continue;
    for (const auto& [other, weight] : middle.of_others)
      result.weights.row(middle.node) += weight * result.weights.row(other);
  }
  return result;
}

// Formulas that are exact for quadratic functions give positions from those of the corners.
Eigen::MatrixXd straight_nodes(const ElementType& type) {
  const int corners = n_corners(type.shape);
  Eigen::MatrixXd result = Eigen::MatrixXd::Identity(type.n_nodes, corners);
  for (const FollowingNode& node : following_nodes(type))
    for (const auto& [other, weight] : node.of_others)
      result.row(node.node) += weight * result.row(other);
  return result;
}

std::vector<Variables> node_variables(const ElementType& type) {
  const Eigen::MatrixXd straight = straight_nodes(type);
  std::vector<Variables> result(static_cast<std::size_t>(type.n_nodes), Variables{});
  for (int node = 0; node < type.n_nodes; ++node)
    for (int corner = 0; corner < n_corners(type.shape); ++corner)
      for (std::size_t v = 0; v < most_variables; ++v)
        result[static_cast<std::size_t>(node)][v] +=
            straight(node, corner) * corner_variables(type.shape, corner)[v];
  return result;
}

// Coefficients of the monomials by nodes: what interpolates.
Eigen::MatrixXd interpolation(const ElementType& type, const std::vector<Exponents>& monomials) {
  const Complete full = complete(type, static_cast<int>(monomials.size()));
  const std::vector<Variables> nodes = node_variables(full.type);
  Eigen::MatrixXd values(nodes.size(), monomials.size());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t k = 0; k < monomials.size(); ++k)
      values(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          value(monomials[k], nodes[i]);
  // All are multiples of 1/4: without round-off, zeros are zeros.
  return (4 * values.partialPivLu().solve(full.weights)).array().round() / 4;
}

// With the first variable of a factor as 1 minus the others, the derivative by one of these is that
// by the variable less that by the first.
MapDerivative derive(const std::vector<SimplexFactor>& factors, std::size_t factor, int variable,
                     const std::vector<Exponents>& from, const Eigen::MatrixXd& of_nodes) {
  MapDerivative result;
  result.degrees.assign(factors.size(), 2);
  result.degrees[factor] = 1;
  result.monomials = monomials(factors, result.degrees);
  result.of_nodes.setZero(static_cast<Eigen::Index>(result.monomials.size()), of_nodes.cols());
  const auto add = [&](Exponents e, Eigen::Index row, int v, double sign) {
    const int power = e[static_cast<std::size_t>(v)]--;
    if (power == 0) return;
    const auto at = std::find(result.monomials.begin(), result.monomials.end(), e);
    result.of_nodes.row(at - result.monomials.begin()) += sign * power * of_nodes.row(row);
  };
  for (std::size_t k = 0; k < from.size(); ++k) {
    add(from[k], static_cast<Eigen::Index>(k), variable, 1);
    add(from[k], static_cast<Eigen::Index>(k), factors[factor].first, -1);
  }
  return result;
}

std::unique_ptr<const QuadraticMap> make_map(const ElementType& type) {
  auto map = std::make_unique<QuadraticMap>();
  map->factors = factors_of(type.shape);
  if (map->factors.empty()) return nullptr;
  map->straight = straight_nodes(type);
  const std::vector<Exponents> all =
      monomials(map->factors, std::vector<int>(map->factors.size(), 2));
  const Eigen::MatrixXd of_nodes = interpolation(type, all);
  for (std::size_t f = 0; f < map->factors.size(); ++f)
    for (int v = 1; v <= map->factors[f].dimension; ++v)
      map->derivatives.push_back(derive(map->factors, f, map->factors[f].first + v, all, of_nodes));
  return map;
}

constexpr std::array<ElementType, 8> types = {{{ElementShape::triangle, 2, 6},
                                               {ElementShape::quadrangle, 2, 8},
                                               {ElementShape::quadrangle, 2, 9},
                                               {ElementShape::tetrahedron, 2, 10},
                                               {ElementShape::hexahedron, 2, 20},
                                               {ElementShape::hexahedron, 2, 27},
                                               {ElementShape::prism, 2, 15},
                                               {ElementShape::prism, 2, 18}}};

using Maps = std::map<std::pair<ElementShape, int>, std::unique_ptr<const QuadraticMap>>;

Maps make_maps() {
  Maps maps;
  for (const ElementType& type : types) maps[{type.shape, type.n_nodes}] = make_map(type);
  return maps;
}

}  // namespace

std::vector<Exponents> monomials(const std::vector<SimplexFactor>& factors,
                                 const std::vector<int>& degrees) {
  std::vector<Exponents> result{Exponents{}};
  for (std::size_t f = 0; f < factors.size(); ++f)
    result = times_factor(result, factors[f], degrees[f]);
  return result;
}

double value(const Exponents& monomial, const std::array<double, most_variables>& variables) {
  double product = 1;
  for (std::size_t v = 0; v < most_variables; ++v)
    for (int power = 0; power < monomial[v]; ++power) product *= variables[v];
  return product;
}

const QuadraticMap* quadratic_map(const ElementType& type) {
  if (type.order != 2) return nullptr;
  static const Maps maps = make_maps();
  const auto found = maps.find({type.shape, type.n_nodes});
  return found == maps.end() ? nullptr : found->second.get();
}

}  // namespace roughmesh::detail
