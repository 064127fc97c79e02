// SPDX-License-Identifier: BSD-3-Clause
#include "surface_orientation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "roughmesh/error.hpp"

#include "disjoint_sets.hpp"
#include "messages.hpp"
#include "parallel.hpp"
#include "polygon.hpp"
#include "volume_faces.hpp"

namespace roughmesh::detail {
namespace {

// A patch is connected through edges of exactly two faces: beyond an edge of three faces there is
// no telling which two belong together.
struct Patches {
  std::vector<Index> of_face;
  std::vector<std::uint8_t> turned;  // per face: against the corners as given
  Index n = 0;
};

Vec3 centroid(const WeldedPoints& welded, std::span<const Index> face) {
  Vec3 sum = Vec3::Zero();
  for (const Index point : face) sum += welded.points[point];
  return sum / static_cast<double>(face.size());
}

[[noreturn]] void refuse_one_sided(const WeldedPoints& welded, const Faces& faces, Index face) {
  const Tag tag = faces.tags[face];
  throw InputError(fmt::format(
      "the surface is one-sided (like a Moebius strip): its normals contradict each other {}at {}; "
      "leave out faces or split the surface there",
      tag > 0 ? fmt::format("near element {} ", tag) : "",
      place(centroid(welded, faces.face(face)))));
}

// Breadth first from one face; the patches found so far are complete.
void grow_patch(const WeldedPoints& welded, const Faces& faces, const EdgeTable& edges, Index seed,
                Patches& patches) {
  std::vector<Index> front = {seed};
  patches.of_face[seed] = patches.n;
  for (std::size_t i = 0; i < front.size(); ++i) {
    const Index face = front[i];
    for (Index corner = faces.offsets[face]; corner < faces.offsets[face + 1]; ++corner) {
      const auto sides = edges.edge(edges.edge_of_corner[corner]);
      if (sides.size() != 2) continue;
      const Index other = sides[0].face == face ? sides[1].face : sides[0].face;
      const bool same_way = sides[0].forward == sides[1].forward;
      const bool turned = (patches.turned[face] != 0) != same_way;
      if (patches.of_face[other] < 0) {
        patches.of_face[other] = patches.n;
        patches.turned[other] = turned;
        front.push_back(other);
      } else if ((patches.turned[other] != 0) != turned) {
        refuse_one_sided(welded, faces, other);
      }
    }
  }
  ++patches.n;
}

Patches make_patches(const WeldedPoints& welded, const Faces& faces, const EdgeTable& edges) {
  Patches patches{std::vector<Index>(faces.tags.size(), -1),
                  std::vector<std::uint8_t>(faces.tags.size(), 0), 0};
  for (Index face = 0; face < faces.size(); ++face)
    if (patches.of_face[face] < 0) grow_patch(welded, faces, edges, face, patches);
  return patches;
}

void turn_patches(const std::vector<std::uint8_t>& turn, Patches& patches) {
  for (std::size_t face = 0; face < patches.turned.size(); ++face)
    patches.turned[face] ^= turn[patches.of_face[face]];
}

// Sums over the faces of each patch, `add(face, sum)` adding one; on several threads, in ranges
// that are long enough for all sums together to be fewer than the faces.
template <class Sum, class Add>
std::vector<Sum> over_patches(const Patches& patches, Add&& add) {
  constexpr std::size_t least_grain = 8192;
  const std::size_t n_faces = patches.of_face.size(), n = static_cast<std::size_t>(patches.n);
  const std::size_t grain = std::max(least_grain, 4 * n);
  std::vector<std::vector<Sum>> parts((n_faces + grain - 1) / grain);
  parallel_for(n_faces, grain, [&](std::size_t begin, std::size_t end) {
    std::vector<Sum>& part = parts[begin / grain];
    part.resize(n);
    for (std::size_t f = begin; f < end; ++f) add(static_cast<Index>(f), part[patches.of_face[f]]);
  });
  std::vector<Sum> total(n);
  for (const std::vector<Sum>& part : parts)
    for (std::size_t patch = 0; patch < n; ++patch) total[patch].add(part[patch]);
  return total;
}

// How a patch lies in the file.
struct FileOrientation {
  double area = 0;
  double as_given = 0;                              // area that is not turned, minus area that is
  Index first = -1;                                 // face
  Index order = std::numeric_limits<Index>::max();  // of it in the file

  void add(const FileOrientation& other) {
    area += other.area;
    as_given += other.as_given;
    if (other.order >= order) return;
    first = other.first;
    order = other.order;
  }
  bool is_turned(const Patches& patches) const {
    constexpr double tie = 1e-9;  // halves of equal area, with the round-off of their sums
    return std::abs(as_given) > tie * area ? as_given < 0 : patches.turned[first] != 0;
  }
};

// Each patch as most of its area in the file has it: a few faces the wrong way round do not count,
// wherever they stand in the file.
void keep_orientation_of_file(const WeldedPoints& welded, const Faces& faces, Patches& patches) {
  const auto in_file =
      over_patches<FileOrientation>(patches, [&](Index face, FileOrientation& sum) {
        const double area = face_area(gather(faces.face(face), welded.points).span());
        sum.add({area, patches.turned[face] ? -area : area, face, faces.file_order[face]});
      });
  std::vector<std::uint8_t> turn(in_file.size());
  for (std::size_t patch = 0; patch < turn.size(); ++patch)
    turn[patch] = in_file[patch].is_turned(patches);
  turn_patches(turn, patches);
}

// A face of a patch at an edge.
struct PatchSide {
  Index patch;
  int way;  // 1 along the edge, -1 against it
};

// A patch is closed if at every edge its faces run to and fro equally often.
std::vector<std::uint8_t> closed_patches(const EdgeTable& edges, const Patches& patches) {
  std::vector<std::uint8_t> closed(static_cast<std::size_t>(patches.n), 1);
  std::vector<PatchSide> sides;
  for (Index e = 0; e < edges.size(); ++e) {
    if (edges.edge(e).size() == 2) continue;  // within one patch, whose faces agree
    sides.clear();
    for (const Side& side : edges.edge(e)) {
      const bool against = side.forward == (patches.turned[side.face] != 0);
      sides.push_back({patches.of_face[side.face], against ? -1 : 1});
    }
    std::sort(sides.begin(), sides.end(),
              [](const PatchSide& a, const PatchSide& b) { return a.patch < b.patch; });
    for (auto side = sides.begin(); side != sides.end();) {
      const Index patch = side->patch;
      int balance = 0;
      for (; side != sides.end() && side->patch == patch; ++side) balance += side->way;
      if (balance != 0) closed[patch] = 0;
    }
  }
  return closed;
}

struct Centre {
  Vec3 sum = Vec3::Zero();
  double n = 0;

  void add(const Centre& other) {
    sum += other.sum;
    n += other.n;
  }
};

struct Volume {
  double value = 0;

  void add(const Volume& other) { value += other.value; }
};

// Volume inside each patch, from cones about the patch's own centre so that a body far from the
// origin keeps its digits.
std::vector<Volume> patch_volumes(const WeldedPoints& welded, const Faces& faces,
                                  const Patches& patches) {
  const auto centres = over_patches<Centre>(patches, [&](Index face, Centre& centre) {
    centre.add({centroid(welded, faces.face(face)), 1});
  });
  return over_patches<Volume>(patches, [&](Index face, Volume& volume) {
    const Centre& centre = centres[patches.of_face[face]];
    const Corners corners = gather(faces.face(face), welded.points);
    const double cone = cone_volume(corners.span(), centre.sum / centre.n, faces.plane_normal);
    volume.value += patches.turned[face] ? -cone : cone;
  });
}

// Entities of the elements (of a curve: of the plane) on either side of a face, seen along its
// corners as given.
struct Neighbours {
  std::optional<Tag> behind, ahead;

  // 1 if the face looks where it should, -1 if it has to look the other way, 0 if there is no
  // telling: out of the only volume, or of the lower-numbered of two.
  int vote() const {
    if (behind == ahead) return 0;
    if (!behind || !ahead) return behind ? 1 : -1;
    return *behind < *ahead ? 1 : -1;
  }
};

struct FacetPoints {
  std::array<Index, 4> points{};
  std::size_t n = 0;

  std::span<const Index> span() const { return {points.data(), n}; }
};

// Points of a facet of a side of a cell, -1 where the selection has none.
FacetPoints facet_points(const CellFace& side, std::span<const int> facet,
                         const WeldedPoints& welded) {
  FacetPoints result;
  for (const int k : facet) result.points[result.n++] = welded.point_of_node[side.nodes[k]];
  return result;
}

Vec3 middle_of_corners(const Mesh& mesh, const ElementBlock& block, Index element) {
  Vec3 middle = Vec3::Zero();
  const int n = n_corners(block.type.shape);
  for (int corner = 0; corner < n; ++corner)
    middle += mesh.nodes[block.element(element)[corner]] / n;
  return middle;
}

void note_neighbours(const Mesh& mesh, const ElementBlock& block, Index element,
                     const WeldedPoints& welded, const FaceLookup& lookup, const Faces& faces,
                     std::vector<Neighbours>& neighbours) {
  for (std::size_t f = 0; f < local_faces(block.type.shape).size(); ++f) {
    const CellFace side = cell_face(block, element, f);
    for (const std::vector<int>& facet : facets(side.type)) {
      const Index number = lookup.find(facet_points(side, facet, welded).span());
      if (number < 0) continue;
      const Corners corners = gather(faces.face(number), welded.points);
      const Vec3 inward =
          middle_of_corners(mesh, block, element) - centroid(welded, faces.face(number));
      const bool ahead = face_vector(corners.span(), faces.plane_normal).dot(inward) > 0;
      (ahead ? neighbours[number].ahead : neighbours[number].behind) = block.entity;
    }
  }
}

// How many more faces of each patch look where their volumes want them to than the other way.
std::vector<std::int64_t> votes_of_volumes(const Mesh& mesh, const WeldedPoints& welded,
                                           const Faces& faces, const Patches& patches) {
  std::vector<std::int64_t> votes(static_cast<std::size_t>(patches.n), 0);
  if (n_elements(mesh, faces.dimension + 1) == 0) return votes;
  const FaceLookup lookup(faces.offsets, faces.corners);
  std::vector<Neighbours> neighbours(faces.tags.size());
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; dimension(block.type.shape) == faces.dimension + 1 && e < block.size(); ++e)
      note_neighbours(mesh, block, e, welded, lookup, faces, neighbours);
  for (std::size_t face = 0; face < neighbours.size(); ++face) {
    const int vote = neighbours[face].vote();
    votes[patches.of_face[face]] += patches.turned[face] ? -vote : vote;
  }
  return votes;
}

void look_outward(const Mesh& mesh, const WeldedPoints& welded, const Faces& faces,
                  const EdgeTable& edges, Patches& patches) {
  const std::vector<std::uint8_t> closed = closed_patches(edges, patches);
  const std::vector<Volume> volumes = patch_volumes(welded, faces, patches);
  std::vector<std::int64_t> votes(closed.size(), 0);
  if (std::find(closed.begin(), closed.end(), 0) != closed.end())
    votes = votes_of_volumes(mesh, welded, faces, patches);
  std::vector<std::uint8_t> turn(closed.size());
  for (std::size_t patch = 0; patch < turn.size(); ++patch)
    turn[patch] = closed[patch] ? volumes[patch].value < 0 : votes[patch] < 0;
  turn_patches(turn, patches);
}

// Patches that touch along edges of three and more faces are one piece.
Index count_pieces(const EdgeTable& edges, const Patches& patches) {
  DisjointSets pieces(static_cast<std::size_t>(patches.n));
  for (Index e = 0; patches.n > 1 && e < edges.size(); ++e)
    for (const Side& side : edges.edge(e))
      pieces.unite(patches.of_face[edges.edge(e).front().face], patches.of_face[side.face]);
  Index n_pieces = 0;
  for (Index patch = 0; patch < patches.n; ++patch)
    if (pieces.smallest(patch) == patch) ++n_pieces;
  return n_pieces;
}

}  // namespace

Index orient_faces(const Mesh& mesh, const WeldedPoints& welded, const EdgeTable& edges,
                   Faces& faces) {
  Patches patches = make_patches(welded, faces, edges);
  keep_orientation_of_file(welded, faces, patches);
  look_outward(mesh, welded, faces, edges, patches);
  for (Index face = 0; face < faces.size(); ++face)
    if (patches.turned[face]) faces.turn(face);
  return count_pieces(edges, patches);
}

}  // namespace roughmesh::detail
