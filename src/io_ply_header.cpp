// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <charconv>

#include <fmt/format.h>

#include "io_ply.hpp"

namespace roughmesh::detail {
namespace {

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t i = 0; i < line.size();) {
    while (i < line.size() && is_space(line[i])) ++i;
    const std::size_t start = i;
    while (i < line.size() && !is_space(line[i])) ++i;
    if (i > start) words.push_back(line.substr(start, i - start));
  }
  return words;
}

std::optional<PlyType> find_type(std::string_view word) {
  struct Name {
    std::string_view word;
    PlyType type;
  };
  static constexpr std::array names = {
      Name{"char", PlyType::int8},      Name{"int8", PlyType::int8},
      Name{"uchar", PlyType::uint8},    Name{"uint8", PlyType::uint8},
      Name{"short", PlyType::int16},    Name{"int16", PlyType::int16},
      Name{"ushort", PlyType::uint16},  Name{"uint16", PlyType::uint16},
      Name{"int", PlyType::int32},      Name{"int32", PlyType::int32},
      Name{"uint", PlyType::uint32},    Name{"uint32", PlyType::uint32},
      Name{"int64", PlyType::int64},    Name{"uint64", PlyType::uint64},
      Name{"float", PlyType::float32},  Name{"float32", PlyType::float32},
      Name{"double", PlyType::float64}, Name{"float64", PlyType::float64}};
  const auto found =
      std::find_if(names.begin(), names.end(), [&](const Name& name) { return name.word == word; });
  return found == names.end() ? std::nullopt : std::optional(found->type);
}

// Reads the header line by line.
class HeaderReader {
 public:
  explicit HeaderReader(Scanner& scanner) : scanner_(&scanner) {}

  PlyHeader read() {
    if (scanner_->line() != "ply") scanner_->fail_at(0, "expected ply");
    scanner_->set_section("header");
    while (read_line()) {
    }
    if (!has_format_) scanner_->fail("declares no format");
    scanner_->set_encoding(header_.encoding, header_.swap_bytes);
    return std::move(header_);
  }

 private:
  bool read_line() {
    start_ = scanner_->offset();
    if (scanner_->at_end()) scanner_->fail("end_header is missing: the file is cut short");
    const std::string_view line = scanner_->line();
    words_ = split(line);
    if (words_.empty() || words_[0] == "obj_info") return true;
    if (words_[0] == "end_header") return false;
    if (words_[0] == "comment")
      read_comment(line);
    else if (words_[0] == "format")
      read_format();
    else if (words_[0] == "element")
      read_element();
    else if (words_[0] == "property")
      read_property();
    else
      fail(fmt::format("{} is no word of a PLY header: the file is damaged", quoted(words_[0])));
    return true;
  }

  [[noreturn]] void fail(std::string_view what) const { scanner_->fail_at(start_, what); }

  // "comment physical_group DIMENSION NUMBER NAME", as write_new_ply writes it.
  void read_comment(std::string_view line) {
    if (words_.size() < 5 || words_[1] != ply_group) return;
    PhysicalGroup group;
    const auto parse = [](std::string_view word, auto& value) {
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      return error == std::errc() && end == word.data() + word.size();
    };
    if (!parse(words_[2], group.dimension) || !parse(words_[3], group.tag)) return;
    if (group.dimension < 1 || group.dimension > 2) return;
    group.name = line.substr(static_cast<std::size_t>(words_[4].data() - line.data()));
    header_.groups.push_back(std::move(group));
  }

  void read_format() {
    if (words_.size() != 3) fail("a format is a name and a version");
    const bool is_big = words_[1] == "binary_big_endian";
    if (!is_big && words_[1] != "binary_little_endian" && words_[1] != "ascii")
      fail(fmt::format("{} is no PLY format: use ascii, binary_little_endian or binary_big_endian",
                       quoted(words_[1])));
    if (words_[2] != "1.0") fail(fmt::format("version {} where 1.0 is known", quoted(words_[2])));
    header_.encoding = words_[1] == "ascii" ? Encoding::text : Encoding::binary;
    header_.swap_bytes =
        header_.encoding == Encoding::binary && is_big != (std::endian::native == std::endian::big);
    has_format_ = true;
  }

  void read_element() {
    if (words_.size() != 3) fail("an element is a name and a count");
    const std::size_t next = scanner_->offset();
    const Tag count = scanner_->text_integer(words_[2]);
    scanner_->move_to(next);
    if (count < 0) fail(fmt::format("{} elements; a count cannot be negative", count));
    if (words_[1] == "tristrips")
      scanner_->refuse("holds strips of triangles; save it with faces instead");
    header_.elements.push_back({std::string(words_[1]), count, start_, {}});
  }

  PlyType type(std::string_view word) const {
    const std::optional<PlyType> found = find_type(word);
    if (!found) fail(fmt::format("{} is no type of a property", quoted(word)));
    return *found;
  }

  void read_property() {
    if (header_.elements.empty()) fail("a property stands before the first element");
    const bool is_list = words_.size() > 1 && words_[1] == "list";
    if (words_.size() != (is_list ? 5U : 3U))
      fail("a property is a type and a name, or list, two types and a name");
    PlyProperty property;
    property.name = words_.back();
    property.type = type(words_[words_.size() - 2]);
    if (is_list) property.count = type(words_[2]);
    if (property.count && is_real(*property.count))
      fail(fmt::format("the length of a list is of type {}; it must be whole", quoted(words_[2])));
    header_.elements.back().properties.push_back(std::move(property));
  }

  Scanner* scanner_;
  std::size_t start_ = 0;
  std::vector<std::string_view> words_;
  bool has_format_ = false;
  PlyHeader header_;
};

}  // namespace

std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 10> sizes = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

const PlyElement* PlyHeader::find(std::string_view name) const {
  const auto found = std::find_if(elements.begin(), elements.end(),
                                  [&](const PlyElement& element) { return element.name == name; });
  return found == elements.end() ? nullptr : &*found;
}

PlyHeader read_ply_header(Scanner& scanner) { return HeaderReader(scanner).read(); }

PlyVertexLayout::PlyVertexLayout(const PlyElement& vertex)
    : roles(vertex.properties.size(), other) {
  constexpr std::array<std::string_view, 6> names = {"x", "y", "z", "nx", "ny", "nz"};
  std::array<std::size_t, 6> places{};
  std::array<bool, 6> found{};
  for (std::size_t p = 0; p < roles.size(); ++p) {
    const PlyProperty& property = vertex.properties[p];
    const auto name = std::find(names.begin(), names.end(), property.name);
    if (name == names.end() || property.count || !is_real(property.type)) continue;
    const auto role = static_cast<std::size_t>(name - names.begin());
    if (std::exchange(found[role], true)) continue;
    places[role] = p;
  }
  has_normals = found[3] && found[4] && found[5];
  for (std::size_t role = 0; role < (has_normals ? 6U : 3U); ++role) {
    if (!found[role]) continue;
    roles[places[role]] = static_cast<int>(role);
    if (role < 3) coordinates[role] = &vertex.properties[places[role]];
  }
}

double ply_real(Scanner& scanner, PlyType type) {
  if (scanner.encoding() == Encoding::text) return scanner.text_real();
  return type == PlyType::float32 ? scanner.bytes<float>() : scanner.bytes<double>();
}

Tag ply_integer(Scanner& scanner, PlyType type) {
  if (scanner.encoding() == Encoding::text) return scanner.text_integer();
  switch (type) {
    case PlyType::int8:
      return scanner.bytes<std::int8_t>();
    case PlyType::uint8:
      return scanner.bytes<std::uint8_t>();
    case PlyType::int16:
      return scanner.bytes<std::int16_t>();
    case PlyType::uint16:
      return scanner.bytes<std::uint16_t>();
    case PlyType::int32:
      return scanner.bytes<std::int32_t>();
    case PlyType::uint32:
      return scanner.bytes<std::uint32_t>();
    case PlyType::int64:
      return scanner.bytes<std::int64_t>();
    default:
      return static_cast<Tag>(scanner.bytes<std::uint64_t>());
  }
}

void skip_ply_property(Scanner& scanner, const PlyProperty& property) {
  if (!property.count) return scanner.skip_number(size_of(property.type));
  const bool is_text = scanner.encoding() == Encoding::text;
  const Tag announced = ply_integer(scanner, *property.count);
  const std::size_t n = scanner.count(announced, is_text ? 2 : size_of(property.type), "numbers");
  if (!is_text) return scanner.skip(n * size_of(property.type));
  for (std::size_t i = 0; i < n; ++i) scanner.skip_number(0);
}

}  // namespace roughmesh::detail
