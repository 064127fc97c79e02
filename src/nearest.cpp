// SPDX-License-Identifier: BSD-3-Clause
#include "nearest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <nanoflann.hpp>

#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

/// The first of each run of equal places.
class DistinctPlaces {
 public:
  explicit DistinctPlaces(std::span<const Vec3> places) : places_(places) {
    if (std::adjacent_find(places.begin(), places.end()) == places.end()) return;
    for (std::uint32_t i = 0; i < places.size(); ++i)
      if (i == 0 || places[i] != places[i - 1]) firsts_.push_back(i);
  }

  std::size_t size() const { return firsts_.empty() ? places_.size() : firsts_.size(); }
  std::size_t first(std::size_t number) const { return firsts_.empty() ? number : firsts_[number]; }
  const Vec3& operator[](std::size_t number) const { return places_[first(number)]; }

 private:
  std::span<const Vec3> places_;
  std::vector<std::uint32_t> firsts_;  ///< empty: no two are equal
};

/// What nanoflann asks of a set of points.
struct Cloud {
  const DistinctPlaces& places;

  std::size_t kdtree_get_point_count() const { return places.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return places[i][static_cast<int>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

class Neighbours {
 public:
  Neighbours(const DistinctPlaces& places, const Vec3& period)
      : cloud_{places}, tree_(3, cloud_, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {
    for (std::size_t i = 0; i < places.size(); ++i) box_.extend(places[i]);
    add_shifts(period);
  }

  double distance(std::size_t i) const {
    const Vec3& x = cloud_.places[i];
    std::array<std::uint32_t, 2> index{};
    std::array<double, 2> square{};
    // The nearest of all is the place itself.
    const std::size_t n = tree_.knnSearch(x.data(), 2, index.data(), square.data());
    double nearest = n == 2 ? square[1] : std::numeric_limits<double>::infinity();
    for (const Vec3& shift : shifts_) {
      const Vec3 image = x + shift;
      if (box_.squaredExteriorDistance(image) >= nearest) continue;
      tree_.knnSearch(image.data(), 1, index.data(), square.data());
      nearest = std::min(nearest, square[0]);
    }
    return std::sqrt(nearest);
  }

 private:
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>,
                                                   Cloud, 3, std::uint32_t>;

  void add_shifts(const Vec3& period) {
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        for (int k = -1; k <= 1; ++k) {
          const Vec3 n(i, j, k);
          const bool is_shift =
              n != Vec3::Zero() && ((n.array() == 0) || (period.array() > 0)).all();
          if (is_shift) shifts_.emplace_back(n.cwiseProduct(period));
        }
  }

  Cloud cloud_;
  Tree tree_;
  Eigen::AlignedBox3d box_;
  std::vector<Vec3> shifts_;
};

}  // namespace

std::vector<double> nearest_distances(std::span<const Vec3> places, const Vec3& period) {
  const DistinctPlaces distinct(places);
  const Neighbours neighbours(distinct, period);
  std::vector<double> result(places.size());
  parallel_for(distinct.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[distinct.first(i)] = neighbours.distance(i);
  });
  for (std::size_t i = 1; i < places.size(); ++i)
    if (places[i] == places[i - 1]) result[i] = result[i - 1];
  return result;
}

}  // namespace roughmesh::detail
