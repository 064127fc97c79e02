// SPDX-License-Identifier: BSD-3-Clause
// Reads Medit files, text (.mesh) and binary (.meshb): sections in any order, each a keyword, a
// count and as many rows of numbers.
#include "io_medit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "block_builder.hpp"
#include "io_patch.hpp"
#include "scanner.hpp"

namespace roughmesh::detail {

namespace {

struct Keyword {
  std::string_view name;
  int code;
};

// Sections that are looked into beside those of elements.
constexpr std::array known = {Keyword{"Vertices", medit_code::vertices},
                              Keyword{"Normals", 60},
                              Keyword{"NormalAtVertices", 20},
                              Keyword{"NormalAtTriangleVertices", 21},
                              Keyword{"Tangents", 59},
                              Keyword{"TangentAtVertices", 61},
                              Keyword{"TangentAtEdgeVertices", 19},
                              Keyword{"Wedges", -1}};

// Sections that would give the others another meaning, or elements that roughmesh cannot move.
constexpr std::array refused = {Keyword{"HexahedraQ2", 33},
                                Keyword{"PrismsP2", 86},
                                Keyword{"PyramidsP2", 87},
                                Keyword{"QuadrilateralsQ3", 88},
                                Keyword{"QuadrilateralsQ4", 89},
                                Keyword{"TrianglesP3", 90},
                                Keyword{"TrianglesP4", 91},
                                Keyword{"EdgesP3", 92},
                                Keyword{"EdgesP4", 93},
                                Keyword{"TetrahedraP3", 96},
                                Keyword{"TetrahedraP4", 97},
                                Keyword{"HexahedraQ3", 98},
                                Keyword{"HexahedraQ4", 99},
                                Keyword{"PyramidsP3", 100},
                                Keyword{"PyramidsP4", 101},
                                Keyword{"PrismsP3", 102},
                                Keyword{"PrismsP4", 103},
                                Keyword{"Polyhedra", 46},
                                Keyword{"Polygons", 47},
                                Keyword{"BezierBasis", 125},
                                Keyword{"EdgesP2Ordering", 127},
                                Keyword{"TrianglesP2Ordering", 129},
                                Keyword{"QuadrilateralsQ2Ordering", 131},
                                Keyword{"TetrahedraP2Ordering", 133},
                                Keyword{"FloatingPointPrecision", 155},
                                Keyword{"NormalAtQuadrilateralVertices", 22}};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// A word that no number begins with; "nan" and "inf" are left to whoever reads the number.
bool is_keyword(std::string_view token) {
  return is_letter(token[0]) && !equal_ignoring_case(token, "nan") &&
         !equal_ignoring_case(token, "inf") && !equal_ignoring_case(token, "infinity");
}

struct Section {
  std::size_t offset = 0;  ///< of the count
  Tag n_numbers = 0;       ///< up to the next keyword, with the count; text only
};

struct MeditReader {
  explicit MeditReader(const FileBytes& file) : scanner(file) {}

  Scanner scanner;
  Tag version = 0;
  Tag dimension = 0;
  std::map<std::string_view, Section> sections;
  Mesh mesh;
  MeshSource source;
  Tag n_elements = 0;                   ///< read so far
  std::vector<Index> edges, triangles;  ///< corners, where vectors at them are stated

  bool is_text() const { return scanner.encoding() == Encoding::text; }
  std::size_t n_reals() const { return static_cast<std::size_t>(dimension); }
  std::size_t real_bytes() const { return is_text() ? 2 : version == 1 ? 4 : 8; }
  std::size_t integer_bytes() const { return is_text() ? 2 : version < 4 ? 4 : 8; }
  Tag integer() {
    if (is_text()) return scanner.text_integer();
    return version < 4 ? Tag{scanner.bytes<std::int32_t>()} : scanner.bytes<std::int64_t>();
  }
  double real();
  std::optional<std::size_t> start(std::string_view keyword, std::size_t bytes_each);
  void finish();                                ///< of a section that was started
  Index number(Tag n, std::string_view thing);  ///< of one of n things, from 0
};

double MeditReader::real() {
  if (is_text()) return scanner.text_real();
  const std::size_t start = scanner.offset();
  const double value = version == 1 ? double{scanner.bytes<float>()} : scanner.bytes<double>();
  if (!std::isfinite(value))
    scanner.fail_at(start, "a number is not finite: mend it or make the mesh anew");
  return value;
}

// Moves to the rows of a section and tells how many there are.
std::optional<std::size_t> MeditReader::start(std::string_view keyword, std::size_t bytes_each) {
  const auto found = sections.find(keyword);
  if (found == sections.end()) return std::nullopt;
  scanner.move_to(found->second.offset);
  scanner.set_section(std::string(keyword));
  const Tag n = integer();
  if (n > largest_index)
    scanner.refuse(fmt::format("{} {} are more than the {} that roughmesh handles; split the mesh",
                               n, keyword, largest_index));
  return scanner.count(n, bytes_each, "rows");
}

// Rows that are longer than their keyword says would be taken for other ones.
void MeditReader::finish() {
  if (!is_text()) return;
  scanner.skip_space();
  if (!scanner.at_end() && !is_keyword(Scanner(scanner).text_token()))
    scanner.fail(
        "numbers are left behind the last row: the count is wrong, or rows are longer than "
        "the keyword or Dimension says");
}

Index MeditReader::number(Tag n, std::string_view thing) {
  const Tag value = integer();
  if (value < 1 || value > n)
    scanner.fail(fmt::format("{} {} does not exist: they are numbered 1 to {}", thing, value, n));
  return static_cast<Index>(value - 1);
}

void check_version(MeditReader& reader) {
  if (reader.version < 1 || reader.version > 4)
    reader.scanner.refuse(
        fmt::format("version {} of the Medit format is not read, only 1 to 4", reader.version));
}

void check_dimension(MeditReader& reader) {
  if (reader.dimension != 2 && reader.dimension != 3)
    reader.scanner.fail(fmt::format("Dimension {} is neither 2 nor 3", reader.dimension));
}

// The section as it is noted; null where the keyword is none that is looked into.
template <typename Matches>
Section* note_section(MeditReader& reader, std::size_t keyword_offset, Matches&& matches) {
  for (const Keyword& keyword : refused)
    if (matches(keyword))
      reader.scanner.refuse(
          fmt::format("the section {} is not read; save the mesh without it", keyword.name));
  std::string_view name;
  for (const Keyword& keyword : known)
    if (matches(keyword)) name = keyword.name == "Wedges" ? "Prisms" : keyword.name;
  for (const MeditElements& elements : medit_elements())
    if (matches(Keyword{elements.keyword, elements.code})) name = elements.keyword;
  if (name.empty()) return nullptr;
  const auto [place, is_new] =
      reader.sections.try_emplace(name, Section{reader.scanner.offset(), 0});
  if (!is_new)
    reader.scanner.fail_at(keyword_offset,
                           fmt::format("a second section {}; a file has one", name));
  return &place->second;
}

void find_text_sections(MeditReader& reader) {
  Scanner& scanner = reader.scanner;
  bool has_end = false;
  Section* section = nullptr;  // the one that is passed
  for (scanner.skip_space(); !scanner.at_end() && !has_end; scanner.skip_space()) {
    const std::size_t start = scanner.offset();
    const std::string_view word = scanner.text_token();
    if (!is_keyword(word)) {
      if (section != nullptr) ++section->n_numbers;
      continue;
    }
    section = nullptr;
    if (equal_ignoring_case(word, "MeshVersionFormatted")) {
      reader.version = scanner.text_integer();
    } else if (equal_ignoring_case(word, "Dimension")) {
      reader.dimension = scanner.text_integer();
    } else {
      has_end = equal_ignoring_case(word, "End");
      section = note_section(reader, start, [&](const Keyword& keyword) {
        return equal_ignoring_case(word, keyword.name);
      });
    }
  }
  if (!has_end)
    scanner.fail("the file ends without End: it is cut short, or lacks that word as its last line");
}

// Each keyword is followed by the place of the next one.
void find_binary_sections(MeditReader& reader) {
  Scanner& scanner = reader.scanner;
  scanner.skip(sizeof(std::int32_t));
  reader.version = scanner.bytes<std::int32_t>();
  check_version(reader);
  for (;;) {
    const std::size_t start = scanner.offset();
    const int code = scanner.bytes<std::int32_t>();
    const Tag next =
        reader.version >= 3 ? scanner.bytes<std::int64_t>() : Tag{scanner.bytes<std::int32_t>()};
    if (code == medit_code::end) return;
    if (code == medit_code::dimension)
      reader.dimension = scanner.bytes<std::int32_t>();
    else
      note_section(reader, start, [&](const Keyword& keyword) { return code == keyword.code; });
    const Tag size = static_cast<Tag>(scanner.offset() + scanner.remaining());
    if (next < static_cast<Tag>(scanner.offset()) || next >= size)
      scanner.fail_at(start, fmt::format("the section with code {} ends at byte {}, not within the "
                                         "file: it is cut short or damaged",
                                         code, next));
    scanner.move_to(static_cast<std::size_t>(next));
  }
}

void read_vertices(MeditReader& reader) {
  const std::size_t n_reals = reader.n_reals();
  const auto n = reader.start("Vertices", n_reals * reader.real_bytes() + reader.integer_bytes());
  if (!n) reader.scanner.fail("no section Vertices: the file is cut short");
  if (*n == 0) reader.scanner.fail("no vertices; save the mesh again");
  reader.mesh.nodes.reserve(*n);
  reader.source.offsets.reserve(*n);
  for (std::size_t i = 0; i < *n; ++i) {
    if (reader.is_text()) reader.scanner.skip_space();
    reader.source.offsets.push_back(reader.scanner.offset());
    Vec3& x = reader.mesh.nodes.emplace_back(Vec3::Zero());
    for (std::size_t k = 0; k < n_reals; ++k) x[static_cast<Eigen::Index>(k)] = reader.real();
    reader.integer();  // reference
  }
  reader.finish();
  number_nodes(reader.mesh);
}

void read_element(MeditReader& reader, const MeditElements& elements, BlockBuilder& blocks,
                  std::vector<Index>* corners) {
  std::array<Index, 10> nodes{};
  for (const int place : elements.places)
    nodes[static_cast<std::size_t>(place)] = reader.number(reader.mesh.n_nodes(), "vertex");
  blocks.set_group(reader.integer());
  ElementBlock& block = blocks.find(elements.type);
  block.nodes.insert(block.nodes.end(), nodes.begin(), nodes.begin() + elements.type.n_nodes);
  block.tags.push_back(++reader.n_elements);
  if (corners != nullptr)
    corners->insert(corners->end(), nodes.begin(), nodes.begin() + elements.type.n_nodes);
}

// gmsh 4.8 writes elements of order 2 under the keywords of order 1, which the length of the rows
// gives away.
const MeditElements& by_length_of_rows(MeditReader& reader, const MeditElements& elements) {
  const Section& section = reader.sections.at(elements.keyword);
  Scanner ahead = reader.scanner;
  ahead.move_to(section.offset);
  if (!reader.is_text() || section.n_numbers < 2) return elements;
  const Tag n = ahead.text_integer();
  for (const MeditElements& other : medit_elements())
    if (other.type.shape == elements.type.shape && other.type.order == 2 && n > 0 &&
        (section.n_numbers - 1) / n == other.type.n_nodes + 1 && (section.n_numbers - 1) % n == 0)
      return other;
  return elements;
}

// Elements are numbered over all sections, in the order of the file.
void read_elements(MeditReader& reader) {
  std::vector<const MeditElements*> present;
  for (const MeditElements& elements : medit_elements())
    if (reader.sections.contains(elements.keyword)) present.push_back(&elements);
  std::sort(present.begin(), present.end(), [&](const MeditElements* a, const MeditElements* b) {
    return reader.sections.at(a->keyword).offset < reader.sections.at(b->keyword).offset;
  });
  BlockBuilder blocks(reader.mesh.blocks);
  for (const MeditElements* const elements : present) {
    const MeditElements& rows = by_length_of_rows(reader, *elements);
    const auto n_numbers = static_cast<std::size_t>(rows.type.n_nodes) + 1;
    const auto n = reader.start(elements->keyword, n_numbers * reader.integer_bytes());
    std::vector<Index>* corners = nullptr;
    if (rows.keyword == "Edges" && reader.sections.contains("TangentAtEdgeVertices"))
      corners = &reader.edges;
    if (rows.keyword == "Triangles" && reader.sections.contains("NormalAtTriangleVertices"))
      corners = &reader.triangles;
    for (std::size_t i = 0; i < *n; ++i) read_element(reader, rows, blocks, corners);
    reader.finish();
  }
  reader.scanner.set_section("");
  check_element_count(reader.scanner, reader.n_elements);
  reader.mesh.groups = used_groups(reader.mesh.blocks);
}

// Normals or tangents, on no nodes yet.
std::vector<NodeVector> read_vectors(MeditReader& reader, std::string_view section) {
  std::vector<NodeVector> vectors;
  const auto n = reader.start(section, reader.n_reals() * reader.real_bytes());
  for (std::size_t i = 0; n && i < *n; ++i) {
    if (reader.is_text()) reader.scanner.skip_space();
    NodeVector& vector = vectors.emplace_back();
    vector.offset = reader.scanner.offset();
    for (int k = 0; k < 3; ++k) vector.value[k] = reader.real();
  }
  if (n) reader.finish();
  return vectors;
}

void add_vector(MeditReader& reader, const std::vector<NodeVector>& vectors, Index node,
                bool is_normal) {
  NodeVector vector = vectors[reader.number(static_cast<Tag>(vectors.size()), "vector")];
  vector.node = node;
  vector.is_normal = is_normal;
  reader.source.vectors.push_back(vector);
}

void place_at_vertices(MeditReader& reader, std::string_view section,
                       const std::vector<NodeVector>& vectors, bool is_normal) {
  const auto n = reader.start(section, 2 * reader.integer_bytes());
  for (std::size_t i = 0; n && i < *n; ++i) {
    const Index node = reader.number(reader.mesh.n_nodes(), "vertex");
    add_vector(reader, vectors, node, is_normal);
  }
}

// At a corner of an edge or triangle, which is named by its number and that of the corner.
void place_at_corners(MeditReader& reader, std::string_view section,
                      const std::vector<NodeVector>& vectors, const std::vector<Index>& corners,
                      Tag n_corners) {
  const auto n = reader.start(section, 3 * reader.integer_bytes());
  const Tag n_elements = static_cast<Tag>(corners.size()) / n_corners;
  for (std::size_t i = 0; n && i < *n; ++i) {
    const Tag element = reader.number(n_elements, "element");
    const Tag corner = reader.number(n_corners, "corner");
    add_vector(reader, vectors, corners[static_cast<std::size_t>(n_corners * element + corner)],
               false);
  }
}

void place_vectors(MeditReader& reader) {
  if (reader.dimension == 2) return;  // in the plane there are no faces to take normals from
  const std::vector<NodeVector> normals = read_vectors(reader, "Normals");
  place_at_vertices(reader, "NormalAtVertices", normals, true);
  place_at_corners(reader, "NormalAtTriangleVertices", normals, reader.triangles, 3);
  const std::vector<NodeVector> tangents = read_vectors(reader, "Tangents");
  place_at_vertices(reader, "TangentAtVertices", tangents, false);
  place_at_corners(reader, "TangentAtEdgeVertices", tangents, reader.edges, 2);
  std::stable_sort(reader.source.vectors.begin(), reader.source.vectors.end(),
                   [](const NodeVector& a, const NodeVector& b) { return a.offset < b.offset; });
}

constexpr std::int32_t byte_order_mark = 1;

std::int32_t int_at(std::string_view bytes, std::size_t offset) {
  std::int32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

bool is_binary_medit(std::string_view bytes) {
  if (bytes.size() < 3 * sizeof(std::int32_t)) return false;
  const std::int32_t mark = int_at(bytes, 0);
  const bool is_swapped = mark == reverse_bytes(byte_order_mark);
  if (mark != byte_order_mark && !is_swapped) return false;
  const auto value = [&](std::size_t offset) {
    return is_swapped ? reverse_bytes(int_at(bytes, offset)) : int_at(bytes, offset);
  };
  return value(4) >= 1 && value(4) <= 255 && value(8) == medit_code::dimension;
}

bool is_text_medit(std::string_view bytes) {
  constexpr std::string_view word = "MeshVersionFormatted";
  while (!bytes.empty()) {
    bytes = bytes.substr(std::min(bytes.find_first_not_of(" \t\r\n\v\f"), bytes.size()));
    if (!bytes.starts_with('#')) return equal_ignoring_case(bytes.substr(0, word.size()), word);
    bytes.remove_prefix(std::min(bytes.find('\n'), bytes.size()));
  }
  return false;
}

bool is_medit(std::string_view bytes, std::string_view) {
  return is_binary_medit(bytes) || is_text_medit(bytes);
}

void read_all(MeditReader& reader) {
  if (reader.is_text())
    find_text_sections(reader);
  else
    find_binary_sections(reader);
  check_version(reader);
  check_dimension(reader);
  read_vertices(reader);
  read_elements(reader);
  place_vectors(reader);
}

void set_binary(MeditReader& reader, const FileBytes& file) {
  reader.scanner.set_encoding(Encoding::binary, int_at(file.view(), 0) != byte_order_mark);
}

Mesh read_medit(FileBytes file) {
  const bool is_binary = is_binary_medit(file.view());
  const bool has_comments = !is_binary && file.view().find('#') != std::string_view::npos;
  const FileBytes plain = has_comments ? without_comments(file, '#') : FileBytes{};
  MeditReader reader(has_comments ? plain : file);
  if (is_binary) set_binary(reader, file);
  read_all(reader);
  MeshSource& source = reader.source;
  if (is_binary)
    source.coordinates = reader.version == 1 ? NumberFormat::float32 : NumberFormat::float64;
  source.vector_numbers = source.coordinates;
  source.swap_bytes = reader.scanner.swap_bytes();
  source.n_coordinates = static_cast<int>(reader.dimension);
  source.comment = is_binary ? '\0' : '#';
  reader.mesh.format = MeshFormat::medit;
  attach_source(reader.mesh, std::move(source), std::move(file));
  return std::move(reader.mesh);
}

}  // namespace

const FileFormat medit_format = {.format = MeshFormat::medit,
                                 .extensions = {".mesh", ".meshb"},
                                 .beginning = "begin with MeshVersionFormatted or its binary mark",
                                 .recognizes = is_medit,
                                 .read = read_medit,
                                 .write_patched = write_patched,
                                 .check_new = check_for_medit,
                                 .write_new = write_new_medit,
                                 .holds = {.groups = true},
                                 .losses = losses_of_medit,
                                 .encodings = {Encoding::text, Encoding::binary}};

}  // namespace roughmesh::detail
