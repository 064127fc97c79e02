// SPDX-License-Identifier: BSD-3-Clause
// What examples/ and docs/ show does what their words say.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"
#include "roughmesh/options.hpp"

#include "support/files.hpp"
#include "support/process.hpp"

using namespace roughmesh;

namespace {

const std::filesystem::path source = ROUGHMESH_SOURCE_DIR;

class Examples : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
    for (const char* const script : {"line_edges.geo", "sphere.geo"})
      std::filesystem::copy_file(source / "examples" / script, folder / script);
  }

  /// Runs an example where its script lies.
  void run(const std::string& job, const std::string& arguments = "") {
    std::filesystem::copy_file(source / "examples" / job, folder / job);
    const test::Outcome outcome =
        test::run_in(folder, std::string(ROUGHMESH_APP) + " roughen --job " + job + arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }

  test::TemporaryFolder folder;
};

/// Heights along one edge of the line, by their place: the edges lie along x, and their normals
/// along y.
std::map<double, double> edge(const Mesh& mesh, const std::string& group, double y) {
  std::map<double, double> heights;
  for (const PhysicalGroup& g : mesh.groups)
    for (const ElementBlock& block : mesh.blocks)
      if (g.name == group && g.dimension == 1 && block.type.shape == ElementShape::line &&
          block.physical_groups == std::vector<Tag>{g.tag})
        for (const Index node : block.nodes)
          heights[mesh.nodes[node].x()] = mesh.nodes[node].y() - y;
  return heights;
}

std::vector<double> values(const std::map<double, double>& heights) {
  std::vector<double> result;
  for (const auto& [x, height] : heights) result.push_back(height);
  return result;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Blocks of code in a page of Markdown: lines indented by four spaces.
std::vector<std::string> blocks_of(const std::string& page) {
  std::vector<std::string> blocks;
  bool is_inside = false;
  for (std::size_t begin = 0; begin < page.size();) {
    const std::size_t end = std::min(page.find('\n', begin), page.size());
    const std::string line = page.substr(begin, end - begin);
    begin = end + 1;
    const bool is_code = line.starts_with("    ") || (line.empty() && is_inside);
    if (is_code && !is_inside) blocks.emplace_back();
    if (is_code) blocks.back() += line + "\n";
    is_inside = is_code;
  }
  return blocks;
}

RoughenOptions parsed(const std::string& job) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "job.toml", job);
  return read_job(folder / "job.toml");
}

}  // namespace

// The sum of products over the sum of squares has mean 0 and the standard deviation
// sqrt(3 l / 2 / (realizations * 40)) or less for independent edges of length 40 whose correlation
// is exp(-r / l) of l = 3: the integral of its square is l. Five of them are allowed.
TEST_F(Examples, EdgesOfTheirOwnSeedsAreIndependent) {
  constexpr int n = 40;
  run("line_edges.toml", " --realizations " + std::to_string(n));
  double products = 0, lower_squares = 0, upper_squares = 0;
  for (int k = 0; k < n; ++k) {
    const Mesh mesh = read_mesh(folder / ("independent_" + std::to_string(k) + ".msh"));
    const auto lower = values(edge(mesh, "lower", -2)), upper = values(edge(mesh, "upper", 2));
    ASSERT_EQ(lower.size(), 81U);
    ASSERT_EQ(upper.size(), 81U);
    products += dot(lower, upper);
    lower_squares += dot(lower, lower);
    upper_squares += dot(upper, upper);
  }
  const double correlation = products / std::sqrt(lower_squares * upper_squares);
  EXPECT_LT(std::abs(correlation), 5 * std::sqrt(4.5 / (n * 40)));
  EXPECT_NE(correlation, 0);
}

// One height for both: to the 1e-8 Rq that a factor in floating point keeps.
TEST_F(Examples, EdgesOfOneFieldKeepTheWidthOfTheLine) {
  run("line_edges_in_step.toml");
  for (const char* const file : {"in_step_0.msh", "in_step_1.msh", "in_step_2.msh"}) {
    const Mesh mesh = read_mesh(folder / file);
    const auto lower = edge(mesh, "lower", -2), upper = edge(mesh, "upper", 2);
    ASSERT_EQ(lower.size(), upper.size());
    const std::vector<double> below = values(lower), above = values(upper);
    for (std::size_t i = 0; i < below.size(); ++i) EXPECT_NEAR(below[i], above[i], 1e-8 * 0.15);
    EXPECT_GT(std::sqrt(dot(below, below) / 81), 0.03);
    EXPECT_EQ(below.front(), 0);  // faded out at the ends
    EXPECT_EQ(below.back(), 0);
  }
}

// On the unit sphere: the window around the north pole has weight 0, and so has the south but for
// exp(-(z / 0.2)^2), below 2e-4 at z = -0.6.
TEST_F(Examples, MaskedNodesStay) {
  run("masks.toml");
  const Mesh mesh = read_mesh(folder / "half_0.msh");
  double window = 0, south = 0, north = 0;
  Index n_window = 0;
  for (const Vec3& x : mesh.nodes) {
    const double height = std::abs(x.norm() - 1);
    const double to_pole = (x - Vec3(0, 0, 1)).norm();
    if (to_pole < 0.18) ++n_window;
    if (to_pole < 0.18) window = std::max(window, height);
    if (x.z() < -0.7) south = std::max(south, height);
    if (x.z() > 0.1 && to_pole > 0.5) north = std::max(north, height);
  }
  EXPECT_GT(n_window, 5);
  EXPECT_LT(window, 1e-12);
  EXPECT_LT(south, 6 * 0.02 * 2e-4);
  EXPECT_GT(north, 0.02);
}

// Several surfaces and masks, on meshes that are made anew from their scripts.
TEST_F(Examples, TheirReportsAreJobsThatGiveTheSameBytes) {
  for (const auto& [job, report, mesh] : std::vector<std::array<std::string, 3>>{
           {"line_edges.toml", "independent_", "independent_2.msh"},
           {"line_edges_in_step.toml", "in_step_", "in_step_0.msh"},
           {"masks.toml", "half_", "half_0.msh"}}) {
    run(job);
    const std::string bytes = test::read_bytes(folder / mesh);
    std::filesystem::remove(folder / mesh);
    std::filesystem::rename(folder / (report + ".report.json"), folder / "job.json");
    const test::Outcome again =
        test::run_in(folder, std::string(ROUGHMESH_APP) + " roughen --job job.json");
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(again.err.find("checksum"), std::string::npos) << again.err;
    EXPECT_EQ(test::read_bytes(folder / mesh), bytes) << job;
  }
}

TEST(JobsPage, ItsBlocksAreJobs) {
  const std::vector<std::string> blocks = blocks_of(test::read_bytes(source / "docs/jobs.md"));
  ASSERT_EQ(blocks.size(), 4U);
  const RoughenOptions simple = parsed(blocks[0]);
  EXPECT_EQ(simple.realizations, 10U);
  EXPECT_EQ(simple.surfaces.at(0).group, std::vector<std::string>{"surface"});
  check_options(simple);
  // The second is said to be an example, but for what the first has shown.
  const RoughenOptions edges = parsed(blocks[1]);
  const RoughenOptions example = read_job(source / "examples/line_edges.toml");
  ASSERT_EQ(edges.surfaces.size(), 2U);
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_EQ(edges.surfaces[s].group, example.surfaces[s].group);
    EXPECT_EQ(edges.surfaces[s].rms, example.surfaces[s].rms);
    EXPECT_EQ(edges.surfaces[s].fade, example.surfaces[s].fade);
    EXPECT_TRUE(same_field(edges.surfaces[s], example.surfaces[s]));
  }
  for (const std::size_t part : {2U, 3U}) check_options(parsed("rms = 1\n" + blocks[part]));
  EXPECT_EQ(parsed(blocks[2]).surfaces[0].axes.size(), 2U);
  EXPECT_EQ(parsed(blocks[3]).surfaces[0].cutoff, 2);
}

// Words of the page about keys and kinds of masks, in a job that has them all.
TEST(JobsPage, ItsTableOfWeightsHolds) {
  const RoughenOptions options = parsed(
      "fixed = [\"GROUP\"]\nfade = [\"1\", \"2:GROUP\"]\n"
      "[[mask]]\nkind = \"box\"\nmin = [-inf, 0, 0]\nmax = [inf, 1, 1]\nfade = 0.5\noutside = "
      "true\n"
      "[[mask]]\nkind = \"sphere\"\ncentre = [0, 0, 0]\nradius = 1\nfade = 0.5\n"
      "[[mask]]\nkind = \"formula\"\nexpression = \"x + nz\"\n");
  EXPECT_EQ(options.surfaces.at(0).mask.size(), 3U);
  EXPECT_EQ(options.surfaces.at(0).fade.size(), 2U);
}

TEST(ExamplesFolder, EveryJobIsRead) {
  int n_jobs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source / "examples"))
    if (entry.path().extension() == ".toml") {
      check_options(read_job(entry.path()));
      ++n_jobs;
    }
  EXPECT_EQ(n_jobs, 3);
}
