// SPDX-License-Identifier: BSD-3-Clause
// PLY: a header of text that declares elements and their properties, then their values as text or
// bytes. Format: G. Turk (1994), The PLY Polygon File Format,
// http://gamma.cs.unc.edu/POWERPLANT/papers/ply.pdf
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "file_formats.hpp"
#include "scanner.hpp"

namespace roughmesh::detail {

enum class PlyType : std::uint8_t {
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64
};

std::size_t size_of(PlyType type);
inline bool is_real(PlyType type) { return type >= PlyType::float32; }

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count = {};  ///< of a list: the type of its length
};

struct PlyElement {
  std::string name;
  Tag count = 0;
  std::size_t declared_at = 0;  ///< offset of its line in the header
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  Encoding encoding = Encoding::text;
  bool swap_bytes = false;
  std::vector<PlyElement> elements;   ///< in the order of the file
  std::vector<PhysicalGroup> groups;  ///< names in comments of our own
  const PlyElement* find(std::string_view name) const;
};

/// Leaves the scanner behind the header, in the encoding that it declares.
/// @throws FormatError
PlyHeader read_ply_header(Scanner& scanner);

/// Which property of a vertex is which coordinate (0 to 2) or component of its normal (3 to 5).
struct PlyVertexLayout {
  static constexpr int other = -1;
  static constexpr int normal = 3;

  explicit PlyVertexLayout(const PlyElement& vertex);

  std::vector<int> roles;                           ///< one for each property
  std::array<const PlyProperty*, 3> coordinates{};  ///< null where missing
  bool has_normals = false;                         ///< all three, of a real type
};

/// A number as the header declares it. The properties of a text file must not be lists.
double ply_real(Scanner& scanner, PlyType type);
Tag ply_integer(Scanner& scanner, PlyType type);
void skip_ply_property(Scanner& scanner, const PlyProperty& property);

/// Cell data by which roughmesh keeps physical groups in a PLY file.
inline constexpr std::string_view ply_group = "physical_group";

void write_patched_ply(const Mesh& mesh, OutputFile& output);
void check_ply(const Mesh& mesh, const std::filesystem::path& path);
void write_new_ply(const Mesh& mesh, const WriteOptions& options, OutputFile& output);

}  // namespace roughmesh::detail
