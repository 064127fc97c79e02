// SPDX-License-Identifier: BSD-3-Clause
#include "volume_regions.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "roughmesh/error.hpp"

#include "disjoint_sets.hpp"
#include "messages.hpp"
#include "parallel.hpp"
#include "surface_faces.hpp"

namespace roughmesh::detail {
namespace {

// A side of a cell, or an element that could be one.
struct Side {
  FaceKey key;
  std::int32_t block;
  Index element;
  std::int8_t face;  // -1: an element of dimension 2

  bool is_element() const { return face < 0; }
  friend bool operator<(const Side& a, const Side& b) {
    return std::tie(a.key, a.face, a.block, a.element) <
           std::tie(b.key, b.face, b.block, b.element);
  }
};

Side make_side(const Mesh& mesh, std::size_t b, Index element, int face) {
  const ElementBlock& block = mesh.blocks[b];
  const auto n = static_cast<std::size_t>(n_corners(block.type.shape));
  const FaceKey key =
      face < 0 ? face_key(block.element(element).first(n))
               : face_key(cell_face(block, element, static_cast<std::size_t>(face)).corners());
  return {key, static_cast<std::int32_t>(b), element, static_cast<std::int8_t>(face)};
}

// Equal ones beside each other, elements of dimension 2 first.
std::vector<Side> sorted_sides(const Mesh& mesh) {
  std::vector<Side> sides;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const ElementShape shape = mesh.blocks[b].type.shape;
    const int n_faces = dimension(shape) == 3 ? static_cast<int>(local_faces(shape).size()) : 0;
    for (Index e = 0; e < mesh.blocks[b].size(); ++e) {
      if (dimension(shape) == 2) sides.push_back(make_side(mesh, b, e, -1));
      for (int f = 0; f < n_faces; ++f) sides.push_back(make_side(mesh, b, e, f));
    }
  }
  parallel_sort(std::span(sides), std::less<>());
  return sides;
}

// The sides with one key.
struct SideGroup {
  std::span<const Side> elements, cells;
};

template <class Visit>
void for_each_group(const std::vector<Side>& sides, Visit&& visit) {
  for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
    std::size_t n_elements = 0;
    for (; end < sides.size() && sides[end].key == sides[first].key; ++end)
      n_elements += sides[end].is_element() ? 1 : 0;
    const std::span<const Side> all(sides.data() + first, end - first);
    visit(SideGroup{all.first(n_elements), all.subspan(n_elements)});
  }
}

// Cells of all blocks counted one after the other.
class Cells {
 public:
  explicit Cells(const Mesh& mesh) : mesh_(mesh) {
    std::map<std::pair<Tag, std::vector<Tag>>, Index> kinds;
    for (const ElementBlock& block : mesh.blocks) {
      first_.push_back(n_);
      const bool is_cell = dimension(block.type.shape) == 3;
      if (is_cell) n_ += block.tags.size();
      const auto key = std::make_pair(block.entity, block.physical_groups);
      kind_.push_back(kinds.try_emplace(key, static_cast<Index>(kinds.size())).first->second);
    }
  }

  std::size_t size() const { return n_; }
  Index number(const Side& side) const {
    return static_cast<Index>(first_[side.block]) + side.element;
  }
  bool alike(const Side& a, const Side& b) const { return kind_[a.block] == kind_[b.block]; }

  // Regions count in the order of their first cells.
  Index fill(DisjointSets& sets, std::vector<std::vector<Index>>& of_block) const {
    std::vector<Index> region(n_, -1);
    Index n_regions = 0;
    of_block.resize(mesh_.blocks.size());
    for (std::size_t b = 0; b < mesh_.blocks.size(); ++b) {
      if (dimension(mesh_.blocks[b].type.shape) != 3) continue;
      for (Index e = 0; e < mesh_.blocks[b].size(); ++e) {
        const Index root = sets.smallest(static_cast<Index>(first_[b]) + e);
        if (region[root] < 0) region[root] = n_regions++;
        of_block[b].push_back(region[root]);
      }
    }
    return n_regions;
  }

 private:
  const Mesh& mesh_;
  std::vector<std::size_t> first_;
  std::vector<Index> kind_;
  std::size_t n_ = 0;
};

void check_group(const Mesh& mesh, const SideGroup& group) {
  if (group.cells.size() <= 2) return;
  const Side& third = group.cells[2];
  const ElementBlock& block = mesh.blocks[third.block];
  throw InputError(fmt::format(
      "element {} and two others share a side, so that they overlap: such a mesh cannot "
      "be meshed anew; take --volume move",
      block.tags[third.element]));
}

RegionFace make_face(const Mesh& mesh, const SideGroup& group,
                     const std::vector<std::vector<Index>>& of_block) {
  const Side& cell = group.cells.front();
  RegionFace result{
      cell_face(mesh.blocks[cell.block], cell.element, static_cast<std::size_t>(cell.face)),
      {of_block[cell.block][cell.element], -1}};
  if (!group.elements.empty()) {
    const Side& element = group.elements.front();
    result.face.element = mesh.blocks[element.block].tags[element.element];
  }
  if (group.cells.size() == 2) {
    result.regions[1] = of_block[group.cells[1].block][group.cells[1].element];
    if (result.regions[1] < result.regions[0]) std::swap(result.regions[0], result.regions[1]);
  }
  return result;
}

}  // namespace

VolumeRegions find_regions(const Mesh& mesh) {
  const std::vector<Side> sides = sorted_sides(mesh);
  const Cells cells(mesh);
  DisjointSets sets(cells.size());
  const auto is_inner = [&](const SideGroup& group) {
    return group.elements.empty() && group.cells.size() == 2 &&
           cells.alike(group.cells[0], group.cells[1]);
  };
  for_each_group(sides, [&](const SideGroup& group) {
    check_group(mesh, group);
    if (is_inner(group)) sets.unite(cells.number(group.cells[0]), cells.number(group.cells[1]));
  });
  VolumeRegions regions;
  regions.n_regions = cells.fill(sets, regions.of_block);
  for_each_group(sides, [&](const SideGroup& group) {
    if (!group.cells.empty() && !is_inner(group))
      regions.faces.push_back(make_face(mesh, group, regions.of_block));
  });
  return regions;
}

}  // namespace roughmesh::detail
