// SPDX-License-Identifier: BSD-3-Clause
#include "box_surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace roughmesh::detail {
namespace {

using Place3 = std::array<int, 3>;

class Builder {
 public:
  Builder(const Eigen::AlignedBox3d& box, double size) : box_(box) {
    constexpr double fewest = 3, most = 200;
    for (std::size_t k = 0; k < 3; ++k) {
      const double side = box.sizes()[static_cast<Eigen::Index>(k)];
      n_[k] = static_cast<int>(std::lround(std::clamp(side / size, fewest, most)));
    }
  }

  BoxSurface run() && {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int level : {0, n_[axis]}) add_side(axis, level);
    return std::move(surface_);
  }

 private:
  void add_side(std::size_t axis, int level) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int j = 0; j < n_[v]; ++j)
      for (int i = 0; i < n_[u]; ++i) {
        const auto corner = [&](int di, int dj) {
          Place3 p{};
          p[axis] = level;
          p[u] = i + di;
          p[v] = j + dj;
          return node(p);
        };
        const Index a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
        if (level > 0)
          surface_.triangles.insert(surface_.triangles.end(), {{a, b, c}, {a, c, d}});
        else
          surface_.triangles.insert(surface_.triangles.end(), {{a, c, b}, {a, d, c}});
      }
  }

  Index node(const Place3& p) {
    const auto [at, is_new] = numbers_.try_emplace(p, static_cast<Index>(surface_.nodes.size()));
    if (is_new) {
      const Vec3 share(static_cast<double>(p[0]) / n_[0], static_cast<double>(p[1]) / n_[1],
                       static_cast<double>(p[2]) / n_[2]);
      surface_.nodes.push_back(box_.min() + share.cwiseProduct(box_.sizes()));
    }
    return at->second;
  }

  const Eigen::AlignedBox3d& box_;
  Place3 n_{};
  std::map<Place3, Index> numbers_;
  BoxSurface surface_;
};

}  // namespace

BoxSurface make_box_surface(const Eigen::AlignedBox3d& box, double size) {
  return Builder(box, size).run();
}

}  // namespace roughmesh::detail
