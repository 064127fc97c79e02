// SPDX-License-Identifier: BSD-3-Clause
// The pipeline is the order of the headers: each public header includes only headers above it.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

const std::vector<std::string> order = {
    "error",       "mesh",    "mesh_io",         "cad",      "surface",     "mask",
    "periodic",    "curve",   "autocorrelation", "distance", "correlation", "resolution",
    "white_noise", "field",   "displace",        "walls",    "check",       "move_volume",
    "statistics",  "options", "field_model",     "report",   "pipeline"};

std::filesystem::path source_dir() { return ROUGHMESH_SOURCE_DIR; }

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> included_headers(const std::string& text) {
  static const std::regex include(R"(#\s*include\s*[<"]roughmesh/(\w+)\.hpp[>"])");
  std::vector<std::string> names;
  for (std::sregex_iterator it(text.begin(), text.end(), include), end; it != end; ++it)
    names.push_back((*it)[1]);
  return names;
}

std::ptrdiff_t place(const std::string& header) {
  return std::find(order.begin(), order.end(), header) - order.begin();
}

std::ptrdiff_t n_headers() { return static_cast<std::ptrdiff_t>(order.size()); }

}  // namespace

TEST(Includes, EveryPublicHeaderHasItsPlaceInTheOrder) {
  for (const auto& entry : std::filesystem::directory_iterator(source_dir() / "include/roughmesh"))
    EXPECT_LT(place(entry.path().stem().string()), n_headers()) << entry.path();
}

TEST(Includes, PublicHeadersIncludeOnlyWhatStandsAboveThem) {
  for (const std::string& header : order) {
    const auto path = source_dir() / "include/roughmesh" / (header + ".hpp");
    for (const std::string& included : included_headers(text_of(path)))
      EXPECT_LT(place(included), place(header)) << header << ".hpp includes " << included << ".hpp";
  }
}

// A source named after a stage uses that stage and earlier ones: data flows one way.
TEST(Includes, SourcesUseNothingFromLaterStages) {
  for (const std::string& stage : order) {
    const auto path = source_dir() / "src" / (stage + ".cpp");
    if (!std::filesystem::exists(path)) continue;
    for (const std::string& included : included_headers(text_of(path)))
      EXPECT_LE(place(included), place(stage)) << stage << ".cpp includes " << included << ".hpp";
  }
}

// Nothing under the GPL is linked; CGAL is told to refuse its GPL parts, and is used in one
// source.
TEST(Includes, NoHeaderOfAGplLibraryIsUsed) {
  static const std::regex gpl(
      R"(#\s*include\s*[<"](fftw|gsl/|umfpack|cholmod|SuiteSparseQR|ceres/|gmsh\.h|CGAL/(Surface_mesh|Polyhedron|AABB|Polygon_mesh_processing|box_intersection|Triangulation|Delaunay)))");
  for (const std::string folder : {"src", "include", "app", "tests", "benchmarks"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source_dir() / folder))
      if (entry.is_regular_file() && entry.path() != __FILE__) {
        EXPECT_FALSE(std::regex_search(text_of(entry.path()), gpl)) << entry.path();
      }
}
