// SPDX-License-Identifier: BSD-3-Clause
#include "p2_harmonic.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include <Eigen/LU>

#include "quadratic_map.hpp"

namespace roughmesh::detail {
namespace {

// The determinant over the longest edge to the power of the dimension, below which an element is
// left out.
constexpr double flat = 1e-10;

struct QuadraturePoint {
  std::array<double, most_variables> variables{};
  double weight = 1;
};

// Gauss' three points, exact to degree 5.
constexpr std::array<std::pair<double, double>, 3> gauss = {
    {{0.1127016653792583, 5.0 / 18}, {0.5, 8.0 / 18}, {0.8872983346207417, 5.0 / 18}}};

// On a line; on a triangle as a square with one side shrunk to a point, exact to degree 4; on a
// tetrahedron the four points that are exact to degree 2, that of the integrand there.
std::vector<QuadraturePoint> rule(const SimplexFactor& factor) {
  std::vector<QuadraturePoint> points;
  const auto first = static_cast<std::size_t>(factor.first);
  const auto add = [&](std::initializer_list<double> variables, double weight) {
    QuadraturePoint point;
    std::copy(variables.begin(), variables.end(), point.variables.begin() + first);
    point.weight = weight;
    points.push_back(point);
  };
  if (factor.dimension == 1)
    for (const auto& [s, weight] : gauss) add({1 - s, s}, weight);
  if (factor.dimension == 2)
    for (const auto& [s, of_s] : gauss)
      for (const auto& [t, of_t] : gauss)
        add({1 - s - t * (1 - s), s, t * (1 - s)}, of_s * of_t * (1 - s));
  if (factor.dimension == 3) {
    constexpr double a = 0.5854101966249685, b = 0.1381966011250105;
    add({a, b, b, b}, 1.0 / 24);
    add({b, a, b, b}, 1.0 / 24);
    add({b, b, a, b}, 1.0 / 24);
    add({b, b, b, a}, 1.0 / 24);
  }
  return points;
}

// The product of two rules.
std::vector<QuadraturePoint> product(const std::vector<QuadraturePoint>& a,
                                     const std::vector<QuadraturePoint>& b) {
  std::vector<QuadraturePoint> points;
  for (const QuadraturePoint& left : a)
    for (const QuadraturePoint& right : b) {
      QuadraturePoint point = left;
      for (std::size_t v = 0; v < most_variables; ++v) point.variables[v] += right.variables[v];
      point.weight *= right.weight;
      points.push_back(point);
    }
  return points;
}

// Gradients of the shape functions in the reference element, at the points of a quadrature.
struct Gradients {
  std::vector<double> weights;
  std::vector<Eigen::MatrixXd> of_nodes;    // at each point, nodes by coordinates
  std::vector<Eigen::MatrixXd> of_corners;  // of those of the straight element
};

Gradients make_gradients(const QuadraticMap& map) {
  std::vector<QuadraturePoint> points(1);
  for (const SimplexFactor& factor : map.factors) points = product(points, rule(factor));
  Gradients result;
  for (const QuadraturePoint& point : points) {
    Eigen::MatrixXd at(map.straight.rows(), map.derivatives.size());
    for (std::size_t j = 0; j < map.derivatives.size(); ++j) {
      const MapDerivative& derivative = map.derivatives[j];
      Eigen::RowVectorXd values(derivative.monomials.size());
      for (std::size_t k = 0; k < derivative.monomials.size(); ++k)
        values[static_cast<Eigen::Index>(k)] = value(derivative.monomials[k], point.variables);
      at.col(static_cast<Eigen::Index>(j)) = (values * derivative.of_nodes).transpose();
    }
    result.weights.push_back(point.weight);
    result.of_corners.emplace_back(map.straight.transpose() * at);
    result.of_nodes.push_back(std::move(at));
  }
  return result;
}

const Gradients& gradients(const ElementType& type) {
  static const auto all = [] {
    std::map<const QuadraticMap*, Gradients> result;
    for (int shape = 0; shape < 8; ++shape)
      for (int n = 1; n <= static_cast<int>(most_quadratic_nodes); ++n)
        if (const auto* map = quadratic_map({static_cast<ElementShape>(shape), 2, n}))
          result[map] = make_gradients(*map);
    return result;
  }();
  return all.at(quadratic_map(type));
}

// At most 3 by 3 and most_quadratic_nodes by 3, on the stack.
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
using PerNode = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                              static_cast<int>(most_quadratic_nodes), 3>;

// The straight element between the corners, in space also where it has two dimensions.
struct StraightElement {
  const Gradients& gradients;
  PerNode corners;  // a row each

  StraightElement(const Mesh& mesh, const ElementOfMesh& element)
      : gradients(detail::gradients(element.type(mesh))),
        corners(n_corners(element.type(mesh).shape), 3) {
    const auto nodes = element.nodes(mesh);
    for (Eigen::Index k = 0; k < corners.rows(); ++k)
      corners.row(k) = mesh.nodes[nodes[static_cast<std::size_t>(k)]].transpose();
  }

  // Products of the derivatives by two coordinates; a third, where there is none, is 1.
  Eigen::Matrix3d metric(std::size_t point) const {
    const Small derivatives = corners.transpose() * gradients.of_corners[point];
    Eigen::Matrix3d products = Eigen::Matrix3d::Identity();
    products.topLeftCorner(derivatives.cols(), derivatives.cols()).noalias() =
        derivatives.transpose() * derivatives;
    return products;
  }
  double volume() const {
    double sum = 0;
    for (std::size_t q = 0; q < gradients.weights.size(); ++q)
      sum += gradients.weights[q] * std::sqrt(std::max(0.0, metric(q).determinant()));
    return sum;
  }
  bool is_flat() const {
    double longest = 0;
    for (Eigen::Index a = 0; a < corners.rows(); ++a)
      for (Eigen::Index b = 0; b < a; ++b)
        longest = std::max(longest, (corners.row(a) - corners.row(b)).norm());
    const double least = flat * std::pow(longest, gradients.of_nodes.front().cols());
    for (std::size_t q = 0; q < gradients.weights.size(); ++q)
      if (!(metric(q).determinant() > least * least)) return true;
    return false;
  }
};

std::vector<double> volumes_of(const Mesh& mesh, std::span<const ElementOfMesh> elements) {
  std::vector<double> volumes;
  for (const ElementOfMesh& each : elements) {
    const StraightElement element(mesh, each);
    volumes.push_back(element.is_flat() ? 0 : element.volume());
  }
  return volumes;
}

class Assembly {
 public:
  Assembly(const Mesh& mesh, std::span<const ElementOfMesh> elements, const NodeRoles& roles)
      : mesh_(mesh),
        elements_(elements),
        roles_(roles),
        volumes_(volumes_of(mesh, elements)),
        at_unknown_(static_cast<std::size_t>(roles.n_unknown)) {
    scale_ = std::accumulate(volumes_.begin(), volumes_.end(), 0.0) /
             static_cast<double>(std::max<std::size_t>(1, volumes_.size()));
    for (std::size_t e = 0; e < elements.size(); ++e)
      for (const Index node : elements[e].nodes(mesh))
        if (volumes_[e] > 0 && roles.unknown[node] >= 0) add_once(e, roles.unknown[node]);
  }

  void rows(std::size_t begin, std::size_t end, RowRange& stiffness, RowRange& coupling) const {
    Row unknown, given;
    for (std::size_t i = begin; i < end; ++i) {
      unknown.clear();
      given.clear();
      for (const std::size_t e : at_unknown_[i])
        add_element(e, static_cast<Index>(i), unknown, given);
      // An unknown without an element gets the equation w = 0.
      if (at_unknown_[i].empty()) unknown.add(static_cast<Index>(i), 1);
      stiffness.append(unknown.sorted());
      coupling.append(given.sorted());
    }
  }

 private:
  // Periodic partners of one element are one unknown.
  void add_once(std::size_t element, Index unknown) {
    auto& elements = at_unknown_[static_cast<std::size_t>(unknown)];
    if (elements.empty() || elements.back() != element) elements.push_back(element);
  }

  void add_element(std::size_t number, Index i, Row& unknown, Row& given) const {
    const auto nodes = elements_[number].nodes(mesh_);
    for (std::size_t own = 0; own < nodes.size(); ++own)
      if (roles_.unknown[nodes[own]] == i)
        add_row(number, static_cast<Eigen::Index>(own), unknown, given);
  }

  void add_row(std::size_t number, Eigen::Index own, Row& unknown, Row& given) const {
    const StraightElement element(mesh_, elements_[number]);
    const auto nodes = elements_[number].nodes(mesh_);
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, static_cast<int>(most_quadratic_nodes), 1> row =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(nodes.size()));
    for (std::size_t q = 0; q < element.gradients.weights.size(); ++q) {
      const Eigen::Matrix3d metric = element.metric(q);
      const Eigen::MatrixXd& at = element.gradients.of_nodes[q];
      const Small image =
          metric.inverse().topLeftCorner(at.cols(), at.cols()) * at.row(own).transpose();
      row.noalias() +=
          element.gradients.weights[q] * std::sqrt(metric.determinant()) * (at * image);
    }
    row *= scale_ / volumes_[number];
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const double value = row[static_cast<Eigen::Index>(k)];
      if (roles_.unknown[nodes[k]] >= 0)
        unknown.add(roles_.unknown[nodes[k]], value);
      else if (roles_.given[nodes[k]] >= 0)
        given.add(roles_.given[nodes[k]], value);
    }
  }

  const Mesh& mesh_;
  std::span<const ElementOfMesh> elements_;
  const NodeRoles& roles_;
  std::vector<double> volumes_;  // 0: left out
  std::vector<std::vector<std::size_t>> at_unknown_;
  double scale_ = 1;  // only the ratio of weights matters
};

}  // namespace

QuadraticExtension::QuadraticExtension(const Mesh& mesh, std::span<const ElementOfMesh> elements,
                                       const NodeRoles& roles)
    : system_(roles.n_unknown, roles.n_given,
              [assembly = Assembly(mesh, elements, roles)](
                  std::size_t begin, std::size_t end, RowRange& stiffness, RowRange& coupling) {
                assembly.rows(begin, end, stiffness, coupling);
              }) {}

}  // namespace roughmesh::detail
