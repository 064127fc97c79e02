// SPDX-License-Identifier: BSD-3-Clause
// Abaqus input: nodes, elements and sets of one part, or of a file without parts.
#include "io_abaqus.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "decimals.hpp"
#include "fortran_real.hpp"
#include "io_patch.hpp"

namespace roughmesh::detail {

std::vector<std::string_view> comma_fields(std::string_view line) {
  std::vector<std::string_view> fields;
  while (!line.empty()) {
    const std::size_t comma = std::min(line.find(','), line.size());
    fields.push_back(trimmed(line.substr(0, comma)));
    line.remove_prefix(std::min(comma + 1, line.size()));
  }
  return fields;
}

std::string AbaqusKeyword::value(const std::string& parameter) const {
  const auto place = parameters.find(parameter);
  return place == parameters.end() ? "" : place->second;
}

AbaqusKeyword parse_abaqus_keyword(std::string_view text) {
  const auto without_spaces = [](std::string_view part) {
    std::string result = upper(part);
    std::erase_if(result, is_space);
    return result;
  };
  const auto unquoted = [](std::string_view value) {
    value = trimmed(value);
    if (value.size() >= 2 && value.front() == '"' && value.back() == '"')
      value = value.substr(1, value.size() - 2);
    return std::string(value);
  };
  AbaqusKeyword keyword;
  for (const std::string_view field : comma_fields(text)) {
    if (keyword.name.empty()) {
      keyword.name = without_spaces(field);
      continue;
    }
    const std::size_t equals = std::min(field.find('='), field.size());
    keyword.parameters.try_emplace(without_spaces(field.substr(0, equals)),
                                   unquoted(field.substr(std::min(equals + 1, field.size()))));
  }
  return keyword;
}

namespace {

constexpr std::string_view flat_file = "write the input file without parts and with plain nodes";

bool is_keyword(std::string_view line) { return line.starts_with('*') && !line.starts_with("**"); }

// Where a keyword stands; nodes and elements of the assembly are reference points and connectors.
enum class Level : std::uint8_t { model, part, assembly, instance };

enum class Section : std::uint8_t { other, nodes, elements, set, surface };

class Reader {
 public:
  explicit Reader(const FileBytes& file) : scanner_(file), sets_(elements_, scanner_) {}

  Mesh read();
  MeshSource source() { return std::move(source_); }

 private:
  void read_keyword(std::string_view line);
  void start(const AbaqusKeyword& keyword);
  void change_level(const AbaqusKeyword& keyword);
  void start_nodes();
  void start_elements(const AbaqusKeyword& keyword);
  void start_set(const AbaqusKeyword& keyword);
  void start_surface(const AbaqusKeyword& keyword);
  void read_data(std::string_view line);
  void read_node(std::string_view line);
  void read_element_line(std::string_view line);
  void finish_element();
  void claim_body();

  bool in_assembly() const { return level_ == Level::assembly; }
  std::string body() const { return level_ == Level::model ? "" : part_; }
  bool is_of_mesh(const AbaqusKeyword& keyword) const;
  std::size_t offset(std::string_view text) const {
    return scanner_.offset() + scanner_.remaining() -
           static_cast<std::size_t>(scanner_.rest().data() + scanner_.remaining() - text.data());
  }
  [[noreturn]] void refuse(const std::string& what) const { scanner_.refuse(what); }

  Scanner scanner_;
  Mesh mesh_;
  MeshSource source_;
  ElementTable elements_;
  AbaqusSets sets_;

  Level level_ = Level::model;
  Section section_ = Section::other;
  std::string part_;                          ///< being read, in capitals
  std::optional<std::string> meshed_part_;    ///< whose nodes are the mesh
  std::map<std::string, std::string> parts_;  ///< of instances, both in capitals
  AbaqusType type_;
  std::optional<Index> set_;  ///< of the elements, or the one being listed
  bool generates_ = false;
  std::vector<Tag> pending_;  ///< numbers of an element whose line goes on
  std::uint64_t pending_offset_ = 0;
};

// Keywords that make nodes or elements from others, or put them elsewhere.
void refuse_generator(const Scanner& scanner, const AbaqusKeyword& keyword) {
  constexpr std::array generators = {"NGEN",  "NFILL",  "NCOPY",  "NMAP",
                                     "ELGEN", "ELCOPY", "SYSTEM", "IMPORT"};
  if (keyword.name == "INCLUDE" ||
      ((keyword.name == "NODE" || keyword.name == "ELEMENT" || keyword.name == "ELSET") &&
       keyword.has("INPUT")))
    scanner.refuse(
        fmt::format("*{} takes lines from the file {}, which is not read; put its lines "
                    "into this file",
                    printable(keyword.name), detail::quoted(keyword.value("INPUT"))));
  if (std::find(generators.begin(), generators.end(), keyword.name) != generators.end() ||
      (keyword.name == "NODE" && keyword.has("SYSTEM") && upper(keyword.value("SYSTEM")) != "R"))
    scanner.refuse(fmt::format("*{} makes or moves nodes or elements, which is not followed; {}",
                               printable(keyword.name), flat_file));
}

Mesh Reader::read() {
  while (!scanner_.at_end()) {
    const std::size_t start = scanner_.offset();
    const std::string_view line = trimmed(scanner_.line());
    if (line.empty() || line.starts_with("**")) continue;
    const std::size_t next = scanner_.offset();
    scanner_.move_to(start);  // where messages say they are
    if (is_keyword(line)) {
      scanner_.move_to(next);
      read_keyword(line);
    } else {
      read_data(line);
      scanner_.move_to(next);
    }
  }
  finish_element();
  scanner_.set_section("");
  if (mesh_.nodes.empty()) scanner_.fail("no nodes; save the mesh with its *NODE lines");
  if (elements_.size() == 0) scanner_.fail("no elements; save the mesh with its *ELEMENT lines");
  const std::map<Tag, std::string> names = sets_.apply();
  elements_.fill(mesh_, source_.offsets, names, scanner_);
  mesh_.format = MeshFormat::abaqus;
  return std::move(mesh_);
}

void Reader::read_keyword(std::string_view line) {
  finish_element();
  std::string text(line.substr(1));
  while (trimmed(text).ends_with(',') && !scanner_.at_end()) {
    const std::size_t start = scanner_.offset();
    const std::string_view next = trimmed(scanner_.line());
    if (next.starts_with('*') || next.empty()) {
      scanner_.move_to(start);
      break;
    }
    text += next;
  }
  const std::size_t next = scanner_.offset();
  scanner_.move_to(offset(line));
  const AbaqusKeyword keyword = parse_abaqus_keyword(text);
  scanner_.set_section("*" + keyword.name);
  start(keyword);
  scanner_.move_to(next);
}

void Reader::start(const AbaqusKeyword& keyword) {
  section_ = Section::other;
  set_.reset();
  refuse_generator(scanner_, keyword);
  change_level(keyword);
  if (keyword.name == "NODE") start_nodes();
  if (keyword.name == "ELEMENT") start_elements(keyword);
  if (keyword.name == "ELSET") start_set(keyword);
  if (keyword.name == "SURFACE") start_surface(keyword);
}

void Reader::change_level(const AbaqusKeyword& keyword) {
  if (keyword.name == "PART") {
    level_ = Level::part;
    part_ = upper(keyword.value("NAME"));
  } else if (keyword.name == "INSTANCE") {
    level_ = Level::instance;
    part_ = upper(keyword.value("PART"));
    parts_.try_emplace(upper(keyword.value("NAME")), part_);
  } else if (keyword.name == "ASSEMBLY" || keyword.name == "ENDINSTANCE") {
    level_ = Level::assembly;
  } else if (keyword.name == "ENDPART" || keyword.name == "ENDASSEMBLY") {
    level_ = Level::model;
  }
}

bool Reader::is_of_mesh(const AbaqusKeyword& keyword) const {
  if (!in_assembly()) return !meshed_part_ || *meshed_part_ == body();
  if (!keyword.has("INSTANCE")) return true;
  const auto part = parts_.find(upper(keyword.value("INSTANCE")));
  return part != parts_.end() && meshed_part_ == part->second;
}

void Reader::claim_body() {
  if (meshed_part_ && *meshed_part_ != body())
    refuse(
        fmt::format("parts {} and {} both have nodes, each in its own coordinates; {}, or put "
                    "each part into a file of its own",
                    detail::quoted(*meshed_part_), detail::quoted(body()), flat_file));
  meshed_part_ = body();
}

void Reader::start_nodes() {
  if (in_assembly()) return;
  claim_body();
  section_ = Section::nodes;
}

// Sets of elements that are not in the mesh are empty, but other sets may name them.
void Reader::start_elements(const AbaqusKeyword& keyword) {
  if (keyword.has("ELSET")) set_ = sets_.set(keyword.value("ELSET"), in_assembly(), false);
  if (in_assembly()) return;
  const std::string name = upper(keyword.value("TYPE"));
  const std::optional<AbaqusType> type = abaqus_type(name);
  if (!type)
    refuse(
        fmt::format("elements of type {} are not handled; use others or leave them out of the "
                    "file",
                    detail::quoted(name)));
  type_ = *type;
  if (type_.role == AbaqusRole::ignored) return;
  claim_body();
  section_ = Section::elements;
}

void Reader::start_set(const AbaqusKeyword& keyword) {
  if (!is_of_mesh(keyword) && !in_assembly()) return;
  if (is_of_mesh(keyword)) section_ = Section::set;
  generates_ = keyword.has("GENERATE");
  if (keyword.value("ELSET").empty()) scanner_.fail("has no ELSET=NAME; give the set a name");
  set_ = sets_.set(keyword.value("ELSET"), in_assembly(), keyword.has("INTERNAL"));
}

void Reader::start_surface(const AbaqusKeyword& keyword) {
  const std::string type = upper(keyword.value("TYPE"));
  if (!is_of_mesh(keyword) || keyword.has("COMBINE") || !(type.empty() || type == "ELEMENT"))
    return;
  section_ = Section::surface;
  set_ = sets_.surface(keyword.value("NAME"));
}

void Reader::read_data(std::string_view line) {
  switch (section_) {
    case Section::nodes:
      return read_node(line);
    case Section::elements:
      return read_element_line(line);
    case Section::set:
      return sets_.add_line(*set_, line, generates_, in_assembly());
    case Section::surface:
      return sets_.add_surface_line(*set_, line, in_assembly());
    case Section::other:
      return;
  }
}

void Reader::read_node(std::string_view line) {
  const std::vector<std::string_view> fields = comma_fields(line);
  const std::optional<Tag> number = whole_number(fields[0]);
  if (!number || *number < 0)
    scanner_.fail(
        fmt::format("expected the number of a node, found {}", detail::quoted(fields[0])));
  if (fields.size() < 2) scanner_.fail(fmt::format("node {} has no coordinates", *number));
  if (mesh_.nodes.size() >= static_cast<std::size_t>(largest_index))
    refuse("more nodes than roughmesh handles; split the mesh");
  Vec3 x = Vec3::Zero();  // a field left out is 0
  for (std::size_t k = 1; k < std::min<std::size_t>(fields.size(), 4); ++k) {
    if (fields[k].empty()) continue;
    const std::optional<double> value = fortran_real(fields[k]);
    if (!value)
      scanner_.fail(
          fmt::format("node {}: {} is no finite number", *number, detail::quoted(fields[k])));
    x[static_cast<Eigen::Index>(k) - 1] = *value;
  }
  mesh_.nodes.push_back(x);
  mesh_.node_tags.push_back(*number);
  source_.offsets.push_back(offset(line));
}

void Reader::read_element_line(std::string_view line) {
  if (pending_.empty()) pending_offset_ = offset(line);
  const auto n_due = static_cast<std::size_t>(type_.type.n_nodes) + 1;
  for (const std::string_view field : comma_fields(line)) {
    const std::optional<Tag> number = whole_number(field);
    if (!number || *number < 0)
      scanner_.fail(
          fmt::format("expected a number of an element or node, found {}", detail::quoted(field)));
    if (pending_.size() == n_due)
      scanner_.fail(
          fmt::format("element {} has more than the {} nodes of its type", pending_[0], n_due - 1));
    pending_.push_back(*number);
  }
  if (pending_.size() == n_due) finish_element();
}

void Reader::finish_element() {
  if (pending_.empty()) return;
  const auto n_nodes = static_cast<std::size_t>(type_.type.n_nodes);
  if (pending_.size() != n_nodes + 1)
    scanner_.fail_at(pending_offset_,
                     fmt::format("element {} has {} nodes where {} are due: the file is cut short "
                                 "or the type is wrong",
                                 pending_[0], pending_.size() - 1, n_nodes));
  std::vector<Tag> nodes;
  for (const int place : abaqus_node_orders().in_file(type_.type))
    nodes.push_back(pending_[static_cast<std::size_t>(place) + 1]);
  elements_.add({type_.type, 0, pending_[0], pending_offset_}, nodes);
  sets_.add_element(type_.role, set_);
  pending_.clear();
}

Mesh read_abaqus(FileBytes file) {
  Reader reader(file);
  Mesh mesh = reader.read();
  attach_source(mesh, reader.source(), std::move(file));
  return mesh;
}

// A coordinate that the line leaves out is 0, and is added with its commas.
void patch_node(TextPatcher& patcher, std::string_view line, const Vec3& from, const Vec3& to) {
  const std::vector<std::string_view> fields = comma_fields(line);
  std::string added;
  for (std::size_t k = 1; k <= 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k) - 1;
    const bool has_moved = !same_bits(from[axis], to[axis]);
    if (k >= fields.size() && !(k == fields.size() && line.ends_with(','))) added += ", ";
    if (!has_moved) continue;
    if (k < fields.size())
      patcher.replace(fields[k], shortest(to[axis]));
    else {
      patcher.replace(line.substr(line.size()), added + shortest(to[axis]));
      added.clear();
    }
  }
}

void write_patched_abaqus(const Mesh& mesh, OutputFile& output) {
  const MeshSource& source = *mesh.source;
  patch_moved_nodes(mesh, output, [&](TextPatcher& patcher, std::size_t i) {
    const std::string_view rest = source.file.view().substr(source.offsets[i]);
    patch_node(patcher, trimmed(rest.substr(0, rest.find('\n'))), source.positions[i],
               mesh.nodes[i]);
  });
}

bool is_abaqus(std::string_view bytes, std::string_view extension) {
  return extension == ".inp" && trimmed(bytes.substr(0, 4096)).starts_with('*');
}

}  // namespace

const FileFormat abaqus_format = {.format = MeshFormat::abaqus,
                                  .extensions = {".inp"},
                                  .beginning = "begin with a keyword such as *HEADING",
                                  .recognizes = is_abaqus,
                                  .read = read_abaqus,
                                  .write_patched = write_patched_abaqus,
                                  .check_new = check_abaqus,
                                  .write_new = write_new_abaqus,
                                  .holds = {.groups = true,
                                            .several_groups = true,
                                            .group_names = true,
                                            .tags = true,
                                            .least_dimension = 1}};

}  // namespace roughmesh::detail
