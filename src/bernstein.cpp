// SPDX-License-Identifier: BSD-3-Clause
#include "bernstein.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

namespace roughmesh::detail {
namespace {

// Those of a hexahedron: degrees 1, 2, 2, and 4, 3, 3 of the product of two.
constexpr std::size_t most_derivative_monomials = 18;
constexpr std::size_t most_minors = 80;

double binomial(int n, int k) {
  double result = 1;
  for (int i = 1; i <= k; ++i) result = result * (n - k + i) / i;
  return result;
}

double multinomial(const Exponents& e, const std::vector<SimplexFactor>& factors) {
  double product = 1;
  for (const SimplexFactor& factor : factors) {
    int sum = 0;
    for (int v = factor.first; v <= factor.first + factor.dimension; ++v) {
      sum += e[static_cast<std::size_t>(v)];
      product *= binomial(sum, e[static_cast<std::size_t>(v)]);
    }
  }
  return product;
}

Exponents sum_of(Exponents a, const Exponents& b) {
  for (std::size_t v = 0; v < a.size(); ++v) a[v] = static_cast<std::uint8_t>(a[v] + b[v]);
  return a;
}

std::vector<int> sum_of(std::vector<int> a, const std::vector<int>& b) {
  for (std::size_t f = 0; f < a.size(); ++f) a[f] += b[f];
  return a;
}

std::map<Exponents, std::size_t> positions_of(const std::vector<Exponents>& monomials) {
  std::map<Exponents, std::size_t> index;
  for (std::size_t k = 0; k < monomials.size(); ++k) index[monomials[k]] = k;
  return index;
}

// For each pair of monomials the position of its product.
std::vector<std::size_t> products(const std::vector<Exponents>& a, const std::vector<Exponents>& b,
                                  const std::map<Exponents, std::size_t>& index) {
  std::vector<std::size_t> result;
  for (const Exponents& left : a)
    for (const Exponents& right : b) result.push_back(index.at(sum_of(left, right)));
  return result;
}

std::array<double, most_variables> grid_point(const Exponents& e,
                                              const std::vector<SimplexFactor>& factors) {
  std::array<double, most_variables> point{};
  for (const SimplexFactor& factor : factors) {
    const auto first = static_cast<std::size_t>(factor.first);
    const std::size_t last = first + static_cast<std::size_t>(factor.dimension);
    int degree = 0;
    for (std::size_t v = first; v <= last; ++v) degree += e[v];
    for (std::size_t v = first; v <= last; ++v) point[v] = static_cast<double>(e[v]) / degree;
  }
  return point;
}

bool is_corner(const Exponents& e, const std::vector<SimplexFactor>& factors) {
  return std::all_of(factors.begin(), factors.end(), [&](const SimplexFactor& factor) {
    const auto* const begin = e.begin() + factor.first;
    return std::count_if(begin, begin + factor.dimension + 1,
                         [](int power) { return power > 0; }) == 1;
  });
}

}  // namespace

std::vector<JacobianPolynomial::Term> JacobianPolynomial::terms_of(
    const MapDerivative& derivative) {
  std::vector<Term> terms;
  for (Eigen::Index k = 0; k < derivative.of_nodes.rows(); ++k)
    for (Eigen::Index i = 0; i < derivative.of_nodes.cols(); ++i)
      if (derivative.of_nodes(k, i) != 0)
        terms.push_back(
            {static_cast<std::size_t>(k), static_cast<std::size_t>(i), derivative.of_nodes(k, i)});
  return terms;
}

// In a plane, the first derivative is the constant normal.
JacobianPolynomial::JacobianPolynomial(const QuadraticMap& map) : map_(map) {
  for (const MapDerivative& derivative : map.derivatives) terms_.push_back(terms_of(derivative));
  const std::size_t last = map.derivatives.size() - 1;
  const MapDerivative &b = map.derivatives[last - 1], &c = map.derivatives[last];
  std::vector<int> degrees = sum_of(b.degrees, c.degrees);
  const std::vector<Exponents> minors = monomials(map.factors, degrees);
  n_minors_ = minors.size();
  minor_of_ = products(b.monomials, c.monomials, positions_of(minors));
  if (last == 2) degrees = sum_of(degrees, map.derivatives[0].degrees);
  exponents_ = monomials(map.factors, degrees);
  index_ = positions_of(exponents_);
  if (last == 2) product_of_ = products(map.derivatives[0].monomials, minors, index_);
  for (std::size_t k = 0; k < exponents_.size(); ++k) {
    inverse_multinomials_.push_back(1 / multinomial(exponents_[k], map.factors));
    if (is_corner(exponents_[k], map.factors)) corners_.push_back(k);
  }
  const auto n = static_cast<Eigen::Index>(exponents_.size());
  values_.resize(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto of = static_cast<std::size_t>(k);
      values_(i, k) =
          value(exponents_[of], grid_point(exponents_[static_cast<std::size_t>(i)], map.factors)) /
          inverse_multinomials_[of];
    }
}

const JacobianPolynomial* JacobianPolynomial::of(const ElementType& type) {
  using All = std::map<const QuadraticMap*, std::unique_ptr<const JacobianPolynomial>>;
  static const All all = [] {
    All result;
    for (int shape = 0; shape < 8; ++shape)
      for (int n = 1; n <= static_cast<int>(most_quadratic_nodes); ++n)
        if (const auto* map = quadratic_map({static_cast<ElementShape>(shape), 2, n}))
          result[map] = std::make_unique<const JacobianPolynomial>(*map);
    return result;
  }();
  const QuadraticMap* const map = quadratic_map(type);
  return map == nullptr ? nullptr : all.at(map).get();
}

// Monomials are multiplied, and only what comes out is put into Bernstein form.
std::vector<double> JacobianPolynomial::coefficients(std::span<const Vec3> nodes,
                                                     const Vec3& normal) const {
  const std::size_t last = map_.derivatives.size() - 1;
  std::array<std::array<Vec3, most_derivative_monomials>, 3> derivatives;
  for (std::size_t j = 0; j <= last; ++j) {
    const std::size_t n = map_.derivatives[j].monomials.size();
    std::fill_n(derivatives[j].begin(), n, Vec3::Zero());
    for (const Term& term : terms_[j])
      derivatives[j][term.monomial] += term.weight * nodes[term.node];
  }
  const std::size_t n_b = map_.derivatives[last - 1].monomials.size();
  const std::size_t n_c = map_.derivatives[last].monomials.size();
  std::array<Vec3, most_minors> minors;
  std::fill_n(minors.begin(), n_minors_, Vec3::Zero());
  for (std::size_t i = 0; i < n_b; ++i)
    for (std::size_t j = 0; j < n_c; ++j)
      minors[minor_of_[i * n_c + j]] += derivatives[last - 1][i].cross(derivatives[last][j]);
  std::vector<double> result(exponents_.size(), 0.0);
  if (last == 1) {
    for (std::size_t k = 0; k < result.size(); ++k) result[k] = normal.dot(minors[k]);
  } else {
    for (std::size_t i = 0; i < map_.derivatives[0].monomials.size(); ++i)
      for (std::size_t j = 0; j < n_minors_; ++j)
        result[product_of_[i * n_minors_ + j]] += derivatives[0][i].dot(minors[j]);
  }
  for (std::size_t k = 0; k < result.size(); ++k) result[k] *= inverse_multinomials_[k];
  return result;
}

std::vector<double> JacobianPolynomial::values(std::span<const double> coefficients) const {
  std::vector<double> result(coefficients.size());
  Eigen::Map<Eigen::VectorXd>(result.data(), values_.rows()).noalias() =
      values_ * Eigen::Map<const Eigen::VectorXd>(coefficients.data(), values_.cols());
  return result;
}

// The polynomial on the half whose vertex `moved` is the middle of the edge from `kept`: there
// lambda_kept = mu_kept + mu_moved / 2 and lambda_moved = mu_moved / 2, which in Bernstein form is
// de Casteljau's mean.
std::vector<double> JacobianPolynomial::half(std::span<const double> coefficients, int kept,
                                             int moved) const {
  std::vector<double> result(coefficients.size());
  for (std::size_t k = 0; k < result.size(); ++k) {
    Exponents e = exponents_[k];
    const int n = e[static_cast<std::size_t>(moved)];
    double sum = 0;
    for (int i = 0; i <= n; ++i) {
      sum += binomial(n, i) * coefficients[index_.at(e)];
      --e[static_cast<std::size_t>(moved)];
      ++e[static_cast<std::size_t>(kept)];
    }
    result[k] = std::ldexp(sum, -n);
  }
  return result;
}

std::pair<JacobianPolynomial::Piece, JacobianPolynomial::Piece> JacobianPolynomial::halves(
    const Piece& piece) const {
  double longest = -1;
  std::array<int, 2> ends{};
  for (const SimplexFactor& factor : map_.factors)
    for (int p = factor.first; p <= factor.first + factor.dimension; ++p)
      for (int q = p + 1; q <= factor.first + factor.dimension; ++q) {
        const double length = (piece.vertices[static_cast<std::size_t>(p)] -
                               piece.vertices[static_cast<std::size_t>(q)])
                                  .squaredNorm();
        if (length <= longest) continue;
        longest = length;
        ends = {p, q};
      }
  const auto make = [&](int kept, int moved) {
    Piece result{half(piece.coefficients, kept, moved), piece.vertices};
    Vec3& vertex = result.vertices[static_cast<std::size_t>(moved)];
    vertex = (vertex + piece.vertices[static_cast<std::size_t>(kept)]) / 2;
    return result;
  };
  return {make(ends[0], ends[1]), make(ends[1], ends[0])};
}

double JacobianPolynomial::least_at_corners(std::span<const double> coefficients) const {
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t k : corners_) least = std::min(least, coefficients[k]);
  return least;
}

LeastValue JacobianPolynomial::least(std::vector<double> coefficients) const {
  Piece whole{std::move(coefficients), {}};
  for (const SimplexFactor& factor : map_.factors)
    for (int v = 0; v <= factor.dimension; ++v) {
      Vec3& vertex = whole.vertices[static_cast<std::size_t>(factor.first) + v];
      vertex = v == 0 ? Vec3(Vec3::Zero()) : Vec3(Vec3::Unit(v - 1));
    }
  LeastValue result{std::numeric_limits<double>::infinity(), true};
  constexpr double tight = 0.9;
  double reached = std::numeric_limits<double>::infinity();
  std::vector<Piece> open{std::move(whole)};
  for (int n_pieces = 1; !open.empty(); n_pieces += 2) {
    const Piece piece = std::move(open.back());
    open.pop_back();
    const double bound = *std::min_element(piece.coefficients.begin(), piece.coefficients.end());
    const double at_corners = least_at_corners(piece.coefficients);
    // Written so that not-a-number is refuted.
    if (!(at_corners > 0)) return {at_corners, false};
    reached = std::min(reached, at_corners);
    if (bound > 0 && (bound >= tight * reached || n_pieces >= most_for_precision)) {
      result.value = std::min(result.value, bound);
      continue;
    }
    if (n_pieces >= most_pieces) return {0, false};
    auto [a, b] = halves(piece);
    open.push_back(std::move(a));
    open.push_back(std::move(b));
  }
  return result;
}

}  // namespace roughmesh::detail
