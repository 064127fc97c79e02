// SPDX-License-Identifier: BSD-3-Clause
#include "distortion.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t simplices_per_range = 512;
constexpr std::size_t nodes_per_range = 2048;

std::size_t n_ranges(std::size_t n) { return (n + simplices_per_range - 1) / simplices_per_range; }

// NaN if one of them is.
double smaller(double a, double b) { return std::isnan(a) || a <= b ? a : b; }

template <int dim, int space>
Eigen::Matrix<double, space, dim> edges(const std::vector<Eigen::Matrix<double, space, 1>>& points,
                                        const std::array<Index, dim + 1>& corners) {
  Eigen::Matrix<double, space, dim> result;
  for (std::size_t k = 0; k < dim; ++k)
    result.col(static_cast<Eigen::Index>(k)) = points[corners[k + 1]] - points[corners[0]];
  return result;
}

// Matrix of cofactors, the derivative of the determinant.
Eigen::Matrix2d cofactors(const Eigen::Matrix2d& j) {
  Eigen::Matrix2d result;
  result << j(1, 1), -j(1, 0), -j(0, 1), j(0, 0);
  return result;
}

Eigen::Matrix3d cofactors(const Eigen::Matrix3d& j) {
  Eigen::Matrix3d result;
  result.col(0) = j.col(1).cross(j.col(2));
  result.col(1) = j.col(2).cross(j.col(0));
  result.col(2) = j.col(0).cross(j.col(1));
  return result;
}

template <int dim>
double determinant_of(const Eigen::Matrix<double, dim, dim>& j,
                      const Eigen::Matrix<double, dim, dim>& cofactor) {
  return j.col(0).dot(cofactor.col(0));
}

// Positive stand-in for a determinant (eq. 51) and its derivative. Below zero the difference of the
// definition would cancel.
struct Regularized {
  double value;
  double slope;

  Regularized(double det, double epsilon) {
    const double root = std::hypot(det, epsilon);
    value = det > 0 ? (det + root) / 2 : epsilon * epsilon / (2 * (root - det));
    slope = value / root;
  }
};

// value^(-2 / dim)
template <int dim>
double shape_factor(double value) {
  if constexpr (dim == 2) return 1 / value;
  const double root = std::cbrt(value);
  return 1 / (root * root);
}

// Energy of one simplex and its derivative by J (eq. 50).
template <int dim>
double energy(const Eigen::Matrix<double, dim, dim>& j, double epsilon,
              Eigen::Matrix<double, dim, dim>& derivative) {
  const Eigen::Matrix<double, dim, dim> cofactor = cofactors(j);
  const double det = determinant_of<dim>(j, cofactor);
  const Regularized chi(det, epsilon);
  const double factor = shape_factor<dim>(chi.value);
  const double shape = j.squaredNorm() * factor;
  const double size = (det * det + 1) / chi.value;
  const double by_det =
      (det - 0.5 * size * chi.slope) / chi.value - 2.0 / dim * shape * chi.slope / chi.value;
  derivative = 2 * factor * j + by_det * cofactor;
  return (shape - dim) + 0.5 * (size - 2);
}

}  // namespace

template <int dim, int space>
Distortion<dim, space>::Distortion(std::span<const Matrix> rest, std::vector<Corners> simplices,
                                   std::vector<Point> points, Index n_free,
                                   std::vector<Frame> frames)
    : points_(std::move(points)),
      simplices_(std::move(simplices)),
      frames_(std::move(frames)),
      n_free_(n_free) {
  inverse_rest_.reserve(rest.size());
  weights_.reserve(rest.size());
  for (const Matrix& shape : rest) {
    inverse_rest_.push_back(shape.inverse());
    weights_.push_back(std::pow(std::abs(shape.determinant()), 1.0 / dim));
  }
  index_slots();
}

template <int dim, int space>
void Distortion<dim, space>::index_slots() {
  first_slot_.assign(static_cast<std::size_t>(n_free_) + 1, 0);
  const auto is_free = [&](Index node) { return node < n_free_; };
  for (const Corners& corners : simplices_)
    for (const Index node : corners)
      if (is_free(node)) ++first_slot_[node + 1];
  for (std::size_t i = 1; i < first_slot_.size(); ++i) first_slot_[i] += first_slot_[i - 1];
  slots_.resize(first_slot_.back());
  std::vector<std::size_t> next(first_slot_.begin(), first_slot_.end() - 1);
  slot_of_corner_.resize(simplices_.size());
  for (std::size_t t = 0; t < simplices_.size(); ++t)
    for (std::size_t k = 0; k <= dim; ++k) {
      const Index node = simplices_[t][k];
      slot_of_corner_[t][k] = is_free(node) ? static_cast<Index>(next[node]++) : -1;
    }
}

template <int dim, int space>
Eigen::VectorXd Distortion<dim, space>::free_points() const {
  Eigen::VectorXd result(static_cast<Eigen::Index>(n_free_) * space);
  for (Eigen::Index i = 0; i < n_free_; ++i)
    result.template segment<space>(i * space) = points_[static_cast<std::size_t>(i)];
  return result;
}

template <int dim, int space>
void Distortion<dim, space>::place(const Eigen::VectorXd& free_points) {
  for (Eigen::Index i = 0; i < n_free_; ++i)
    points_[static_cast<std::size_t>(i)] = free_points.template segment<space>(i * space);
}

template <int dim, int space>
typename Distortion<dim, space>::Matrix Distortion<dim, space>::jacobian(
    std::size_t simplex) const {
  const Eigen::Matrix<double, space, dim> now = edges<dim, space>(points_, simplices_[simplex]);
  if constexpr (space == dim)
    return now * inverse_rest_[simplex];
  else
    return frames_[simplex] * now * inverse_rest_[simplex];
}

template <int dim, int space>
double Distortion<dim, space>::add_simplex(std::size_t simplex) {
  Matrix derivative;
  const double value = energy<dim>(jacobian(simplex), epsilon_, derivative);
  const Matrix by_seen = weights_[simplex] * derivative * inverse_rest_[simplex].transpose();
  Eigen::Matrix<double, space, dim> by_edges;
  if constexpr (space == dim)
    by_edges = by_seen;
  else
    by_edges = frames_[simplex].transpose() * by_seen;
  const Corners& slot = slot_of_corner_[simplex];
  if (slot[0] >= 0) slots_[slot[0]] = -by_edges.rowwise().sum();
  for (std::size_t k = 1; k <= dim; ++k)
    if (slot[k] >= 0) slots_[slot[k]] = by_edges.col(static_cast<Eigen::Index>(k) - 1);
  return weights_[simplex] * value;
}

template <int dim, int space>
double Distortion<dim, space>::operator()(const Eigen::VectorXd& free_points,
                                          Eigen::VectorXd& gradient) {
  place(free_points);
  std::vector<double> sums(n_ranges(simplices_.size()), 0);
  parallel_for(simplices_.size(), simplices_per_range, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t t = begin; t < end; ++t) sum += add_simplex(t);
    sums[begin / simplices_per_range] = sum;
  });
  gradient.resize(free_points.size());
  const auto n_free = static_cast<std::size_t>(n_free_);
  parallel_for(n_free, nodes_per_range, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Point sum = Point::Zero();
      for (std::size_t s = first_slot_[i]; s < first_slot_[i + 1]; ++s) sum += slots_[s];
      gradient.template segment<space>(static_cast<Eigen::Index>(i) * space) = sum;
    }
  });
  double total = 0;
  for (const double sum : sums) total += sum;
  return total;
}

template <int dim, int space>
Determinants Distortion<dim, space>::determinants(const Eigen::VectorXd& free_points) {
  place(free_points);
  std::vector<Determinants> parts(n_ranges(simplices_.size()));
  parallel_for(simplices_.size(), simplices_per_range, [&](std::size_t begin, std::size_t end) {
    Determinants& part = parts[begin / simplices_per_range];
    for (std::size_t t = begin; t < end; ++t) {
      const Matrix j = jacobian(t);
      const double det = determinant_of<dim>(j, cofactors(j));
      part.smallest = smaller(part.smallest, det);
      if (!(det > 0)) ++part.n_negative;
    }
  });
  Determinants total;
  for (const Determinants& part : parts) {
    total.smallest = smaller(total.smallest, part.smallest);
    total.n_negative += part.n_negative;
  }
  return total;
}

template class Distortion<2>;
template class Distortion<2, 3>;
template class Distortion<3>;

}  // namespace roughmesh::detail
