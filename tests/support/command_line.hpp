// SPDX-License-Identifier: BSD-3-Clause
// The command in a folder with a sphere and a ball in a box.
#pragma once

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"
#include "roughmesh/options.hpp"

#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/process.hpp"

namespace roughmesh::test {

inline const std::string command = ROUGHMESH_APP;

class CommandLine : public testing::Test {
 protected:
  void SetUp() override {
    write_mesh(icosphere(2), folder / "sphere.msh");
    write_mesh(ball_in_box(8), folder / "ball.msh");
  }

  Outcome run(const std::string& arguments) { return run_in(folder, command + " " + arguments); }

  TemporaryFolder folder;
};

inline const std::string sphere_job = "roughen sphere.msh --rms 0.02 --length 0.8 ";

inline void expect_failure(const Outcome& outcome, int exit_code, const std::string& what) {
  EXPECT_EQ(outcome.exit_code, exit_code) << what << ": " << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1)
      << what << ": " << outcome.err;
  EXPECT_EQ(outcome.out, "") << what;
}

/// Of the command: those of a run and of its surface.
template <class Visit>
void for_every_option(RoughenOptions& options, Visit&& visit) {
  for_each_run_option(options, visit);
  for_each_surface_option(options.surfaces.front(), visit);
}

}  // namespace roughmesh::test
