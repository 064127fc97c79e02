// SPDX-License-Identifier: BSD-3-Clause
// OFF: a word, two or three counts, a vertex per line, a face per line; text with comments.
// Format: Geomview manual, "OFF files", http://www.geomview.org/docs/html/OFF.html
#include <algorithm>

#include <fmt/format.h>

#include "block_builder.hpp"
#include "corner_normals.hpp"
#include "file_formats.hpp"
#include "io_patch.hpp"
#include "number_writer.hpp"
#include "scanner.hpp"
#include "surface_files.hpp"

namespace roughmesh::detail {
namespace {

// What the first word, [ST][C][N][4][n]OFF with the prefixes in any order, announces.
struct OffKind {
  bool is_off = false;
  bool has_normals = false;
  bool has_other_dimension = false;  // 4 or n coordinates
  std::size_t length = 0;            // of the word
};

OffKind parse_kind(std::string_view word) {
  OffKind kind;
  std::size_t i = 0;
  for (; i < word.size() && i < 8 && !word.substr(i).starts_with("OFF"); ++i) {
    if (word.substr(i).starts_with("ST"))
      ++i;
    else if (word[i] == 'N')
      kind.has_normals = true;
    else if (word[i] == '4' || word[i] == 'n')
      kind.has_other_dimension = true;
    else if (word[i] != 'C')
      return kind;
  }
  // Some programs glue the first count to the word: "OFF490 518 0".
  const std::size_t end = std::min(i + 3, word.size());
  const bool has_end = end == word.size() || is_space(word[end]) || word[end] == '#' ||
                       static_cast<unsigned char>(word[end] - '0') < 10;
  kind.is_off = word.substr(std::min(i, word.size())).starts_with("OFF") && has_end;
  kind.length = end;
  return kind;
}

void skip_space_and_comments(Scanner& scanner) {
  for (scanner.skip_space(); scanner.peek() == '#' && !scanner.at_end(); scanner.skip_space())
    scanner.line();
}

std::size_t skip_beginning(std::string_view bytes) {
  std::size_t i = 0;
  while (i < bytes.size() && is_space(bytes[i])) ++i;
  return i;
}

bool is_off(std::string_view bytes, std::string_view extension) {
  const std::size_t start = skip_beginning(bytes.substr(0, 1024));
  const std::string_view word = bytes.substr(start, 32);
  if (parse_kind(word).is_off) return true;
  // The word may be missing, as may everything before the counts but comments.
  const bool may_begin =
      word.starts_with('#') || (!word.empty() && word[0] >= '0' && word[0] <= '9');
  return extension == ".off" && may_begin;
}

class OffReader {
 public:
  explicit OffReader(const FileBytes& file) : scanner_(file) {}

  Mesh read(MeshSource& source) {
    read_kind();
    skip_space_and_comments(scanner_);
    const Tag n_announced = scanner_.text_integer();
    const Tag n_faces_announced = scanner_.text_integer();
    scanner_.line();  // the number of edges, which nobody needs
    if (n_announced > largest_index || n_faces_announced > largest_index)
      scanner_.refuse(fmt::format(
          "more nodes or faces than the {} that roughmesh handles; split the mesh", largest_index));
    if (n_announced == 0) scanner_.fail("no vertices; save the mesh again");
    const std::size_t n_nodes = scanner_.count(n_announced, 6, "vertices");
    const std::size_t n_faces = scanner_.count(n_faces_announced, 8, "faces");
    if (n_faces == 0) scanner_.refuse("holds points but no faces; make a surface of them first");
    read_vertices(n_nodes, source);
    read_faces(n_faces);
    skip_space_and_comments(scanner_);
    if (!scanner_.at_end())
      scanner_.fail("something stands behind the last face: a count is wrong");
    mesh_.format = MeshFormat::off;
    return std::move(mesh_);
  }

 private:
  void read_kind() {
    skip_space_and_comments(scanner_);
    const OffKind kind = parse_kind(scanner_.rest().substr(0, 32));
    if (!kind.is_off) return;
    if (kind.has_other_dimension)
      scanner_.refuse("has points of other than three dimensions; save it as OFF");
    scanner_.skip(kind.length);
    skip_space_and_comments(scanner_);
    if (scanner_.rest().starts_with("BINARY"))
      scanner_.refuse("is a binary OFF; save it as text or as PLY");
  }

  // Colours, texture coordinates and normals follow the coordinates on the same line.
  void read_vertices(std::size_t n, MeshSource& source) {
    scanner_.set_section("vertices");
    mesh_.nodes.reserve(n);
    source.offsets.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      skip_space_and_comments(scanner_);
      source.offsets.push_back(scanner_.offset());
      const double x = scanner_.text_real();
      const double y = scanner_.text_real();
      const double z = scanner_.text_real();
      mesh_.nodes.emplace_back(x, y, z);
      scanner_.line();
    }
    number_nodes(mesh_);
  }

  void read_faces(std::size_t n) {
    scanner_.set_section("faces");
    BlockBuilder blocks(mesh_.blocks);
    for (std::size_t i = 0; i < n; ++i) {
      skip_space_and_comments(scanner_);
      const Tag n_corners = scanner_.text_integer();
      check_face_size(scanner_, n_corners);
      std::array<Index, 4> corners{};
      for (std::size_t k = 0; k < static_cast<std::size_t>(n_corners); ++k)
        corners[k] = checked_node(scanner_, scanner_.text_integer(), mesh_.n_nodes());
      scanner_.line();  // a colour
      blocks.add_face(static_cast<Tag>(i) + 1,
                      {corners.data(), static_cast<std::size_t>(n_corners)});
    }
  }

  Scanner scanner_;
  Mesh mesh_;
};

Mesh read_off(FileBytes file) {
  MeshSource source;
  Mesh mesh = OffReader(file).read(source);
  attach_source(mesh, std::move(source), std::move(file));
  return mesh;
}

// The three numbers behind those of a position, if the line has them.
std::optional<std::size_t> normal_offset(Scanner& scanner, std::size_t position) {
  scanner.move_to(position);
  Scanner ahead = scanner;
  const std::size_t end = position + ahead.line().size();
  for (int k = 0; k < 3; ++k) scanner.text_token();
  std::size_t normal = 0;
  for (int k = 0; k < 3; ++k) {
    scanner.skip_space();
    if (scanner.offset() >= end || scanner.peek() == '#') return std::nullopt;
    if (k == 0) normal = scanner.offset();
    scanner.text_token();
  }
  return normal;
}

void write_patched_off(const Mesh& mesh, OutputFile& output) {
  const MeshSource& source = *mesh.source;
  Scanner scanner(source.file);
  skip_space_and_comments(scanner);
  if (!parse_kind(scanner.rest().substr(0, 32)).has_normals) return write_patched(mesh, output);
  const std::vector<bool> is_stale = is_at_moved_face(mesh);
  const std::vector<Vec3> normals = node_normals(mesh, stored_positions(mesh));
  TriplePatcher patcher(source, output);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (!same_bits(source.positions[i], mesh.nodes[i]))
      patcher.replace(source.offsets[i], source.positions[i], mesh.nodes[i]);
    if (!is_stale[i]) continue;
    if (const auto normal = normal_offset(scanner, source.offsets[i]))
      patcher.replace(*normal, normals[i]);
  }
  patcher.finish();
}

void check_off(const Mesh& mesh, const std::filesystem::path& path) {
  check_surface_part(mesh, path, 2);
}

void write_new_off(const Mesh& mesh, const WriteOptions&, OutputFile& output) {
  const SurfacePart part(mesh, 2);
  NumberWriter numbers(output, Encoding::text);
  numbers.text(fmt::format("OFF\n{} {} 0\n", part.nodes.size(), n_elements(part, 2)));
  for (const Index node : part.nodes) {
    numbers.vector(mesh.nodes[node]);
    numbers.end_line();
  }
  for (const ElementBlock* block : part.blocks)
    for (Index i = 0; i < block->size(); ++i) {
      numbers.number(block->type.n_nodes);
      for (const Index node : block->element(i)) numbers.number(part.numbers[node]);
      numbers.end_line();
    }
}

}  // namespace

const FileFormat off_format = {.format = MeshFormat::off,
                               .extensions = {".off"},
                               .beginning = "begin with OFF or one of its variants",
                               .recognizes = is_off,
                               .read = read_off,
                               .write_patched = write_patched_off,
                               .check_new = check_off,
                               .write_new = write_new_off,
                               .holds = {.least_dimension = 2, .most_dimension = 2}};

}  // namespace roughmesh::detail
