// SPDX-License-Identifier: BSD-3-Clause
#include "tied_nodes.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace roughmesh::detail {
namespace {

// Completes orthonormal columns, each time by the axis farthest from their span: where they are
// axes themselves, the others come out exactly.
template <int dim>
Eigen::Matrix<double, dim, dim> completed(std::span<const Eigen::Matrix<double, dim, 1>> columns) {
  using Vector = Eigen::Matrix<double, dim, 1>;
  Eigen::Matrix<double, dim, dim> result;
  Eigen::Index n = 0;
  for (const Vector& column : columns) result.col(n++) = column;
  for (; n < dim; ++n) {
    Vector farthest = Vector::Zero();
    for (Eigen::Index axis = 0; axis < dim; ++axis) {
      Vector rest = Vector::Unit(axis);
      for (Eigen::Index k = 0; k < n; ++k) rest -= result.col(k).dot(rest) * result.col(k);
      if (rest.norm() > farthest.norm()) farthest = rest;
    }
    result.col(n) = farthest.normalized();
  }
  return result;
}

}  // namespace

std::span<const SlidingNode> NodeTies::of(Index node) const {
  const auto first = std::lower_bound(sliding.begin(), sliding.end(), node,
                                      [](const SlidingNode& s, Index n) { return s.node < n; });
  auto end = first;
  while (end != sliding.end() && end->node == node) ++end;
  return {first, end};
}

template <int dim>
TiedPoints<dim>::TiedPoints(const NodeTies& ties, std::span<const Index> nodes,
                            const Eigen::Matrix<double, dim, 3>& axes,
                            const Eigen::VectorXd& start) {
  std::map<Index, Index> class_of_image;
  std::vector<double> q;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto [at, is_new] =
        class_of_image.try_emplace(ties.image(nodes[i]), static_cast<Index>(bases_.size()));
    class_of_node_.push_back(at->second);
    if (!is_new) continue;
    bases_.push_back(free_directions(ties.of(nodes[i]), axes));
    const auto x = start.template segment<dim>(static_cast<Eigen::Index>(i) * dim);
    const Eigen::VectorXd own = bases_.back().transpose() * x;
    q.insert(q.end(), own.begin(), own.end());
    first_.push_back(static_cast<Eigen::Index>(q.size()));
  }
  start_ = Eigen::Map<const Eigen::VectorXd>(q.data(), static_cast<Eigen::Index>(q.size()));
}

template <int dim>
typename TiedPoints<dim>::Basis TiedPoints<dim>::free_directions(
    std::span<const SlidingNode> normals, const Eigen::Matrix<double, dim, 3>& axes) {
  std::vector<Eigen::Matrix<double, dim, 1>> across;
  for (const SlidingNode& each : normals) across.push_back(axes * each.normal);
  const Eigen::Matrix<double, dim, dim> all = completed<dim>(across);
  return all.rightCols(dim - static_cast<Eigen::Index>(across.size()));
}

template <int dim>
Eigen::VectorXd TiedPoints<dim>::shifts(const Eigen::VectorXd& q) const {
  const Eigen::VectorXd step = q - start_;
  Eigen::VectorXd result(static_cast<Eigen::Index>(class_of_node_.size()) * dim);
  for (std::size_t i = 0; i < class_of_node_.size(); ++i) {
    const Basis& basis = bases_[class_of_node_[i]];
    result.template segment<dim>(static_cast<Eigen::Index>(i) * dim) =
        basis * step.segment(first_[class_of_node_[i]], basis.cols());
  }
  return result;
}

template <int dim>
Eigen::VectorXd TiedPoints<dim>::reduced(const Eigen::VectorXd& gradient) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(start_.size());
  for (std::size_t i = 0; i < class_of_node_.size(); ++i) {
    const Basis& basis = bases_[class_of_node_[i]];
    result.segment(first_[class_of_node_[i]], basis.cols()) +=
        basis.transpose() * gradient.template segment<dim>(static_cast<Eigen::Index>(i) * dim);
  }
  return result;
}

template class TiedPoints<2>;
template class TiedPoints<3>;

}  // namespace roughmesh::detail
