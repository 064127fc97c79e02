// SPDX-License-Identifier: BSD-3-Clause
#include "io_patch.hpp"

#include <bit>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "decimals.hpp"
#include "file_formats.hpp"
#include "node_vectors.hpp"
#include "scanner.hpp"

namespace roughmesh::detail {

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same_bits(const Vec3& a, const Vec3& b) {
  return same_bits(a[0], b[0]) && same_bits(a[1], b[1]) && same_bits(a[2], b[2]);
}

double as_stored(NumberFormat format, double value) {
  return format == NumberFormat::float32 ? static_cast<float>(value) : value;
}

double as_stored(const MeshSource& source, double value) {
  return as_stored(source.coordinates, value);
}

void TriplePatcher::replace(std::uint64_t offset, const Vec3& from, const Vec3& to) {
  copy_until(offset);
  for (int k = 0; k < source_->n_coordinates; ++k) {
    copy_space();
    const std::uint64_t start = position_;
    skip_number();
    if (same_bits(from[k], to[k]))
      output_->write(source_->file.view().substr(start, position_ - start));
    else
      write_number(to[k]);
  }
}

void TriplePatcher::replace(std::uint64_t offset, const Vec3& to) {
  copy_until(offset);
  for (int k = 0; k < source_->n_coordinates; ++k) {
    copy_space();
    skip_number();
    write_number(to[k]);
  }
}

void TriplePatcher::replace_number(std::uint64_t offset, std::size_t n_bytes, NumberFormat format,
                                   double value) {
  copy_until(offset);
  position_ += n_bytes;
  const NumberFormat usual = std::exchange(format_, format);
  write_number(value);
  format_ = usual;
}

void TriplePatcher::copy_until(std::uint64_t offset) {
  output_->write(source_->file.view().substr(position_, offset - position_));
  position_ = offset;
}

void TriplePatcher::copy_space() {
  if (format_ != NumberFormat::text) return;
  const char* const bytes = source_->file.data.get();
  std::uint64_t stop = position_;
  for (; stop < source_->file.size; ++stop) {
    if (is_comment(bytes[stop]))
      while (stop < source_->file.size && bytes[stop] != '\n') ++stop;
    else if (!is_space(bytes[stop]))
      break;
  }
  copy_until(stop);
}

bool TriplePatcher::is_comment(char c) const {
  return source_->comment != '\0' && c == source_->comment;
}

void TriplePatcher::skip_number() {
  if (format_ != NumberFormat::text) {
    position_ += format_ == NumberFormat::float32 ? sizeof(float) : sizeof(double);
    return;
  }
  const char* const bytes = source_->file.data.get();
  while (position_ < source_->file.size && !is_space(bytes[position_]) &&
         !is_comment(bytes[position_]))
    ++position_;
}

void TriplePatcher::write_number(double value) {
  const double stored = as_stored(format_, value);
  if (!std::isfinite(stored))
    throw InputError(fmt::format("{}: a coordinate of {} cannot be stored; check the displacement",
                                 output_->path().string(), value));
  if (format_ == NumberFormat::float32) return write_bytes(static_cast<float>(stored));
  if (format_ == NumberFormat::float64) return write_bytes(stored);
  output_->write(shortest(stored));
}

template <typename T>
void TriplePatcher::write_bytes(T value) {
  if (source_->swap_bytes) value = reverse_bytes(value);
  output_->write({reinterpret_cast<const char*>(&value), sizeof value});
}

void TextPatcher::replace(std::string_view span, std::string_view text) {
  const std::string_view file = source_->file.view();
  const auto begin = static_cast<std::size_t>(span.data() - file.data());
  output_->write(file.substr(position_, begin - position_));
  output_->write(text);
  position_ = begin + span.size();
}

void TextPatcher::finish() { output_->write(source_->file.view().substr(position_)); }

std::vector<bool> has_moved(const Mesh& mesh) {
  std::vector<bool> moved(mesh.nodes.size());
  for (std::size_t i = 0; i < moved.size(); ++i)
    moved[i] = !same_bits(mesh.nodes[i], mesh.source->positions[i]);
  return moved;
}

namespace {

void check_plane(const Mesh& mesh, Index node, const OutputFile& output) {
  const double z = mesh.nodes[node][2];
  if (mesh.source->n_coordinates == 2 && z != 0)
    throw InputError(
        fmt::format("{}: node {} has left the plane (z = {}), but the file has no z; convert it "
                    "to a mesh in space first",
                    output.path().string(), mesh.node_tags[node], z));
}

}  // namespace

void write_patched(const Mesh& mesh, OutputFile& output) {
  const MeshSource& source = *mesh.source;
  const std::vector<MovedVector> vectors = moved_vectors(mesh);
  auto vector = vectors.begin();
  TriplePatcher patcher(source, output);
  const auto replace_vectors_before = [&](std::uint64_t offset) {
    patcher.set_format(source.vector_numbers);
    for (; vector != vectors.end() && vector->offset < offset; ++vector)
      patcher.replace(vector->offset, vector->value);
    patcher.set_format(source.coordinates);
  };
  for (Index i = 0; i < mesh.n_nodes(); ++i) {
    if (same_bits(source.positions[i], mesh.nodes[i])) continue;
    check_plane(mesh, i, output);
    replace_vectors_before(source.offsets[i]);
    patcher.replace(source.offsets[i], source.positions[i], mesh.nodes[i]);
  }
  replace_vectors_before(source.file.size);
  patcher.finish();
}

}  // namespace roughmesh::detail
