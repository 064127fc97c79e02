// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "corner_normals.hpp"
#include "io_obj.hpp"
#include "io_patch.hpp"
#include "new_file.hpp"
#include "number_writer.hpp"

namespace roughmesh::detail {
namespace {

// Three numbers of the source that change.
struct Replacement {
  std::uint64_t offset = 0;
  std::array<std::optional<double>, 3> values = {};
};

Replacement of_position(std::uint64_t offset, const Vec3& from, const Vec3& to) {
  Replacement replacement{offset};
  for (std::size_t k = 0; k < 3; ++k)
    if (!same_bits(from[k], to[k])) replacement.values[k] = to[k];
  return replacement;
}

Replacement of_normal(std::uint64_t offset, const Vec3& normal) {
  return {offset, {normal[0], normal[1], normal[2]}};
}

void append_normals(const Mesh& mesh, std::vector<Replacement>& replacements) {
  const ObjContent content = parse_obj(mesh.source->file, true);
  const ObjCorners& corners = content.corners;
  const std::vector<bool> moved = has_moved(mesh);
  CornerNormals sums(mesh.nodes, content.normals.size());
  std::vector<bool> is_stale(content.normals.size());
  std::size_t begin = 0;
  for (const std::size_t end : corners.ends) {
    const std::span nodes = std::span(corners.nodes).subspan(begin, end - begin);
    const std::span normals = std::span(corners.normals).subspan(begin, end - begin);
    begin = end;
    sums.add_face(nodes, normals, nodes.size());
    if (std::none_of(nodes.begin(), nodes.end(), [&](Index node) { return moved[node]; })) continue;
    for (const Index normal : normals)
      if (normal >= 0) is_stale[normal] = true;
  }
  for (std::size_t i = 0; i < is_stale.size(); ++i)
    if (is_stale[i]) replacements.push_back(of_normal(content.normals[i], sums.normal(i)));
}

void patch(Scanner& scanner, const Replacement& replacement, TriplePatcher& patcher) {
  scanner.move_to(replacement.offset);
  for (const auto& value : replacement.values) {
    const std::size_t n_bytes = obj_word(scanner).size();
    if (value)
      patcher.replace_number(scanner.offset() - n_bytes, n_bytes, NumberFormat::text, *value);
  }
}

// Names of groups as words of a statement, no two of a dimension alike.
class GroupWords {
 public:
  explicit GroupWords(const Mesh& mesh) {
    std::set<std::pair<int, std::string>> taken;
    for (const ElementBlock& block : mesh.blocks)
      for (const Tag tag : block.physical_groups) {
        const int dim = dimension(block.type.shape);
        const auto [place, is_new] = words_.try_emplace({dim, tag});
        if (!is_new) continue;
        place->second = word(group_name(mesh, dim, tag));
        if (!taken.insert({dim, place->second}).second) place->second += fmt::format("_{}", tag);
      }
  }

  std::string statement(const ElementBlock& block) const {
    if (block.physical_groups.empty()) return "g default\n";
    std::string line = "g";
    for (const Tag tag : block.physical_groups)
      line += " " + words_.at({dimension(block.type.shape), tag});
    return line + "\n";
  }

 private:
  static std::string word(std::string name) {
    std::replace(name.begin(), name.end(), ' ', '_');
    std::replace(name.begin(), name.end(), '\\', '_');
    if (name.front() == '#') name.front() = '_';
    return name;
  }

  std::map<std::pair<int, Tag>, std::string> words_;
};

const char* keyword(const ElementBlock& block) {
  constexpr std::array words = {"p ", "l ", "f "};
  return words[static_cast<std::size_t>(dimension(block.type.shape))];
}

}  // namespace

void write_patched_obj(const Mesh& mesh, OutputFile& output) {
  const MeshSource& source = *mesh.source;
  std::vector<Replacement> replacements;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (!same_bits(source.positions[i], mesh.nodes[i]))
      replacements.push_back(of_position(source.offsets[i], source.positions[i], mesh.nodes[i]));
  const bool may_have_normals = source.file.view().find("vn") != std::string_view::npos;
  if (!replacements.empty() && may_have_normals) append_normals(mesh, replacements);
  std::sort(replacements.begin(), replacements.end(),
            [](const Replacement& a, const Replacement& b) { return a.offset < b.offset; });
  Scanner scanner(source.file);
  TriplePatcher patcher(source, output);
  for (const Replacement& replacement : replacements) patch(scanner, replacement, patcher);
  patcher.finish();
}

void check_obj(const Mesh& mesh, const std::filesystem::path& path) {
  check_surface_part(mesh, path, 0);
}

void write_new_obj(const Mesh& mesh, const WriteOptions&, OutputFile& output) {
  const SurfacePart part(mesh, 0);
  const GroupWords words(mesh);
  NumberWriter numbers(output, Encoding::text);
  numbers.text("# written by roughmesh\n");
  for (const Index node : part.nodes) {
    numbers.text("v ");
    numbers.vector(mesh.nodes[node]);
    numbers.end_line();
  }
  std::string current = "g default\n";
  for (const ElementBlock* block : part.blocks) {
    std::string statement = words.statement(*block);
    if (statement != current) numbers.text(statement);
    current = std::move(statement);
    for (Index i = 0; i < block->size(); ++i) {
      numbers.text(keyword(*block));
      for (const Index node : block->element(i)) numbers.number(part.numbers[node] + 1);
      numbers.end_line();
    }
  }
}

}  // namespace roughmesh::detail
