// SPDX-License-Identifier: BSD-3-Clause
#include "mask_formula.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include <fmt/format.h>
#include <muParser.h>

#include "roughmesh/error.hpp"

#include "messages.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t longest = 1000;    // characters of an expression
constexpr std::size_t most_quoted = 60;  // of them in a message
constexpr std::string_view letters_and_digits =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
constexpr std::string_view signs = " .,()+-*/^<>=!&|?:";
constexpr const char* remedy =
    "write it with numbers, x, y, z, nx, ny, nz, pi, e, + - * / ^ ( ), comparisons, && ||, a ? b : "
    "c and functions like sin, exp, sqrt, min";

// One line, whatever the expression holds.
std::string quoted(std::string_view text) {
  std::string line(text.substr(0, most_quoted));
  for (char& c : line)
    if (c < ' ' || c > '~') c = '?';
  return "'" + line + (text.size() > most_quoted ? "...'" : "'");
}

[[noreturn]] void refuse(const std::string& expression, const std::string& why) {
  throw InputError(fmt::format("mask formula {}: {}; {}", quoted(expression), why, remedy));
}

[[noreturn]] void refuse_at(const std::string& expression, std::size_t position,
                            const std::string& why) {
  refuse(expression, fmt::format("character {}: {}", position + 1, why));
}

void check_length(const std::string& expression) {
  if (expression.size() <= longest) return;
  throw InputError(fmt::format("mask formula {}: it has {} characters; shorten it to {}",
                               quoted(expression), expression.size(), longest));
}

bool is_known(char c) {
  return letters_and_digits.find(c) != std::string_view::npos ||
         signs.find(c) != std::string_view::npos;
}

// An equals sign that is not part of <= >= == != would assign to a variable.
bool assigns(std::string_view text, std::size_t i) {
  const bool ends_comparison =
      i > 0 && std::string_view("<>=!").find(text[i - 1]) != std::string_view::npos;
  const bool starts_equality = i + 1 < text.size() && text[i + 1] == '=';
  return text[i] == '=' && !ends_comparison && !starts_equality;
}

void check_characters(const std::string& expression) {
  for (std::size_t i = 0; i < expression.size(); ++i) {
    if (!is_known(expression[i]))
      refuse_at(expression, i,
                quoted(std::string_view(expression).substr(i, 1)) + " has no meaning here");
    if (assigns(expression, i)) refuse_at(expression, i, "nothing can be assigned, == compares");
  }
}

std::string reason(const mu::ParserError& error) {
  switch (error.GetCode()) {
    case mu::ecUNEXPECTED_EOF:
      return "the expression ends too early";
    case mu::ecEMPTY_EXPRESSION:
      return "the expression is empty";
    case mu::ecMISSING_PARENS:
      return "a parenthesis is not closed";
    case mu::ecUNASSIGNABLE_TOKEN:
      return "unknown name " + quoted(error.GetToken());
    case mu::ecTOO_MANY_PARAMS:
    case mu::ecTOO_FEW_PARAMS:
      return "wrong number of arguments of " + quoted(error.GetToken());
    case mu::ecMISSING_ELSE_CLAUSE:
      return "? without :";
    default:
      return error.GetToken().empty() ? "this cannot stand here"
                                      : quoted(error.GetToken()) + " cannot stand here";
  }
}

[[noreturn]] void refuse(const std::string& expression, const mu::ParserError& error) {
  const auto position = static_cast<std::size_t>(std::max(0, error.GetPos()));
  refuse_at(expression, std::min(position, expression.size()), reason(error));
}

// ---- The functions, the same in every version of the parser ----

struct Function {
  const char* name;
  double (*evaluate)(double);
};

constexpr std::array functions = {
    Function{"sin", [](double v) { return std::sin(v); }},
    Function{"cos", [](double v) { return std::cos(v); }},
    Function{"tan", [](double v) { return std::tan(v); }},
    Function{"asin", [](double v) { return std::asin(v); }},
    Function{"acos", [](double v) { return std::acos(v); }},
    Function{"atan", [](double v) { return std::atan(v); }},
    Function{"sinh", [](double v) { return std::sinh(v); }},
    Function{"cosh", [](double v) { return std::cosh(v); }},
    Function{"tanh", [](double v) { return std::tanh(v); }},
    Function{"exp", [](double v) { return std::exp(v); }},
    Function{"log", [](double v) { return std::log(v); }},
    Function{"log10", [](double v) { return std::log10(v); }},
    Function{"sqrt", [](double v) { return std::sqrt(v); }},
    Function{"abs", [](double v) { return std::abs(v); }},
    Function{"floor", [](double v) { return std::floor(v); }},
    Function{"ceil", [](double v) { return std::ceil(v); }},
};

double arc_tangent(double y, double x) { return std::atan2(y, x); }

// NaN is kept: a hole in a formula must not vanish between its neighbours.
double extreme(const double* values, int n, bool largest) {
  double result = values[0];
  for (int i = 1; i < n && !std::isnan(result); ++i)
    if (std::isnan(values[i]) || (largest ? values[i] > result : values[i] < result))
      result = values[i];
  return result;
}

double smallest_of(const double* values, int n) { return extreme(values, n, false); }
double largest_of(const double* values, int n) { return extreme(values, n, true); }

void define_functions(mu::Parser& parser) {
  parser.ClearFun();
  for (const Function& function : functions) parser.DefineFun(function.name, function.evaluate);
  parser.DefineFun("atan2", arc_tangent);
  parser.DefineFun("min", smallest_of);
  parser.DefineFun("max", largest_of);
}

}  // namespace

struct MaskFormula::Parser {
  std::string expression;
  std::array<double, 6> variables{};  // x, y, z, nx, ny, nz
  mu::Parser parser;
};

MaskFormula::MaskFormula(const std::string& expression) : parser_(std::make_unique<Parser>()) {
  constexpr std::array names = {"x", "y", "z", "nx", "ny", "nz"};
  check_length(expression);
  check_characters(expression);
  parser_->expression = expression;
  mu::Parser& parser = parser_->parser;
  try {
    define_functions(parser);
    parser.ClearConst();
    parser.DefineConst("pi", std::numbers::pi);
    parser.DefineConst("e", std::numbers::e);
    for (std::size_t k = 0; k < names.size(); ++k)
      parser.DefineVar(names[k], &parser_->variables[k]);
    parser.SetExpr(expression);
    parser.Eval();  // reads the expression; errors come here
  } catch (const mu::ParserError& error) {
    refuse(expression, error);
  }
  if (const int n = parser.GetNumResults(); n != 1)
    refuse(expression, fmt::format("it has {} values, separated by commas, not one", n));
}

MaskFormula::~MaskFormula() = default;

double MaskFormula::value(const Vec3& point, const Vec3& normal) {
  std::copy_n(point.data(), 3, parser_->variables.begin());
  std::copy_n(normal.data(), 3, parser_->variables.begin() + 3);
  try {
    return parser_->parser.Eval();
  } catch (const mu::ParserError& error) {
    refuse(parser_->expression, error);
  }
}

void MaskFormula::refuse_value(const Vec3& point) const {
  throw InputError(fmt::format(
      "mask formula {}: it is not a number at {}; use a ? b : c or max to keep away from there",
      quoted(parser_->expression), place(point)));
}

}  // namespace roughmesh::detail
