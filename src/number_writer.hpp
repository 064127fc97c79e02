// SPDX-License-Identifier: BSD-3-Clause
// Writes numbers as text or as bytes, so that a format's writer is written once for both.
#pragma once

#include <bit>
#include <string_view>

#include "roughmesh/mesh.hpp"

#include "decimals.hpp"
#include "output_file.hpp"
#include "scanner.hpp"

namespace roughmesh::detail {

class NumberWriter {
 public:
  /// @param order  of the bytes of binary numbers
  NumberWriter(OutputFile& output, Encoding encoding, std::endian order = std::endian::native)
      : output_(&output), encoding_(encoding), swap_bytes_(order != std::endian::native) {}

  bool is_text() const { return encoding_ == Encoding::text; }

  /// As it is, in both encodings.
  void text(std::string_view text) { output_->write(text); }

  /// In text the shortest decimals that read back exactly, with a space between numbers.
  template <typename T>
  void number(T value) {
    if (is_text()) return decimal(value);
    if (swap_bytes_) value = reverse_bytes(value);
    output_->write({reinterpret_cast<const char*>(&value), sizeof value});
  }

  void vector(const Vec3& x) {
    for (int k = 0; k < 3; ++k) number(x[k]);
  }

  void end_line() {  ///< in text only
    if (is_text()) output_->write("\n");
    is_line_start_ = true;
  }

 private:
  template <typename T>
  void decimal(T value) {
    char digits[1 + most_decimals];
    digits[0] = ' ';
    const char* const end = write_decimals(value, digits + 1);
    const char* const start = is_line_start_ ? digits + 1 : digits;
    output_->write({start, static_cast<std::size_t>(end - start)});
    is_line_start_ = false;
  }

  OutputFile* output_;
  Encoding encoding_;
  bool swap_bytes_;
  bool is_line_start_ = true;
};

}  // namespace roughmesh::detail
