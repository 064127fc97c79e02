// SPDX-License-Identifier: BSD-3-Clause
#include "flat_walls.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "roughmesh/surface.hpp"

#include "disjoint_sets.hpp"
#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

constexpr double same_direction = 1e-5;  // sine of the angle between faces of one plane
constexpr double flat = 1e-6;            // distance from the plane over the extent of the patch
constexpr double on_axis = 1e-9;         // likewise, of a plane of coordinates
constexpr double no_area = 1e-10;        // area over the square of the longest edge

// Unit normal of a face, or of a line in its plane; zero without area.
Vec3 unit_normal(const Mesh& mesh, const CellFace& face, const Vec3& plane_normal) {
  std::array<Vec3, 4> x;
  const auto corners = face.corners();
  double longest = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    x[k] = mesh.nodes[corners[k]];
    longest = std::max(longest, (x[k] - x[0]).norm());
  }
  const Vec3 normal = corners.size() == 2 ? Vec3((x[1] - x[0]).cross(plane_normal))
                                          : area_vector(std::span(x).first(corners.size()));
  const double full = corners.size() == 2 ? longest : longest * longest;
  return normal.norm() > no_area * full ? Vec3(normal.normalized()) : Vec3::Zero();
}

// A place where faces can be joined: an edge, or an end of a line.
struct Joint {
  Index a = 0, b = 0;  // nodes, ascending
  Index face = 0;

  friend bool operator<(const Joint& x, const Joint& y) {
    return std::tie(x.a, x.b, x.face) < std::tie(y.a, y.b, y.face);
  }
  bool is_at(const Joint& other) const { return a == other.a && b == other.b; }
};

std::vector<Joint> sorted_joints(std::span<const WallFace> faces, std::span<const Vec3> normals) {
  std::vector<Joint> joints;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (normals[f].isZero(0)) continue;
    const auto corners = faces[f].face.corners();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Index next = corners.size() == 2 ? corners[k] : corners[(k + 1) % corners.size()];
      const auto [a, b] = std::minmax(corners[k], next);
      joints.push_back({a, b, static_cast<Index>(f)});
    }
  }
  parallel_sort(std::span(joints), std::less<>());
  return joints;
}

// Calls visit(faces at one joint).
template <class Visit>
void for_each_joint(std::span<const Joint> joints, Visit&& visit) {
  for (std::size_t first = 0; first < joints.size();) {
    std::size_t end = first + 1;
    while (end < joints.size() && joints[end].is_at(joints[first])) ++end;
    visit(joints.subspan(first, end - first));
    first = end;
  }
}

DisjointSets unite_faces(std::span<const Joint> joints, std::span<const Vec3> normals) {
  DisjointSets sets(normals.size());
  for_each_joint(joints, [&](std::span<const Joint> at) {
    for (std::size_t i = 0; i < at.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (normals[at[i].face].cross(normals[at[j].face]).norm() <= same_direction)
          sets.unite(at[i].face, at[j].face);
  });
  return sets;
}

// What is learned of a patch from its faces.
struct Fit {
  Vec3 normal = Vec3::Zero();
  Vec3 point = Vec3::Zero();
  Eigen::AlignedBox3d box;
  double distance = 0;
  bool can_move = true;  // all elements are of order 1 and 2

  double extent() const { return box.sizes().norm(); }
  // A plane of coordinates is taken as such, so that no round-off leads off it.
  void take_axis() {
    normal.normalize();
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    if (box.sizes()[axis] <= on_axis * extent()) normal = Vec3::Unit(axis);
  }
};

void take_face(const Mesh& mesh, const WallFace& face, const Vec3& normal, Fit& fit) {
  if (fit.normal.isZero(0)) fit.point = mesh.nodes[face.face.nodes[0]];
  fit.normal += fit.normal.dot(normal) < 0 ? Vec3(-normal) : normal;
  for (const Index node : face.face.all()) fit.box.extend(mesh.nodes[node]);
  if (face.block >= 0 && mesh.blocks[face.block].type.order > 2) fit.can_move = false;
}

std::vector<WallPatch> fit_patches(const Mesh& mesh, std::span<const WallFace> faces,
                                   std::span<const Vec3> normals,
                                   std::span<const Index> patch_of_face, std::size_t n_patches) {
  std::vector<Fit> fits(n_patches);
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (patch_of_face[f] >= 0) take_face(mesh, faces[f], normals[f], fits[patch_of_face[f]]);
  for (Fit& fit : fits) fit.take_axis();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (patch_of_face[f] < 0) continue;
    Fit& fit = fits[patch_of_face[f]];
    for (const Index node : faces[f].face.all())
      fit.distance = std::max(fit.distance, std::abs(fit.normal.dot(mesh.nodes[node] - fit.point)));
  }
  std::vector<WallPatch> patches;
  patches.reserve(fits.size());
  for (const Fit& fit : fits)
    patches.push_back({fit.normal, fit.can_move && fit.distance <= flat * fit.extent()});
  return patches;
}

// Equal for elements of the same groups, or of one entity without any.
bool are_of_one_group(const Mesh& mesh, const WallFace& a, const WallFace& b) {
  if (a.block == b.block) return true;
  if (a.block < 0 || b.block < 0) return false;
  const ElementBlock &first = mesh.blocks[a.block], &second = mesh.blocks[b.block];
  return first.physical_groups == second.physical_groups &&
         (!first.physical_groups.empty() || first.entity == second.entity);
}

// A patch goes on where exactly two of its faces meet, of one group.
std::vector<WallBorder> find_borders(const Mesh& mesh, std::span<const WallFace> faces,
                                     std::span<const Joint> joints,
                                     std::span<const Index> patch_of_face) {
  std::vector<WallBorder> borders;
  for_each_joint(joints, [&](std::span<const Joint> at) {
    for (const Joint& own : at) {
      const Index patch = patch_of_face[own.face];
      Index n_others = 0;
      bool is_inside = false;
      for (const Joint& other : at) {
        if (other.face == own.face || patch_of_face[other.face] != patch) continue;
        ++n_others;
        is_inside = are_of_one_group(mesh, faces[own.face], faces[other.face]);
      }
      if (n_others != 1 || !is_inside) borders.push_back({{own.a, own.b}, patch});
    }
  });
  return borders;
}

}  // namespace

WallPatches find_patches(const Mesh& mesh, std::span<const WallFace> faces,
                         const Vec3& plane_normal) {
  std::vector<Vec3> normals;
  normals.reserve(faces.size());
  for (const WallFace& face : faces) normals.push_back(unit_normal(mesh, face.face, plane_normal));
  const std::vector<Joint> joints = sorted_joints(faces, normals);
  DisjointSets sets = unite_faces(joints, normals);
  WallPatches result;
  result.patch_of_face.assign(faces.size(), -1);
  Index n_patches = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (normals[f].isZero(0)) continue;
    const Index first = sets.smallest(static_cast<Index>(f));
    result.patch_of_face[f] =
        first == static_cast<Index>(f) ? n_patches++ : result.patch_of_face[first];
  }
  result.patches =
      fit_patches(mesh, faces, normals, result.patch_of_face, static_cast<std::size_t>(n_patches));
  result.borders = find_borders(mesh, faces, joints, result.patch_of_face);
  return result;
}

}  // namespace roughmesh::detail
