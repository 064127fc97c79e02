// SPDX-License-Identifier: BSD-3-Clause
#include "geo_script.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "scanner.hpp"

namespace roughmesh::detail {
namespace {

using Tokens = std::vector<ScriptToken>;
using Finding = std::optional<ScriptFinding>;

// Gmsh keeps 1,023 characters of a string and reads the rest as commands.
constexpr std::size_t longest_string = 1000;

bool is_word(const ScriptToken& token) { return token.kind == TokenKind::word; }
bool is_symbol(const ScriptToken& token, std::string_view text) {
  return token.kind == TokenKind::symbol && token.text == text;
}
bool is_hidden(const ScriptToken& token) {
  return token.kind == TokenKind::string || token.kind == TokenKind::comment;
}

// Gmsh ends a comment or string at a zero byte.
Finding find_control_character(std::string_view script) {
  const auto is_odd = [](char c) {
    return static_cast<unsigned char>(c) < 32 && c != '\n' && c != '\t' && c != '\r' && c != '\f';
  };
  const auto found = std::find_if(script.begin(), script.end(), is_odd);
  if (found == script.end()) return {};
  return ScriptFinding{static_cast<std::size_t>(1 + std::count(script.begin(), found, '\n')),
                       "a control character; a geometry script is plain text"};
}

Finding find_odd_string(const ScriptToken& token) {
  if (!is_hidden(token)) return {};
  const char* const thing = token.kind == TokenKind::string ? "string" : "comment";
  if (!token.is_closed) return ScriptFinding{token.line, fmt::format("a {} without end", thing)};
  if (token.kind == TokenKind::string && token.text.size() > longest_string)
    return ScriptFinding{token.line, fmt::format("a string of {} characters, of which Gmsh reads "
                                                 "the end as commands",
                                                 token.text.size())};
  return {};
}

Finding find_refused_word(const ScriptToken& token) {
  if (!is_word(token) || refusal_of(token.text).empty()) return {};
  return ScriptFinding{token.line, fmt::format("{} {}", token.text, refusal_of(token.text))};
}

// The tokens without comments, which separate but mean nothing.
Tokens without_comments(const Tokens& tokens) {
  Tokens code;
  std::copy_if(tokens.begin(), tokens.end(), std::back_inserter(code),
               [](const ScriptToken& token) { return token.kind != TokenKind::comment; });
  return code;
}

// Printf(...) > "file";
class RedirectionSearch {
 public:
  Finding step(const ScriptToken& token) {
    if (is_word(token) &&
        (token.text == "Printf" || token.text == "Error" || token.text == "Warning"))
      start(token);
    if (name_.empty() || token.kind != TokenKind::symbol) return {};
    if (token.text == "(" || token.text == "[") ++depth_;
    if (token.text == ")" || token.text == "]") --depth_;
    if (token.text == ";") name_ = {};
    if (depth_ <= 0 && (token.text == ">" || token.text == ">>"))
      return ScriptFinding{token.line, fmt::format("{} with {} writes files", name_, token.text)};
    return {};
  }

 private:
  void start(const ScriptToken& token) {
    name_ = token.text;
    depth_ = 0;
  }

  std::string_view name_;
  int depth_ = 0;
};

// Background Field = 1; says which field is used.
bool names_a_field(std::string_view word) {
  return word == "Background" || word == "BoundaryLayer";
}

// Field[...] = Type;
class FieldSearch {
 public:
  Finding step(const Tokens& code, std::size_t i) {
    const ScriptToken& token = code[i];
    if (is_word(token) && token.text == "Field")
      is_pending_ = i == 0 || !(is_word(code[i - 1]) && names_a_field(code[i - 1].text));
    if (is_symbol(token, ".") || is_symbol(token, ";")) is_pending_ = false;
    if (!is_pending_ || !is_symbol(token, "=") || i + 1 == code.size()) return {};
    is_pending_ = false;
    const ScriptToken& type = code[i + 1];
    if (!is_word(type) || is_safe_field(type.text)) return {};
    return ScriptFinding{type.line,
                         fmt::format("mesh size field {} may touch files", printable(type.text))};
  }

 private:
  bool is_pending_ = false;
};

// Category.Name, where an index may stand before the point: View[0].Name.
Finding find_option(const Tokens& code, std::size_t i) {
  if (i < 2 || !is_word(code[i]) || !is_symbol(code[i - 1], ".")) return {};
  const std::string_view category = is_word(code[i - 2]) ? code[i - 2].text : std::string_view();
  if (is_safe_option(category, code[i].text)) return {};
  return ScriptFinding{code[i].line, fmt::format("option {}.{} may name a program or a file",
                                                 category.empty() ? "[]" : printable(category),
                                                 printable(code[i].text))};
}

bool may_follow_a_value(std::string_view word) {
  constexpr std::array<std::string_view, 8> words = {
      "Using", "In", "Affine", "Left", "Right", "Alternate", "AlternateLeft", "AlternateRight"};
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool names_what_follows(const ScriptToken& token) {
  constexpr std::array<std::string_view, 6> words = {"Using",  "Macro",   "Function",
                                                     "Struct", "Combine", "Color"};
  return is_word(token) && std::find(words.begin(), words.end(), token.text) != words.end();
}

// Two values never follow each other: a name before a value is a command, here one that this
// version of roughmesh does not know.
Finding find_unknown_command(const Tokens& code, std::size_t i) {
  const ScriptToken& token = code[i];
  if (!is_word(token) || is_known_word(token.text) || i + 1 == code.size()) return {};
  if (i > 0 && (is_symbol(code[i - 1], ".") || names_what_follows(code[i - 1]))) return {};
  const ScriptToken& next = code[i + 1];
  const bool opens = is_symbol(next, "(") || is_symbol(next, "[");
  const bool takes_text = opens && i + 2 < code.size() && code[i + 2].kind == TokenKind::string;
  const bool takes_value = next.kind == TokenKind::string || next.kind == TokenKind::number ||
                           (is_word(next) && !may_follow_a_value(next.text));
  if (!takes_text && !takes_value) return {};
  return ScriptFinding{token.line,
                       fmt::format("{} is a command unknown here", printable(token.text))};
}

Finding find_in_code(const Tokens& code) {
  RedirectionSearch redirection;
  FieldSearch field;
  for (std::size_t i = 0; i < code.size(); ++i) {
    if (Finding found = find_refused_word(code[i])) return found;
    if (Finding found = redirection.step(code[i])) return found;
    if (Finding found = field.step(code, i)) return found;
    if (Finding found = find_option(code, i)) return found;
    if (Finding found = find_unknown_command(code, i)) return found;
  }
  return {};
}

// Words of a comment or string, wherever its own strings may begin.
std::vector<std::string_view> words_of(std::string_view text) {
  const auto is_part = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  std::vector<std::string_view> words;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = begin;
    while (end < text.size() && is_part(text[end])) ++end;
    if (end > begin) words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

bool ends_block(std::string_view word) {
  return word == "EndIf" || word == "Else" || word == "ElseIf" || word == "EndFor" ||
         word == "Return";
}

// What of a comment or string would be refused as code; empty if nothing.
std::string_view danger_in(std::string_view text) {
  const bool redirects = text.find('>') != std::string_view::npos;
  for (const std::string_view word : words_of(text)) {
    if (!refusal_of(word).empty()) return word;
    if (redirects && (word == "Printf" || word == "Error" || word == "Warning")) return word;
  }
  return {};
}

// Where a loop goes back, and where a branch is skipped, Gmsh's scanner may take the inside of a
// comment or string for commands. It does so inside those that a line or a piece of its buffer
// begins in; and, once a skipped branch lost count of quotes, in any, which needs the word that
// ends the branch in a comment or string as well.
Finding find_in_hidden_text(const Tokens& tokens) {
  const auto is_control = [](const ScriptToken& token) {
    return is_word(token) && is_control_word(token.text);
  };
  if (std::none_of(tokens.begin(), tokens.end(), is_control)) return {};
  const bool hides_an_end = std::any_of(tokens.begin(), tokens.end(), [](const ScriptToken& token) {
    const auto words = is_hidden(token) ? words_of(token.text) : std::vector<std::string_view>();
    return std::any_of(words.begin(), words.end(), ends_block);
  });
  for (const ScriptToken& token : tokens) {
    if (!is_hidden(token) || !(token.is_exposed || hides_an_end)) continue;
    if (const std::string_view word = danger_in(token.text); !word.empty())
      return ScriptFinding{
          token.line, fmt::format("{} in a {}, which Gmsh may run in a script with loops, "
                                  "branches or macros",
                                  word, token.kind == TokenKind::string ? "string" : "comment")};
  }
  return {};
}

}  // namespace

std::optional<ScriptFinding> find_unsafe(std::string_view script) {
  if (Finding found = find_control_character(script)) return found;
  const Tokens tokens = tokens_of(script);
  for (const ScriptToken& token : tokens)
    if (Finding found = find_odd_string(token)) return found;
  if (Finding found = find_in_code(without_comments(tokens))) return found;
  return find_in_hidden_text(tokens);
}

bool makes_mesh(std::string_view script) {
  const Tokens code = without_comments(tokens_of(script));
  for (std::size_t i = 0; i + 1 < code.size(); ++i)
    if (is_word(code[i]) && code[i].text == "Mesh" && (i == 0 || !is_word(code[i - 1])) &&
        (code[i + 1].kind == TokenKind::number || is_word(code[i + 1])))
      return true;
  return false;
}

}  // namespace roughmesh::detail
