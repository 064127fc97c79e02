// SPDX-License-Identifier: BSD-3-Clause
#include "surface_faces.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t grain = 4096;

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

std::size_t n_corners(const FaceKey& key) {
  return static_cast<std::size_t>(std::find(key.begin(), key.end(), no_point) - key.begin());
}

// Keys of all faces; of those without extent, largest of all.
std::vector<FaceKey> keys_of(const Faces& on_nodes, std::span<const Index> point_of_node) {
  std::vector<FaceKey> keys(on_nodes.tags.size(), face_key({}));
  parallel_for(keys.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Polygon polygon =
          without_repeated_neighbours(on_nodes.face(static_cast<Index>(f)), point_of_node);
      const FaceKey key = face_key(polygon.span());
      if (has_extent(key, polygon.n, on_nodes.dimension)) keys[f] = key;
    }
  });
  return keys;
}

struct KeyedFace {
  FaceKey key;
  Index face;

  friend bool operator<(const KeyedFace& a, const KeyedFace& b) {
    return a.key != b.key ? a.key < b.key : a.face < b.face;
  }
};

// Faces with extent in the order of their keys, equal ones in that of the file. They are sorted
// into one bucket per smallest point first, since few share it.
std::vector<KeyedFace> sorted_faces(std::span<const FaceKey> keys, Index n_points) {
  const auto is_face = [](const FaceKey& key) { return key.front() < no_point; };
  std::vector<Index> offsets(static_cast<std::size_t>(n_points) + 1, 0);
  for (const FaceKey& key : keys)
    if (is_face(key)) ++offsets[key.front() + 1];
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  std::vector<KeyedFace> faces(static_cast<std::size_t>(offsets.back()));
  std::vector<Index> next(offsets.begin(), offsets.end() - 1);
  for (std::size_t f = 0; f < keys.size(); ++f)
    if (is_face(keys[f])) faces[next[keys[f].front()]++] = {keys[f], static_cast<Index>(f)};
  parallel_for(static_cast<std::size_t>(n_points), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t point = begin; point < end; ++point)
      std::sort(faces.begin() + offsets[point], faces.begin() + offsets[point + 1]);
  });
  return faces;
}

// Faces on nodes in the order of their keys, about to be put on points.
struct SortedFaces {
  const Faces& on_nodes;
  std::span<const Index> point_of_node;
  std::vector<KeyedFace> faces;

  bool is_duplicate(std::size_t i) const { return i > 0 && faces[i].key == faces[i - 1].key; }
  Faces distinct() const;

 private:
  struct Counts {
    std::size_t faces = 0, corners = 0;
  };
  std::vector<Counts> counts_before() const;
  void write(std::size_t begin, std::size_t end, Counts at, Faces& result) const;
};

// Distinct faces before each range of faces, and of all.
std::vector<SortedFaces::Counts> SortedFaces::counts_before() const {
  std::vector<Counts> counts((faces.size() + grain - 1) / grain + 1);
  parallel_for(faces.size(), grain, [&](std::size_t begin, std::size_t end) {
    Counts& range = counts[begin / grain + 1];
    for (std::size_t i = begin; i < end; ++i) {
      if (is_duplicate(i)) continue;
      ++range.faces;
      range.corners += n_corners(faces[i].key);
    }
  });
  for (std::size_t r = 1; r < counts.size(); ++r) {
    counts[r].faces += counts[r - 1].faces;
    counts[r].corners += counts[r - 1].corners;
  }
  return counts;
}

void SortedFaces::write(std::size_t begin, std::size_t end, Counts at, Faces& result) const {
  for (std::size_t i = begin; i < end; ++i) {
    if (is_duplicate(i)) continue;
    const Index face = faces[i].face;
    Polygon polygon = without_repeated_neighbours(on_nodes.face(face), point_of_node);
    const auto first = polygon.corners.begin();
    const auto last = first + static_cast<std::ptrdiff_t>(polygon.n);
    if (on_nodes.dimension == 2) std::rotate(first, std::min_element(first, last), last);
    std::copy(first, last, result.corners.begin() + static_cast<std::ptrdiff_t>(at.corners));
    at.corners += polygon.n;
    result.tags[at.faces] = on_nodes.tags[face];
    result.file_order[at.faces] = on_nodes.file_order[face];
    result.offsets[++at.faces] = static_cast<Index>(at.corners);
  }
}

Faces SortedFaces::distinct() const {
  const std::vector<Counts> counts = counts_before();
  const auto [n_faces, n_all_corners] = counts.back();
  Faces result;
  result.dimension = on_nodes.dimension;
  result.plane_normal = on_nodes.plane_normal;
  result.offsets.resize(n_faces + 1);
  result.corners.resize(n_all_corners);
  result.tags.resize(n_faces);
  result.file_order.resize(n_faces);
  parallel_for(faces.size(), grain, [&](std::size_t begin, std::size_t end) {
    write(begin, end, counts[begin / grain], result);
  });
  return result;
}

// Numbers from 0 to below `end`.
Index n_distinct(std::span<const Index> numbers, Index end) {
  std::vector<std::uint8_t> occurs(static_cast<std::size_t>(end), 0);
  for (const Index number : numbers) occurs[number] = 1;
  return static_cast<Index>(std::count(occurs.begin(), occurs.end(), 1));
}

}  // namespace

void Faces::add(std::span<const Index> face_corners, Tag tag, Index order) {
  corners.insert(corners.end(), face_corners.begin(), face_corners.end());
  offsets.push_back(static_cast<Index>(corners.size()));
  tags.push_back(tag);
  file_order.push_back(order);
}

void Faces::reserve(std::size_t n_faces, std::size_t n_corners) {
  corners.reserve(n_corners);
  offsets.reserve(n_faces + 1);
  tags.reserve(n_faces);
  file_order.reserve(n_faces);
}

void Faces::turn(Index i) {
  const Index fixed = dimension == 1 ? 0 : 1;
  std::reverse(corners.begin() + offsets[i] + fixed, corners.begin() + offsets[i + 1]);
}

FaceKey face_key(std::span<const Index> corners) {
  FaceKey key;
  key.fill(no_point);
  std::copy(corners.begin(), corners.end(), key.begin());
  std::sort(key.begin(), key.end());
  return key;
}

CanonicalFaces canonical_faces(const Faces& on_nodes, std::span<const Index> point_of_node,
                               Index n_points) {
  const SortedFaces sorted{on_nodes, point_of_node,
                           sorted_faces(keys_of(on_nodes, point_of_node), n_points)};
  CanonicalFaces result;
  result.faces = sorted.distinct();
  std::vector<Index> duplicates;
  for (std::size_t i = 0; result.faces.tags.size() < sorted.faces.size() && i < sorted.faces.size();
       ++i)
    if (sorted.is_duplicate(i)) duplicates.push_back(on_nodes.file_order[sorted.faces[i].face]);
  const Index n_elements = on_nodes.file_order.empty() ? 0 : on_nodes.file_order.back() + 1;
  result.n_elements = n_distinct(result.faces.file_order, n_elements);
  result.n_duplicates = n_distinct(duplicates, n_elements);
  return result;
}

// Faces stand in the order of their smallest points.
FaceLookup::FaceLookup(std::span<const Index> offsets, std::span<const Index> corners)
    : offsets_(offsets), corners_(corners) {
  const std::size_t n_faces = offsets.size() - 1;
  for (std::size_t f = 0; f < n_faces; ++f) {
    const auto smallest = static_cast<std::size_t>(key_of(static_cast<Index>(f)).front());
    first_face_.resize(std::max(first_face_.size(), smallest + 1), static_cast<Index>(f));
  }
  first_face_.push_back(static_cast<Index>(n_faces));
}

FaceKey FaceLookup::key_of(Index face) const {
  const Index begin = offsets_[face], end = offsets_[face + 1];
  return face_key(
      corners_.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin)));
}

Index FaceLookup::find(std::span<const Index> points) const {
  if (std::find(points.begin(), points.end(), -1) != points.end()) return -1;
  const FaceKey key = face_key(points);
  const auto smallest = static_cast<std::size_t>(key.front());
  if (smallest + 1 >= first_face_.size()) return -1;
  const Index end = first_face_[smallest + 1];
  Index low = first_face_[smallest];
  for (Index high = end; low < high;) {
    const Index middle = low + (high - low) / 2;
    if (key_of(middle) < key)
      low = middle + 1;
    else
      high = middle;
  }
  return low < end && key_of(low) == key ? low : -1;
}

}  // namespace roughmesh::detail
