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
  options.surfaces[0].axes = {Vec3(1, 0.1 + 0.2, 0), Vec3(0, 0, 1e-3)};
  options.surfaces[0].cutoff = 1.0 / 3;
  options.method = Method::lattice;
  options.tolerance = 1e-5;
  options.volume = VolumeChoice::none;
  options.surfaces[0].seed = std::numeric_limits<std::uint64_t>::max();
  options.surfaces[0].flip = true;
  const auto json = detail::options_to_json(options);
  const RoughenOptions back = detail::options_from_json(nlohmann::json::parse(json.dump()), "test");
  EXPECT_EQ(detail::options_to_json(back), json);
  EXPECT_EQ(back.surfaces[0].seed, options.surfaces[0].seed);
  EXPECT_EQ(back.surfaces[0].length, options.surfaces[0].length);
  EXPECT_EQ(*back.surfaces[0].hurst, *options.surfaces[0].hurst);
  EXPECT_EQ(back.surfaces[0].axes, options.surfaces[0].axes);
  EXPECT_EQ(back.surfaces[0].cutoff, options.surfaces[0].cutoff);
  EXPECT_EQ(back.method, Method::lattice);
}

TEST(Options, TomlAndJsonJobsMeanTheSame) {
  const RoughenOptions toml = read_job_text(
      "input = \"a.msh\"\nrms = 2\nlength = [10, inf, 5.5]\nacf = \"matern\"\nnu = 1.5\nseed = 3\n"
      "group = [\"surface\", 4]\nflip = true\naxes = [[1, 0, 0], [0, 2.0, 0]]\ncutoff = 1\n");
  const RoughenOptions json = read_job_text(
      R"({"input": "a.msh", "rms": 2, "length": [10, "inf", 5.5], "acf": "matern", "nu": 1.5, "seed": 3,
          "group": ["surface", "4"], "flip": true, "axes": [[1, 0, 0], [0, 2, 0]], "cutoff": 1})");
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
        "{\"request\": 3}", "group = [[1]]", "axes = [1, 0, 0]", "axes = [[1, 0], [0, 1]]",
        "axes = [[1, 0, 'x'], [0, 1, 0]]", "axes = 3", "method = 'fft'", "cutoff = 'x'"}) {
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
          {"--cutoff", [](auto& o, double x) { o.surfaces[0].cutoff = x; }},
          {"--mesh-size", [](auto& o, double x) { o.mesh_size = x; }},
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

// Lengths far beyond any mesh, whose powers a double does not hold. One infinite length of several
// makes streaks, all do not.
TEST(Options, LengthsBeyondAnyMeshAreRefused) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  using Lengths = std::vector<double>;
  const auto refused = [](const std::string& option, const auto& set) {
    RoughenOptions options = good_options();
    set(options.surfaces[0]);
    return refusal(options).starts_with(option + ": ");
  };
  for (const double x : {1e300, 1e-300, -1.0, nan}) {
    EXPECT_TRUE(refused("--rms", [&](auto& o) { o.rms = x; })) << x;
    EXPECT_TRUE(refused("--length", [&](auto& o) { o.length = {x}; })) << x;
    EXPECT_TRUE(refused("--cutoff", [&](auto& o) { o.cutoff = x; })) << x;
    EXPECT_TRUE(refused("--period", [&](auto& o) { o.period = {0, x, 1}; })) << x;
    EXPECT_TRUE(refused("--rolloff", [&](auto& o) {
      o.acf = Family::self_affine, o.hurst = 0.5, o.length = {}, o.rolloff = x;
    })) << x;
    for (const Lengths& lengths : {Lengths{x, 1}, Lengths{1, x}, Lengths{1, inf, x}})
      EXPECT_TRUE(refused("--length", [&](auto& o) { o.length = lengths; })) << x;
  }
  for (const Lengths& lengths : {Lengths{inf}, Lengths{inf, inf}, Lengths{inf, inf, inf}})
    EXPECT_TRUE(refused("--length", [&](auto& o) { o.length = lengths; }));
  for (const Lengths& lengths : {Lengths{inf, 0.1, 0.1}, Lengths{inf, inf, 1}, Lengths{1, inf}})
    EXPECT_FALSE(refused("--length", [&](auto& o) { o.length = lengths; }));
  EXPECT_FALSE(refused("--length", [](auto& o) { o.length = {1e-9}; }));
  EXPECT_TRUE(refused("--cutoff", [](auto& o) { o.cutoff = 1e-10 * o.length[0]; }));
  EXPECT_FALSE(refused("--cutoff", [](auto& o) { o.cutoff = 1e-8 * o.length[0]; }));
}

TEST(Options, ToleranceIsAShare) {
  for (const double x : {0.0, -1e-4, 1.0, 2.0, std::nan("")}) {
    RoughenOptions options = good_options();
    options.tolerance = x;
    EXPECT_TRUE(refusal(options).starts_with("--tolerance: ")) << x;
  }
}

// Each refusal names a way out that is taken.
TEST(Options, MethodCutoffAndDistanceMustFitTogether) {
  for (const DistanceKind kind :
       {DistanceKind::great_circle, DistanceKind::minimum_image, DistanceKind::curve}) {
    RoughenOptions options = good_options();
    options.surfaces[0].distance = kind;
    EXPECT_EQ(refusal(options), "");
    options.method = Method::lattice;
    EXPECT_NE(refusal(options).find("take --method cholesky"), std::string::npos) << name(kind);
    options.method = Method::cholesky;
    EXPECT_EQ(refusal(options), "");
    options.surfaces[0].cutoff = 1;
    EXPECT_NE(refusal(options).find("--cutoff"), std::string::npos) << name(kind);
    options.method = Method::automatic;
    EXPECT_NE(refusal(options).find("--cutoff"), std::string::npos) << name(kind);
  }
  for (const Method method : {Method::automatic, Method::lattice})
    for (const auto& kind : {std::optional<DistanceKind>(), std::optional(DistanceKind::euclidean),
                             std::optional(DistanceKind::periodic)}) {
      RoughenOptions options = good_options();
      options.method = method;
      options.surfaces[0].distance = kind;
      options.surfaces[0].cutoff = 1;
      EXPECT_EQ(refusal(options), "");
    }
  RoughenOptions options = good_options();
  options.method = Method::cholesky;
  options.surfaces[0].cutoff = 1;
  EXPECT_NE(refusal(options).find("--cutoff"), std::string::npos);
}

// The columns, to round-off: of directions of any size that are orthogonal to what seven typed
// digits give, of the first two of three, and of an angle.
TEST(Options, AxesOfLengthsAreOrthonormal) {
  Roughness request{.length = {1, 2, 3}};
  request.axes = {Vec3(3e200, 4e200, 0), Vec3(-0.8, 0.6 + 5e-7, 0)};
  for (const bool has_third : {false, true}) {
    if (has_third) request.axes.emplace_back(3e-7, 0, -1e-200 + 1);
    const Eigen::Matrix3d axes = length_axes(request);
    EXPECT_LT((axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm(), 1e-15);
    EXPECT_LT((axes.col(0) - Vec3(0.6, 0.8, 0)).norm(), 1e-15);
    EXPECT_LT((axes.col(1) - Vec3(-0.8, 0.6, 0)).norm(), 1e-6);
    EXPECT_LT((axes.col(2) - Vec3::UnitZ()).norm(), 1e-6);
  }
  request.axes = {};
  request.angle = 90;
  EXPECT_LT((length_axes(request).col(0) - Vec3::UnitY()).norm(), 1e-15);
}

TEST(Options, AxesThatAreNoneAreRefused) {
  const double inf = std::numeric_limits<double>::infinity();
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  using Axes = std::vector<Vec3>;
  const auto refusal_of = [](const Axes& axes, double angle, const std::vector<double>& length) {
    RoughenOptions options = good_options();
    options.surfaces[0].length = length;
    options.surfaces[0].axes = axes;
    options.surfaces[0].angle = angle;
    return refusal(options);
  };
  for (const Axes& axes : {Axes{x}, Axes{x, y, z, z}, Axes{x, x}, Axes{x, Vec3(2e-6, 1, 0)},
                           Axes{x, y, y}, Axes{x, y, Vec3(0, 2e-6, 1)}, Axes{x, Vec3::Zero()},
                           Axes{x, Vec3(0, inf, 0)}, Axes{x, Vec3(0, std::nan(""), 1)}})
    EXPECT_TRUE(refusal_of(axes, 0, {1, 2, 3}).starts_with("axes: "))
        << refusal_of(axes, 0, {1, 2});
  EXPECT_EQ(refusal_of({x, y}, 0, {1, 2, 3}), "");
  EXPECT_EQ(refusal_of({z, x, y}, 0, {1, 2}), "");
  EXPECT_NE(refusal_of({x, y}, 10, {1, 2, 3}), "");  // both
  EXPECT_NE(refusal_of({x, y}, 0, {1}), "");         // nothing to turn
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

// What a field depends on, by name; what it does not depend on may differ.
TEST(Options, SurfacesShareAFieldOnlyWhereItIsOne) {
  const Roughness one{.rms = 1, .length = {1, 2, 3}};
  const auto is_same = [&](const auto& change) {
    Roughness other = one;
    change(other);
    return same_field(one, other);
  };
  EXPECT_TRUE(is_same([](auto& o) { o.rms = 2, o.flip = true, o.group = {"a"}; }));
  EXPECT_FALSE(is_same([](auto& o) { o.cutoff = 1; }));
  EXPECT_FALSE(is_same([](auto& o) { o.axes = {Vec3::UnitY(), Vec3::UnitX()}; }));
  EXPECT_FALSE(is_same([](auto& o) { o.seed = 1; }));
  EXPECT_FALSE(is_same([](auto& o) { o.length[2] = 4; }));
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
