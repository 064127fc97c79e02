// SPDX-License-Identifier: BSD-3-Clause
#include "repair_volume.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "foldover_free.hpp"
#include "plane.hpp"
#include "poor_elements.hpp"
#include "split_trapped.hpp"

namespace roughmesh::detail {
namespace {

// Quality that an element keeps of what it had; what it had above `enough` it may lose. Mesh
// generators leave some elements near 0.1, so that a solver has to put up with 0.1 anyway.
constexpr PoorLimit limit = {.share = 0.7, .enough = 0.15};
constexpr PoorLimit inverted_only = {};

// Layers of simplices around poor elements whose nodes may move. More of them do not raise the
// smallest quality, which the surface sets: they are for elements that stay inverted.
constexpr std::array layers_of_stage = {3, 6, 1'000'000};

// One more layer: all nodes of simplices that have a marked one.
bool grow(const std::vector<Simplex>& simplices, NodeFlags& marked) {
  NodeFlags next = marked;
  for (const Simplex& s : simplices) {
    const bool touches =
        std::any_of(s.begin(), s.end(), [&](Index node) { return node >= 0 && marked[node] != 0; });
    for (const Index node : s)
      if (touches && node >= 0) next[node] = 1;
  }
  const bool grew = next != marked;
  marked = std::move(next);
  return grew;
}

// Nodes that move alike, if one of them is marked.
void mark_images(const NodeTies& ties, NodeFlags& marked) {
  const auto n = static_cast<Index>(ties.images.size());
  for (Index node = 0; node < n; ++node)
    if (marked[node] != 0) marked[ties.images[node]] = 1;
  for (Index node = 0; node < n; ++node)
    if (marked[ties.images[node]] != 0) marked[node] = 1;
}

bool is_better(const MeshCheck& a, const MeshCheck& b) {
  return a.inverted_elements != b.inverted_elements ? a.inverted_elements < b.inverted_elements
                                                    : a.min_quality > b.min_quality;
}

}  // namespace

VolumeRepair::VolumeRepair(const Mesh& mesh, NodeFlags is_free, int n_splits, NodeTies ties)
    : VolumeRepair(mesh, std::move(is_free), n_splits, mesh.n_nodes(), std::move(ties)) {}

VolumeRepair::VolumeRepair(const Mesh& mesh, NodeFlags is_free, int n_splits, Index first_new_node,
                           NodeTies ties)
    : mesh_(mesh),
      simplices_(deforming_simplices(mesh, dimension(mesh), is_free)),
      is_free_(std::move(is_free)),
      ties_(std::move(ties)),
      n_splits_(n_splits),
      first_new_node_(first_new_node) {
  if (dimension(mesh) == 2) plane_normal_ = fit_plane(mesh).normal;
}

NodeFlags VolumeRepair::free_near_poor(const std::vector<Vec3>& positions, int layers) const {
  NodeFlags near = nodes_of_poor_elements(mesh_, positions, limit);
  for (int layer = 0; layer < layers; ++layer)
    if (!grow(simplices_, near)) break;
  mark_images(ties_, near);
  for (std::size_t node = 0; node < near.size(); ++node)
    near[node] = near[node] != 0 && is_free_[node] != 0;
  return near;
}

// No element can be poor, without looking at each.
bool VolumeRepair::needs_nothing(const MeshCheck& check) const {
  return check.valid() && check.min_quality >= limit.share * limit.enough;
}

// The best positions so far and what is wrong with them.
MeshCheck VolumeRepair::untangle_near_poor(std::vector<Vec3>& positions) const {
  MeshCheck best = check_corners(mesh_, positions);
  if (needs_nothing(best)) return best;
  for (const int layers : layers_of_stage) {
    const NodeFlags is_free = free_near_poor(positions, layers);
    if (std::find(is_free.begin(), is_free.end(), 1) == is_free.end()) break;
    std::vector<Vec3> candidate = positions;
    untangle({mesh_.nodes, simplices_, plane_normal_, first_new_node_, ties_}, is_free, candidate);
    const MeshCheck check = check_corners(mesh_, candidate);
    if (is_better(check, best)) {
      best = check;
      positions = std::move(candidate);
    }
    if (best.valid()) break;
  }
  return best;
}

std::optional<MovedVolume> VolumeRepair::split_around(const NodeFlags& marked,
                                                      const std::vector<Vec3>& positions) const {
  if (std::find(marked.begin(), marked.end(), 1) == marked.end()) return std::nullopt;
  std::optional<SplitMesh> split = split_trapped(mesh_, is_free_, marked, positions);
  if (!split) return std::nullopt;
  auto mesh = std::make_shared<const Mesh>(std::move(split->mesh));
  NodeFlags is_free = is_free_;
  is_free.resize(mesh->nodes.size(), 1);
  const VolumeRepair repair(*mesh, std::move(is_free), n_splits_ - 1, first_new_node_, ties_);
  MovedVolume result = repair.mend(std::move(split->positions));
  if (!result.split) result.split = std::move(mesh);
  if (!check_corners(*result.split, result.nodes).valid()) return std::nullopt;
  result.method = VolumeMethod::split;
  return result;
}

// Elements that the map cannot mend, so that there is no use in trying it first.
std::optional<MovedVolume> VolumeRepair::split_trapped_elements(
    const std::vector<Vec3>& positions) const {
  return split_around(nodes_of_poor_elements(mesh_, positions, inverted_only, is_free_), positions);
}

std::optional<MovedVolume> VolumeRepair::split_inverted_elements(
    const std::vector<Vec3>& positions) const {
  return split_around(nodes_of_poor_elements(mesh_, positions, inverted_only), positions);
}

MovedVolume VolumeRepair::mend(std::vector<Vec3> positions) const {
  MovedVolume result{std::move(positions), VolumeMethod::harmonic, nullptr};
  const MeshCheck check = check_corners(mesh_, result.nodes);
  if (needs_nothing(check)) return result;
  const bool can_split = n_splits_ > 0 && dimension(mesh_) == 3;
  if (can_split && !check.valid())
    if (auto split = split_trapped_elements(result.nodes)) return std::move(*split);
  const std::vector<Vec3> harmonic = result.nodes;
  const bool is_valid = untangle_near_poor(result.nodes).valid();
  if (result.nodes != harmonic) result.method = VolumeMethod::foldover_free;
  if (can_split && !is_valid)
    if (auto split = split_inverted_elements(result.nodes)) return std::move(*split);
  return result;
}

}  // namespace roughmesh::detail
