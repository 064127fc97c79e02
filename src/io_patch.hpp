// SPDX-License-Identifier: BSD-3-Clause
// Copies a source while replacing some of its numbers.
#pragma once

#include <cstdint>
#include <string>

#include "roughmesh/mesh.hpp"

#include "mesh_source.hpp"
#include "output_file.hpp"

namespace roughmesh::detail {

/// Equal as bits: 0 and -0 differ, so that what was read is what is written.
bool same_bits(double a, double b);
bool same_bits(const Vec3& a, const Vec3& b);

/// Replaces triples of numbers, front to back; everything between them is copied.
class TriplePatcher {
 public:
  TriplePatcher(const MeshSource& source, OutputFile& output)
      : source_(&source), output_(&output) {}

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
  void skip_number();
  void write_number(double value, NumberFormat format);
  template <typename T>
  void write_bytes(T value);

  const MeshSource* source_;
  OutputFile* output_;
  std::uint64_t position_ = 0;  ///< everything before it is written
};

/// The number that a format, or the source's own, holds for a value: nearest float32, or the value
/// itself. Not inline: GCC 12 leaves the rounding out where it vectorizes conversions to float and
/// back.
double as_stored(NumberFormat format, double value);
double as_stored(const MeshSource& source, double value);

}  // namespace roughmesh::detail
