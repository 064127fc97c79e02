// SPDX-License-Identifier: BSD-3-Clause
// What roughmesh knows of each file format, in one table. A new format is one io_*.cpp that
// declares its FileFormat here, and a line in file_formats.cpp.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "roughmesh/mesh.hpp"
#include "roughmesh/mesh_io.hpp"

#include "mesh_source.hpp"
#include "output_file.hpp"

namespace roughmesh::detail {

/// What a file written anew in a format holds beside positions and connectivity.
struct Holds {
  bool groups = false;          ///< numbers of physical groups
  bool several_groups = false;  ///< an element may be in more than one
  bool group_names = false;
  bool periodic_links = false;
  bool tags = false;           ///< numbers of nodes and elements
  bool point_fields = false;   ///< WriteOptions::fields
  bool group_numbers = true;   ///< where it holds groups; else it holds them by name only
  bool quadrangles = true;     ///< else each is written as two triangles
  bool full_precision = true;  ///< positions as float64
  int least_dimension = 0;     ///< of elements; others are left out
  int most_dimension = 3;
};

struct FileFormat {
  MeshFormat format = MeshFormat::none;
  /// In lower case; the first is the usual one. Of formats that share an extension, the first in
  /// the table has it by default.
  std::vector<std::string_view> extensions = {};
  /// How a good file begins, for the message about one that does not; for example "begin with ply".
  std::string_view beginning = {};

  /// Is this a file of the format? `extension` is in lower case.
  bool (*recognizes)(std::string_view bytes, std::string_view extension) = nullptr;
  Mesh (*read)(FileBytes file) = nullptr;
  /// Copies the source with the numbers of moved nodes replaced.
  void (*write_patched)(const Mesh& mesh, OutputFile& output) = nullptr;

  /// Refuses a mesh that the format cannot hold, whatever its positions are.
  /// @throws InputError
  void (*check_new)(const Mesh& mesh, const std::filesystem::path& path) = nullptr;
  /// From the arrays alone, of a mesh that passed the check. Null if never written anew.
  void (*write_new)(const Mesh& mesh, const WriteOptions& options, OutputFile& output) = nullptr;
  Holds holds = {};
  std::optional<Holds> text_holds = {};  ///< where a text file holds something else
  /// Phrases for what `holds` cannot tell of. Null if there is nothing.
  std::vector<std::string> (*losses)(const Mesh& mesh) = nullptr;
  /// Largest distance between neighbouring numbers that patching can write at the coordinates of
  /// the mesh; 0, or null, where it is that of the number format.
  double (*spacing)(const Mesh& mesh) = nullptr;
  /// Likewise of a new file. Null where positions are float64, or float32 as `holds` tells.
  double (*new_spacing)(const Mesh& mesh) = nullptr;
  std::vector<Encoding> encodings = {Encoding::text};  ///< of new files, the usual one first
};

extern const FileFormat msh4_format, msh2_format, stl_format, ply_format, off_format, vtk_format,
    medit_format, su2_format, ply2_format, obj_format, abaqus_format, nastran_format, unv_format,
    vtu_format;

/// Every format, in the order in which they are asked whether they recognize a file.
std::span<const FileFormat* const> file_formats();
const FileFormat& file_format(MeshFormat format);  ///< @pre not `none`

/// The format that a file's content and extension show.
/// @throws FormatError  claims by its extension to be of a format that it is not, or is empty
/// @throws InputError   of no format that is read
const FileFormat& recognize(const FileBytes& file);

std::string lower_extension(const std::filesystem::path& path);  ///< with its dot

/// The source with the coordinates of moved nodes replaced, where MeshSource::offsets says where
/// they stand.
void write_patched(const Mesh& mesh, OutputFile& output);

/// @throws InputError  fields whose sizes do not fit, or elements that refer to nodes that are not
void check_arrays(const Mesh& mesh, const std::filesystem::path& path);
/// Elements of an order above `most`, or (where `surface_only`) of dimension 3, are refused.
/// @throws InputError
void check_elements(const Mesh& mesh, const std::filesystem::path& path, int most_order,
                    bool surface_only);

inline constexpr Tag largest_index = std::numeric_limits<Index>::max();

}  // namespace roughmesh::detail
