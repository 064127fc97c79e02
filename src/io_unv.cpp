// SPDX-License-Identifier: BSD-3-Clause
// UNV: datasets of nodes, elements and groups; all others are only kept.
#include "io_unv.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "element_table.hpp"
#include "fortran_real.hpp"
#include "io_patch.hpp"
#include "scanner.hpp"
#include "text.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::string_view delimiter = "-1";
constexpr std::array node_datasets = {Tag{781}, Tag{2411}};
constexpr std::array element_datasets = {Tag{780}, Tag{2412}};
// Entities of groups by type and number; and by type, number and two numbers more.
constexpr std::array pair_group_datasets = {Tag{2417}, Tag{2429}, Tag{2430}, Tag{2432}};
constexpr std::array group_datasets = {Tag{2435}, Tag{2452}, Tag{2467}, Tag{2477}};
constexpr Tag element_entity = 8;

template <typename List>
bool contains(const List& list, Tag number) {
  return std::find(list.begin(), list.end(), number) != list.end();
}

struct Membership {
  Tag element = 0, group = 0;
};

class Reader {
 public:
  explicit Reader(const FileBytes& file) : scanner_(file) {}

  Mesh read();
  MeshSource source() { return std::move(source_); }

 private:
  void read_dataset();
  bool next_record(std::string_view& line);
  std::string_view record_line();
  std::vector<Tag> numbers(std::string_view line, std::size_t least);
  void read_nodes();
  void read_elements(bool has_bins);
  void read_element(const std::vector<Tag>& head, bool has_bins);
  std::vector<Tag> read_node_numbers(std::size_t n);
  void read_groups(std::size_t n_each);
  void read_entities(Tag n, std::size_t n_each, Tag group);
  void apply_groups();
  [[noreturn]] void fail(std::string_view what) const { scanner_.fail_at(line_start_, what); }

  Scanner scanner_;
  std::size_t line_start_ = 0;
  Mesh mesh_;
  MeshSource source_;
  ElementTable elements_;
  std::vector<Membership> members_;
  std::map<Tag, std::string> names_;
};

Mesh Reader::read() {
  for (scanner_.skip_space(); !scanner_.at_end(); scanner_.skip_space()) {
    line_start_ = scanner_.offset();
    if (trimmed(scanner_.line()) != delimiter)
      fail("expected -1 before a dataset: a count is wrong or the file is damaged");
    read_dataset();
    scanner_.set_section("");
  }
  if (mesh_.nodes.empty()) scanner_.fail("no nodes; save the mesh with dataset 2411");
  if (elements_.size() == 0) scanner_.fail("no elements; save the mesh with dataset 2412");
  apply_groups();
  elements_.fill(mesh_, source_.offsets, names_, scanner_);
  mesh_.format = MeshFormat::unv;
  return std::move(mesh_);
}

void Reader::read_dataset() {
  const std::vector<std::string_view> head = words(record_line());
  // Binary datasets are called "58b".
  const Tag dataset = head.empty() ? 0 : whole_number(head[0]).value_or(0);
  scanner_.set_section(fmt::format("dataset {}", head.empty() ? "" : head[0]));
  if (head.empty() || head[0].front() < '0' || head[0].front() > '9')
    fail("expected the number of a dataset");
  if (contains(node_datasets, dataset)) return read_nodes();
  if (contains(element_datasets, dataset)) return read_elements(dataset == 780);
  if (contains(group_datasets, dataset)) return read_groups(4);
  if (contains(pair_group_datasets, dataset)) return read_groups(2);
  while (trimmed(record_line()) != delimiter) {
  }
}

// A line of the dataset, which is not over before its -1.
std::string_view Reader::record_line() {
  line_start_ = scanner_.offset();
  if (scanner_.at_end()) scanner_.fail("the file ends inside a dataset: it is cut short");
  return scanner_.line();
}

bool Reader::next_record(std::string_view& line) {
  do {
    line = record_line();
  } while (trimmed(line).empty());
  return trimmed(line) != delimiter;
}

std::vector<Tag> Reader::numbers(std::string_view line, std::size_t least) {
  std::vector<Tag> result;
  for (const std::string_view word : words(line)) {
    const std::optional<Tag> number = whole_number(word);
    if (!number) fail(fmt::format("expected a whole number, found {}", quoted(word)));
    result.push_back(*number);
  }
  if (result.size() < least)
    fail(fmt::format("{} numbers where {} are due: the file is damaged", result.size(), least));
  return result;
}

void Reader::read_nodes() {
  std::string_view line;
  while (next_record(line)) {
    const Tag tag = numbers(line, 1)[0];
    if (tag < 0) fail(fmt::format("node {}: a number cannot be negative", tag));
    if (mesh_.nodes.size() >= static_cast<std::size_t>(largest_index))
      scanner_.refuse("more nodes than roughmesh handles; split the mesh");
    const std::vector<std::string_view> texts = words(record_line());
    if (texts.size() < 3) fail(fmt::format("node {} has {} coordinates", tag, texts.size()));
    Vec3 x;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::optional<double> value = fortran_real(texts[k]);
      if (!value) fail(fmt::format("node {}: {} is no finite number", tag, quoted(texts[k])));
      x[static_cast<Eigen::Index>(k)] = *value;
    }
    mesh_.nodes.push_back(x);
    mesh_.node_tags.push_back(tag);
    source_.offsets.push_back(line_start_);
  }
}

void Reader::read_elements(bool has_bins) {
  std::string_view line;
  while (next_record(line)) read_element(numbers(line, has_bins ? 8 : 6), has_bins);
}

// The property is the entity: preprocessors give each part one of its own.
void Reader::read_element(const std::vector<Tag>& head, bool has_bins) {
  const std::size_t start = line_start_;
  const Tag tag = head[0], descriptor = head[1];
  const Tag property = std::max<Tag>(head[has_bins ? 3 : 2], 0);
  const Tag n_nodes = head[has_bins ? 7 : 5];
  const UnvType type = unv_type(descriptor);
  if (tag < 0) fail(fmt::format("element {}: a number cannot be negative", tag));
  if (!type.is_known)
    scanner_.refuse(
        fmt::format("element {} has the finite element descriptor {}, which is not "
                    "handled; use others or leave them out of the file",
                    tag, descriptor));
  if (n_nodes < 1 || (!type.is_ignored && n_nodes != type.type.n_nodes))
    fail(fmt::format("element {} has {} nodes where descriptor {} has {}", tag, n_nodes, descriptor,
                     type.is_ignored ? 1 : type.type.n_nodes));
  if (type.is_beam) record_line();
  const std::vector<Tag> nodes = read_node_numbers(scanner_.count(n_nodes, 2, "nodes"));
  if (type.is_ignored) return;
  std::vector<Tag> in_order;
  for (const int place : unv_node_orders().in_file(type.type))
    in_order.push_back(nodes[static_cast<std::size_t>(place)]);
  elements_.add({type.type, property, tag, start}, in_order);
}

std::vector<Tag> Reader::read_node_numbers(std::size_t n) {
  std::vector<Tag> result;
  while (result.size() < n) {
    const std::vector<Tag> line = numbers(record_line(), 1);
    result.insert(result.end(), line.begin(), line.end());
  }
  if (result.size() > n)
    fail(fmt::format("an element has {} nodes where {} are due", result.size(), n));
  return result;
}

void Reader::read_groups(std::size_t n_each) {
  std::string_view line;
  while (next_record(line)) {
    const std::vector<Tag> head = numbers(line, 7);
    if (head[0] < 0) fail(fmt::format("group {}: a number cannot be negative", head[0]));
    const std::string_view name = trimmed(record_line());
    if (name == delimiter) fail("the dataset ends before the name of a group: it is cut short");
    if (!name.empty()) names_.try_emplace(head[0], name);
    read_entities(head.back(), n_each, head[0]);
  }
}

void Reader::read_entities(Tag n, std::size_t n_each, Tag group) {
  const std::size_t n_entities = scanner_.count(n, 4, "entities");
  for (std::size_t i = 0; i < n_entities;) {
    const std::vector<Tag> line = numbers(record_line(), n_each);
    for (std::size_t k = 0; k + 1 < line.size() && i < n_entities; k += n_each, ++i)
      if (line[k] == element_entity) members_.push_back({line[k + 1], group});
  }
}

// Numbers of elements that are not in the mesh, such as springs, are passed over.
void Reader::apply_groups() {
  std::vector<std::pair<Tag, Index>> by_number;
  by_number.reserve(elements_.size());
  for (Index e = 0; e < static_cast<Index>(elements_.size()); ++e)
    by_number.emplace_back(elements_.row(e).number, e);
  std::sort(by_number.begin(), by_number.end());
  for (const Membership& member : members_) {
    const auto place =
        std::lower_bound(by_number.begin(), by_number.end(), std::pair{member.element, Index{-1}});
    if (place != by_number.end() && place->first == member.element)
      elements_.add_to_group(place->second, member.group);
  }
}

Mesh read_unv(FileBytes file) {
  Reader reader(file);
  Mesh mesh = reader.read();
  attach_source(mesh, reader.source(), std::move(file));
  return mesh;
}

char exponent_letter(std::string_view number) {
  return number.find_first_of("Dd") == number.npos ? 'E' : 'D';
}

// Numbers keep the columns in which they end, as far as they leave a space before them.
void patch_line(TextPatcher& patcher, std::string_view line, const Vec3& from, const Vec3& to) {
  const std::vector<std::string_view> texts = words(line);
  const char* previous_end = line.data();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    const char* const end = texts[k].data() + texts[k].size();
    if (!same_bits(from[axis], to[axis])) {
      const std::string_view field(previous_end, static_cast<std::size_t>(end - previous_end));
      const std::string number = unv_real(to[axis], exponent_letter(texts[k]));
      const std::size_t width = std::max(field.size(), number.size() + (k > 0 ? 1 : 0));
      patcher.replace(field, fmt::format("{:>{}}", number, width));
    }
    previous_end = end;
  }
}

void write_patched_unv(const Mesh& mesh, OutputFile& output) {
  const MeshSource& source = *mesh.source;
  patch_moved_nodes(mesh, output, [&](TextPatcher& patcher, std::size_t i) {
    const std::string_view rest = source.file.view().substr(source.offsets[i]);
    patch_line(patcher, rest.substr(0, rest.find('\n')), source.positions[i], mesh.nodes[i]);
  });
}

// The first line is -1 and the second the number of a dataset.
bool is_unv(std::string_view bytes, std::string_view) {
  const std::vector<std::string_view> start = words(bytes.substr(0, 1024));
  return start.size() >= 2 && start[0] == delimiter && start[1].front() >= '0' &&
         start[1].front() <= '9';
}

}  // namespace

const FileFormat unv_format = {.format = MeshFormat::unv,
                               .extensions = {".unv"},
                               .beginning = "begin with a line of -1 and the number of a dataset",
                               .recognizes = is_unv,
                               .read = read_unv,
                               .write_patched = write_patched_unv,
                               .check_new = check_unv,
                               .write_new = write_new_unv,
                               .holds = {.groups = true,
                                         .several_groups = true,
                                         .group_names = true,
                                         .tags = true,
                                         .least_dimension = 1}};

}  // namespace roughmesh::detail
