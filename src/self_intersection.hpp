// SPDX-License-Identifier: BSD-3-Clause
// Which faces intersect each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "checked_faces.hpp"
#include "facet_pair.hpp"

namespace roughmesh::detail {

/// Faces at one moment of their motion.
struct FacesInPlace {
  const CheckedFaces& faces;
  std::span<const Vec3> positions;  ///< of the points
  std::span<const Index> joined;    ///< of the points: equal where they are one
  int axis = 2;                     ///< along which a plane of lines is seen

  /// Do two faces intersect beyond what they share (facet_pair.hpp)?
  bool intersect(Index face_a, Index face_b) const;
};

/// The same at a share of the way from before to after, with what is shared after.
bool intersect_between(const FacesInPlace& before, const FacesInPlace& after, double share,
                       Index face_a, Index face_b);

struct FacePair {
  Index a, b;  ///< a < b

  friend bool operator==(const FacePair&, const FacePair&) = default;
  friend bool operator<(const FacePair& x, const FacePair& y) {
    return x.a != y.a ? x.a < y.a : x.b < y.b;
  }
};

struct FoundPairs {
  std::vector<FacePair> pairs;     ///< that did not intersect before; ascending, each once
  std::vector<FacePair> in_input;  ///< that did; likewise
  bool is_complete = true;         ///< false: there are more
};

/// Pairs of faces that intersect, one of them with a point that moved; none of faces at one place
/// before. Stops after some 10^5 pairs of either kind, or where very many boxes overlap without an
/// intersection. Depends on no number of threads.
FoundPairs find_intersections(const FacesInPlace& before, const FacesInPlace& now,
                              std::span<const std::uint8_t> has_moved);

}  // namespace roughmesh::detail
