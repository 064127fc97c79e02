// SPDX-License-Identifier: BSD-3-Clause
#include "surface_edges.hpp"

#include <algorithm>

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
void for_each_side(const Faces& faces, Visit&& visit) {
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
bool is_forward(const Faces& faces, Index face, const FaceSide& side) {
  return faces.dimension == 1 ? side.corner == faces.offsets[face] : side.from < side.to;
}

// Sides in one bucket per smaller point: sorting a few at a time is linear in the number of faces.
struct Buckets {
  std::vector<Index> offsets;
  std::vector<LooseSide> sides;
};

Buckets make_buckets(const Faces& faces, Index n_points) {
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

}  // namespace

EdgeTable make_edges(const Faces& faces, Index n_points) {
  Buckets buckets = make_buckets(faces, n_points);
  EdgeTable table;
  table.sides.reserve(faces.corners.size());
  table.edge_of_corner.resize(faces.corners.size());
  for (Index point = 0; point < n_points; ++point) {
    const auto begin = buckets.sides.begin() + buckets.offsets[point];
    const auto end = buckets.sides.begin() + buckets.offsets[point + 1];
    std::sort(begin, end, [](const LooseSide& a, const LooseSide& b) {
      return a.other_point != b.other_point ? a.other_point < b.other_point : a.corner < b.corner;
    });
    for (auto it = begin; it != end; ++it) {
      const bool is_new = it == begin || it->other_point != (it - 1)->other_point;
      if (is_new) {
        table.points.push_back({point, it->other_point});
        table.offsets.push_back(table.offsets.back());
      }
      table.sides.push_back(it->side);
      ++table.offsets.back();
      table.edge_of_corner[it->corner] = table.size() - 1;
    }
  }
  return table;
}

}  // namespace roughmesh::detail
