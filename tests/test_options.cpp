// SPDX-License-Identifier: BSD-3-Clause
// Options are declared once: C++, job file and report agree, and nonsense is refused by name.
#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "roughmesh/options.hpp"

#include "options_json.hpp"
#include "support/files.hpp"

using namespace roughmesh;

namespace {

RoughenOptions good_options() {
  RoughenOptions options;
  options.surfaces[0].rms = 2;
  options.surfaces[0].length = {10};
  return options;
}

/// Message of the InputError that check_options throws; empty if it does not.
std::string refusal(const RoughenOptions& options) {
  try {
    check_options(options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

RoughenOptions read_job_text(const std::string& text) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "job", text);
  return read_job(folder / "job");
}

}  // namespace

TEST(Options, JsonAndBackIsTheIdentity) {
  RoughenOptions options = good_options();
  options.surfaces[0].group = {"surface", "7"};
  options.surfaces[0].length = {10, std::numeric_limits<double>::infinity(), 0.1};
  options.surfaces[0].acf = Family::self_affine;
  options.surfaces[0].hurst = 0.1 + 0.2;
  options.surfaces[0].distance = DistanceKind::great_circle;
  options.surfaces[0].length_definition = LengthDefinition::sal;
  options.volume = VolumeChoice::none;
  options.surfaces[0].seed = std::numeric_limits<std::uint64_t>::max();
  options.surfaces[0].flip = true;
  const auto json = detail::options_to_json(options);
  const RoughenOptions back = detail::options_from_json(nlohmann::json::parse(json.dump()), "test");
  EXPECT_EQ(detail::options_to_json(back), json);
  EXPECT_EQ(back.surfaces[0].seed, options.surfaces[0].seed);
  EXPECT_EQ(back.surfaces[0].length, options.surfaces[0].length);
  EXPECT_EQ(*back.surfaces[0].hurst, *options.surfaces[0].hurst);
}

TEST(Options, TomlAndJsonJobsMeanTheSame) {
  const RoughenOptions toml = read_job_text(
      "input = \"a.msh\"\nrms = 2\nlength = [10, inf, 5.5]\nacf = \"matern\"\nnu = 1.5\nseed = 3\n"
      "group = [\"surface\", 4]\nflip = true\n");
  const RoughenOptions json = read_job_text(
      R"({"input": "a.msh", "rms": 2, "length": [10, "inf", 5.5], "acf": "matern", "nu": 1.5, "seed": 3,
          "group": ["surface", "4"], "flip": true})");
  EXPECT_EQ(detail::options_to_json(toml), detail::options_to_json(json));
  EXPECT_EQ(toml.surfaces[0].acf, Family::matern);
  EXPECT_EQ(toml.surfaces[0].group, (std::vector<std::string>{"surface", "4"}));
}

TEST(Options, AReportIsAJob) {
  RoughenOptions options = good_options();
  options.surfaces[0].seed = 42;
  const nlohmann::ordered_json report = {{"roughmesh", "0.1.0"},
                                         {"request", detail::options_to_json(options)}};
  EXPECT_EQ(detail::options_to_json(read_job_text(report.dump())),
            detail::options_to_json(options));
}

TEST(Options, BadJobsAreRefusedInOneLine) {
  for (const std::string text :
       {"rms = 'two'", "unknown = 1", "length = true", "acf = 'gauss'", "seed = -1", "threads = -1",
        "realizations = 1.5", "flip = 1", "rms = 1979-05-27", "{\"rms\": \"2\"}", "{\"x\": 1}",
        "{\"request\": 3}", "group = [[1]]"}) {
    try {
      read_job_text(text);
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << text;
    }
  }
  for (const std::string text : {"rms = ", "{\"rms\": ", "\xff\xfe", "= 3", "{"})
    EXPECT_THROW(read_job_text(text), FormatError) << text;
  EXPECT_THROW(read_job("/nonexistent/job.toml"), InputError);
  EXPECT_THROW(read_job("/"), InputError);
}

TEST(Options, NonsenseIsRefusedByTheNameOfTheOption) {
  EXPECT_EQ(refusal(good_options()), "");
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const std::vector<std::pair<std::string, std::function<void(RoughenOptions&, double)>>> numbers =
      {
          {"--rms", [](auto& o, double x) { o.surfaces[0].rms = x; }},
          {"--length", [](auto& o, double x) { o.surfaces[0].length = {x}; }},
          {"--tolerance", [](auto& o, double x) { o.tolerance = x; }},
          {"--edge-angle", [](auto& o, double x) { o.surfaces[0].edge_angle = x; }},
          {"--nu",
           [](auto& o, double x) { o.surfaces[0].acf = Family::matern, o.surfaces[0].nu = x; }},
          {"--hurst",
           [](auto& o, double x) {
             o.surfaces[0].acf = Family::self_affine, o.surfaces[0].hurst = x;
           }},
          {"--power",
           [](auto& o, double x) {
             o.surfaces[0].acf = Family::stretched, o.surfaces[0].power = x;
           }},
          {"--alpha",
           [](auto& o, double x) {
             o.surfaces[0].acf = Family::rational_quadratic, o.surfaces[0].alpha = x;
           }},
      };
  for (const auto& [option, set] : numbers)
    for (const double value : {0.0, -1.0, nan, inf, -inf}) {
      RoughenOptions options = good_options();
      set(options, value);
      EXPECT_NE(refusal(options).find(option), std::string::npos)
          << option << " " << value << ": " << refusal(options);
    }
}

TEST(Options, CombinationsThatMakeNoSenseAreRefused) {
  const auto refused = [](const std::function<void(RoughenOptions&)>& change) {
    RoughenOptions options = good_options();
    change(options);
    return !refusal(options).empty();
  };
  EXPECT_TRUE(refused([](auto& o) { o.surfaces[0].length = {}; }));
  EXPECT_TRUE(refused([](auto& o) { o.surfaces[0].length = {1, 2, 3, 4}; }));
  EXPECT_TRUE(refused([](auto& o) { o.surfaces[0].angle = 10; }));
  EXPECT_TRUE(refused([](auto& o) {
    o.surfaces[0].length = {1, 2}, o.surfaces[0].distance = DistanceKind::great_circle;
  }));
  EXPECT_TRUE(refused([](auto& o) { o.surfaces[0].nu = 1; }));
  EXPECT_TRUE(refused([](auto& o) { o.surfaces[0].rolloff = 1; }));
  EXPECT_TRUE(refused([](auto& o) { o.method = "lattice"; }));
  EXPECT_TRUE(refused([](auto& o) { o.threads = -1; }));
  EXPECT_TRUE(refused([](auto& o) { o.realizations = 0; }));
  EXPECT_TRUE(refused([](auto& o) { o.realizations = 2, o.output = "rough.msh"; }));
  EXPECT_TRUE(refused([](auto& o) { o.first = std::numeric_limits<std::uint64_t>::max(); }));
  EXPECT_TRUE(refused([](auto& o) { o.output = "r_{realization:4}.msh"; }));
  EXPECT_TRUE(refused([](auto& o) { o.output = "r.msh", o.report = "./x/../r.msh"; }));
  EXPECT_TRUE(
      refused([](auto& o) { o.input = "/a.msh", o.output = "b.msh", o.report = "/a.msh"; }));
  EXPECT_FALSE(refused([](auto& o) { o.realizations = 2, o.output = "r_{realization}.msh"; }));
}

TEST(Options, TablesOfAJobAreSurfacesThatTakeTheRestFromTheTop) {
  const RoughenOptions job = read_job_text(
      "rms = 2\nlength = 10\nfade = 0.5\n[[surface]]\ngroup = 'a'\nseed = 1\n"
      "[[surface]]\ngroup = 'b'\nrms = 3\nlength = [1, inf]\n"
      "[[surface.mask]]\nkind = 'box'\nmin = [-inf, 0, 0]\nmax = [1, 2, inf]\noutside = true\n"
      "[[surface.mask]]\nkind = 'formula'\nexpression = 'x > 0'\n");
  ASSERT_EQ(job.surfaces.size(), 2U);
  EXPECT_EQ(job.surfaces[0].group, std::vector<std::string>{"a"});
  EXPECT_EQ(job.surfaces[0].rms, 2);
  EXPECT_EQ(job.surfaces[0].seed, 1U);
  EXPECT_EQ(job.surfaces[1].rms, 3);
  EXPECT_EQ(job.surfaces[1].seed, 0U);
  EXPECT_EQ(job.surfaces[1].fade, std::vector<std::string>{"0.5"});
  ASSERT_EQ(job.surfaces[1].mask.size(), 2U);
  EXPECT_TRUE(std::get<BoxMask>(job.surfaces[1].mask[0]).outside);
  EXPECT_EQ(std::get<BoxMask>(job.surfaces[1].mask[0]).max.y(), 2);
  EXPECT_EQ(std::get<FormulaMask>(job.surfaces[1].mask[1]).expression, "x > 0");
  EXPECT_EQ(mask_options(job.surfaces[1]).fade.front().width, 0.5);
  const auto json = detail::options_to_json(job);
  EXPECT_EQ(detail::options_to_json(read_job_text(json.dump())), json);
}

TEST(Options, BadTablesAndMasksAreRefusedByName) {
  const std::vector<std::pair<std::string, std::string>> jobs = {
      {"surface = 3", "[[surface]]"},
      {"surface = []", "[[surface]]"},
      {"[[surface]]\ninput = 'a.msh'", "input"},
      {"[[surface]]\nrms = 'x'", "surface 1"},
      {"mask = 'box'", "[[mask]]"},
      {"[[mask]]\nkind = 'cone'", "box, sphere or formula"},
      {"[[mask]]\nmin = [0, 0, 0]", "kind"},
      {"[[mask]]\nkind = 'box'\nmin = [0, 0]\nmax = [1, 1, 1]", "min"},
      {"[[mask]]\nkind = 'sphere'\ncentre = [0, 0, 0]", "radius"},
      {"[[mask]]\nkind = 'formula'\nexpression = 'x'\nmin = 1", "min"}};
  for (const auto& [text, part] : jobs) {
    try {
      read_job_text(text);
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
}

TEST(Options, SurfacesOfAJobMustFitTogether) {
  RoughenOptions options = good_options();
  options.surfaces.push_back(options.surfaces[0]);
  EXPECT_NE(refusal(options).find("surface 1: no group"), std::string::npos);
  options.surfaces[0].group = {"a"};
  options.surfaces[1].group = {"b"};
  EXPECT_EQ(refusal(options), "");
  options.surfaces[1].length = {11};
  EXPECT_NE(refusal(options).find("same seed"), std::string::npos);
  options.surfaces[1].seed = 1;
  EXPECT_EQ(refusal(options), "");
  options.surfaces[1].rms = -1;
  EXPECT_NE(refusal(options).find("surface 2: --rms"), std::string::npos);
}

TEST(Options, FadesArePositiveWidthsWithAGroup) {
  const auto fade_refused = [](const std::string& text) {
    RoughenOptions options = good_options();
    options.surfaces[0].fade = {text};
    return refusal(options).find("--fade") != std::string::npos;
  };
  for (const std::string text : {"", "0", "-1", "x", "1:", "1x", "inf", "nan", ":wall"})
    EXPECT_TRUE(fade_refused(text)) << text;
  for (const std::string text : {"1", "0.5:wall", "2:a:b"})
    EXPECT_FALSE(fade_refused(text)) << text;
}

TEST(Options, AJobChoosesNoProgramToRun) {
  for (const std::string text : {"trust_scripts = true", "gmsh = './evil.sh'", "{\"gmsh\": \"x\"}"})
    EXPECT_THROW(read_job_text(text), InputError) << text;
  RoughenOptions options = good_options();
  options.gmsh = "./evil.sh";
  options.trust_scripts = true;
  const nlohmann::ordered_json report = {{"request", detail::options_to_json(options)}};
  EXPECT_EQ(read_job_text(report.dump()).gmsh, "gmsh");
  EXPECT_FALSE(read_job_text(report.dump()).trust_scripts);
}

TEST(Options, TheReportTakesThePlaceOfNoFileOfTheRun) {
  RoughenOptions options = good_options();
  options.output = "r_{realization:02}.msh";
  options.realizations = 3;
  options.first = 1;
  for (const std::string report : {"r_01.msh", "r_03.msh", "./x/../r_02.msh"}) {
    options.report = report;
    EXPECT_NE(refusal(options).find("--report"), std::string::npos) << report;
  }
  for (const std::string report : {"r_00.msh", "r_04.msh", "r_1.msh", "r_.msh", "r.json"}) {
    options.report = report;
    EXPECT_EQ(refusal(options), "") << report;
  }
}

TEST(Options, CadIsMeshedForTheShortestLength) {
  RoughenOptions options = good_options();
  options.input = "a.STEP";
  options.surfaces[0].length = {2, 0.5, 1};
  EXPECT_DOUBLE_EQ(geometry_options(options).mesh_size, 0.5 / 2.5);
  options.surfaces.push_back(options.surfaces[0]);
  options.surfaces[1].length = {0.25};
  EXPECT_DOUBLE_EQ(geometry_options(options).mesh_size, 0.25 / 2.5);
  options.input = "a.GEO";
  EXPECT_EQ(geometry_options(options).mesh_size, 0);
}

TEST(Options, OutputNamesFollowTheTemplate) {
  EXPECT_EQ(output_path("rough_{realization}.msh", 7), "rough_7.msh");
  EXPECT_EQ(output_path("{realization:04}/r{realization}.vtu", 12), "0012/r12.vtu");
  EXPECT_EQ(output_path("plain.msh", 3), "plain.msh");
  EXPECT_EQ(output_path("{other}{realization:x}", 3), "{other}{realization:x}");
  const auto report_of = [](const std::string& output) {
    RoughenOptions options;
    options.output = output;
    return report_path(options);
  };
  EXPECT_EQ(report_of("rough_{realization}.msh"), "rough_.report.json");
  EXPECT_EQ(report_of("out/rough.msh"), "out/rough.report.json");
  EXPECT_EQ(report_of("a{realization:04}b.vtu"), "ab.report.json");
  EXPECT_EQ(report_of("runs/run_{realization}/rough.msh"), "runs/rough.report.json");
  EXPECT_EQ(report_of("{realization}/rough.msh"), "rough.report.json");
}
