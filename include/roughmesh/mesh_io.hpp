// SPDX-License-Identifier: BSD-3-Clause
// Mesh files: everything but the coordinates of moved nodes comes out as it went in
// (docs/files.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "roughmesh/error.hpp"
#include "roughmesh/mesh.hpp"

namespace roughmesh {

/// Reads every format of MeshFormat but VTU, in each of its encodings (docs/files.md). The kind of
/// file is told by its content; the extension decides only where the content leaves it open (OBJ,
/// PLY2, bulk data). Corners of an STL at exactly equal positions become one node.
///
/// @throws InputError   missing, unreadable, a directory, or of a kind that roughmesh does not read
/// @throws FormatError  cut short, wrong counts, dangling node numbers, NaN: file, line or byte,
/// section
Mesh read_mesh(const std::filesystem::path& path);

/// Values at the nodes of a mesh, for formats that carry them (VTU, legacy VTK, PLY).
struct PointField {
  std::string name;
  int n_components = 1;
  std::vector<double> values;  ///< n_nodes * n_components, node by node
};

enum class Encoding : std::uint8_t { text, binary };

struct WriteOptions {
  std::vector<PointField> fields = {};    ///< for formats that carry them, else left out
  std::optional<MeshFormat> format = {};  ///< default: by extension; .msh stays what it was
  std::optional<Encoding> encoding = {};  ///< default: that of the source, else the usual one
};

/// Writes the mesh. Where only positions differ from what read_mesh returned, and format and
/// encoding are those of that file: the bytes of the source are copied and only the numbers of
/// nodes whose position changed are replaced (shortest decimals that read back exactly in ASCII
/// files); what depends on them, like facet normals of an STL, is computed anew. Any other mesh is
/// written anew from its arrays, as far as the format holds it: conversion_losses() tells what is
/// left behind.
///
/// The file appears whole or not at all: it is written beside `path` and renamed. `path` may be the
/// file the mesh was read from.
///
/// @throws InputError  unknown extension; elements that the format lacks or that are not written
///                     anew in it; no permission, full disk
void write_mesh(const Mesh& mesh, const std::filesystem::path& path,
                const WriteOptions& options = {});

/// What a file at `path` would not hold of the mesh (docs/files.md): one phrase each, such as
/// "periodic links" or "names of 3 groups". Empty when the source is copied.
/// @throws InputError  as write_mesh would, before anything is written
std::vector<std::string> conversion_losses(const Mesh& mesh, const std::filesystem::path& path,
                                           const WriteOptions& options = {});

/// Would write_mesh() put WriteOptions::fields into a file at `path`?
/// @throws InputError  as write_mesh would, before anything is written
bool carries_fields(const Mesh& mesh, const std::filesystem::path& path,
                    const WriteOptions& options = {});

/// Would a file at `path` hold the volume elements of the mesh?
/// @throws InputError  as write_mesh would, before anything is written
bool carries_volumes(const Mesh& mesh, const std::filesystem::path& path,
                     const WriteOptions& options = {});

/// Writes text the same way: whole or not at all. For reports beside meshes.
void write_text(const std::string& text, const std::filesystem::path& path);

/// Finds out before a long run whether write_mesh could write the mesh to `path` now, whatever its
/// positions become; leaves nothing behind. A pipe is not tried.
///
/// @throws InputError  as write_mesh would: extension, elements that the format lacks, missing
/// folder, no permission, a directory
void check_output(const Mesh& mesh, const std::filesystem::path& path,
                  const WriteOptions& options = {});

/// Likewise for write_text.
void check_text_output(const std::filesystem::path& path);

/// 16 hexadecimal digits of the XXH3 hash (64 bits) of the bytes of the file the mesh was read
/// from, as `xxhsum -H3` prints them; empty for a mesh made in memory. Finds mix-ups, not
/// forgeries.
std::string checksum(const Mesh& mesh);

/// Largest distance between neighbouring numbers of the source's number format at the coordinates
/// of the mesh: 2^-23 of a coordinate's binade for float32 (binary STL, most PLY), a unit of the
/// last digit of a field of 16 characters for Nastran, 2^-52 of the binade otherwise. A length.
double coordinate_spacing(const Mesh& mesh);

/// Likewise of the numbers that write_mesh() would put into a file at `path`: float32 in a new
/// binary STL whatever was read, float64 in most new files, those of the source where it is copied.
/// @throws InputError  as write_mesh would, before anything is written
double coordinate_spacing(const Mesh& mesh, const std::filesystem::path& path,
                          const WriteOptions& options = {});

/// Removes what an unfinished write_mesh or write_text left beside its path; kills a gmsh that runs
/// for mesh_geometry and removes its temporary folder. Async-signal-safe: for the handler of an
/// interrupt, after which the process must end.
void discard_unfinished_files() noexcept;

}  // namespace roughmesh
