// SPDX-License-Identifier: BSD-3-Clause
#include "harmonic.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "corners.hpp"
#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

// Six volumes over the cube of the longest edge (two areas over its square), below which a simplex
// is left out.
constexpr double flat = 1e-10;

std::size_t n_corners(const Simplex& simplex) { return simplex[3] < 0 ? 3 : 4; }

std::span<const Index> corners(const Simplex& simplex) {
  return std::span(simplex).first(n_corners(simplex));
}

// Gradients of the linear shape functions.
struct Gradients {
  std::array<Vec3, 4> of_corner;
  bool is_flat = false;
};

Gradients gradients_of_triangle(const Vec3& a, const Vec3& b) {
  const Vec3 normal = a.cross(b);
  const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
  Gradients g;
  g.is_flat = !(normal.norm() > flat * longest);
  if (g.is_flat) return g;
  g.of_corner[1] = b.cross(normal) / normal.squaredNorm();
  g.of_corner[2] = normal.cross(a) / normal.squaredNorm();
  g.of_corner[0] = -(g.of_corner[1] + g.of_corner[2]);
  return g;
}

Gradients gradients_of_tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double det = a.cross(b).dot(c);
  const double longest =
      std::sqrt(std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm(), (b - a).squaredNorm(),
                          (c - b).squaredNorm(), (a - c).squaredNorm()}));
  Gradients g;
  g.is_flat = !(std::abs(det) > flat * longest * longest * longest);
  if (g.is_flat) return g;
  g.of_corner[1] = b.cross(c) / det;
  g.of_corner[2] = c.cross(a) / det;
  g.of_corner[3] = a.cross(b) / det;
  g.of_corner[0] = -(g.of_corner[1] + g.of_corner[2] + g.of_corner[3]);
  return g;
}

Gradients gradients(std::span<const Vec3> nodes, const Simplex& s) {
  const Vec3& origin = nodes[s[0]];
  const Vec3 a = nodes[s[1]] - origin, b = nodes[s[2]] - origin;
  if (n_corners(s) == 3) return gradients_of_triangle(a, b);
  return gradients_of_tetrahedron(a, b, nodes[s[3]] - origin);
}

double volume(std::span<const Vec3> nodes, const Simplex& s) {
  if (n_corners(s) == 3)
    return (nodes[s[1]] - nodes[s[0]]).cross(nodes[s[2]] - nodes[s[0]]).norm() / 2;
  return std::abs(determinant(nodes[s[0]], nodes[s[1]], nodes[s[2]], nodes[s[3]])) / 6;
}

// Only the ratio of weights matters; relative to the mean volume they suit any unit of length.
double mean_volume(std::span<const Vec3> nodes, std::span<const Simplex> simplices) {
  double sum = 0;
  for (const Simplex& s : simplices) sum += volume(nodes, s);
  return simplices.empty() ? 1 : sum / static_cast<double>(simplices.size());
}

// Simplices at each unknown, in ascending order.
struct Adjacency {
  std::vector<std::size_t> offsets;
  std::vector<Index> simplices;

  std::span<const Index> at(std::size_t unknown) const {
    return {simplices.data() + offsets[unknown], offsets[unknown + 1] - offsets[unknown]};
  }
};

template <class Visit>
void for_each_unknown(std::span<const Simplex> simplices, const NodeRoles& roles, Visit&& visit) {
  for (std::size_t t = 0; t < simplices.size(); ++t)
    for (const Index node : corners(simplices[t]))
      if (roles.unknown[node] >= 0) visit(static_cast<Index>(t), roles.unknown[node]);
}

Adjacency make_adjacency(std::span<const Simplex> simplices, const NodeRoles& roles) {
  Adjacency adjacency;
  auto& offsets = adjacency.offsets;
  offsets.assign(static_cast<std::size_t>(roles.n_unknown) + 1, 0);
  for_each_unknown(simplices, roles, [&](Index, Index unknown) { ++offsets[unknown + 1]; });
  for (std::size_t i = 1; i < offsets.size(); ++i) offsets[i] += offsets[i - 1];
  adjacency.simplices.resize(offsets.back());
  std::vector<std::size_t> next(offsets.begin(), offsets.end() - 1);
  for_each_unknown(simplices, roles,
                   [&](Index t, Index unknown) { adjacency.simplices[next[unknown]++] = t; });
  return adjacency;
}

// Builds each row from the simplices around its unknown: no two threads write to one number, and
// the order of every sum is that of the simplices.
class Assembly {
 public:
  Assembly(std::span<const Vec3> nodes, std::span<const Simplex> simplices, const NodeRoles& roles)
      : nodes_(nodes),
        simplices_(simplices),
        roles_(roles),
        adjacency_(make_adjacency(simplices, roles)),
        scale_(mean_volume(nodes, simplices)) {}

  void rows(std::size_t begin, std::size_t end, RowRange& stiffness, RowRange& coupling) const {
    Row unknown, given;
    for (std::size_t i = begin; i < end; ++i) {
      unknown.clear();
      given.clear();
      const double diagonal = add_simplices(static_cast<Index>(i), unknown, given);
      // An unknown without a simplex gets the equation u = 0.
      unknown.add(static_cast<Index>(i), diagonal > 0 ? diagonal : 1);
      stiffness.append(unknown.sorted());
      coupling.append(given.sorted());
    }
  }

 private:
  // Returns the diagonal entry.
  double add_simplices(Index i, Row& unknown, Row& given) const {
    double diagonal = 0;
    Index last = -1;
    for (const Index number : adjacency_.at(static_cast<std::size_t>(i))) {
      if (std::exchange(last, number) == number) continue;  // two of its corners move alike
      const Simplex& t = simplices_[number];
      const Gradients g = gradients(nodes_, t);
      if (g.is_flat) continue;
      for (std::size_t own = 0; own < n_corners(t); ++own)
        if (roles_.unknown[t[own]] == i) diagonal += add_corner(t, g, own, unknown, given);
    }
    return diagonal;
  }

  double add_corner(const Simplex& t, const Gradients& g, std::size_t own, Row& unknown,
                    Row& given) const {
    double diagonal = scale_ * g.of_corner[own].squaredNorm();
    for (std::size_t k = 0; k < n_corners(t); ++k) {
      if (k == own) continue;
      const double value = scale_ * g.of_corner[own].dot(g.of_corner[k]);
      const Index other = roles_.unknown[t[k]];
      if (other >= 0 && other == roles_.unknown[t[own]])
        diagonal += value;
      else if (other >= 0)
        unknown.add(other, value);
      else if (roles_.given[t[k]] >= 0)
        given.add(roles_.given[t[k]], value);
    }
    return diagonal;
  }

  std::span<const Vec3> nodes_;
  std::span<const Simplex> simplices_;
  const NodeRoles& roles_;
  Adjacency adjacency_;
  double scale_;
};

}  // namespace

bool is_flat(std::span<const Vec3> nodes, const Simplex& simplex) {
  return gradients(nodes, simplex).is_flat;
}

HarmonicExtension::HarmonicExtension(std::span<const Vec3> nodes,
                                     std::span<const Simplex> simplices, const NodeRoles& roles)
    : system_(
          roles.n_unknown, roles.n_given,
          [assembly = std::make_shared<const Assembly>(nodes, simplices, roles)](
              std::size_t begin, std::size_t end, RowRange& stiffness, RowRange& coupling) {
            assembly->rows(begin, end, stiffness, coupling);
          },
          roles.sliding) {}

}  // namespace roughmesh::detail
