// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "io_patch.hpp"
#include "io_stl.hpp"
#include "new_file.hpp"
#include "number_writer.hpp"
#include "scanner.hpp"
#include "surface_files.hpp"

namespace roughmesh::detail {
namespace {

using Triangle = std::array<Vec3, 3>;

Triangle stored(NumberFormat format, Triangle corners) {
  for (Vec3& x : corners) x = x.unaryExpr([&](double value) { return as_stored(format, value); });
  return corners;
}

// Zero for a triangle without area.
Vec3 normal_of(const Triangle& x) {
  const Vec3 a = x[1] - x[0], b = x[2] - x[0];
  // Scaled first, so that neither tiny nor huge triangles leave the range of doubles.
  const double scale = std::max(a.lpNorm<Eigen::Infinity>(), b.lpNorm<Eigen::Infinity>());
  const Vec3 area = (a / scale).cross(b / scale);
  const double length = area.norm();
  if (!(length > 0 && std::isfinite(length))) return Vec3::Zero();
  return area / length + Vec3::Zero();  // no -0
}

// A triangle itself, or a quadrangle along its shorter diagonal (0-2 where both are equal).
std::vector<std::array<Index, 3>> split(std::span<const Index> face,
                                        const std::vector<Vec3>& nodes) {
  if (face.size() == 3) return {{face[0], face[1], face[2]}};
  const double diagonal02 = (nodes[face[2]] - nodes[face[0]]).norm();
  const double diagonal13 = (nodes[face[3]] - nodes[face[1]]).norm();
  if (diagonal02 <= diagonal13) return {{face[0], face[1], face[2]}, {face[0], face[2], face[3]}};
  return {{face[0], face[1], face[3]}, {face[1], face[2], face[3]}};
}

std::int64_t n_triangles(const SurfacePart& part) {
  std::int64_t n = 0;
  for (const ElementBlock* block : part.blocks)
    n += std::int64_t{block->size()} * (block->type.n_nodes - 2);
  return n;
}

class StlWriter {
 public:
  StlWriter(const Mesh& mesh, Encoding encoding, OutputFile& output)
      : mesh_(&mesh),
        output_(&output),
        numbers_(output, encoding, std::endian::little),
        part_(mesh, 2) {}

  void write_binary() {
    std::string header = "written by roughmesh";  // not "solid"
    header.resize(stl_header_bytes, ' ');
    numbers_.text(header);
    numbers_.number(static_cast<std::uint32_t>(n_triangles(part_)));
    for (const ElementBlock* block : part_.blocks)
      for_each_triangle(*block, [&](const Triangle& corners) { write_bytes_of(corners); });
  }

  // One solid for each first group of elements, in order of appearance.
  void write_text() {
    std::vector<std::pair<Tag, std::vector<const ElementBlock*>>> solids;
    std::map<Tag, std::size_t> places;
    for (const ElementBlock* block : part_.blocks) {
      const Tag group = first_group(*block);
      const auto [place, is_new] = places.try_emplace(group, solids.size());
      if (is_new) solids.push_back({group, {}});
      solids[place->second].second.push_back(block);
    }
    for (const auto& [group, blocks] : solids) write_solid(group, blocks);
  }

 private:
  template <typename Action>
  void for_each_triangle(const ElementBlock& block, Action action) const {
    for (Index i = 0; i < block.size(); ++i)
      for (const std::array<Index, 3>& t : split(block.element(i), mesh_->nodes))
        action({mesh_->nodes[t[0]], mesh_->nodes[t[1]], mesh_->nodes[t[2]]});
  }

  void write_bytes_of(const Triangle& exact) {
    const Triangle corners = stored(NumberFormat::float32, exact);
    const auto write = [&](const Vec3& x) {
      for (const double c : x) numbers_.number(static_cast<float>(c));
    };
    write(normal_of(corners));
    for (const Vec3& corner : corners) {
      if (!corner.allFinite())
        throw InputError(fmt::format("{}: a position is beyond the range of float32; write text",
                                     output_->path().string()));
      write(corner);
    }
    numbers_.number(std::uint16_t{0});
  }

  void write_solid(Tag group, const std::vector<const ElementBlock*>& blocks) {
    const std::string name = group == 0 ? "" : fmt::format(" {}", group_name(*mesh_, 2, group));
    numbers_.text(fmt::format("solid{}\n", name));
    for (const ElementBlock* block : blocks)
      for_each_triangle(*block, [&](const Triangle& corners) { write_text_of(corners); });
    numbers_.text(fmt::format("endsolid{}\n", name));
  }

  void write_text_of(const Triangle& corners) {
    write_vector("facet normal ", normal_of(corners));
    numbers_.text("  outer loop\n");
    for (const Vec3& x : corners) write_vector("    vertex ", x);
    numbers_.text("  endloop\nendfacet\n");
  }

  void write_vector(std::string_view words, const Vec3& x) {
    numbers_.text(words);
    numbers_.vector(x);
    numbers_.end_line();
  }

  const Mesh* mesh_;
  OutputFile* output_;
  NumberWriter numbers_;
  SurfacePart part_;
};

}  // namespace

void write_patched_stl(const Mesh& mesh, OutputFile& output) {
  const MeshSource& source = *mesh.source;
  TriplePatcher patcher(source, output);
  for (const StlFacet& facet : source.facets) {
    Triangle corners;
    bool has_moved = false;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = mesh.nodes[facet.nodes[k]];
      has_moved |= !same_bits(corners[k], source.positions[facet.nodes[k]]);
    }
    if (!has_moved) continue;
    patcher.replace(facet.normal, normal_of(stored(source.coordinates, corners)));
    for (std::size_t k = 0; k < 3; ++k)
      patcher.replace(facet.vertices[k], source.positions[facet.nodes[k]], corners[k]);
  }
  patcher.finish();
}

void check_stl(const Mesh& mesh, const std::filesystem::path& path) {
  check_surface_part(mesh, path, 2);
}

void write_new_stl(const Mesh& mesh, const WriteOptions& options, OutputFile& output) {
  const Encoding encoding = options.encoding.value_or(Encoding::binary);
  StlWriter writer(mesh, encoding, output);
  if (encoding == Encoding::text)
    writer.write_text();
  else
    writer.write_binary();
}

}  // namespace roughmesh::detail
