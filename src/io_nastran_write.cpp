// SPDX-License-Identifier: BSD-3-Clause
// Nastran bulk data: moved GRID entries in a source, and new files in large fields.
#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "io_nastran.hpp"
#include "io_patch.hpp"
#include "new_file.hpp"

namespace roughmesh::detail {
namespace {

constexpr Tag largest_number = 99'999'999;  // eight characters
constexpr std::size_t first_coordinate = 3;

std::string_view line_end(const MeshSource& source, std::string_view line) {
  const std::string_view file = source.file.view();
  const auto end = static_cast<std::size_t>(line.data() - file.data()) + line.size();
  return file.substr(end).starts_with("\r\n") ? "\r\n" : "\n";
}

std::string without_trailing_space(std::string text) {
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

// A GRID entry and where its node goes.
struct Move {
  const BulkCard& card;
  const Vec3& from;
  const Vec3& to;

  bool changes(std::size_t axis) const {
    return !same_bits(from[static_cast<Eigen::Index>(axis)], to[static_cast<Eigen::Index>(axis)]);
  }
  double value(std::size_t axis) const { return to[static_cast<Eigen::Index>(axis)]; }
  std::string text(std::size_t field) const {
    const bool is_coordinate = field >= first_coordinate && field < first_coordinate + 3;
    if (is_coordinate && changes(field - first_coordinate))
      return card.has_free ? nastran_real(value(field - first_coordinate))
                           : nastran_real_16(value(field - first_coordinate));
    return std::string(card.field(field));
  }
};

// From the first line of the entry to its last.
std::string_view span_of(const BulkCard& card) {
  const char* const begin = card.lines.front().data();
  const char* const end = card.lines.back().data() + card.lines.back().size();
  return {begin, static_cast<std::size_t>(end - begin)};
}

// What stands behind the fields of a line: a comment, or marks in columns 73 to 80.
std::string tail_of(std::string_view line) {
  const std::size_t fields_end = std::min<std::size_t>(without_comment(line).size(), 72);
  return without_trailing_space(std::string(line.substr(fields_end)));
}

// Two lines of large fields in place of an entry with small ones.
void rewrite_in_large_fields(TextPatcher& patcher, const MeshSource& source, const Move& move) {
  std::string first = "GRID*   ", second = "*       ";
  for (std::size_t field = 1; field <= 4; ++field) first += fmt::format("{:<16}", move.text(field));
  for (std::size_t field = 5; field <= 8; ++field)
    second += fmt::format("{:<16}", move.text(field));
  const std::string tail = move.card.is_large[0] ? "" : tail_of(move.card.lines[0]);
  patcher.replace(span_of(move.card), first + "*" +
                                          std::string(line_end(source, move.card.lines[0])) +
                                          without_trailing_space(second + tail));
}

// One field of 16 characters; what stands before and behind it keeps its columns.
std::string with_field(std::string_view line, std::size_t column, const std::string& text) {
  std::string body(without_comment(line));
  const std::string comment(line.substr(body.size()));
  const std::size_t width = std::max(body.size(), column);
  body.resize(std::max(body.size(), column + 16), ' ');
  body.replace(column, 16, fmt::format("{:<16}", text));
  if (width <= column + 16) body = without_trailing_space(body);
  if (!comment.empty()) body.resize(std::max(body.size(), width), ' ');
  return body + comment;
}

void patch_large_fields(TextPatcher& patcher, const Move& move) {
  std::string first(move.card.lines[0]), second(move.card.lines[1]);
  if (move.changes(0)) first = with_field(first, 40, move.text(3));
  if (move.changes(1)) first = with_field(first, 56, move.text(4));
  if (move.changes(2)) second = with_field(second, 8, move.text(5));
  patcher.replace(move.card.lines[0], first);
  patcher.replace(move.card.lines[1], second);
}

void patch_free_fields(TextPatcher& patcher, const Move& move) {
  const auto is_there = [&](std::size_t axis) {
    return !move.changes(axis) || move.card.field(first_coordinate + axis).data() != nullptr;
  };
  // A fixed field among free ones holds too few characters for all digits.
  if (!move.card.has_fixed && is_there(0) && is_there(1) && is_there(2)) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (move.changes(axis))
        patcher.replace(move.card.fields[first_coordinate + axis],
                        move.text(first_coordinate + axis));
    return;
  }
  std::string line = "GRID";
  for (std::size_t field = 1; field <= 8; ++field) {
    line += ',';
    line += move.text(field);
  }
  line.erase(line.find_last_not_of(',') + 1);
  const std::string_view last = move.card.lines.back();
  patcher.replace(span_of(move.card),
                  line + std::string(last.substr(without_comment(last).size())));
}

void patch_grid(TextPatcher& patcher, const MeshSource& source, const Move& move) {
  const BulkCard& card = move.card;
  if (card.has_free) return patch_free_fields(patcher, move);
  const bool is_large_throughout =
      card.lines.size() == 2 && card.is_large[0] && card.is_large[1] && card.expanded.empty();
  if (is_large_throughout) return patch_large_fields(patcher, move);
  rewrite_in_large_fields(patcher, source, move);
}

bool is_free_record(std::string_view file, std::uint64_t offset) {
  const std::string_view start = file.substr(offset, 10);
  return start.substr(0, std::min(start.find('\n'), start.size())).find(',') != start.npos;
}

// Properties of new elements: the tag of their group where no other dimension has taken it.
class Properties {
 public:
  explicit Properties(const Mesh& mesh) {
    for (const PhysicalGroup& group : mesh.groups) add(group.dimension, group.tag);
    for (const ElementBlock& block : mesh.blocks)
      add(dimension(block.type.shape), first_group(block));
  }
  Tag operator()(const ElementBlock& block) const {
    return numbers_.at({dimension(block.type.shape), first_group(block)});
  }
  Tag operator()(const PhysicalGroup& group) const {
    return numbers_.at({group.dimension, group.tag});
  }

 private:
  void add(int dimension, Tag tag) {
    const auto [place, is_new] = numbers_.try_emplace({dimension, tag}, tag);
    if (!is_new) return;
    Tag& number = place->second;
    while (number < 1 || number > largest_number || taken_.count(number) > 0) number = ++last_;
    taken_.insert(number);
  }

  std::map<std::pair<int, Tag>, Tag> numbers_;
  std::set<Tag> taken_;
  Tag last_ = 0;
};

std::string_view card_name(const ElementType& type) {
  switch (type.shape) {
    case ElementShape::line:
      return type.order == 1 ? "CROD" : "CBEAM3";
    case ElementShape::triangle:
      return type.order == 1 ? "CTRIA3" : "CTRIA6";
    case ElementShape::quadrangle:
      return type.order == 1 ? "CQUAD4" : "CQUAD8";
    case ElementShape::tetrahedron:
      return "CTETRA";
    case ElementShape::hexahedron:
      return "CHEXA";
    case ElementShape::prism:
      return "CPENTA";
    default:
      return "CPYRAM";
  }
}

// Small fields, eight to a line, for whole numbers.
void write_card(std::string_view name, const std::vector<Tag>& numbers, OutputFile& output) {
  std::string text = fmt::format("{:<8}", name);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0 && i % 8 == 0) text += "+\n+       ";
    text += fmt::format("{:<8}", numbers[i]);
  }
  output.write(without_trailing_space(text) + "\n");
}

void write_elements(const Mesh& mesh, const NewNumbers& numbers, const Properties& properties,
                    OutputFile& output) {
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const ElementBlock& block = mesh.blocks[b];
    if (block.type.shape == ElementShape::point) continue;
    for (Index e = 0; e < block.size(); ++e) {
      std::vector<Tag> fields = {numbers.elements[b][static_cast<std::size_t>(e)],
                                 properties(block)};
      for (const int place : nastran_node_orders().in_gmsh(block.type))
        fields.push_back(numbers.nodes[static_cast<std::size_t>(
            block.element(e)[static_cast<std::size_t>(place)])]);
      write_card(card_name(block.type), fields, output);
    }
  }
}

}  // namespace

void write_patched_nastran(const Mesh& mesh, OutputFile& output) {
  const MeshSource& source = *mesh.source;
  BulkReader reader(source.file);
  BulkCard card;
  patch_moved_nodes(mesh, output, [&](TextPatcher& patcher, std::size_t i) {
    reader.scanner().move_to(source.offsets[i]);
    reader.next(card);
    patch_grid(patcher, source, {card, source.positions[i], mesh.nodes[i]});
  });
}

double nastran_spacing(const Mesh& mesh) {
  const MeshSource& source = *mesh.source;
  const std::string_view file = source.file.view();
  if (std::all_of(source.offsets.begin(), source.offsets.end(),
                  [&](std::uint64_t offset) { return is_free_record(file, offset); }))
    return 0;
  return new_nastran_spacing(mesh);
}

double new_nastran_spacing(const Mesh& mesh) {
  double least = 0, greatest = 0;
  for (const Vec3& x : mesh.nodes) {
    least = std::min(least, x.minCoeff());
    greatest = std::max(greatest, x.maxCoeff());
  }
  return std::max(spacing_16(least), spacing_16(greatest));
}

void check_nastran(const Mesh& mesh, const std::filesystem::path& path) {
  check_serendipity(mesh, path, true);
}

void write_new_nastran(const Mesh& mesh, const WriteOptions&, OutputFile& output) {
  const NewNumbers numbers = new_numbers(mesh, largest_number);
  const Properties properties(mesh);
  output.write("$ written by roughmesh\nBEGIN BULK\n");
  for (const PhysicalGroup& group : mesh.groups)
    if (!group.name.empty() && group.dimension > 0)
      output.write(fmt::format("$ Femap Property {} : {}\n", properties(group),
                               group_name(group, GroupNames::of_dimension)));
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Vec3& x = mesh.nodes[i];
    output.write(fmt::format("GRID*   {:<16}{:<16}{:<16}{:<16}*\n*       {}\n", numbers.nodes[i], 0,
                             nastran_real_16(x[0]), nastran_real_16(x[1]), nastran_real_16(x[2])));
  }
  write_elements(mesh, numbers, properties, output);
  output.write("ENDDATA\n");
}

}  // namespace roughmesh::detail
