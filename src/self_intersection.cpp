// SPDX-License-Identifier: BSD-3-Clause
#include "self_intersection.hpp"

#include <algorithm>

#include "parallel.hpp"
#include "triangle_tree.hpp"

namespace roughmesh::detail {
namespace {

// All faces at one place make a square of their number of pairs. Counted for each task and for
// batches of tasks, so that what is found is the same on any number of threads.
constexpr std::size_t most_pairs = 200'000;
constexpr std::size_t most_pairs_of_task = 20'000;
constexpr std::size_t tasks_per_batch = 64;
constexpr std::size_t most_tests_of_task = 1'000'000;
constexpr std::size_t most_tests_of_facet = 1'000;

/// @param place  of a point
template <class Place>
bool facets_intersect(const FacesInPlace& now, std::size_t i, std::size_t j, Place&& place) {
  const auto placed = [&](const Facet& f) {
    return PlacedFacet{{now.joined[f[0]], now.joined[f[1]], now.joined[f[2]]},
                       {place(f[0]), place(f[1]), place(f[2])}};
  };
  const PlacedFacet a = placed(now.faces.facets[i]), b = placed(now.faces.facets[j]);
  return now.faces.dimension == 1 ? segments_intersect(a, b, now.axis) : triangles_intersect(a, b);
}

template <class Place>
bool faces_intersect(const FacesInPlace& now, Index face_a, Index face_b, Place&& place) {
  const std::vector<Index>& first = now.faces.first_facet;
  for (Index i = first[face_a]; i < first[face_a + 1]; ++i)
    for (Index j = first[face_b]; j < first[face_b + 1]; ++j)
      if (facets_intersect(now, i, j, place)) return true;
  return false;
}

void sort_once(std::vector<FacePair>& pairs) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

FoundPairs search(const FacesInPlace& before, const FacesInPlace& now, const TriangleTree& tree,
                  const TriangleTree::Task& task, std::size_t most_tests) {
  FoundPairs part;
  std::size_t n_tests = 0;
  const std::vector<Index>& same_place = now.faces.same_place;
  const auto place = [&](Index point) -> const Vec3& { return now.positions[point]; };
  tree.for_each_pair(task, [&](std::size_t i, std::size_t j) {
    const FacePair pair{now.faces.face_of_facet[i], now.faces.face_of_facet[j]};
    part.is_complete = ++n_tests < most_tests &&
                       std::max(part.pairs.size(), part.in_input.size()) < most_pairs_of_task;
    if (same_place[pair.a] != same_place[pair.b] && facets_intersect(now, i, j, place))
      (before.intersect(pair.a, pair.b) ? part.in_input : part.pairs).push_back(pair);
    return part.is_complete;
  });
  return part;
}

void append(FoundPairs& all, const FoundPairs& part) {
  all.pairs.insert(all.pairs.end(), part.pairs.begin(), part.pairs.end());
  all.in_input.insert(all.in_input.end(), part.in_input.begin(), part.in_input.end());
  all.is_complete = all.is_complete && part.is_complete;
}

}  // namespace

bool FacesInPlace::intersect(Index face_a, Index face_b) const {
  return faces_intersect(*this, face_a, face_b,
                         [&](Index point) -> const Vec3& { return positions[point]; });
}

bool intersect_between(const FacesInPlace& before, const FacesInPlace& after, double share,
                       Index face_a, Index face_b) {
  return faces_intersect(after, face_a, face_b, [&](Index point) -> Vec3 {
    const Vec3& start = before.positions[point];
    return start + share * (after.positions[point] - start);
  });
}

FoundPairs find_intersections(const FacesInPlace& before, const FacesInPlace& now,
                              std::span<const std::uint8_t> has_moved) {
  const TriangleTree tree(now.faces.facets, now.positions, has_moved);
  const std::vector<TriangleTree::Task> tasks = tree.tasks();
  const std::size_t most_tests =
      most_tests_of_task +
      most_tests_of_facet * (now.faces.facets.size() / std::max<std::size_t>(tasks.size(), 1));
  FoundPairs found;
  std::vector<FoundPairs> parts(tasks.size());
  for (std::size_t first = 0; first < tasks.size(); first += tasks_per_batch) {
    const std::size_t n = std::min(tasks_per_batch, tasks.size() - first);
    parallel_for(n, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = first + begin; t < first + end; ++t)
        parts[t] = search(before, now, tree, tasks[t], most_tests);
    });
    for (std::size_t t = first; t < first + n; ++t) append(found, parts[t]);
    if (std::max(found.pairs.size(), found.in_input.size()) <= most_pairs) continue;
    found.is_complete = found.is_complete && first + n == tasks.size();
    break;
  }
  sort_once(found.pairs);
  sort_once(found.in_input);
  return found;
}

}  // namespace roughmesh::detail
