// SPDX-License-Identifier: BSD-3-Clause
#include "volume_faces.hpp"

#include <algorithm>
#include <iterator>

#include "parallel.hpp"
#include "surface_faces.hpp"

namespace roughmesh::detail {
namespace {

// Where a face stands: small, because a mesh has twice as many of them as tetrahedra.
struct FaceRef {
  std::int32_t block;
  Index element;
  std::uint8_t face;
};

template <class Visit>
void for_each_face(const Mesh& mesh, int cell_dimension, Visit&& visit) {
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const ElementBlock& block = mesh.blocks[b];
    if (dimension(block.type.shape) != cell_dimension) continue;
    const std::size_t n_faces = local_faces(block.type.shape).size();
    for (Index e = 0; e < block.size(); ++e)
      for (std::size_t f = 0; f < n_faces; ++f)
        visit(FaceRef{static_cast<std::int32_t>(b), e, static_cast<std::uint8_t>(f)});
  }
}

CellFace resolve(const Mesh& mesh, const FaceRef& ref) {
  return cell_face(mesh.blocks[ref.block], ref.element, ref.face);
}

Index smallest_node(const Mesh& mesh, const FaceRef& ref) {
  const CellFace face = resolve(mesh, ref);
  const auto corners = face.corners();
  return *std::min_element(corners.begin(), corners.end());
}

// Faces sorted into one bucket per smallest node, so that equal faces meet in a bucket of some
// twenty instead of in one sort of all.
struct Buckets {
  std::vector<std::size_t> offsets;
  std::vector<FaceRef> faces;
};

Buckets make_buckets(const Mesh& mesh, int cell_dimension) {
  Buckets buckets;
  buckets.offsets.assign(mesh.nodes.size() + 1, 0);
  for_each_face(mesh, cell_dimension,
                [&](const FaceRef& ref) { ++buckets.offsets[smallest_node(mesh, ref) + 1]; });
  for (std::size_t i = 1; i < buckets.offsets.size(); ++i)
    buckets.offsets[i] += buckets.offsets[i - 1];
  buckets.faces.resize(buckets.offsets.back());
  std::vector<std::size_t> next(buckets.offsets.begin(), buckets.offsets.end() - 1);
  for_each_face(mesh, cell_dimension,
                [&](const FaceRef& ref) { buckets.faces[next[smallest_node(mesh, ref)]++] = ref; });
  return buckets;
}

struct KeyedFace {
  FaceKey key;
  FaceRef ref;
};

std::span<const Index> corners(const Mesh& mesh, const FaceRef& ref) {
  const ElementBlock& block = mesh.blocks[ref.block];
  return block.element(ref.element).first(static_cast<std::size_t>(n_corners(block.type.shape)));
}

// Do the faces belong to one element that the mesh lists twice, as files do for elements in several
// groups?
bool is_repetition(const Mesh& mesh, const FaceRef& a, const FaceRef& b) {
  if (a.block == b.block && a.element == b.element) return false;
  const auto of_a = corners(mesh, a), of_b = corners(mesh, b);
  return std::is_permutation(of_a.begin(), of_a.end(), of_b.begin(), of_b.end());
}

void append_single_faces(const Mesh& mesh, std::span<const FaceRef> bucket,
                         std::vector<KeyedFace>& scratch, std::vector<CellFace>& out) {
  scratch.clear();
  for (const FaceRef& ref : bucket)
    scratch.push_back({face_key(resolve(mesh, ref).corners()), ref});
  std::sort(scratch.begin(), scratch.end(),
            [](const KeyedFace& a, const KeyedFace& b) { return a.key < b.key; });
  for (auto first = scratch.begin(); first != scratch.end();) {
    const auto end =
        std::find_if(first, scratch.end(), [&](const KeyedFace& f) { return f.key != first->key; });
    const bool of_one_element = std::all_of(
        first + 1, end, [&](const KeyedFace& f) { return is_repetition(mesh, first->ref, f.ref); });
    if (of_one_element) out.push_back(resolve(mesh, first->ref));
    first = end;
  }
}

}  // namespace

CellFace cell_face(const ElementBlock& block, Index element, std::size_t face) {
  const LocalFace& local = element_faces(block.type)[face];
  const auto nodes = block.element(element);
  CellFace result{local.type, {}, block.tags[element]};
  for (int k = 0; k < local.type.n_nodes; ++k) result.nodes[k] = nodes[local.nodes[k]];
  return result;
}

std::vector<CellFace> boundary_faces(const Mesh& mesh, int cell_dimension) {
  if (n_elements(mesh, cell_dimension) == 0) return {};
  const Buckets buckets = make_buckets(mesh, cell_dimension);
  constexpr std::size_t grain = 8192;
  std::vector<std::vector<CellFace>> parts((mesh.nodes.size() + grain - 1) / grain);
  parallel_for(mesh.nodes.size(), grain, [&](std::size_t begin, std::size_t end) {
    std::vector<KeyedFace> scratch;
    for (std::size_t node = begin; node < end; ++node) {
      const std::size_t first = buckets.offsets[node];
      append_single_faces(mesh, {buckets.faces.data() + first, buckets.offsets[node + 1] - first},
                          scratch, parts[begin / grain]);
    }
  });
  std::vector<CellFace> faces;
  for (const std::vector<CellFace>& part : parts)
    faces.insert(faces.end(), part.begin(), part.end());
  return faces;
}

}  // namespace roughmesh::detail
