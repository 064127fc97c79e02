// SPDX-License-Identifier: BSD-3-Clause
#include "surface_faces.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace roughmesh::detail {
namespace {

// Up to four corners without allocation.
struct Polygon {
  std::array<Index, 4> corners{};
  std::size_t n = 0;

  std::span<const Index> span() const { return {corners.data(), n}; }
};

Polygon without_repeated_neighbours(std::span<const Index> nodes,
                                    std::span<const Index> point_of_node) {
  Polygon polygon;
  for (const Index node : nodes) {
    const Index point = point_of_node[node];
    if (polygon.n == 0 || polygon.corners[polygon.n - 1] != point)
      polygon.corners[polygon.n++] = point;
  }
  if (polygon.n > 1 && polygon.corners[polygon.n - 1] == polygon.corners[0]) --polygon.n;
  return polygon;
}

bool has_extent(const FaceKey& key, std::size_t n_corners, int dimension) {
  const auto end = key.begin() + static_cast<std::ptrdiff_t>(n_corners);
  return static_cast<int>(n_corners) > dimension && std::adjacent_find(key.begin(), end) == end;
}

struct Candidate {
  FaceKey key;
  Index face;  // in the order of the file
};

std::vector<Candidate> sorted_candidates(const Faces& on_nodes,
                                         std::span<const Index> point_of_node) {
  std::vector<Candidate> candidates;
  candidates.reserve(static_cast<std::size_t>(on_nodes.size()));
  for (Index f = 0; f < on_nodes.size(); ++f) {
    const Polygon polygon = without_repeated_neighbours(on_nodes.face(f), point_of_node);
    const FaceKey key = face_key(polygon.span());
    if (has_extent(key, polygon.n, on_nodes.dimension)) candidates.push_back({key, f});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.key != b.key ? a.key < b.key : a.face < b.face;
  });
  return candidates;
}

Index n_distinct(std::vector<Index> numbers) {
  std::sort(numbers.begin(), numbers.end());
  return static_cast<Index>(std::unique(numbers.begin(), numbers.end()) - numbers.begin());
}

}  // namespace

void Faces::add(std::span<const Index> face_corners, Tag tag, Index order) {
  corners.insert(corners.end(), face_corners.begin(), face_corners.end());
  offsets.push_back(static_cast<Index>(corners.size()));
  tags.push_back(tag);
  file_order.push_back(order);
}

void Faces::turn(Index i) {
  const Index fixed = dimension == 1 ? 0 : 1;
  std::reverse(corners.begin() + offsets[i] + fixed, corners.begin() + offsets[i + 1]);
}

FaceKey face_key(std::span<const Index> corners) {
  FaceKey key;
  key.fill(std::numeric_limits<Index>::max());
  std::copy(corners.begin(), corners.end(), key.begin());
  std::sort(key.begin(), key.end());
  return key;
}

CanonicalFaces canonical_faces(const Faces& on_nodes, std::span<const Index> point_of_node) {
  CanonicalFaces result;
  result.faces.dimension = on_nodes.dimension;
  result.faces.plane_normal = on_nodes.plane_normal;
  const std::vector<Candidate> candidates = sorted_candidates(on_nodes, point_of_node);
  std::vector<Index> kept, duplicates;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Index face = candidates[i].face;
    if (i > 0 && candidates[i].key == candidates[i - 1].key) {
      duplicates.push_back(on_nodes.file_order[face]);
      continue;
    }
    kept.push_back(on_nodes.file_order[face]);
    Polygon polygon = without_repeated_neighbours(on_nodes.face(face), point_of_node);
    const auto begin = polygon.corners.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(polygon.n);
    if (on_nodes.dimension == 2) std::rotate(begin, std::min_element(begin, end), end);
    result.faces.add(polygon.span(), on_nodes.tags[face], on_nodes.file_order[face]);
  }
  result.n_elements = n_distinct(std::move(kept));
  result.n_duplicates = n_distinct(std::move(duplicates));
  return result;
}

FaceLookup::FaceLookup(std::span<const Index> offsets, std::span<const Index> corners) {
  keys_.reserve(offsets.size() - 1);
  for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
    const auto n = static_cast<std::size_t>(offsets[f + 1] - offsets[f]);
    keys_.push_back(face_key(corners.subspan(static_cast<std::size_t>(offsets[f]), n)));
  }
}

Index FaceLookup::find(std::span<const Index> points) const {
  if (std::find(points.begin(), points.end(), -1) != points.end()) return -1;
  const FaceKey key = face_key(points);
  const auto at = std::lower_bound(keys_.begin(), keys_.end(), key);
  return at != keys_.end() && *at == key ? static_cast<Index>(at - keys_.begin()) : -1;
}

}  // namespace roughmesh::detail
