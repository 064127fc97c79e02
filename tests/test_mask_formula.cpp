// SPDX-License-Identifier: BSD-3-Clause
// Formulas as masks: what they compute, and how they refuse.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "roughmesh/mask.hpp"

#include "mask_formula.hpp"
#include "parallel.hpp"
#include "support/errors.hpp"
#include "support/meshes.hpp"

using namespace roughmesh;

namespace {

struct Ball {
  Mesh mesh = test::icosphere(3);
  Surface surface = select_surface(mesh);

  std::vector<double> weights(std::string expression) const {
    return mask_weights(mesh, surface, {.formulas = {{std::move(expression)}}});
  }
};

double value(const std::string& expression, const Vec3& x = {0.1, 0.2, 0.3},
             const Vec3& n = {0.6, 0, 0.8}) {
  return detail::MaskFormula(expression).value(x, n);
}

std::string refusal(const std::string& expression) {
  return test::message_of([&] { detail::MaskFormula formula(expression); });
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST(MaskFormula, ComputesWhatItsTextSays) {
  EXPECT_EQ(value("x + 2*y - z/4"), 0.1 + 2 * 0.2 - 0.3 / 4);
  EXPECT_EQ(value("nx*nx + ny + nz"), 0.6 * 0.6 + 0.8);
  EXPECT_EQ(value("pi"), std::numbers::pi);
  EXPECT_EQ(value("e"), std::numbers::e);
  EXPECT_EQ(value("2^3^2"), 512);
  EXPECT_EQ(value("-2^2"), -4);
  EXPECT_EQ(value("1e-3 + .5 + 2."), 1e-3 + .5 + 2.);
  EXPECT_EQ(value("x < y && z >= 0.3 ? 7 : 8"), 7);
  EXPECT_EQ(value("x == y || x != 0.1"), 0);
  EXPECT_EQ(value("atan2(1, -1)"), std::atan2(1, -1));
  EXPECT_EQ(value("min(3, 1, 2) + 10*max(3, 1, 5)"), 51);
  EXPECT_EQ(value("log(e) + log10(1000)"), 1 + 3);
  EXPECT_EQ(value("sqrt(abs(-4)) + floor(1.7) + ceil(1.2)"), 5);
  for (const auto& [name, f] :
       std::vector<std::pair<std::string, double (*)(double)>>{{"sin", std::sin},
                                                               {"cos", std::cos},
                                                               {"tan", std::tan},
                                                               {"asin", std::asin},
                                                               {"acos", std::acos},
                                                               {"atan", std::atan},
                                                               {"sinh", std::sinh},
                                                               {"cosh", std::cosh},
                                                               {"tanh", std::tanh},
                                                               {"exp", std::exp}})
    EXPECT_EQ(value(name + "(z)"), f(0.3)) << name;
}

TEST(MaskFormula, WeightsAreItsValuesClippedToZeroAndOne) {
  const Ball ball;
  const std::vector<double> weights = ball.weights("3*z");
  for (std::size_t i = 0; i < weights.size(); ++i)
    EXPECT_EQ(weights[i], std::clamp(3 * ball.surface.points[i].z(), 0.0, 1.0));
  EXPECT_EQ(ball.weights("1/0"), std::vector<double>(weights.size(), 1.0));
  // The surface is a sphere about the origin: its normals are its points.
  const std::vector<double> by_normal = ball.weights("3*nz");
  for (std::size_t i = 0; i < weights.size(); ++i) EXPECT_NEAR(by_normal[i], weights[i], 0.02);
}

// 642 points are one range of the loop; more ranges and threads must make no difference.
TEST(MaskFormula, ThreadsChangeNothing) {
  const Mesh mesh = test::icosphere(5);
  const Surface surface = select_surface(mesh);
  const MaskOptions options{.formulas = {{"0.5 + 0.5*sin(20*x)*cos(30*y + z)"}}};
  const auto with_threads = [&](int n) {
    const detail::ThreadLimit limit(n);
    return mask_weights(mesh, surface, options);
  };
  const std::vector<double> one = with_threads(1);
  EXPECT_EQ(one, with_threads(4));
  for (std::size_t i = 0; i < one.size(); ++i) {
    const Vec3& x = surface.points[i];
    EXPECT_EQ(one[i],
              std::clamp(0.5 + 0.5 * std::sin(20 * x.x()) * std::cos(30 * x.y() + x.z()), 0., 1.));
  }
}

TEST(MaskFormula, AssignsNothing) {
  for (const char* text : {"x = 0.5", "1 ? x=1 : 2", "x=y=z", "(x)=1", "x= =1"})
    EXPECT_TRUE(contains(refusal(text), "nothing can be assigned")) << text;
  EXPECT_EQ(value("x==0.1"), 1);
  EXPECT_EQ(value("x<=0.1"), 1);
  EXPECT_EQ(value("x>=0.2"), 0);
  EXPECT_EQ(value("x!=0.1"), 0);
  detail::MaskFormula formula("x*y");
  EXPECT_EQ(formula.value({2, 3, 0}, {0, 0, 1}), 6);
  EXPECT_EQ(formula.value({5, 7, 0}, {0, 0, 1}), 35);
  EXPECT_EQ(formula.value({2, 3, 0}, {0, 0, 1}), 6);
}

TEST(MaskFormula, RefusalsNameExpressionPositionAndRemedy) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"x + foo*2", "mask formula 'x + foo*2': character 5: unknown name 'foo'; write it with"},
      {"rnd(1)", "character 1: unknown name 'rnd'"},
      {"sum(1,2)", "unknown name 'sum'"},
      {"(x + 1", "a parenthesis is not closed"},
      {"x + 1)", "character 6: ')' cannot stand here"},
      {"x +", "the expression ends too early"},
      {"2**3", "character 3: '*' cannot stand here"},
      {"x y", "character 3: 'y' cannot stand here"},
      {"sin(1, 2)", "wrong number of arguments of 'sin'"},
      {"atan2(1)", "wrong number of arguments of 'atan2'"},
      {"min()", "wrong number of arguments of 'min'"},
      {"x > 0 ? 1", "? without :"},
      {"", "mask formula '': character 1: the expression is empty"},
      {"   ", "the expression is empty"},
      {"1, x", "it has 2 values, separated by commas, not one"},
      {"system(\"ls\")", "character 8: '\"' has no meaning here"},
      {"x; y", "character 2: ';' has no meaning here"},
      {"x\n+1", "mask formula 'x?+1': character 2: '?' has no meaning here"},
      {"_pi", "unknown name '_pi'"},
      {"0x10", "unknown name 'x10'"},
  };
  for (const auto& [expression, expected] : cases) {
    const std::string message = refusal(expression);
    EXPECT_TRUE(contains(message, expected)) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(MaskFormula, WhatIsNotANumberIsToldWithItsPoint) {
  const Ball ball;
  const std::string message = test::message_of([&] { ball.weights("sqrt(x + 0.9)"); });
  EXPECT_TRUE(contains(message, "'sqrt(x + 0.9)': it is not a number at (")) << message;
  EXPECT_TRUE(contains(message, "max")) << message;
  EXPECT_EQ(ball.weights("sqrt(max(0, x + 0.9))").size(), ball.surface.points.size());
  EXPECT_TRUE(
      contains(test::message_of([&] { ball.weights("max(0, sqrt(-2), 1)"); }), "not a number"));
  EXPECT_TRUE(contains(test::message_of([&] { ball.weights("0/0"); }), "not a number"));
}

TEST(MaskFormula, LongAndDeepTextsAreRefusedOrComputed) {
  EXPECT_TRUE(contains(refusal(std::string(1000000, '1')), "it has 1000000 characters"));
  EXPECT_LT(refusal(std::string(1000000, '(')).size(), 300u);
  EXPECT_EQ(value(std::string(499, '(') + "x" + std::string(499, ')')), 0.1);
  std::string signs = "x";
  for (int k = 0; k < 300; ++k) signs = "-(" + signs + ")";
  EXPECT_EQ(value(signs), 0.1);
  EXPECT_TRUE(contains(refusal(std::string(900, '-') + "x"), "cannot stand here"));
  EXPECT_TRUE(contains(refusal(std::string(1000, '(')), "mask formula '((("));
  std::string choices = "1";
  while (choices.size() < 980) choices = "x>y?0:(" + choices + ")";
  EXPECT_EQ(value(choices), 1);
  std::string calls = "0.5";
  while (calls.size() < 990) calls = "abs(" + calls + ")";
  EXPECT_EQ(value(calls), 0.5);
}

// Any sequence of the parser's own words is computed or refused by an InputError, nothing else.
TEST(MaskFormula, AnyTextEndsInANumberOrAnInputError) {
  const std::vector<std::string> words = {"x", "ny", "1",  "2.5", "e",      "pi", "+",    "-",
                                          "*", "/",  "^",  "(",   ")",      ",",  "?",    ":",
                                          "<", "<=", "==", "!=",  "&&",     "||", "sin(", "min(",
                                          "!", "&",  "1e", "..",  "atan2(", " ",  "foo",  "max("};
  std::mt19937 random(7);
  int accepted = 0;
  for (int k = 0; k < 20000; ++k) {
    std::string text;
    for (auto n = random() % 12; n > 0; --n) text += words[random() % words.size()];
    try {
      detail::MaskFormula(text).value({1, 2, 3}, {0, 0, 1});
      ++accepted;
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(accepted, 100);
}
