// SPDX-License-Identifier: BSD-3-Clause
// Element sets and surfaces of Abaqus input.
#include <algorithm>

#include <fmt/format.h>

#include "element_nodes.hpp"
#include "fortran_real.hpp"
#include "io_abaqus.hpp"

namespace roughmesh::detail {
namespace {

using Loop = std::vector<int>;  // corners of a face, its normal outward

// Faces S1, S2, ... of the shapes; edges of plane ones, in their direction.
std::span<const Loop> abaqus_faces(ElementShape shape) {
  static const std::vector<Loop> triangle = {{0, 1}, {1, 2}, {2, 0}};
  static const std::vector<Loop> quadrangle = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  static const std::vector<Loop> tetrahedron = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  static const std::vector<Loop> hexahedron = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                               {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  static const std::vector<Loop> prism = {
      {0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
  static const std::vector<Loop> pyramid = {
      {0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  switch (shape) {
    case ElementShape::triangle:
      return triangle;
    case ElementShape::quadrangle:
      return quadrangle;
    case ElementShape::tetrahedron:
      return tetrahedron;
    case ElementShape::hexahedron:
      return hexahedron;
    case ElementShape::prism:
      return prism;
    case ElementShape::pyramid:
      return pyramid;
    default:
      return {};
  }
}

// "PART-1-1.TOP" is TOP of an instance of the part.
std::string_view without_instance(std::string_view field) {
  const std::size_t dot = field.rfind('.');
  return dot == field.npos ? field : field.substr(dot + 1);
}

// 1 to 6 for "S1" to "S6" and for "E1" to "E4"; 0 where the sheet itself is meant.
std::optional<int> face_number(std::string_view field) {
  const std::string name = upper(field);
  if (name.empty() || name == "SPOS" || name == "SNEG") return 0;
  if (name.size() == 2 && (name[0] == 'S' || name[0] == 'E') && name[1] >= '1' && name[1] <= '6')
    return name[1] - '0';
  return {};
}

struct FaceKey {
  std::array<Tag, 4> corners;  // sorted
  Index element;
  int face;
};

FaceKey key_of(const ElementTable& elements, Index element, int face) {
  FaceKey key{{-1, -1, -1, -1}, element, face};
  const Loop& loop =
      abaqus_faces(elements.row(element).type.shape)[static_cast<std::size_t>(face) - 1];
  for (std::size_t k = 0; k < loop.size(); ++k)
    key.corners[k] = elements.nodes(element)[static_cast<std::size_t>(loop[k])];
  std::sort(key.corners.begin(), key.corners.end());
  return key;
}

}  // namespace

void AbaqusSets::add_element(AbaqusRole role, std::optional<Index> set) {
  const auto element = static_cast<Index>(roles_.size());
  roles_.push_back(role);
  if (set) sets_[static_cast<std::size_t>(*set)].elements.push_back(element);
}

Index AbaqusSets::set(const std::string& name, bool in_assembly, bool is_internal) {
  const auto [place, is_new] =
      set_names_.try_emplace({in_assembly, upper(name)}, static_cast<Index>(sets_.size()));
  if (is_new) {
    const bool is_taken = in_assembly && set_names_.count({false, upper(name)}) > 0;
    sets_.push_back({is_taken ? "assembly." + name : name, is_internal ? 0 : ++n_groups_});
  }
  return place->second;
}

Index AbaqusSets::surface(const std::string& name) {
  const auto [place, is_new] =
      surface_names_.try_emplace(upper(name), static_cast<Index>(surfaces_.size()));
  if (is_new) surfaces_.push_back({name, ++n_groups_});
  return place->second;
}

std::optional<Index> AbaqusSets::find_set(std::string_view name, bool in_assembly) const {
  const std::string key = upper(name);
  if (in_assembly)
    if (const auto place = set_names_.find({true, key}); place != set_names_.end())
      return place->second;
  const auto place = set_names_.find({false, upper(without_instance(key))});
  if (place == set_names_.end()) return {};
  return place->second;
}

// Nothing for an element of the assembly itself, none of which is in the mesh.
std::optional<AbaqusSets::Item> AbaqusSets::item(std::string_view field, bool in_assembly) const {
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
    field = field.substr(1, field.size() - 2);
  Item item;
  item.offset = scanner_->offset();
  if (const std::optional<Tag> number = whole_number(without_instance(field))) {
    item.first = item.last = *number;
    return item;
  }
  const std::optional<Index> nested = find_set(field, in_assembly);
  if (!nested)
    scanner_->fail(fmt::format("set {} is not defined before it is used here", quoted(field)));
  item.nested = *nested;
  return item;
}

void AbaqusSets::add_line(Index set, std::string_view line, bool generates, bool in_assembly) {
  const std::vector<std::string_view> fields = comma_fields(line);
  if (!generates) {
    for (const std::string_view field : fields) {
      if (field.empty()) continue;
      Item each = *item(field, in_assembly);
      each.set = set;
      items_.push_back(each);
    }
    return;
  }
  std::array<Tag, 3> numbers = {0, 0, 1};
  if (fields.size() < 2 || fields.size() > 3)
    scanner_->fail(fmt::format("GENERATE takes first, last and step; found {}", quoted(line)));
  for (std::size_t k = 0; k < fields.size(); ++k) {
    if (k == 2 && fields[k].empty()) continue;
    const std::optional<Tag> number = whole_number(fields[k]);
    if (!number)
      scanner_->fail(fmt::format("expected a whole number, found {}", quoted(fields[k])));
    numbers[k] = *number;
  }
  if (numbers[2] < 1 || numbers[0] < 0)
    scanner_->fail(fmt::format("GENERATE from {} by {}: neither may be negative, the step not 0",
                               numbers[0], numbers[2]));
  items_.push_back({set, -1, numbers[0], numbers[1], numbers[2], scanner_->offset()});
}

void AbaqusSets::add_surface_line(Index surface, std::string_view line, bool in_assembly) {
  std::vector<std::string_view> fields = comma_fields(line);
  fields.resize(std::max<std::size_t>(fields.size(), 2));
  const std::optional<int> face = face_number(fields[1]);
  if (!face || fields[0].empty()) return;  // edges, ends, or the free surface of the whole model
  SurfaceItem entry{*item(fields[0], in_assembly), *face};
  entry.item.set = surface;
  surface_items_.push_back(entry);
}

// Sets may name sets and ranges may overlap, so that a short file could list very many elements.
void AbaqusSets::spend(std::size_t n, std::uint64_t offset) {
  constexpr std::size_t most_for_each_byte = 16;
  spent_ += n;
  const std::size_t n_bytes = scanner_->offset() + scanner_->remaining();
  if (spent_ / most_for_each_byte > n_bytes + elements_->size())
    scanner_->fail_at(offset, "the sets list far more elements than the file has: it is damaged");
}

void AbaqusSets::append(const Item& item, std::vector<Index>& elements) {
  if (item.nested < 0) return append_range(item, elements);
  const std::vector<Index>& other = sets_[static_cast<std::size_t>(item.nested)].elements;
  spend(other.size(), item.offset);
  if (&other == &elements) return;
  elements.insert(elements.end(), other.begin(), other.end());
}

// Numbers of elements that are not in the mesh, such as springs, are passed over.
void AbaqusSets::append_range(const Item& item, std::vector<Index>& elements) {
  auto place = std::lower_bound(by_number_.begin(), by_number_.end(), std::pair{item.first, -1});
  std::size_t n_seen = 1;
  for (; place != by_number_.end() && place->first <= item.last; ++place, ++n_seen)
    if ((place->first - item.first) % item.step == 0) elements.push_back(place->second);
  spend(n_seen, item.offset);
}

std::map<Tag, std::string> AbaqusSets::apply() {
  for (Index e = 0; e < static_cast<Index>(elements_->size()); ++e)
    by_number_.emplace_back(elements_->row(e).number, e);
  std::sort(by_number_.begin(), by_number_.end());
  for (const Item& each : items_) append(each, sets_[static_cast<std::size_t>(each.set)].elements);
  std::map<Tag, std::string> names;
  for (const Set& set : sets_) {
    if (set.group == 0) continue;
    names.emplace(set.group, set.name);
    for (const Index e : set.elements) elements_->add_to_group(e, set.group);
  }
  for (const Set& surface : surfaces_) names.emplace(surface.group, surface.name);
  std::vector<Face> faces;
  for (const SurfaceItem& line : surface_items_) apply_surface(line, faces);
  add_faces(std::move(faces));
  return names;
}

void AbaqusSets::apply_surface(const SurfaceItem& line, std::vector<Face>& faces) {
  std::vector<Index> elements;
  append(line.item, elements);
  for (const Index e : elements) {
    const auto n_faces = static_cast<int>(abaqus_faces(elements_->row(e).type.shape).size());
    const AbaqusRole role = roles_[static_cast<std::size_t>(e)];
    const bool is_itself =
        role == AbaqusRole::line || (role == AbaqusRole::sheet && line.face == 0);
    if (is_itself)
      elements_->add_to_group(e, surfaces_[static_cast<std::size_t>(line.item.set)].group);
    else if (line.face > n_faces)
      scanner_->fail_at(line.item.offset, fmt::format("element {} has no face S{}",
                                                      elements_->row(e).number, line.face));
    else
      apply_face(e, line.face, line, faces);
  }
}

void AbaqusSets::apply_face(Index element, int face, const SurfaceItem& line,
                            std::vector<Face>& faces) {
  const Tag group = surfaces_[static_cast<std::size_t>(line.item.set)].group;
  if (face > 0) {
    faces.push_back({element, face, group});
    return;
  }
  const std::vector<Face>& all = free_faces();
  for (auto place = std::lower_bound(all.begin(), all.end(), Face{element, 0, 0});
       place != all.end() && place->element == element; ++place)
    faces.push_back({element, place->face, group});
}

// Faces of solids and edges of plane elements that are on one element only.
const std::vector<AbaqusSets::Face>& AbaqusSets::free_faces() {
  if (free_faces_) return *free_faces_;
  std::vector<FaceKey> keys;
  for (Index e = 0; e < static_cast<Index>(roles_.size()); ++e) {
    const AbaqusRole role = roles_[static_cast<std::size_t>(e)];
    if (role != AbaqusRole::solid && role != AbaqusRole::plane) continue;
    const auto n = static_cast<int>(abaqus_faces(elements_->row(e).type.shape).size());
    for (int face = 1; face <= n; ++face) keys.push_back(key_of(*elements_, e, face));
  }
  std::sort(keys.begin(), keys.end(),
            [](const FaceKey& a, const FaceKey& b) { return a.corners < b.corners; });
  free_faces_.emplace();
  for (std::size_t i = 0, next = 0; i < keys.size(); i = next) {
    for (next = i + 1; next < keys.size() && keys[next].corners == keys[i].corners;) ++next;
    if (next == i + 1) free_faces_->push_back({keys[i].element, keys[i].face, 0});
  }
  std::sort(free_faces_->begin(), free_faces_->end());
  return *free_faces_;
}

void AbaqusSets::add_faces(std::vector<Face> faces) {
  std::sort(faces.begin(), faces.end());
  Tag number = by_number_.empty() ? 0 : by_number_.back().first;
  if (number > std::numeric_limits<Tag>::max() - static_cast<Tag>(faces.size()))
    scanner_->fail("an element number is too large; renumber the mesh");
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const bool is_new =
        i == 0 || faces[i].element != faces[i - 1].element || faces[i].face != faces[i - 1].face;
    if (is_new) add_face_element(faces[i], ++number);
    elements_->add_to_group(static_cast<Index>(elements_->size()) - 1, faces[i].group);
  }
}

void AbaqusSets::add_face_element(const Face& face, Tag number) {
  const ElementTable::Row row = elements_->row(face.element);
  const std::span<const Tag> solid = elements_->nodes(face.element);
  const Loop& corners = abaqus_faces(row.type.shape)[static_cast<std::size_t>(face.face) - 1];
  std::vector<Tag> nodes;
  for (const int corner : corners) nodes.push_back(solid[static_cast<std::size_t>(corner)]);
  const std::size_t n_edges = corners.size() == 2 ? 1 : corners.size();
  for (std::size_t k = 0; row.type.order == 2 && k < n_edges; ++k) {
    const int middle = middle_node(row.type.shape, corners[k], corners[(k + 1) % corners.size()]);
    nodes.push_back(solid[static_cast<std::size_t>(middle)]);
  }
  elements_->add(
      {serendipity_type(shape_of_face(corners.size()), row.type.order), 0, number, row.offset},
      nodes);
}

}  // namespace roughmesh::detail
