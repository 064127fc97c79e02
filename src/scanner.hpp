// SPDX-License-Identifier: BSD-3-Clause
// Reads numbers, written as text or as bytes, from a file in memory; every failure names the place.
#pragma once

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "roughmesh/error.hpp"
#include "roughmesh/mesh.hpp"
#include "roughmesh/mesh_io.hpp"

#include "mesh_source.hpp"
#include "text.hpp"

namespace roughmesh::detail {

static_assert(std::endian::native == std::endian::little ||
              std::endian::native == std::endian::big);

/// The same value in the other byte order.
template <typename T>
T reverse_bytes(T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

inline bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// A position in the bytes of a file. The numbers of a binary file are read as bytes by integer(),
/// size() and real(), in the file's byte order; text_integer() and text_real() read text in any
/// file.
class Scanner {
 public:
  explicit Scanner(const FileBytes& file)
      : file_(&file), position_(file.data.get()), end_(file.data.get() + file.size) {}

  void set_encoding(Encoding encoding, bool swap_bytes);
  void set_section(std::string section) { section_ = std::move(section); }
  const std::string& section() const { return section_; }
  Encoding encoding() const { return encoding_; }
  bool swap_bytes() const { return swap_bytes_; }

  std::size_t offset() const { return static_cast<std::size_t>(position_ - file_->data.get()); }
  std::size_t remaining() const { return static_cast<std::size_t>(end_ - position_); }
  std::string_view rest() const { return {position_, remaining()}; }
  void move_to(std::size_t offset) { position_ = file_->data.get() + offset; }
  void skip(std::size_t n_bytes);  ///< checked against what remains
  void skip_space() {
    while (is_space(*position_)) ++position_;
  }
  bool at_end() const { return position_ == end_; }
  char peek() const { return *position_; }  ///< '\0' at the end

  std::string_view line();        ///< the rest of the line, without its end; moves behind it
  std::string_view text_token();  ///< characters up to the next space; empty only at the end

  Tag text_integer();
  double text_real();  ///< finite, else it fails

  /// Of a piece of the text that is one number whatever stands behind it; moves to its end.
  Tag text_integer(std::string_view token);
  double text_real(std::string_view token);

  Tag integer() { return encoding_ == Encoding::text ? text_integer() : bytes<std::int32_t>(); }
  Tag size();  ///< 0 to 2^63 - 1
  double real();
  void skip_number(std::size_t n_bytes);  ///< of any kind; so many bytes in a binary file

  template <typename T>
  T bytes() {  ///< a number of a binary file, in the file's byte order
    if (remaining() < sizeof(T)) fail(cut_short);
    T value;
    std::memcpy(&value, position_, sizeof(T));
    position_ += sizeof(T);
    return swap_bytes_ ? reverse_bytes(value) : value;
  }

  /// A number of things of which each takes at least so many bytes: fails where they cannot fit
  /// into what remains, before anything is allocated for them.
  std::size_t count(Tag n, std::size_t min_bytes_each, std::string_view things) const;

  /// @throws FormatError  with file, line or byte, and section
  [[noreturn]] void fail(std::string_view what) const;
  [[noreturn]] void fail_at(std::size_t offset, std::string_view what) const;
  /// @throws InputError  for what may be a good file, but of a kind or size that is not handled
  [[noreturn]] void refuse(std::string_view what) const;

 private:
  [[noreturn]] void fail_token(std::string_view expected) const;
  double checked_real(std::from_chars_result result, double value);

  static constexpr std::string_view cut_short = "the file ends here: it is cut short";

  const FileBytes* file_;
  const char* position_;
  const char* end_;
  Encoding encoding_ = Encoding::text;
  bool swap_bytes_ = false;
  std::string section_;
};

/// For messages: at most 24 characters, nothing that could break a line or a terminal.
std::string printable(std::string_view text);
std::string quoted(std::string_view text);  ///< likewise, in quotes

/// A copy of a text in which comments, from the mark to the end of their line, are spaces: what is
/// read from it stands at the same offsets in the file.
FileBytes without_comments(const FileBytes& file, char mark);

// In the header: a mesh of a million nodes has fifty million integers.
inline Tag Scanner::text_integer() {
  skip_space();
  const char* p = position_;
  const bool is_negative = *p == '-';
  if (is_negative || *p == '+') ++p;
  const char* const first = p;
  std::uint64_t value = 0;
  while (static_cast<unsigned char>(*p - '0') < 10)
    value = value * 10 + static_cast<std::uint64_t>(*p++ - '0');
  // 18 digits never overflow; longer numbers are rare enough to be read again with care.
  if (p == first || p - first > 18 || !(is_space(*p) || p == end_)) [[unlikely]] {
    Tag careful = 0;
    const char* const start = *position_ == '+' ? position_ + 1 : position_;
    const auto [stop, error] = std::from_chars(start, end_, careful);
    if (error != std::errc() || !(is_space(*stop) || stop == end_)) fail_token("a whole number");
    position_ = stop;
    return careful;
  }
  position_ = p;
  return is_negative ? -static_cast<Tag>(value) : static_cast<Tag>(value);
}

inline double Scanner::text_real() {
  skip_space();
  const char* const start = *position_ == '+' ? position_ + 1 : position_;
  double value = 0;
  const std::from_chars_result result = std::from_chars(start, end_, value);
  const bool is_plain = result.ec == std::errc() && (is_space(*result.ptr) || result.ptr == end_) &&
                        value - value == 0;
  if (!is_plain) [[unlikely]]
    return checked_real(result, value);
  position_ = result.ptr;
  return value;
}

}  // namespace roughmesh::detail
