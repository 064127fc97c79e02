// SPDX-License-Identifier: BSD-3-Clause
// Writes a unit sphere as binary PLY, of any size in little memory: a cube of divisions^3 cells
// blown up. Its surface has 6 divisions^2 + 2 nodes and twice as many triangles less 4.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <numbers>

namespace {

/// Nodes of the surface of the cube of cells [0, n]^3, layer by layer along z, the layers between
/// the first and the last being rings.
class CubeSurface {
 public:
  explicit CubeSurface(std::int64_t n) : n_(n) {}

  std::int64_t n_nodes() const { return 6 * n_ * n_ + 2; }
  std::int64_t n_triangles() const { return 12 * n_ * n_; }

  std::int64_t node(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const std::int64_t plate = (n_ + 1) * (n_ + 1);
    if (k == 0) return j * (n_ + 1) + i;
    if (k == n_) return plate + 4 * n_ * (n_ - 1) + j * (n_ + 1) + i;
    return plate + 4 * n_ * (k - 1) + along_ring(i, j);
  }

  /// Calls visit(i, j, k) for every node, by ascending number.
  template <class Visit>
  void for_each_node(const Visit& visit) const {
    for (std::int64_t k = 0; k <= n_; ++k) {
      if (k == 0 || k == n_)
        for (std::int64_t j = 0; j <= n_; ++j)
          for (std::int64_t i = 0; i <= n_; ++i) visit(i, j, k);
      else
        for (std::int64_t place = 0; place < 4 * n_; ++place) {
          const auto [i, j] = ring_node(place);
          visit(i, j, k);
        }
    }
  }

  /// Calls visit(a, b, c, d) for every square, counterclockwise from outside.
  template <class Visit>
  void for_each_square(const Visit& visit) const {
    for (std::int64_t v = 0; v < n_; ++v)
      for (std::int64_t u = 0; u < n_; ++u)
        for (int axis = 0; axis < 3; ++axis) {
          visit(at(axis, n_, u, v), at(axis, n_, u + 1, v), at(axis, n_, u + 1, v + 1),
                at(axis, n_, u, v + 1));
          visit(at(axis, 0, u, v), at(axis, 0, u, v + 1), at(axis, 0, u + 1, v + 1),
                at(axis, 0, u + 1, v));
        }
  }

 private:
  /// Around the square [0, n]^2: along the lower side, up the right, back along the upper, down.
  std::int64_t along_ring(std::int64_t i, std::int64_t j) const {
    if (j == 0) return i;
    if (i == n_) return n_ + j;
    if (j == n_) return 3 * n_ - i;
    return 4 * n_ - j;
  }

  std::array<std::int64_t, 2> ring_node(std::int64_t place) const {
    if (place < n_) return {place, 0};
    if (place < 2 * n_) return {n_, place - n_};
    if (place < 3 * n_) return {3 * n_ - place, n_};
    return {0, 4 * n_ - place};
  }

  std::int64_t at(int axis, std::int64_t level, std::int64_t u, std::int64_t v) const {
    return axis == 0 ? node(level, u, v) : axis == 1 ? node(v, level, u) : node(u, v, level);
  }

  std::int64_t n_;
};

/// The angle, not the coordinate, is divided evenly, so that triangles differ by little in size.
double warped(std::int64_t i, std::int64_t n) {
  return std::tan((2.0 * static_cast<double>(i) / static_cast<double>(n) - 1) * std::numbers::pi /
                  4);
}

template <class Value>
void put(std::ostream& file, Value value) {
  file.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void write_sphere(std::ostream& file, std::int64_t n) {
  const CubeSurface cube(n);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << cube.n_nodes()
       << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
       << cube.n_triangles() << "\nproperty list uchar int vertex_indices\nend_header\n";
  cube.for_each_node([&](std::int64_t i, std::int64_t j, std::int64_t k) {
    const double x = warped(i, n), y = warped(j, n), z = warped(k, n);
    const double radius = std::hypot(x, y, z);
    for (const double coordinate : {x, y, z}) put(file, coordinate / radius);
  });
  const auto put_triangle = [&](std::int64_t a, std::int64_t b, std::int64_t c) {
    put(file, std::uint8_t{3});
    for (const std::int64_t node : {a, b, c}) put(file, static_cast<std::int32_t>(node));
  };
  cube.for_each_square([&](std::int64_t a, std::int64_t b, std::int64_t c, std::int64_t d) {
    put_triangle(a, b, c);
    put_triangle(a, c, d);
  });
}

}  // namespace

int main(int argc, char** argv) {
  const std::int64_t divisions = argc == 3 ? std::atoll(argv[1]) : 0;
  if (divisions < 2 || divisions > 10'000) {
    std::cerr << "usage: make_sphere DIVISIONS FILE.ply: DIVISIONS from 2 to 10000\n";
    return 2;
  }
  std::ofstream file(argv[2], std::ios::binary);
  write_sphere(file, divisions);
  file.close();
  if (!file) std::cerr << argv[2] << ": cannot be written\n";
  return file ? 0 : 1;
}
