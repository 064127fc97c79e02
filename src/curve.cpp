// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/curve.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>

#include "messages.hpp"

namespace roughmesh {
namespace {

/// The lines at a point: one at an end, else two.
struct LinesAtPoint {
  std::array<Index, 2> lines{};
  int n = 0;
};

void require_line(const Surface& surface, Index line) {
  const auto face = surface.face(line);
  if (face.size() == 2 && face[0] != face[1]) return;
  throw InputError(
      fmt::format("distance along a curve needs lines of two points, but element {} has {}; choose "
                  "a group of lines or --distance euclidean",
                  surface.face_tags[line], face.size()));
}

std::vector<LinesAtPoint> lines_at_points(const Surface& surface) {
  std::vector<LinesAtPoint> at(surface.points.size());
  for (Index line = 0; line < surface.n_faces(); ++line) {
    require_line(surface, line);
    for (const Index point : surface.face(line)) {
      if (at[point].n == 2)
        throw InputError(
            fmt::format("three or more lines of the curve meet at {}: no arc length is unique "
                        "there; choose groups without branches or --distance euclidean",
                        detail::place(surface.points[point])));
      at[point].lines[at[point].n++] = line;
    }
  }
  for (std::size_t point = 0; point < at.size(); ++point)
    if (at[point].n == 0)
      throw InputError(
          fmt::format("the point at {} is on no line of the curve; choose --distance euclidean",
                      detail::place(surface.points[point])));
  return at;
}

Index other_end(const Surface& surface, Index line, Index point) {
  const auto face = surface.face(line);
  return face[0] == point ? face[1] : face[0];
}

/// Walks from `start` on and fills in the places of one piece.
class Walk {
 public:
  Walk(const Surface& surface, const std::vector<LinesAtPoint>& at, CurvePlaces& result)
      : surface_(surface), at_(at), result_(result) {}

  void along_piece(Index start) {
    const auto number = static_cast<double>(result_.lengths.size());
    double s = 0;
    Index point = start, line = first_line(start);
    result_.places[point] = {s, number, 0};
    do {
      const Index next = other_end(surface_, line, point);
      s += (surface_.points[next] - surface_.points[point]).norm();
      if (next != start) result_.places[next] = {s, number, 0};
      point = next;
      const LinesAtPoint& lines = at_[point];
      if (lines.n == 2) line = lines.lines[0] == line ? lines.lines[1] : lines.lines[0];
    } while (point != start && at_[point].n == 2);
    const bool is_closed = point == start;
    result_.lengths.push_back(s);
    result_.closed_lengths.push_back(is_closed ? s : std::numeric_limits<double>::infinity());
  }

 private:
  /// Of two, that to the point that comes first, so that numbers of elements play no part.
  Index first_line(Index point) const {
    const LinesAtPoint& lines = at_[point];
    if (lines.n == 1 ||
        other_end(surface_, lines.lines[0], point) < other_end(surface_, lines.lines[1], point))
      return lines.lines[0];
    return lines.lines[1];
  }

  const Surface& surface_;
  const std::vector<LinesAtPoint>& at_;
  CurvePlaces& result_;
};

/// One point of each piece from which to walk, ascending by the first point of the piece: the first
/// end of an open piece, the first point of a closed one.
std::vector<Index> starts_of_pieces(const Surface& surface, const std::vector<LinesAtPoint>& at) {
  std::vector<char> is_seen(at.size(), 0);
  std::vector<Index> starts, piece, open;
  for (Index first = 0; first < surface.n_points(); ++first) {
    if (is_seen[first]) continue;
    piece.clear();
    open = {first};
    is_seen[first] = 1;
    while (!open.empty()) {
      const Index point = open.back();
      open.pop_back();
      piece.push_back(point);
      for (int k = 0; k < at[point].n; ++k) {
        const Index next = other_end(surface, at[point].lines[k], point);
        if (!is_seen[next]) open.push_back(next);
        is_seen[next] = 1;
      }
    }
    Index start = surface.n_points();
    for (const Index point : piece)
      if (at[point].n == 1) start = std::min(start, point);
    starts.push_back(start < surface.n_points() ? start : first);
  }
  return starts;
}

}  // namespace

CurvePlaces curve_places(const Surface& surface) {
  const std::vector<LinesAtPoint> at = lines_at_points(surface);
  CurvePlaces result;
  result.places.resize(surface.points.size());
  Walk walk(surface, at, result);
  for (const Index start : starts_of_pieces(surface, at)) walk.along_piece(start);
  return result;
}

}  // namespace roughmesh
