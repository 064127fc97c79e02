// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/correlation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "all_points.hpp"
#include "image_sum.hpp"
#include "parallel.hpp"

namespace roughmesh {
namespace {

void check_places(std::span<const Vec3> places, const Distance& distance) {
  const double n_pieces = static_cast<double>(distance.closed_lengths().size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3& x = places[i];
    if (!x.allFinite())
      throw InputError(fmt::format(
          "point {} of the field has a coordinate that is not finite; mend the mesh", i));
    if (distance.kind() != DistanceKind::curve) continue;
    if (!(x.y() >= 0 && x.y() < n_pieces && x.y() == std::floor(x.y())))
      throw InputError(fmt::format(
          "point {} stands on piece {} of a curve that has pieces 0 to {}; take its place from "
          "curve_places()",
          i, x.y(), n_pieces - 1));
  }
}

Vec3 extent(std::span<const Vec3> places) {
  if (places.empty()) return Vec3::Zero();
  Eigen::AlignedBox3d box;
  for (const Vec3& x : places) box.extend(x);
  return box.sizes();
}

}  // namespace

Correlation::Correlation(std::vector<Vec3> places, const Autocorrelation& autocorrelation,
                         const Distance& distance)
    : owned_places_(std::make_shared<const std::vector<Vec3>>(std::move(places))),
      places_(*owned_places_),
      autocorrelation_(autocorrelation),
      distance_(distance) {
  check_places(places_, distance_);
  if (distance_.kind() == DistanceKind::periodic)
    images_ =
        std::make_shared<const detail::ImageSum>(autocorrelation_, distance_, extent(places_));
}

double Correlation::image_sum(const Vec3& x, const Vec3& y) const { return images_->rho(x - y); }

Correlation Correlation::among(std::span<const Index> points) const {
  Correlation result = *this;
  if (detail::is_all(points, n_points())) return result;
  std::vector<Vec3> places;
  places.reserve(points.size());
  for (const Index point : points) {
    if (point < 0 || point >= n_points())
      throw InputError(
          fmt::format("correlation among point {}: there are {} points", point, n_points()));
    places.push_back(places_[static_cast<std::size_t>(point)]);
  }
  result.owned_places_ = std::make_shared<const std::vector<Vec3>>(std::move(places));
  result.places_ = *result.owned_places_;
  return result;
}

std::optional<double> Correlation::minimum_image_difference() const {
  constexpr std::size_t most_sources = 256, most_partners = 2048;
  if (!images_) return {};
  const std::size_t n = places_.size();
  const std::size_t n_sources = std::min(n, most_sources), n_partners = std::min(n, most_partners);
  std::vector<double> largest(n_sources, 0);
  detail::parallel_for(n_sources, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const std::size_t source = s * n / n_sources;
      for (std::size_t p = 0; p < n_partners; ++p) {
        const Vec3 &x = places_[source], &y = places_[(p * n + source) / n_partners];
        largest[s] =
            std::max(largest[s], std::abs(image_sum(x, y) - autocorrelation_.rho(distance_(x, y))));
      }
    }
  });
  return n_sources == 0 ? 0 : *std::max_element(largest.begin(), largest.end());
}

}  // namespace roughmesh
