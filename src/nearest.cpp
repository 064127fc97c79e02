// SPDX-License-Identifier: BSD-3-Clause
#include "nearest.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

#include <nanoflann.hpp>

#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

/// One place for each run of equal ones.
struct DistinctPlaces {
  std::vector<Vec3> places;
  std::vector<std::size_t> of_place;
};

DistinctPlaces distinct(std::span<const Vec3> places) {
  DistinctPlaces result;
  result.of_place.reserve(places.size());
  for (const Vec3& x : places) {
    if (result.places.empty() || result.places.back() != x) result.places.push_back(x);
    result.of_place.push_back(result.places.size() - 1);
  }
  return result;
}

/// What nanoflann asks of a set of points.
struct Cloud {
  const std::vector<Vec3>& places;

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
  Neighbours(const std::vector<Vec3>& places, const Vec3& period)
      : cloud_{places}, tree_(3, cloud_, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {
    for (const Vec3& x : places) box_.extend(x);
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
  const DistinctPlaces once = distinct(places);
  const Neighbours neighbours(once.places, period);
  std::vector<double> of_distinct(once.places.size()), result(places.size());
  parallel_for(of_distinct.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) of_distinct[i] = neighbours.distance(i);
  });
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = of_distinct[once.of_place[i]];
  return result;
}

}  // namespace roughmesh::detail
