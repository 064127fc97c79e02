// SPDX-License-Identifier: BSD-3-Clause
// Copies a source while replacing some of its numbers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "mesh_source.hpp"
#include "output_file.hpp"

namespace roughmesh::detail {

/// Equal as bits: 0 and -0 differ, so that what was read is what is written.
bool same_bits(double a, double b);
bool same_bits(const Vec3& a, const Vec3& b);

/// For each node, whether its position differs in bits from that in the source.
std::vector<bool> has_moved(const Mesh& mesh);

/// Replaces triples of numbers (pairs in a plane mesh), front to back; everything between them is
/// copied.
class TriplePatcher {
 public:
  TriplePatcher(const MeshSource& source, OutputFile& output)
      : source_(&source), output_(&output), format_(source.coordinates) {}

  /// Of the numbers that follow; at first that of the coordinates.
  void set_format(NumberFormat format) { format_ = format; }

  /// The three numbers that begin at `offset`: each that differs between `from` and `to` is
  /// written anew, each other keeps its bytes.
  /// @throws InputError  a number that is not finite, or too large for float32
  void replace(std::uint64_t offset, const Vec3& from, const Vec3& to);
  void replace(std::uint64_t offset, const Vec3& to);  ///< all three

  /// A single number of so many bytes that begins at `offset`, in a format of its own.
  void replace_number(std::uint64_t offset, std::size_t n_bytes, NumberFormat format, double value);

  void finish() { copy_until(source_->file.size); }

 private:
  void copy_until(std::uint64_t offset);
  void copy_space();
  bool is_comment(char c) const;
  void skip_number();
  void write_number(double value);
  template <typename T>
  void write_bytes(T value);

  const MeshSource* source_;
  OutputFile* output_;
  NumberFormat format_;
  std::uint64_t position_ = 0;  ///< everything before it is written
};

/// Copies a text source while replacing spans of it, front to back.
class TextPatcher {
 public:
  TextPatcher(const MeshSource& source, OutputFile& output) : source_(&source), output_(&output) {}

  /// @param span  a part of the source
  void replace(std::string_view span, std::string_view text);
  void finish();

 private:
  const MeshSource* source_;
  OutputFile* output_;
  std::size_t position_ = 0;  ///< everything before it is written
};

/// Calls replace(patcher, node) for each node that moved, in order, and copies all else.
template <typename Replace>
void patch_moved_nodes(const Mesh& mesh, OutputFile& output, Replace replace) {
  TextPatcher patcher(*mesh.source, output);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (!same_bits(mesh.source->positions[i], mesh.nodes[i])) replace(patcher, i);
  patcher.finish();
}

/// The number that a format, or the source's own, holds for a value: nearest float32, or the value
/// itself. Not inline: GCC 12 leaves the rounding out where it vectorizes conversions to float and
/// back.
double as_stored(NumberFormat format, double value);
double as_stored(const MeshSource& source, double value);

}  // namespace roughmesh::detail
