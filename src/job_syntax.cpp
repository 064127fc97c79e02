// SPDX-License-Identifier: BSD-3-Clause
#include "job_syntax.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "roughmesh/error.hpp"

namespace roughmesh::detail {
namespace {

[[noreturn]] void refuse_depth(const std::string& source, std::size_t line) {
  throw FormatError(
      fmt::format("{}:{}: more than {} lists or tables within each other; no option needs as many",
                  source, line, deepest_job));
}

std::size_t line_at(std::string_view text, std::size_t place) {
  return 1 + static_cast<std::size_t>(
                 std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(place), '\n'));
}

bool begins_key(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == '"' || c == '\'';
}

// Follows TOML as far as brackets, dots and what hides them: strings and comments. Where a text is
// no TOML it may lose its way, but not before toml++ gives up.
class TomlScan {
 public:
  TomlScan(std::string_view text, const std::string& source) : text_(text), source_(source) {}

  void run() {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // the mark of UTF-8
    while (at_ < text_.size()) step();
  }

 private:
  char here(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }

  void step() {
    const char c = here();
    if (c == '"' || c == '\'') return skip_string(c);
    if (c == '#') return skip_to_line_end();
    require_ascii();
    if (c == '[' && in_key_ && open_.empty()) check_header();
    if (c == '[' || c == '{') open_.push_back(c);
    if (c == ']' || c == '}') close(c);
    if (c == '\n' || c == '=' || c == ',' || c == '[' || c == '{') n_dots_ = 0;
    if (c == '.') ++n_dots_;
    if (c == '=') in_key_ = false;
    if (c == '\n' && open_.empty()) in_key_ = true;
    if (open_.size() > deepest_job || n_dots_ >= deepest_job)
      refuse_depth(source_, line_at(text_, at_));
    ++at_;
  }

  // toml++ 3.3 takes for granted that no other bracket stands where a value is due.
  void close(char bracket) {
    const char due = open_.empty() ? '\0' : open_.back() == '[' ? ']' : '}';
    if (bracket != due)
      throw FormatError(fmt::format("{}:{}: not TOML: {} closes what was not opened", source_,
                                    line_at(text_, at_), bracket));
    open_.pop_back();
  }

  void skip_to_line_end() { at_ = std::min(text_.find('\n', at_), text_.size()); }

  void skip_string(char quote) {
    const bool is_long = here(1) == quote && here(2) == quote;
    at_ += is_long ? 3 : 1;
    for (; at_ < text_.size(); ++at_) {
      if (here() == '\\' && quote == '"')
        skip_escape();
      else if (here() == '\n' && !is_long)
        return;  // an error, which toml++ tells
      else if (here() == quote && (!is_long || (here(1) == quote && here(2) == quote)))
        break;
    }
    // A long string may end with quotes of its own, up to two before the three.
    for (int n = 0; n < (is_long ? 5 : 1) && here() == quote; ++n) ++at_;
  }

  // Up to the last sign of an escape sequence: the second one, or the end of the space that a
  // backslash at the end of a line takes away.
  void skip_escape() {
    ++at_;
    const std::size_t next = text_.find_first_not_of(" \t\r\n", at_);
    if (next == at_ || next == text_.npos) return;
    at_ = next;
    require_ascii();
    --at_;
  }

  // Where toml++ 3.3 looks for space, some letters beyond ASCII lead it astray.
  void require_ascii() const {
    if (static_cast<unsigned char>(here()) < 0x80) return;
    throw FormatError(fmt::format(
        "{}:{}: not TOML: a sign beyond ASCII, perhaps a no-break space, where a key, a number or "
        "a space is expected; write texts between quotes",
        source_, line_at(text_, at_)));
  }

  // toml++ 3.3 takes for granted that a key follows.
  void check_header() const {
    std::size_t next = at_ + (here(1) == '[' ? 2 : 1);
    next = text_.find_first_not_of(" \t", next);
    if (next == text_.npos || begins_key(text_[next]) || text_[next] == ']' ||
        static_cast<unsigned char>(text_[next]) >= 0x80)  // told in its place
      return;
    throw FormatError(fmt::format("{}:{}: not TOML: a table without a name; write [[surface]]",
                                  source_, line_at(text_, at_)));
  }

  std::string_view text_;
  const std::string& source_;
  std::size_t at_ = 0;
  bool in_key_ = true;      ///< before the = of a line
  std::string open_;        ///< brackets that are
  std::size_t n_dots_ = 0;  ///< of one key
};

}  // namespace

void check_json_syntax(std::string_view text, const std::string& source) {
  std::size_t depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') in_string = !in_string;
    if (in_string && c == '\\') ++i;
    if (in_string) continue;
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && depth > 0) --depth;
    if (depth > deepest_job) refuse_depth(source, line_at(text, i));
  }
}

void check_toml_syntax(std::string_view text, const std::string& source) {
  TomlScan(text, source).run();
}

std::string one_line(std::string_view text) {
  std::string line(text);
  std::replace_if(
      line.begin(), line.end(),
      [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }, '?');
  return line;
}

}  // namespace roughmesh::detail
