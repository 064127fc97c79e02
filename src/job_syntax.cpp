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

bool is_ascii(char c) { return static_cast<unsigned char>(c) < 0x80; }

bool is_letter_or_digit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

bool begins_key(char c) {
  return is_letter_or_digit(c) || c == '_' || c == '-' || c == '"' || c == '\'';
}

// A run of digits, with underscores between.
std::size_t end_of_digits(std::string_view word, std::size_t begin, std::string_view digits) {
  if (begin >= word.size() || digits.find(word[begin]) == digits.npos) return word.npos;
  return std::min(word.find_first_not_of(std::string(digits) + '_', begin), word.size());
}

bool is_whole_number(std::string_view word) {
  for (const auto& [prefix, digits] : {std::pair{"0x", "0123456789abcdefABCDEF"},
                                       std::pair{"0o", "01234567"}, std::pair{"0b", "01"}})
    if (word.starts_with(prefix)) return end_of_digits(word, 2, digits) == word.size();
  return false;
}

bool is_decimal_number(std::string_view word) {
  static constexpr std::string_view digits = "0123456789";
  std::size_t end = end_of_digits(word, 0, digits);
  if (end < word.size() && word[end] == '.') end = end_of_digits(word, end + 1, digits);
  if (end < word.size() && (word[end] == 'e' || word[end] == 'E')) {
    ++end;
    if (end < word.size() && (word[end] == '+' || word[end] == '-')) ++end;
    end = end_of_digits(word, end, digits);
  }
  return end == word.size();
}

bool is_number_or_truth(std::string_view word) {
  if (word == "true" || word == "false" || is_whole_number(word)) return true;
  if (word.starts_with('+') || word.starts_with('-')) word.remove_prefix(1);
  return word == "inf" || word == "nan" || is_decimal_number(word);
}

bool begins_date(std::string_view word) {
  const std::size_t end = word.find_first_not_of("0123456789");
  return (end == 4 && word[end] == '-') || (end == 2 && word[end] == ':');
}

// Reads the signs of TOML without their meaning. toml++ 3.3 looks for space around keys and values,
// where signs beyond ASCII lead it astray; so this must know as well as toml++ where a text or a
// comment begins and ends. Where a text is no TOML it may lose its way, but not before toml++ gives
// up: outside of texts and comments, only what may begin, end or part keys and values is let
// through.
class TomlScan {
 public:
  TomlScan(std::string_view text, const std::string& source) : text_(text), source_(source) {}

  void run() {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // the mark of UTF-8
    while (at_ < text_.size()) step();
  }

 private:
  enum class Due { line, key, value, nothing };  ///< what may begin here; a line: a key or a header

  char here(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }

  char inside() const { return open_.empty() ? '\0' : open_.back(); }

  void step() {
    require_ascii();
    const char c = here();
    if (c == '#') return skip_to_line_end();
    if (c == '"' || c == '\'') return pass_text(c);
    if (in_word(c)) return pass_word();
    pass_sign(c);
    if (open_.size() > deepest_job || n_dots_ >= deepest_job)
      refuse_depth(source_, line_at(text_, at_));
    ++at_;
  }

  void pass_sign(char c) {
    switch (c) {
      case ' ':
      case '\t':
      case '\r':
        return;
      case '\n':
        return end_line();
      case '.':
        return part_key();
      case '=':
        return part_pair();
      case ',':
        return part_list();
      case '[':
      case '{':
        return open(c);
      case ']':
      case '}':
        return close(c);
      default:
        refuse_sign(c);
    }
  }

  void end_line() {
    if (open_.empty()) begin_pair(Due::line);
  }

  void begin_pair(Due due) {
    due_ = due;
    in_key_ = true;
    n_dots_ = 0;
  }

  void part_key() {
    if (!in_key_ || due_ != Due::nothing) refuse_sign('.');
    due_ = Due::key;
    ++n_dots_;
  }

  void part_pair() {
    if (!in_key_ || due_ != Due::nothing || inside() == header) refuse_sign('=');
    due_ = Due::value;
    in_key_ = false;
  }

  void part_list() {
    if (due_ != Due::nothing || (inside() != '[' && inside() != '{')) refuse_sign(',');
    if (inside() == '[')
      due_ = Due::value;
    else
      begin_pair(Due::key);
  }

  void open(char bracket) {
    if (bracket == '[' && due_ == Due::line) return open_header();
    if (due_ != Due::value) refuse_sign(bracket);
    open_.push_back(bracket);
    if (bracket == '{') begin_pair(Due::key);
  }

  void open_header() {
    check_header();
    open_.push_back(header);
    if (here(1) == '[') {
      open_.push_back(header);
      ++at_;
    }
    begin_pair(Due::key);
  }

  // toml++ 3.3 takes for granted that no other bracket stands where a value is due.
  void close(char bracket) {
    const char due = open_.empty() ? '\0' : inside() == '{' ? '}' : ']';
    if (bracket != due)
      throw FormatError(fmt::format("{}:{}: not TOML: {} closes what was not opened", source_,
                                    line_at(text_, at_), bracket));
    open_.pop_back();
    due_ = Due::nothing;
    in_key_ = inside() == header;
  }

  bool in_word(char c) const {
    return is_letter_or_digit(c) || c == '_' || c == '-' ||
           (!in_key_ && (c == '.' || c == '+' || c == ':'));
  }

  void pass_word() {
    const std::size_t begin = at_;
    while (in_word(here())) ++at_;
    if (!in_key_) {
      require_end_of_value();
      require_value(text_.substr(begin, at_ - begin));
    }
    due_ = Due::nothing;
  }

  // toml++ 3.3 takes some broken dates for granted; no option needs one.
  void require_value(std::string_view word) const {
    if (due_ != Due::value)
      throw FormatError(fmt::format("{}:{}: not TOML: {:.40} where {} is expected", source_,
                                    line_at(text_, at_), word, expected()));
    if (begins_date(word))
      throw InputError(
          fmt::format("{}:{}: {:.40}: dates and times are no option values; write a "
                      "number, true or false, or text between quotes",
                      source_, line_at(text_, at_), word));
    if (!is_number_or_truth(word))
      throw FormatError(
          fmt::format("{}:{}: {:.40} is neither a number nor true or false; numbers have digits on "
                      "both sides of the point, texts stand between quotes",
                      source_, line_at(text_, at_), word));
  }

  // toml++ 3.3 takes all signs up to these for a part of the number.
  void require_end_of_value() const {
    const bool ends = at_ == text_.size() ||
                      std::string_view(" \t\r\n,]}#").find(here()) != std::string_view::npos;
    if (!ends && is_ascii(here())) refuse_sign(here());
  }

  void skip_to_line_end() { at_ = std::min(text_.find('\n', at_), text_.size()); }

  void pass_text(char quote) {
    if (due_ == Due::nothing) refuse_sign(quote);
    due_ = Due::nothing;
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
    if (next == text_.npos) return;
    const bool is_space = next > at_;
    at_ = next;
    require_ascii();
    if (is_space) --at_;
  }

  // Where toml++ 3.3 looks for space, some letters beyond ASCII lead it astray.
  void require_ascii() const {
    if (is_ascii(here())) return;
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
        !is_ascii(text_[next]))  // told in its place
      return;
    throw FormatError(fmt::format("{}:{}: not TOML: a table without a name; write [[surface]]",
                                  source_, line_at(text_, at_)));
  }

  [[noreturn]] void refuse_sign(char c) const {
    const bool is_quote = c == '"' || c == '\'', is_printed = c > ' ' && c < '\x7f';
    const std::string sign = is_quote     ? "text in quotes"
                             : is_printed ? std::string(1, c)
                                          : fmt::format("control character {}", int{c});
    throw FormatError(fmt::format("{}:{}: not TOML: {} where none is expected, but {}", source_,
                                  line_at(text_, at_), sign, expected()));
  }

  std::string_view expected() const {
    if (due_ == Due::value) return "a value";
    if (due_ != Due::nothing) return "a key";
    if (inside() == header) return "]";
    if (in_key_) return "=";
    if (open_.empty()) return "the end of the line";
    return inside() == '[' ? "a comma or ]" : "a comma or }";
  }

  static constexpr char header = 'h';  ///< among open_, of a header's bracket
  std::string_view text_;
  const std::string& source_;
  std::size_t at_ = 0;
  Due due_ = Due::line;
  bool in_key_ = true;      ///< before the = of a pair, or in a header
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

}  // namespace roughmesh::detail
