// SPDX-License-Identifier: BSD-3-Clause
#include "scanner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace roughmesh::detail {

void Scanner::set_encoding(Encoding encoding, bool swap_bytes) {
  encoding_ = encoding;
  swap_bytes_ = swap_bytes;
}

void Scanner::skip(std::size_t n_bytes) {
  if (n_bytes > remaining()) fail(cut_short);
  position_ += n_bytes;
}

std::string_view Scanner::line() {
  const char* const start = position_;
  const char* const stop = std::find(start, end_, '\n');
  position_ = stop == end_ ? end_ : stop + 1;
  std::string_view text(start, static_cast<std::size_t>(stop - start));
  if (text.ends_with('\r')) text.remove_suffix(1);
  return text;
}

std::string_view Scanner::text_token() {
  skip_space();
  const char* const start = position_;
  position_ = std::find_if(position_, end_, is_space);
  return {start, static_cast<std::size_t>(position_ - start)};
}

Tag Scanner::text_integer(std::string_view token) {
  position_ = token.data();
  const char* const whole = std::exchange(end_, token.data() + token.size());
  const Tag value = text_integer();
  end_ = whole;
  return value;
}

double Scanner::text_real(std::string_view token) {
  position_ = token.data();
  const char* const whole = std::exchange(end_, token.data() + token.size());
  const double value = text_real();
  end_ = whole;
  return value;
}

Tag Scanner::size() {
  const std::size_t start = offset();
  const Tag value =
      encoding_ == Encoding::text ? text_integer() : static_cast<Tag>(bytes<std::uint64_t>());
  if (value < 0)
    fail_at(start, "a count or number is negative or above 2^63 - 1: the file is damaged");
  return value;
}

double Scanner::real() {
  if (encoding_ == Encoding::text) return text_real();
  const std::size_t start = offset();
  const double value = bytes<double>();
  if (!std::isfinite(value))
    fail_at(start, "a number is not finite: mend it or make the mesh anew");
  return value;
}

void Scanner::skip_number(std::size_t n_bytes) {
  if (encoding_ == Encoding::binary) return skip(n_bytes);
  if (text_token().empty()) fail(cut_short);
}

std::size_t Scanner::count(Tag n, std::size_t min_bytes_each, std::string_view things) const {
  if (n < 0) fail(fmt::format("the number of {} is {}; it cannot be negative", things, n));
  // A file may lack the end of its last line, hence one byte more than remains.
  const auto size = static_cast<std::uint64_t>(n);
  if (size > (remaining() + 1) / min_bytes_each)
    fail(
        fmt::format("{} {} do not fit into the {} bytes that remain: the file is cut short or the "
                    "count is wrong",
                    n, things, remaining()));
  return size;
}

void Scanner::fail(std::string_view what) const { fail_at(offset(), what); }

void Scanner::fail_at(std::size_t offset, std::string_view what) const {
  const std::string file = file_->path.string();
  const std::string section = section_.empty() ? "" : printable(section_) + ": ";
  if (encoding_ == Encoding::binary)
    throw FormatError(fmt::format("{}: byte {}: {}{}", file, offset, section, what));
  // Lines are counted only here, so that reading a good file need not count them.
  const char* const start = file_->data.get();
  const auto line = 1 + std::count(start, start + offset, '\n');
  throw FormatError(fmt::format("{}:{}: {}{}", file, line, section, what));
}

void Scanner::refuse(std::string_view what) const {
  throw InputError(fmt::format("{}: {}", file_->path.string(), what));
}

void Scanner::fail_token(std::string_view expected) const {
  if (at_end()) fail(cut_short);
  Scanner ahead = *this;
  fail(fmt::format("expected {}, found {}", expected, quoted(ahead.text_token())));
}

// Reached by everything that is not a finite number within the range of normal doubles.
double Scanner::checked_real(std::from_chars_result result, double value) {
  const bool is_token_end = is_space(*result.ptr) || result.ptr == end_;
  if (result.ec == std::errc() && is_token_end && !std::isfinite(value))
    fail("a number is not finite: mend it or make the mesh anew");
  if (result.ec != std::errc::result_out_of_range || !is_token_end) fail_token("a number");
  const std::string_view token(position_, static_cast<std::size_t>(result.ptr - position_));
  if (token.find("e-") == token.npos && token.find("E-") == token.npos)
    fail(fmt::format("{} is beyond the range of double precision", quoted(token)));
  position_ = result.ptr;
  return 0;  // too small for a double
}

std::string printable(std::string_view text) {
  constexpr std::size_t longest = 24;
  std::string safe(text.substr(0, longest));
  for (char& c : safe)
    if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = '?';
  return text.size() > longest ? safe + "..." : safe;
}

std::string quoted(std::string_view text) { return '"' + printable(text) + '"'; }

FileBytes without_comments(const FileBytes& file, char mark) {
  FileBytes copy{file.path, std::make_unique_for_overwrite<char[]>(file.size + 1), file.size};
  bool is_comment = false;
  for (std::size_t i = 0; i < file.size; ++i) {
    const char c = file.data[i];
    is_comment = c != '\n' && (is_comment || c == mark);
    copy.data[i] = is_comment ? ' ' : c;
  }
  copy.data[file.size] = '\0';
  return copy;
}

}  // namespace roughmesh::detail
