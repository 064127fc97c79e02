// SPDX-License-Identifier: BSD-3-Clause
// Splits a geometry script as Gmsh's scanner does.
#include <algorithm>
#include <utility>

#include "geo_script.hpp"

namespace roughmesh::detail {
namespace {

// Gmsh's scanner takes in a line at once, or a piece of its buffer's size of a longer one (8 kB or
// more); a loop goes back to such a boundary. Below this length there is none inside a line.
constexpr std::size_t longest_line_at_once = 4000;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

class Tokenizer {
 public:
  explicit Tokenizer(std::string_view script) : script_(script) {}

  std::vector<ScriptToken> run() {
    while (position_ < script_.size()) step();
    return std::move(tokens_);
  }

 private:
  char at(std::size_t i) const { return i < script_.size() ? script_[i] : '\0'; }

  void step() {
    const char c = at(position_);
    const char next = at(position_ + 1);
    if (c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\n')
      skip_space(c);
    else if (c == '/' && next == '*')
      add_enclosed(TokenKind::comment, position_ + 2, "*/");
    else if (c == '/' && next == '/')
      add_line_comment();
    else if (c == '"' || c == '\'')
      add_enclosed(TokenKind::string, position_ + 1, c == '"' ? "\"" : "'");
    else if (is_letter(c))
      add_word();
    else if (is_digit(c) || (c == '.' && is_digit(next)))
      add(TokenKind::number, end_of_number());
    else
      add(TokenKind::symbol, position_ + (c == '>' && (next == '>' || next == '=') ? 2 : 1));
  }

  void skip_space(char c) {
    ++position_;
    if (c == '\n') begin_line();
  }

  void begin_line() {
    ++line_;
    line_start_ = position_;
  }

  void add(TokenKind kind, std::size_t end) {
    tokens_.push_back({.kind = kind, .text = part(position_, end), .line = line_});
    position_ = end;
  }

  void add_word() {
    std::size_t end = position_;
    while (is_letter(at(end)) || is_digit(at(end))) ++end;
    add(TokenKind::word, end);
  }

  std::size_t end_of_number() const {
    std::size_t end = position_;
    while (is_digit(at(end))) ++end;
    if (at(end) == '.') ++end;
    while (is_digit(at(end))) ++end;
    if (at(end) != 'e' && at(end) != 'E') return end;
    std::size_t exponent = end + 1;
    if (at(exponent) == '+' || at(exponent) == '-') ++exponent;
    if (!is_digit(at(exponent))) return end;
    while (is_digit(at(exponent))) ++exponent;
    return exponent;
  }

  // A carriage return does not end a comment: Gmsh waits for the line feed.
  void add_line_comment() {
    const std::size_t end = std::min(script_.find('\n', position_), script_.size());
    tokens_.push_back({.kind = TokenKind::comment,
                       .text = part(position_ + 2, end),
                       .line = line_,
                       .is_exposed = is_far_from_line_start(end)});
    position_ = end;
  }

  void add_enclosed(TokenKind kind, std::size_t begin, std::string_view closing) {
    const std::size_t found = script_.find(closing, begin);
    const std::size_t end = std::min(found, script_.size());
    ScriptToken token{.kind = kind, .text = part(begin, end), .line = line_};
    token.is_closed = found != std::string_view::npos;
    token.is_exposed = is_far_from_line_start(end);
    for (position_ = begin; position_ < end;)
      if (script_[position_++] == '\n') {
        begin_line();
        token.is_exposed = true;
      }
    if (token.is_closed) position_ = end + closing.size();
    tokens_.push_back(token);
  }

  bool is_far_from_line_start(std::size_t end) const {
    return end - line_start_ > longest_line_at_once;
  }

  std::string_view part(std::size_t begin, std::size_t end) const {
    return script_.substr(begin, end - begin);
  }

  std::string_view script_;
  std::vector<ScriptToken> tokens_;
  std::size_t position_ = 0;
  std::size_t line_ = 1;
  std::size_t line_start_ = 0;
};

}  // namespace

std::vector<ScriptToken> tokens_of(std::string_view script) { return Tokenizer(script).run(); }

}  // namespace roughmesh::detail
