// SPDX-License-Identifier: BSD-3-Clause
#include "surface_edges.hpp"

#include <algorithm>
#include <numeric>
#include <span>

#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

// One side of one face, before it is known which edge it lies on.
struct LooseSide {
  Index other_point;  // the larger one
  Index corner;       // position in Faces::corners
  Side side;
};

struct FaceSide {
  Index from, to, corner;
};

template <class Visit>
void for_each_side(const FaceView& faces, Visit&& visit) {
  for (Index f = 0; f < faces.size(); ++f) {
    const auto corners = faces.face(f);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Index to = faces.dimension == 1 ? corners[k] : corners[(k + 1) % corners.size()];
      visit(f, FaceSide{corners[k], to, faces.offsets[f] + static_cast<Index>(k)});
    }
  }
}

// Two lines of a consistent chain meet at a point that one leaves and the other reaches, just as
// two faces meet at an edge that one runs along to and the other fro.
bool is_forward(const FaceView& faces, Index face, const FaceSide& side) {
  return faces.dimension == 1 ? side.corner == faces.offsets[face] : side.from < side.to;
}

// Sides in one bucket per smaller point: sorting a few at a time is linear in the number of faces.
struct Buckets {
  std::vector<Index> offsets;
  std::vector<LooseSide> sides;
};

Buckets make_buckets(const FaceView& faces, Index n_points) {
  Buckets buckets;
  buckets.offsets.assign(static_cast<std::size_t>(n_points) + 1, 0);
  for_each_side(faces, [&](Index, const FaceSide& side) {
    ++buckets.offsets[std::min(side.from, side.to) + 1];
  });
  for (std::size_t i = 1; i < buckets.offsets.size(); ++i)
    buckets.offsets[i] += buckets.offsets[i - 1];
  buckets.sides.resize(faces.corners.size());
  std::vector<Index> next(buckets.offsets.begin(), buckets.offsets.end() - 1);
  for_each_side(faces, [&](Index face, const FaceSide& side) {
    const auto [smaller, larger] = std::minmax(side.from, side.to);
    buckets.sides[next[smaller]++] = {larger, side.corner, {face, is_forward(faces, face, side)}};
  });
  return buckets;
}

// Sorts the sides of points [begin, end) and returns how many edges they are.
Index sort_sides(std::size_t begin, std::size_t end, Buckets& buckets) {
  Index n_edges = 0;
  for (std::size_t point = begin; point < end; ++point) {
    const std::span sides(buckets.sides.begin() + buckets.offsets[point],
                          buckets.sides.begin() + buckets.offsets[point + 1]);
    std::sort(sides.begin(), sides.end(), [](const LooseSide& a, const LooseSide& b) {
      return a.other_point != b.other_point ? a.other_point < b.other_point : a.corner < b.corner;
    });
    for (std::size_t k = 0; k < sides.size(); ++k)
      n_edges += k == 0 || sides[k].other_point != sides[k - 1].other_point;
  }
  return n_edges;
}

// Writes the edges of points [begin, end) from this one on.
void write_edges(std::size_t begin, std::size_t end, const Buckets& buckets, Index edge,
                 EdgeTable& table) {
  for (std::size_t point = begin; point < end; ++point) {
    const Index first = buckets.offsets[point], last = buckets.offsets[point + 1];
    for (Index k = first; k < last; ++k) {
      const LooseSide& side = buckets.sides[k];
      if (k == first || side.other_point != buckets.sides[k - 1].other_point) {
        table.points[edge] = {static_cast<Index>(point), side.other_point};
        table.offsets[edge++] = k;
      }
      table.sides[k] = side.side;
      table.edge_of_corner[side.corner] = edge - 1;
    }
  }
}

}  // namespace

EdgeTable make_edges(const FaceView& faces, Index n_points) {
  constexpr std::size_t grain = 4096;
  const auto n = static_cast<std::size_t>(n_points);
  Buckets buckets = make_buckets(faces, n_points);
  std::vector<Index> firsts(n / grain + 2, 0);  // edge of each range of points
  parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
    firsts[begin / grain + 1] = sort_sides(begin, end, buckets);
  });
  std::partial_sum(firsts.begin(), firsts.end(), firsts.begin());
  EdgeTable table;
  table.points.resize(static_cast<std::size_t>(firsts.back()));
  table.offsets.assign(table.points.size() + 1, static_cast<Index>(buckets.sides.size()));
  table.sides.resize(buckets.sides.size());
  table.edge_of_corner.resize(faces.corners.size());
  parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
    write_edges(begin, end, buckets, firsts[begin / grain], table);
  });
  return table;
}

}  // namespace roughmesh::detail
