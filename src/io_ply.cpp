// SPDX-License-Identifier: BSD-3-Clause
#include "io_ply.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "block_builder.hpp"
#include "surface_files.hpp"

namespace roughmesh::detail {
namespace {

// Where a face has its corners and its group.
struct FaceLayout {
  std::size_t corners = 0;
  std::optional<std::size_t> group = {};
};

class PlyReader {
 public:
  explicit PlyReader(Scanner& scanner) : scanner_(&scanner), header_(read_ply_header(scanner)) {
    vertex_ = header_.find("vertex");
    face_ = header_.find("face");
    edge_ = header_.find("edge");
    if (vertex_ == nullptr || vertex_->count == 0)
      scanner_->fail("no vertices; save the mesh again");
    if (vertex_->count > largest_index) refuse_size();
    n_nodes_ = static_cast<Index>(vertex_->count);
  }

  Mesh read(MeshSource& source) {
    for (const PlyElement& element : header_.elements) {
      scanner_->set_section(element.name);
      read_element(element, source);
    }
    require_end();
    Mesh& mesh = mesh_;
    mesh.format = MeshFormat::ply;
    if (mesh.blocks.empty())
      scanner_->refuse("holds points but no faces; make a surface of them first");
    number_nodes(mesh);
    add_groups();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuse_size() const {
    scanner_->refuse(fmt::format(
        "more nodes or faces than the {} that roughmesh handles; split the mesh", largest_index));
  }

  // Of each element at least, so that its count can be compared with what remains.
  std::size_t least_bytes(const PlyElement& element) const {
    std::size_t n = 0;
    for (const PlyProperty& property : element.properties)
      n += scanner_->encoding() == Encoding::text ? 2
                                                  : size_of(property.count.value_or(property.type));
    if (n == 0 && element.count > 0) scanner_->fail("the header gives it no properties");
    return std::max<std::size_t>(n, 1);
  }

  void read_element(const PlyElement& element, MeshSource& source) {
    const std::size_t n = scanner_->count(element.count, least_bytes(element), "elements");
    if (&element == vertex_) return read_vertices(element, n, source);
    if (&element == face_) return read_faces(element, n);
    if (&element == edge_) return read_edges(element, n);
    for (std::size_t i = 0; i < n; ++i)
      for (const PlyProperty& property : element.properties) skip_ply_property(*scanner_, property);
  }

  void require_coordinates(const PlyVertexLayout& layout) const {
    for (std::size_t k = 0; k < 3; ++k)
      if (layout.coordinates[k] == nullptr)
        scanner_->fail(fmt::format("no property {} of type float or double", "xyz"[k]));
  }

  void read_vertices(const PlyElement& vertex, std::size_t n, MeshSource& source) {
    const PlyVertexLayout layout(vertex);
    require_coordinates(layout);
    source.coordinates = number_format(layout);
    source.swap_bytes = header_.swap_bytes;
    source.offsets.reserve(n);
    mesh_.nodes.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      source.offsets.push_back(scanner_->offset());
      mesh_.nodes.push_back(read_position(vertex, layout));
    }
  }

  // Of the coordinates as a whole: the least precise of the three.
  NumberFormat number_format(const PlyVertexLayout& layout) const {
    if (header_.encoding == Encoding::text) return NumberFormat::text;
    const bool has_float =
        std::any_of(layout.coordinates.begin(), layout.coordinates.end(),
                    [](const PlyProperty* property) { return property->type == PlyType::float32; });
    return has_float ? NumberFormat::float32 : NumberFormat::float64;
  }

  Vec3 read_position(const PlyElement& vertex, const PlyVertexLayout& layout) {
    Vec3 x = Vec3::Zero();
    const std::size_t start = scanner_->offset();
    for (std::size_t p = 0; p < layout.roles.size(); ++p) {
      const int role = layout.roles[p];
      if (role >= 0 && role < 3)
        x[role] = ply_real(*scanner_, vertex.properties[p].type);
      else
        skip_ply_property(*scanner_, vertex.properties[p]);
    }
    if (!x.allFinite())
      scanner_->fail_at(start, "a coordinate is not finite: mend it or make the mesh anew");
    return x;
  }

  FaceLayout face_layout(const PlyElement& face) const {
    FaceLayout layout;
    const auto& properties = face.properties;
    const auto corners =
        std::find_if(properties.begin(), properties.end(), [](const PlyProperty& property) {
          return property.count && !is_real(property.type) &&
                 (property.name == "vertex_indices" || property.name == "vertex_index");
        });
    if (corners == properties.end())
      scanner_->fail("no list vertex_indices of whole numbers; save the mesh again");
    layout.corners = static_cast<std::size_t>(corners - properties.begin());
    layout.group = group_property(face);
    return layout;
  }

  static std::optional<std::size_t> group_property(const PlyElement& element) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (property.name == ply_group && !property.count && !is_real(property.type)) return p;
    }
    return std::nullopt;
  }

  void read_faces(const PlyElement& face, std::size_t n) {
    if (n == 0) return;
    if (n > static_cast<std::size_t>(largest_index)) refuse_size();
    const FaceLayout layout = face_layout(face);
    for (std::size_t i = 0; i < n; ++i) read_face(face, layout);
  }

  void read_face(const PlyElement& face, const FaceLayout& layout) {
    std::array<Index, 4> corners{};
    std::size_t n = 0;
    Tag group = 0;
    for (std::size_t p = 0; p < face.properties.size(); ++p) {
      const PlyProperty& property = face.properties[p];
      if (p == layout.corners)
        n = read_corners(property, corners);
      else if (p == layout.group)
        group = ply_integer(*scanner_, property.type);
      else
        skip_ply_property(*scanner_, property);
    }
    blocks_.set_group(group);
    blocks_.add_face(++n_elements_, {corners.data(), n});
  }

  std::size_t read_corners(const PlyProperty& property, std::array<Index, 4>& corners) {
    const Tag n = ply_integer(*scanner_, *property.count);
    check_face_size(*scanner_, n);
    for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k)
      corners[k] = checked_node(*scanner_, ply_integer(*scanner_, property.type), n_nodes_);
    return static_cast<std::size_t>(n);
  }

  // Edges with other ends than two numbers of vertices are passed over.
  void read_edges(const PlyElement& edge, std::size_t n) {
    const auto find = [&](std::string_view name) {
      const auto found = std::find_if(
          edge.properties.begin(), edge.properties.end(), [&](const PlyProperty& property) {
            return property.name == name && !property.count && !is_real(property.type);
          });
      return static_cast<std::size_t>(found - edge.properties.begin());
    };
    const std::array<std::size_t, 2> ends = {find("vertex1"), find("vertex2")};
    const bool has_ends = std::max(ends[0], ends[1]) < edge.properties.size();
    if (n > static_cast<std::size_t>(largest_index)) refuse_size();
    for (std::size_t i = 0; i < n; ++i) read_edge(edge, ends, has_ends);
  }

  void read_edge(const PlyElement& edge, const std::array<std::size_t, 2>& ends, bool has_ends) {
    std::array<Index, 2> nodes{};
    Tag group = 0;
    const std::optional<std::size_t> group_place = group_property(edge);
    for (std::size_t p = 0; p < edge.properties.size(); ++p) {
      const PlyProperty& property = edge.properties[p];
      const auto end = std::find(ends.begin(), ends.end(), p);
      if (has_ends && end != ends.end())
        nodes[static_cast<std::size_t>(end - ends.begin())] =
            checked_node(*scanner_, ply_integer(*scanner_, property.type), n_nodes_);
      else if (p == group_place)
        group = ply_integer(*scanner_, property.type);
      else
        skip_ply_property(*scanner_, property);
    }
    if (!has_ends) return;
    blocks_.set_group(group);
    blocks_.add(line_type, ++n_elements_, nodes);
  }

  // Bytes behind the last element mean that a count is wrong, unless an editor left line ends
  // there.
  void require_end() {
    const std::string_view rest = scanner_->rest();
    const auto stray = std::find_if_not(rest.begin(), rest.end(), is_space);
    if (stray == rest.end()) return;
    scanner_->skip(static_cast<std::size_t>(stray - rest.begin()));
    scanner_->fail("something stands behind the last element: a count is wrong");
  }

  // Those of elements, with the names that comments give, and those that only comments name.
  void add_groups() {
    std::map<std::pair<int, Tag>, std::string> groups;
    for (const PhysicalGroup& group : used_groups(mesh_.blocks))
      groups[{group.dimension, group.tag}];
    for (PhysicalGroup& group : header_.groups)
      groups[{group.dimension, group.tag}] = std::move(group.name);
    for (auto& [key, name] : groups)
      mesh_.groups.push_back({key.first, key.second, std::move(name)});
  }

  Scanner* scanner_;
  PlyHeader header_;
  const PlyElement* vertex_ = nullptr;
  const PlyElement* face_ = nullptr;
  const PlyElement* edge_ = nullptr;
  Index n_nodes_ = 0;
  Mesh mesh_;
  BlockBuilder blocks_{mesh_.blocks};
  Tag n_elements_ = 0;
};

bool is_ply(std::string_view bytes, std::string_view) {
  return bytes.starts_with("ply\n") || bytes.starts_with("ply\r");
}

Mesh read_ply(FileBytes file) {
  Scanner scanner(file);
  MeshSource source;
  Mesh mesh = PlyReader(scanner).read(source);
  attach_source(mesh, std::move(source), std::move(file));
  return mesh;
}

}  // namespace

const FileFormat ply_format = {.format = MeshFormat::ply,
                               .extensions = {".ply"},
                               .beginning = "begin with \"ply\"",
                               .recognizes = is_ply,
                               .read = read_ply,
                               .write_patched = write_patched_ply,
                               .check_new = check_ply,
                               .write_new = write_new_ply,
                               .holds = {.groups = true,
                                         .group_names = true,
                                         .point_fields = true,
                                         .least_dimension = 1,
                                         .most_dimension = 2},
                               .encodings = {Encoding::binary, Encoding::text}};

}  // namespace roughmesh::detail
