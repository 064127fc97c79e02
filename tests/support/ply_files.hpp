// SPDX-License-Identifier: BSD-3-Clause
// Writes PLY files of every kind, with nothing of the library: what its reader is tested against.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "roughmesh/mesh.hpp"

namespace roughmesh::test {

struct PlyStyle {
  bool binary = false;
  bool big_endian = false;
  std::string real = "float";  ///< type of coordinates and normals
  bool normals = false;
  bool extras = false;  ///< comments, properties, lists and elements that nobody needs, CRLF
};

inline std::string name(const PlyStyle& style) {
  return fmt::format("{}{}_{}{}{}", style.binary ? "binary" : "text",
                     style.big_endian ? "_big_endian" : "", style.real,
                     style.normals ? "_normals" : "", style.extras ? "_extras" : "");
}

inline void PrintTo(const PlyStyle& style, std::ostream* stream) { *stream << name(style); }

inline std::vector<PlyStyle> all_ply_styles() {
  std::vector<PlyStyle> styles;
  for (const int encoding : {0, 1, 2})
    for (const char* const real : {"float", "float64"})
      for (const bool normals : {false, true})
        for (const bool extras : {false, true})
          styles.push_back({encoding > 0, encoding == 2, real, normals, extras});
  return styles;
}

class PlyWriter {
 public:
  PlyWriter(const Mesh& mesh, const PlyStyle& style) : mesh_(mesh), style_(style) {}

  /// How a coordinate is written in a text file; what tests replace to predict a moved node.
  std::function<std::string(std::size_t node, int axis)> coordinate_text =
      [this](std::size_t node, int axis) { return fmt::format("{:.9e}", mesh_.nodes[node][axis]); };
  /// Of every node; zero if empty.
  std::vector<Vec3> normals = {};

  std::string bytes() {
    bytes_.clear();
    write_header();
    if (style_.extras) write_camera();
    for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) write_vertex(i);
    for (const ElementBlock& block : mesh_.blocks)
      for (Index i = 0; i < block.size(); ++i) write_face(block.element(i));
    if (style_.extras) write_tail();
    return bytes_;
  }

 private:
  void line(const std::string& text) { bytes_ += text + (style_.extras ? "\r\n" : "\n"); }
  void end_of_row() {
    if (!style_.binary) line("");
  }

  void write_header() {
    line("ply");
    line(!style_.binary
             ? "format ascii 1.0"
             : fmt::format("format binary_{}_endian 1.0", style_.big_endian ? "big" : "little"));
    if (style_.extras) {
      line("comment made by hand, 1 2 3 end_header");
      line("obj_info element vertex 7");
      line("element camera 1");
      line("property double focal");
      line("property list uchar short pixels");
    }
    line(fmt::format("element vertex {}", mesh_.nodes.size()));
    if (style_.extras) line("property list uint8 int32 neighbours");
    // y first, and something between coordinates
    line("property " + style_.real + " y");
    if (style_.extras) line("property uchar red");
    line("property " + style_.real + " x");
    line("property " + style_.real + " z");
    if (style_.extras) line("property float quality");
    if (style_.normals)
      for (const char axis : {'x', 'y', 'z'})
        line(fmt::format("property {} n{}", style_.real, axis));
    std::size_t n_faces = 0;
    for (const ElementBlock& block : mesh_.blocks) n_faces += block.tags.size();
    line(fmt::format("element face {}", n_faces));
    if (style_.extras) line("property int16 flags");
    line(style_.extras ? "property list uint32 uint32 vertex_index"
                       : "property list uchar int vertex_indices");
    if (style_.extras) {
      line("property list uchar float texcoord");
      line("element material 2");
      line("property double shine");
    }
    line("end_header");
  }

  template <typename T>
  void number(T value, const std::string& text = {}) {
    if (!style_.binary) {
      bytes_ += (text.empty() ? fmt::format("{}", value) : text) + (style_.extras ? "  " : " ");
      return;
    }
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof(T));
    if (style_.big_endian != (std::endian::native == std::endian::big))
      std::reverse(raw.begin(), raw.end());
    bytes_.append(raw.data(), raw.size());
  }
  void real(double value, const std::string& text = {}) {
    style_.real == "float" ? number(static_cast<float>(value), text) : number(value, text);
  }

  void write_camera() {
    number(0.5);
    number(std::uint8_t{2});
    number(std::int16_t{-640});
    number(std::int16_t{480});
    end_of_row();
  }

  void write_vertex(std::size_t i) {
    const auto n_neighbours = static_cast<std::uint8_t>(i % 3);
    if (style_.extras) {
      number(n_neighbours);
      for (std::uint8_t k = 0; k < n_neighbours; ++k) number(std::int32_t{k});
    }
    const auto coordinate = [&](int axis) {
      real(mesh_.nodes[i][axis], style_.binary ? "" : coordinate_text(i, axis));
    };
    coordinate(1);
    if (style_.extras) number(std::uint8_t{200});
    coordinate(0);
    coordinate(2);
    if (style_.extras) number(std::numeric_limits<float>::quiet_NaN(), "nan");
    if (style_.normals)
      for (int k = 0; k < 3; ++k) real(normals.empty() ? 0.0 : normals[i][k]);
    end_of_row();
  }

  void write_face(std::span<const Index> face) {
    if (style_.extras) {
      number(std::int16_t{-3});
      number(static_cast<std::uint32_t>(face.size()));
      for (const Index node : face) number(static_cast<std::uint32_t>(node));
      number(std::uint8_t{2});
      number(0.25F);
      number(0.75F);
    } else {
      number(static_cast<std::uint8_t>(face.size()));
      for (const Index node : face) number(std::int32_t{node});
    }
    end_of_row();
  }

  void write_tail() {
    for (const double shine : {0.1, 0.9}) {
      number(shine);
      end_of_row();
    }
  }

  const Mesh& mesh_;
  PlyStyle style_;
  std::string bytes_;
};

}  // namespace roughmesh::test
