// SPDX-License-Identifier: BSD-3-Clause
// Gmsh geometry scripts (.geo): what may run programs or touch files is found before Gmsh sees it.
//
// The language is that of Gmsh's reference manual, chapter "Gmsh scripting language"
// (https://gmsh.info/doc/texinfo/gmsh.html), read as Gmsh's own scanner reads it. Its loops, macros
// and skipped branches go back to the beginning of a line, or look for their end, without regard to
// where strings and comments begin, so that hidden text can come to life; that is checked too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace roughmesh::detail {

enum class TokenKind : std::uint8_t { word, number, string, comment, symbol };

struct ScriptToken {
  TokenKind kind = TokenKind::symbol;
  std::string_view text;  ///< of strings and comments without what encloses them
  std::size_t line = 1;   ///< counted from 1
  bool is_closed = true;  ///< false for a string or comment that the file ends in
  /// A string or comment whose inside may be the beginning of what Gmsh reads next: it goes over
  /// the end of a line, or stands in a line that is longer than Gmsh's scanner reads at once.
  bool is_exposed = false;
};

/// The tokens of a script; views of it. Linear in its size.
std::vector<ScriptToken> tokens_of(std::string_view script);

struct ScriptFinding {
  std::size_t line = 0;
  std::string what;  ///< for a message: "SystemCall runs programs"
};

/// The first thing in a script that may run a program or touch a file, or of which that is not
/// known; empty for a script that can only make geometry, size fields and a mesh.
std::optional<ScriptFinding> find_unsafe(std::string_view script);

/// Does the script make its mesh itself (`Mesh 2;`)?
bool makes_mesh(std::string_view script);

// Words of the language, in geo_words.cpp.

/// Why a word is refused wherever it stands; empty for others.
std::string_view refusal_of(std::string_view word);
bool is_known_word(std::string_view word);    ///< a keyword or name that does no harm
bool is_control_word(std::string_view word);  ///< If, For, Macro, ...
bool is_safe_field(std::string_view type);    ///< a mesh size field that touches no file
/// Does an option (`category.name`) name no file, program or command?
bool is_safe_option(std::string_view category, std::string_view name);

}  // namespace roughmesh::detail
