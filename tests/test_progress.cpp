// SPDX-License-Identifier: BSD-3-Clause
// What a terminal shows of a run, and how a signal ends it.
#include <csignal>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "roughmesh/pipeline.hpp"

#include "interrupt.hpp"
#include "progress.hpp"
#include "support/meshes.hpp"

using namespace roughmesh;
using namespace roughmesh::app;

namespace {

bool shows(const std::string& line, const std::string& part) {
  return line.find(part) != std::string::npos;
}

/// Realizations of 2 s each after a preparation: two are done, and a third runs since a second.
ProgressState two_of_ten(double preparation) {
  ProgressState state{.n_wanted = 10};
  state.begin({"surface", {}}, preparation / 2);
  for (std::uint64_t k = 0; k < 2; ++k) {
    state.begin({"field", 7 + k}, preparation + 2.0 * static_cast<double>(k));
    state.finish_realization(preparation + 2.0 * static_cast<double>(k + 1));
  }
  state.begin({"volume", 9}, preparation + 4.5);
  return state;
}

}  // namespace

// Eight of 2 s are left, less the second that the third has run.
TEST(Progress, TimeLeftIsThatOfTheRealizationsWithoutThePreparation) {
  for (const double preparation : {0.0, 0.5, 10.0, 10000.0}) {
    const std::string line = progress_line(two_of_ten(preparation), preparation + 5);
    EXPECT_TRUE(shows(line, "2/10")) << line;
    EXPECT_TRUE(shows(line, "volume")) << line;
    EXPECT_TRUE(shows(line, "15 s left")) << line;
    EXPECT_TRUE(shows(line, "[####                ]")) << line;
  }
}

TEST(Progress, NamesTheStageWhereNoTimeLeftIsKnown) {
  ProgressState state{.n_wanted = 10};
  EXPECT_TRUE(shows(progress_line(state, 2), "read  2 s"));
  state.begin({"surface", {}}, 3);
  EXPECT_TRUE(shows(progress_line(state, 45.5), "surface  42 s"));
  EXPECT_FALSE(shows(progress_line(state, 45.5), "left"));
  state.n_wanted = 1;  // no bar for one
  EXPECT_EQ(progress_line(state, 3), "surface  0 s");
}

TEST(Progress, LineFitsATerminalAndTimesAreNotNegative) {
  ProgressState state = two_of_ten(0);
  EXPECT_TRUE(shows(progress_line(state, 1000), "  0 s left"));
  state.n_wanted = 10'000'000;
  state.n_done = 9'000'000;
  state.last_end = 9e6 * 1e4;
  state.stage = "displace";
  EXPECT_LT(progress_line(state, state.last_end).size(), 80U);
  EXPECT_TRUE(shows(progress_line(state, state.last_end), " h "));
}

// Every stage by its name in the report; those of a realization with its number, in order.
TEST(Progress, ARunTellsItsStages) {
  RoughenOptions options;
  options.surfaces[0].rms = 0.01;
  options.surfaces[0].length = {0.5};
  options.realizations = 2;
  options.first = 7;
  std::vector<std::string> common, of_seven, of_eight;
  roughen(
      test::icosphere(1), options, [](const RoughMesh&, Report&) {},
      [&](const Progress& progress) {
        std::vector<std::string>& stages = !progress.realization        ? common
                                           : *progress.realization == 7 ? of_seven
                                                                        : of_eight;
        stages.emplace_back(progress.stage);
      });
  const std::vector<std::string> expected = {"field",  "displace", "check",
                                             "volume", "check",    "write"};
  EXPECT_EQ(of_seven, expected);
  EXPECT_EQ(of_eight, expected);
  for (const char* const stage : {"surface", "field", "audit"})
    EXPECT_EQ(std::count(common.begin(), common.end(), stage) > 0, true) << stage;
}

TEST(InterruptDeathTest, LeavesAtOnce) {
  EXPECT_EXIT(
      {
        handle_signals();
        std::raise(SIGINT);
        std::_Exit(0);
      },
      testing::ExitedWithCode(128 + SIGINT), "interrupted");
}

TEST(InterruptDeathTest, GivesASecondInAGracePeriodAndNoMore) {
  EXPECT_EXIT(
      {
        handle_signals();
        const GracePeriod grace;
        std::raise(SIGTERM);
        std::_Exit(interrupted() == SIGTERM ? 7 : 0);
      },
      testing::ExitedWithCode(7), "");
  const auto wait_in_grace = [](bool again) {
    handle_signals();
    const GracePeriod grace;
    std::raise(SIGINT);
    if (again) std::raise(SIGINT);
    for (int k = 0; k < 100; ++k) usleep(100'000);  // ends early
    std::_Exit(0);
  };
  EXPECT_EXIT(wait_in_grace(false), testing::ExitedWithCode(128 + SIGINT), "interrupted");
  EXPECT_EXIT(wait_in_grace(true), testing::ExitedWithCode(128 + SIGINT), "interrupted");
}
