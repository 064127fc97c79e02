// SPDX-License-Identifier: BSD-3-Clause
#include "io_patch.hpp"

#include <bit>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "file_formats.hpp"
#include "scanner.hpp"

namespace roughmesh::detail {

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same_bits(const Vec3& a, const Vec3& b) {
  return same_bits(a[0], b[0]) && same_bits(a[1], b[1]) && same_bits(a[2], b[2]);
}

double as_stored(const MeshSource& source, double value) {
  return source.coordinates == NumberFormat::float32 ? static_cast<float>(value) : value;
}

void TriplePatcher::replace(std::uint64_t offset, const Vec3& from, const Vec3& to) {
  copy_until(offset);
  for (int k = 0; k < 3; ++k) {
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
  for (int k = 0; k < 3; ++k) {
    copy_space();
    skip_number();
    write_number(to[k]);
  }
}

void TriplePatcher::copy_until(std::uint64_t offset) {
  output_->write(source_->file.view().substr(position_, offset - position_));
  position_ = offset;
}

void TriplePatcher::copy_space() {
  if (source_->coordinates != NumberFormat::text) return;
  std::uint64_t stop = position_;
  while (is_space(source_->file.data[stop])) ++stop;
  copy_until(stop);
}

void TriplePatcher::skip_number() {
  if (source_->coordinates != NumberFormat::text) {
    position_ += source_->coordinates == NumberFormat::float32 ? sizeof(float) : sizeof(double);
    return;
  }
  while (position_ < source_->file.size && !is_space(source_->file.data[position_])) ++position_;
}

void TriplePatcher::write_number(double value) {
  const double stored = as_stored(*source_, value);
  if (!std::isfinite(stored))
    throw InputError(fmt::format("{}: a coordinate of {} cannot be stored; check the displacement",
                                 output_->path().string(), value));
  if (source_->coordinates == NumberFormat::float32) return write_bytes(static_cast<float>(stored));
  if (source_->coordinates == NumberFormat::float64) return write_bytes(stored);
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

std::string shortest(double value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return {text, end};
}

void write_patched(const Mesh& mesh, OutputFile& output) {
  const MeshSource& source = *mesh.source;
  TriplePatcher patcher(source, output);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (!same_bits(source.positions[i], mesh.nodes[i]))
      patcher.replace(source.offsets[i], source.positions[i], mesh.nodes[i]);
  patcher.finish();
}

}  // namespace roughmesh::detail
