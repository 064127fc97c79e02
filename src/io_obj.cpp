// SPDX-License-Identifier: BSD-3-Clause
#include "io_obj.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "block_builder.hpp"

namespace roughmesh::detail {
namespace {

// Each set of groups that elements share is a block, so that names without end would take memory
// that grows with the square of the file.
constexpr std::size_t most_names = 100;

// Bytes of a backslash at the end of a line and of that end; 0 if there is none.
std::size_t continuation(std::string_view text) {
  if (text.starts_with("\\\n")) return 2;
  return text.starts_with("\\\r\n") ? 3 : 0;
}

bool is_blank(char c) { return is_space(c) && c != '\n'; }

// One kind of thing that statements number: vertices or normals.
struct Numbering {
  const char* name = "";
  Tag count = 0;  // so far
  Tag largest = 0;
  std::size_t largest_at = 0;
};

class ObjParser {
 public:
  ObjParser(const FileBytes& file, bool keeps_corners)
      : scanner_(file), keeps_corners_(keeps_corners) {}

  ObjContent parse() {
    while (!scanner_.at_end()) read_statement();
    if (content_.positions.empty()) scanner_.fail("no vertices; save the mesh again");
    require_known(vertices_);
    require_known(normals_);
    if (content_.blocks.empty())
      scanner_.refuse("holds points but no faces; make a surface of them first");
    add_groups();
    return std::move(content_);
  }

 private:
  void read_statement() {
    const std::string_view keyword = obj_word(scanner_);
    if (keyword == "v")
      read_vertex();
    else if (keyword == "vn")
      read_normal();
    else if (keyword == "f" || keyword == "fo")
      read_face();
    else if (keyword == "l")
      read_line();
    else if (keyword == "p")
      read_points();
    else if (keyword == "g")
      read_groups();
    else if (keyword == "o")
      read_object();
    else if (keyword == "surf" || keyword == "curv" || keyword == "curv2")
      scanner_.refuse("holds free-form curves or surfaces; save it as polygons");
    end_statement();
  }

  // What stands behind the arguments that are read: colours, weights, comments, other statements.
  void end_statement() {
    while (!obj_word(scanner_).empty()) {
    }
    scanner_.line();
  }

  // A word that must be there; numbers leave the scanner behind themselves.
  std::string_view required_word(std::string_view what) {
    const std::string_view word = obj_word(scanner_);
    if (word.empty()) scanner_.fail(fmt::format("the line ends where {} is due", what));
    return word;
  }

  void read_vertex() {
    Vec3 x;
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = required_word("a coordinate");
      if (k == 0) content_.offsets.push_back(offset_of(word));
      x[k] = scanner_.text_real(word);
    }
    content_.positions.push_back(x);
    if (++vertices_.count > largest_index)
      scanner_.refuse("more vertices than roughmesh handles; split the mesh");
  }

  // Its numbers are not looked at, so that files in which they are "nan" are read.
  void read_normal() {
    content_.normals.push_back(offset_of(required_word("a component of a normal")));
    for (int k = 1; k < 3; ++k) required_word("a component of a normal");
    if (++normals_.count > largest_index)
      scanner_.refuse("more normals than roughmesh handles; split the mesh");
  }

  // The node of a word such as 7, -1, 7/1, 7//3 or 7/1/3; its normal is appended to `normals`.
  Index read_corner(std::string_view word, std::vector<Index>* normals) {
    const std::size_t end = offset_of(word) + word.size();
    const std::size_t first = std::min(word.find('/'), word.size());
    const std::size_t second =
        std::min(word.find('/', std::min(first + 1, word.size())), word.size());
    const Index node = resolve(word.substr(0, first), vertices_);
    if (normals != nullptr) {
      const std::string_view normal = word.substr(std::min(second + 1, word.size()));
      normals->push_back(normal.empty() ? -1 : resolve(normal, normals_));
    }
    scanner_.move_to(end);
    return node;
  }

  // Numbers count from 1, negative ones back from the latest. Statements may refer to what only
  // follows them, so the largest is compared with the count at the end.
  Index resolve(std::string_view word, Numbering& numbering) {
    const std::size_t start = offset_of(word);
    if (word.empty())
      scanner_.fail_at(start, fmt::format("a {} number is missing", numbering.name));
    const Tag number = scanner_.text_integer(word);
    const Tag from_start = number < 0 ? numbering.count + number + 1 : number;
    if (from_start < 1 || from_start > largest_index) fail_missing(start, number, numbering);
    if (from_start > numbering.largest) {
      numbering.largest = from_start;
      numbering.largest_at = start;
    }
    return static_cast<Index>(from_start - 1);
  }

  [[noreturn]] void fail_missing(std::size_t at, Tag number, const Numbering& numbering) const {
    scanner_.fail_at(at, fmt::format("{} {} does not exist: there are {}", numbering.name, number,
                                     numbering.count));
  }

  void require_known(const Numbering& numbering) const {
    if (numbering.largest > numbering.count)
      fail_missing(numbering.largest_at, numbering.largest, numbering);
  }

  void read_face() {
    std::array<Index, 4> nodes{};
    std::vector<Index>* const normals = &face_normals_;
    normals->clear();
    std::size_t n = 0;
    for (std::string_view word = obj_word(scanner_); !word.empty(); word = obj_word(scanner_)) {
      const Index node = read_corner(word, normals);
      if (n < nodes.size()) nodes[n] = node;
      ++n;
    }
    check_face_size(scanner_, static_cast<Tag>(n));
    apply_groups();
    blocks_.add_face(next_number(), {nodes.data(), n});
    if (keeps_corners_) keep_corners({nodes.data(), n});
  }

  void keep_corners(std::span<const Index> nodes) {
    if (std::count(face_normals_.begin(), face_normals_.end(), -1) == std::ssize(face_normals_))
      return;
    ObjCorners& corners = content_.corners;
    corners.nodes.insert(corners.nodes.end(), nodes.begin(), nodes.end());
    corners.normals.insert(corners.normals.end(), face_normals_.begin(), face_normals_.end());
    corners.ends.push_back(corners.nodes.size());
  }

  // A polyline; each of its pieces is an element.
  void read_line() {
    apply_groups();
    std::array<Index, 2> ends = {read_corner(required_word("the start of a line"), nullptr), 0};
    std::string_view word = required_word("the end of a line");
    for (; !word.empty(); word = obj_word(scanner_)) {
      ends[1] = read_corner(word, nullptr);
      blocks_.add(line_type, next_number(), ends);
      ends[0] = ends[1];
    }
  }

  void read_points() {
    apply_groups();
    for (std::string_view word = obj_word(scanner_); !word.empty(); word = obj_word(scanner_)) {
      const Index node = read_corner(word, nullptr);
      blocks_.add(point_type, next_number(), {&node, 1});
    }
  }

  Tag next_number() {
    if (n_elements_ == largest_index)
      scanner_.refuse("more elements than roughmesh handles; split the mesh");
    return ++n_elements_;
  }

  Tag group_number(std::string_view name) {
    return names_.try_emplace(std::string(name), static_cast<Tag>(names_.size()) + 1).first->second;
  }

  // "default" is the manual's word for no group.
  void read_groups() {
    groups_.clear();
    for (std::string_view name = obj_word(scanner_); !name.empty(); name = obj_word(scanner_))
      if (name != "default") groups_.insert(group_number(name));
    if (groups_.size() > most_names)
      scanner_.refuse(
          fmt::format("a statement g with {} names where {} are handled; save it with "
                      "fewer",
                      groups_.size(), most_names));
    groups_changed_ = true;
  }

  void read_object() {
    std::string name;
    for (std::string_view word = obj_word(scanner_); !word.empty(); word = obj_word(scanner_))
      name.append(name.empty() ? 0 : 1, ' ').append(word);
    object_ = name.empty() ? std::nullopt : std::optional(group_number(name));
    groups_changed_ = true;
  }

  void apply_groups() {
    if (!std::exchange(groups_changed_, false)) return;
    std::set<Tag> all = groups_;
    if (object_) all.insert(*object_);
    blocks_.set_groups({all.begin(), all.end()});
  }

  void add_groups() {
    std::map<Tag, std::string> name_of;
    for (const auto& [name, tag] : names_) name_of[tag] = name;
    content_.groups = used_groups(content_.blocks, name_of);
  }

  std::size_t offset_of(std::string_view word) const {
    return scanner_.offset() - static_cast<std::size_t>(scanner_.rest().data() - word.data());
  }

  Scanner scanner_;
  bool keeps_corners_;
  ObjContent content_;
  Numbering vertices_{"vertex"};
  Numbering normals_{"normal"};
  BlockBuilder blocks_{content_.blocks};
  std::map<std::string, Tag> names_;
  std::set<Tag> groups_;
  std::optional<Tag> object_;
  bool groups_changed_ = false;
  std::vector<Index> face_normals_;
  Tag n_elements_ = 0;
};

Mesh read_obj(FileBytes file) {
  ObjContent content = parse_obj(file, false);
  Mesh mesh;
  MeshSource source;
  mesh.format = MeshFormat::obj;
  mesh.nodes = std::move(content.positions);
  mesh.blocks = std::move(content.blocks);
  mesh.groups = std::move(content.groups);
  source.offsets = std::move(content.offsets);
  number_nodes(mesh);
  attach_source(mesh, std::move(source), std::move(file));
  return mesh;
}

}  // namespace

std::string_view obj_word(Scanner& scanner) {
  const std::string_view text = scanner.rest();
  std::size_t start = 0;
  for (std::size_t gap = 1; gap > 0; start += gap) {
    while (start < text.size() && is_blank(text[start])) ++start;
    gap = continuation(text.substr(start, 3));
  }
  std::size_t end = start;
  if (start < text.size() && text[start] != '#')
    while (end < text.size() && !is_space(text[end]) &&
           !(text[end] == '\\' && continuation(text.substr(end, 3)) > 0))
      ++end;
  scanner.skip(end);
  return text.substr(start, end - start);
}

ObjContent parse_obj(const FileBytes& file, bool keeps_corners) {
  return ObjParser(file, keeps_corners).parse();
}

const FileFormat obj_format = {
    .format = MeshFormat::obj,
    .extensions = {".obj"},
    .recognizes = [](std::string_view, std::string_view extension) { return extension == ".obj"; },
    .read = read_obj,
    .write_patched = write_patched_obj,
    .check_new = check_obj,
    .write_new = write_new_obj,
    .holds = {.groups = true,
              .several_groups = true,
              .group_names = true,
              .group_numbers = false,
              .most_dimension = 2}};

}  // namespace roughmesh::detail
