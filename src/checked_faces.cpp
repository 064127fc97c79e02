// SPDX-License-Identifier: BSD-3-Clause
#include "checked_faces.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "coincident.hpp"
#include "disjoint_sets.hpp"
#include "element_nodes.hpp"
#include "morton.hpp"
#include "parallel.hpp"
#include "surface_faces.hpp"
#include "volume_faces.hpp"
#include "wall_faces.hpp"

namespace roughmesh::detail {
namespace {

constexpr double same_place = 1e-9;  // of the extent, as for the points of a surface

struct Face {
  std::array<Index, 4> nodes = {-1, -1, -1, -1};
  FaceSource source;

  std::span<const Index> corners() const {
    const std::size_t n = nodes[2] < 0 ? 2 : nodes[3] < 0 ? 3 : 4;
    return std::span(nodes).first(n);
  }
};

void add_facets(const ElementType& type, std::span<const Index> nodes, const FaceSource& source,
                std::vector<Face>& faces) {
  for (const std::vector<int>& facet : facets(type)) {
    Face face{{-1, -1, -1, -1}, source};
    for (std::size_t k = 0; k < facet.size(); ++k) face.nodes[k] = nodes[facet[k]];
    faces.push_back(face);
  }
}

// Faces between partitions are none of any surface.
bool is_face(const Mesh& mesh, const ElementBlock& block, int face_dimension) {
  return dimension(block.type.shape) == face_dimension && !is_between_partitions(mesh, block);
}

std::vector<Face> faces_of(const Mesh& mesh, int face_dimension) {
  std::vector<Face> faces;
  faces.reserve(static_cast<std::size_t>(n_elements(mesh, face_dimension)));
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; is_face(mesh, block, face_dimension) && e < block.size(); ++e)
      add_facets(block.type, block.element(e), {block.tags[e], block.type.shape, false}, faces);
  for (const CellFace& side : boundary_faces(mesh, face_dimension + 1))
    add_facets(side.type, side.all(), {side.element, side.type.shape, true}, faces);
  return faces;
}

// For each face the first one with its key.
template <class KeyOf>
std::vector<Index> first_with_key(std::size_t n_faces, KeyOf&& key_of) {
  struct Entry {
    FaceKey key;
    Index face;
  };
  std::vector<Entry> entries;
  entries.reserve(n_faces);
  for (std::size_t f = 0; f < n_faces; ++f) entries.push_back({key_of(f), static_cast<Index>(f)});
  parallel_sort(std::span(entries), [](const Entry& a, const Entry& b) {
    return a.key != b.key ? a.key < b.key : a.face < b.face;
  });
  std::vector<Index> first(n_faces);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const bool is_first = i == 0 || entries[i].key != entries[i - 1].key;
    first[entries[i].face] = is_first ? entries[i].face : first[entries[i - 1].face];
  }
  return first;
}

// Elements of several groups, which a file repeats, and sides that are elements as well: of faces
// on the same nodes only the first stays.
void drop_repetitions(std::vector<Face>& faces) {
  const std::vector<Index> first =
      first_with_key(faces.size(), [&](std::size_t f) { return face_key(faces[f].corners()); });
  std::size_t n_kept = 0;
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (first[f] == static_cast<Index>(f)) faces[n_kept++] = faces[f];
  faces.resize(n_kept);
}

FaceKey key_of_places(const CheckedFaces& faces, std::size_t f) {
  std::array<Index, 4> places{};
  const auto points = faces.face(f);
  for (std::size_t k = 0; k < points.size(); ++k) places[k] = faces.joined[points[k]];
  return face_key(std::span(places).first(points.size()));
}

std::vector<Index> along_curve(const std::vector<Face>& faces, const Mesh& mesh) {
  std::vector<Vec3> middles;
  middles.reserve(faces.size());
  for (const Face& face : faces) {
    Vec3 sum = Vec3::Zero();
    const auto corners = face.corners();
    for (const Index node : corners) sum += mesh.nodes[node] / static_cast<double>(corners.size());
    middles.push_back(sum);
  }
  return morton_order(middles);
}

void add_face(const Face& face, std::vector<Index>& point_of_node, CheckedFaces& result) {
  std::array<Index, 4> points = {-1, -1, -1, -1};
  for (std::size_t k = 0; k < face.corners().size(); ++k) {
    Index& point = point_of_node[face.nodes[k]];
    if (point < 0) {
      point = static_cast<Index>(result.nodes.size());
      result.nodes.push_back(face.nodes[k]);
    }
    points[k] = point;
  }
  result.corners.push_back(points);
  result.sources.push_back(face.source);
}

std::vector<Index> join(std::span<const Vec3> places) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : places) box.extend(x);
  const double step = std::max(same_place * box.sizes().norm(), std::numeric_limits<double>::min());
  std::vector<Vec3> rounded;
  rounded.reserve(places.size());
  for (const Vec3& x : places)
    rounded.emplace_back(((x - box.min()) / step + Vec3::Constant(0.5)).array().floor());
  return first_at_each_position(rounded);
}

void add_facets(CheckedFaces& faces) {
  const auto are_one = [&](Index a, Index b) { return faces.joined[a] == faces.joined[b]; };
  const auto add = [&](std::size_t face, Index a, Index b, Index c) {
    const bool is_segment = b == c;
    if (are_one(a, b) || are_one(a, c) || (!is_segment && are_one(b, c))) return;
    faces.facets.push_back({a, b, c});
    faces.face_of_facet.push_back(static_cast<Index>(face));
  };
  const auto n_quadrangles = static_cast<std::size_t>(std::count_if(
      faces.corners.begin(), faces.corners.end(), [](const auto& face) { return face[3] >= 0; }));
  faces.facets.reserve(faces.corners.size() + 3 * n_quadrangles);
  faces.face_of_facet.reserve(faces.facets.capacity());
  faces.first_facet.reserve(faces.corners.size() + 1);
  for (std::size_t f = 0; f < faces.corners.size(); ++f) {
    const auto [a, b, c, d] = faces.corners[f];
    faces.first_facet.push_back(static_cast<Index>(faces.facets.size()));
    add(f, a, b, c < 0 ? b : c);
    if (d < 0) continue;
    add(f, a, c, d);
    add(f, a, b, d);
    add(f, b, c, d);
  }
  faces.first_facet.push_back(static_cast<Index>(faces.facets.size()));
}

// Corners, sources and nodes, along the curve.
CheckedFaces distinct_faces(const Mesh& mesh, int dimension,
                            std::span<const std::uint8_t> left_out) {
  std::vector<Face> faces = faces_of(mesh, dimension);
  if (!left_out.empty())
    std::erase_if(faces, [&](const Face& face) {
      const auto nodes = face.corners();
      return std::any_of(nodes.begin(), nodes.end(), [&](Index n) { return left_out[n] != 0; });
    });
  drop_repetitions(faces);
  CheckedFaces result;
  result.dimension = dimension;
  result.corners.reserve(faces.size());
  result.sources.reserve(faces.size());
  std::vector<Index> point_of_node(mesh.nodes.size(), -1);
  for (const Index f : along_curve(faces, mesh)) add_face(faces[f], point_of_node, result);
  return result;
}

}  // namespace

CheckedFaces collect_faces(const Mesh& mesh, int dimension,
                           std::span<const std::uint8_t> left_out) {
  CheckedFaces result = distinct_faces(mesh, dimension, left_out);
  result.before.reserve(result.nodes.size());
  for (const Index node : result.nodes) result.before.push_back(mesh.nodes[node]);
  result.joined = join(result.before);
  result.same_place = first_with_key(result.corners.size(),
                                     [&](std::size_t f) { return key_of_places(result, f); });
  add_facets(result);
  return result;
}

std::vector<Index> CheckedFaces::sample(std::size_t step) const {
  DisjointSets parts(nodes.size());
  for (std::size_t f = 0; f < corners.size(); ++f)
    for (const Index point : face(f)) parts.unite(face(f).front(), point);
  std::vector<Index> result;
  for (Index point = 0; point < static_cast<Index>(nodes.size()); ++point)
    if (static_cast<std::size_t>(point) % step == 0 || parts.smallest(point) == point)
      result.push_back(point);
  return result;
}

// Points of one place in the input form few groups that move together, mostly one.
std::vector<Index> joined_after(const CheckedFaces& faces, std::span<const Vec3> after) {
  constexpr std::size_t most_groups = 64;  // a file whose points are all at one place ends as well
  Eigen::AlignedBox3d box;
  for (const Vec3& x : faces.before) box.extend(x);
  const double tolerance = 2 * same_place * box.sizes().norm();
  const auto move_together = [&](Index i, Index j) {
    const Vec3 apart = (after[i] - after[j]) - (faces.before[i] - faces.before[j]);
    return apart.cwiseAbs().maxCoeff() <= tolerance;
  };
  std::vector<Index> result(faces.nodes.size());
  std::map<Index, std::vector<Index>> groups;  // the first of each, by the first of their place
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Index self = static_cast<Index>(i), first = faces.joined[i];
    result[i] = self;
    if (first == self) continue;
    auto& leaders = groups.try_emplace(first, std::vector<Index>{first}).first->second;
    const auto leader = std::find_if(leaders.begin(), leaders.end(),
                                     [&](Index other) { return move_together(self, other); });
    if (leader != leaders.end())
      result[i] = *leader;
    else if (leaders.size() < most_groups)
      leaders.push_back(self);
  }
  return result;
}

}  // namespace roughmesh::detail
