// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/mask.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "mask_fade.hpp"
#include "mask_formula.hpp"
#include "messages.hpp"
#include "parallel.hpp"
#include "smooth_step.hpp"

namespace roughmesh {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t grain = 4096;

void require_fade(double fade, const char* of_what) {
  if (fade >= 0 && std::isfinite(fade)) return;
  throw InputError(
      fmt::format("{} mask: the fade is {}; give a finite length, or 0 for a jump", of_what, fade));
}

void check(const BoxMask& box) {
  require_fade(box.fade, "box");
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min[axis], high = box.max[axis];
    if (!(low <= high) || !(low < infinity) || !(high > -infinity))
      throw InputError(
          fmt::format("box mask: from {} to {} along {} is no interval; give the smaller number "
                      "first (infinite ends are allowed)",
                      low, high, "xyz"[axis]));
  }
}

void check(const SphereMask& sphere) {
  require_fade(sphere.fade, "sphere");
  if (!sphere.centre.allFinite())
    throw InputError(fmt::format("sphere mask: the centre is {}; give three finite numbers",
                                 detail::place(sphere.centre)));
  if (!(sphere.radius > 0) || !std::isfinite(sphere.radius))
    throw InputError(
        fmt::format("sphere mask: the radius is {}; give a finite length above 0", sphere.radius));
}

double distance_from(const BoxMask& box, const Vec3& x) {
  return (box.min - x).cwiseMax(x - box.max).cwiseMax(0.0).norm();
}

double distance_from(const SphereMask& sphere, const Vec3& x) {
  return std::max(0.0, (x - sphere.centre).norm() - sphere.radius);
}

// Eq. 42 of docs/math.md: 1 in the body, 0 from `fade` on.
template <class Body>
void apply_body(const Surface& surface, const Body& body, std::vector<double>& weights) {
  detail::parallel_for(weights.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double distance = distance_from(body, surface.points[i]);
      const double faded = body.fade > 0 ? detail::smooth_step(distance / body.fade)
                                         : static_cast<double>(distance > 0);
      weights[i] *= body.outside ? faded : 1 - faded;
    }
  });
}

// Each range of points has its own parser. What is not a number is found afterwards, so that
// threads do not decide which point the message names.
void apply_formula(const Surface& surface, const std::string& expression,
                   std::vector<double>& weights) {
  const detail::MaskFormula formula(expression);
  std::vector<double> values(weights.size());
  detail::parallel_for(values.size(), grain, [&](std::size_t begin, std::size_t end) {
    detail::MaskFormula own(expression);
    for (std::size_t i = begin; i < end; ++i)
      values[i] = own.value(surface.points[i], surface.normals[i]);
  });
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) formula.refuse_value(surface.points[i]);
    weights[i] *= std::clamp(values[i], 0.0, 1.0);
  }
}

void require_selected_from(const Mesh& mesh, const Surface& surface) {
  if (surface.nodes.empty() || surface.nodes.back() < mesh.n_nodes()) return;
  throw InputError(
      fmt::format("the surface has node {} of a mesh of {} nodes; select it from this mesh",
                  surface.nodes.back(), mesh.n_nodes()));
}

}  // namespace

std::vector<double> mask_weights(const Mesh& mesh, const Surface& surface,
                                 const MaskOptions& options) {
  require_selected_from(mesh, surface);
  for (const BoxMask& box : options.boxes) check(box);
  for (const SphereMask& sphere : options.spheres) check(sphere);

  std::vector<double> weights(surface.points.size(), 1.0);
  for (const std::string& group : options.fixed) detail::apply_fixed(mesh, surface, group, weights);
  for (const FormulaMask& formula : options.formulas)
    apply_formula(surface, formula.expression, weights);
  for (const BoxMask& box : options.boxes) apply_body(surface, box, weights);
  for (const SphereMask& sphere : options.spheres) apply_body(surface, sphere, weights);
  for (const Fade& fade : options.fade) detail::apply_fade(mesh, surface, fade, weights);

  if (!weights.empty() && *std::max_element(weights.begin(), weights.end()) == 0)
    throw InputError(
        fmt::format("the masks leave none of the {} points of the surface above 0, so nothing "
                    "becomes rough; take one away or move it",
                    weights.size()));
  return weights;
}

std::vector<double> full_weight_areas(const Surface& surface, std::span<const double> weights) {
  if (weights.size() != surface.points.size())
    throw InputError(fmt::format("{} weights for a surface of {} points; give one per point",
                                 weights.size(), surface.points.size()));
  std::vector<double> areas(surface.areas);
  for (std::size_t i = 0; i < areas.size(); ++i)
    if (weights[i] != 1) areas[i] = 0;
  return areas;
}

}  // namespace roughmesh
