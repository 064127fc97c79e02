// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/field_model.hpp"

#include <utility>

#include <fmt/format.h>

#include "roughmesh/curve.hpp"

#include "rough_surface.hpp"

namespace roughmesh {
namespace {

/// Lengths along the axes that the request turns; all equal for an isotropic field.
Anisotropy anisotropy_of(const Roughness& request, double length) {
  Anisotropy anisotropy{.lengths = {length, length, length}};
  if (request.length.size() > 1)
    anisotropy.lengths = {request.length[0], request.length[1], request.length.back()};
  anisotropy.axes = length_axes(request);
  return anisotropy;
}

Vec3 period_of(const Roughness& request) {
  if (request.period.size() != 3)
    throw InputError(fmt::format("--distance: {}; needs --period LX,LY,LZ",
                                 name(request.distance.value_or(DistanceKind::periodic))));
  return {request.period[0], request.period[1], request.period[2]};
}

Correlation along_curve(const Autocorrelation& autocorrelation, const Surface& surface) {
  CurvePlaces curve = curve_places(surface);
  return {std::move(curve.places), autocorrelation,
          Distance::curve(std::move(curve.closed_lengths))};
}

Distance distance_between(const Roughness& request, double length, const Surface& surface) {
  switch (request.distance.value_or(DistanceKind::euclidean)) {
    case DistanceKind::great_circle:
      return Distance::great_circle(surface.points);
    case DistanceKind::periodic:
      return Distance::periodic(period_of(request), anisotropy_of(request, length));
    case DistanceKind::minimum_image:
      return Distance::minimum_image(period_of(request), anisotropy_of(request, length));
    default:
      return request.length.size() < 2 ? Distance::euclidean()
                                       : Distance::stretched(anisotropy_of(request, length));
  }
}

}  // namespace

Correlation field_model(const Roughness& request, const Surface& surface) {
  const Autocorrelation autocorrelation(autocorrelation_options(request));
  if (request.distance == DistanceKind::curve) return along_curve(autocorrelation, surface);
  return {surface.points, autocorrelation,
          distance_between(request, autocorrelation.length(), surface)};
}

SurfaceModel surface_model(const Mesh& mesh, const Surface& surface, const Roughness& request) {
  std::string refusal;
  detail::RoughSurfaces rough;
  try {
    rough = detail::prepare_surface(mesh, surface, request, detail::TornLinks::refused);
  } catch (const InputError& error) {
    refusal = error.what();
    rough = detail::prepare_surface(mesh, surface, request, detail::TornLinks::allowed);
  }
  Correlation correlation = detail::correlation_of(rough.plans.front(), rough.fields);
  return {std::move(rough.surfaces.front()), std::move(rough.plans.front().request),
          std::move(correlation), std::move(refusal)};
}

}  // namespace roughmesh
