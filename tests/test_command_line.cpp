// SPDX-License-Identifier: BSD-3-Clause
// The command as users meet it: files, exit codes, one line per failure, nothing half-written.
#include <array>
#include <csignal>
#include <regex>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "roughmesh/mesh_io.hpp"
#include "roughmesh/options.hpp"

#include "support/cells.hpp"
#include "support/command_line.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/planar.hpp"
#include "support/process.hpp"
#include "support/second_order.hpp"

using namespace roughmesh;
using test::command;
using test::CommandLine;
using test::expect_failure;
using test::for_every_option;
using test::Outcome;
using test::sphere_job;
using test::TemporaryFolder;

namespace {

/// A box of second order, periodic along x and y, with links for all nodes of the sides.
Mesh linked_box() {
  Mesh mesh = test::second_order(test::cell_box(ElementShape::tetrahedron, 4), true);
  for (int axis = 0; axis < 2; ++axis) {
    PeriodicLink link{2, axis + 11, axis + 21, {}, {}};
    for (Index slave = 0; slave < mesh.n_nodes(); ++slave)
      for (Index master = 0; master < mesh.n_nodes(); ++master)
        if (mesh.nodes[slave] - mesh.nodes[master] == Vec3::Unit(axis))
          link.nodes.emplace_back(slave, master);
    mesh.periodic_links.push_back(link);
  }
  return mesh;
}

nlohmann::json report_but_for_timings(const std::filesystem::path& path) {
  nlohmann::json report = nlohmann::json::parse(test::read_bytes(path));
  report.erase("timings");
  return report;
}

}  // namespace

TEST_F(CommandLine, RoughensAndReports) {
  const Outcome outcome = run(sphere_job + "-o rough_{realization:02}.msh --realizations 3");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(folder.names(),
            (std::vector<std::string>{"ball.msh", "rough_.report.json", "rough_00.msh",
                                      "rough_01.msh", "rough_02.msh", "sphere.msh"}));
  const auto report = nlohmann::json::parse(test::read_bytes(folder / "rough_.report.json"));
  EXPECT_EQ(report["realizations"][2]["path"], "rough_02.msh");
}

TEST_F(CommandLine, RealizationSevenOfTenIsFirstSevenByteForByte) {
  ASSERT_EQ(run(sphere_job + "-o a_{realization}.msh --realizations 10").exit_code, 0);
  ASSERT_EQ(run(sphere_job + "-o b.msh --first 7").exit_code, 0);
  EXPECT_EQ(test::read_bytes(folder / "a_7.msh"), test::read_bytes(folder / "b.msh"));
  EXPECT_NE(test::read_bytes(folder / "a_6.msh"), test::read_bytes(folder / "b.msh"));
}

TEST_F(CommandLine, AReportReproducesItsMeshByteForByte) {
  ASSERT_EQ(
      run("roughen ball.msh -o rough.msh --group surface --rms 0.01 --length 0.4 --acf matern "
          "--nu 1.5 --seed 99 --threads 2")
          .exit_code,
      0);
  const std::string bytes = test::read_bytes(folder / "rough.msh");
  std::filesystem::rename(folder / "rough.report.json", folder / "job.json");
  std::filesystem::remove(folder / "rough.msh");
  const Outcome again = run("roughen --job job.json");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(test::read_bytes(folder / "rough.msh"), bytes);
  EXPECT_EQ(again.err.find("checksum"), std::string::npos);
  // A changed input is told.
  std::filesystem::copy_file(folder / "rough.msh", folder / "ball.msh",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_NE(run("roughen --job job.json -o other.msh --rms 0.001").err.find("checksum"),
            std::string::npos);
  // Arguments override the job.
  EXPECT_EQ(run("roughen --job job.json --seed 98 -o other.msh").exit_code, 0);
  EXPECT_NE(test::read_bytes(folder / "other.msh"), bytes);
}

// What the run finds out itself (distance and period of the links, method, threads) stands in the
// report, and given back leads to the same run.
TEST_F(CommandLine, AReportReproducesARunOnALinkedMeshOfSecondOrder) {
  write_mesh(linked_box(), folder / "box.msh");
  const Mesh box = read_mesh(folder / "box.msh");
  const Outcome first =
      run("roughen box.msh -o rough_{realization}.msh --group top --rms 0.01 --length 0.5 --acf "
          "exponential --first 3 --realizations 2 --report run.json");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  std::filesystem::create_directory(folder / "first");
  for (const std::string name : {"rough_3.msh", "rough_4.msh", "run.json"})
    std::filesystem::rename(folder / name, folder / ("first/" + name));

  const Outcome again = run("roughen --job first/run.json");
  EXPECT_EQ(again.err, first.err);
  for (const std::string name : {"rough_3.msh", "rough_4.msh"})
    EXPECT_EQ(test::read_bytes(folder / name), test::read_bytes(folder / ("first/" + name)));
  const nlohmann::json report = report_but_for_timings(folder / "run.json");
  EXPECT_EQ(report, report_but_for_timings(folder / "first/run.json"));
  EXPECT_EQ(report["request"]["distance"], "periodic");
  EXPECT_EQ(report["request"]["period"], nlohmann::json({1.0, 1.0, 0.0}));

  const Mesh rough = read_mesh(folder / "rough_4.msh");
  std::size_t n_moved = 0;
  ASSERT_EQ(rough.periodic_links.size(), 2U);
  for (const PeriodicLink& link : rough.periodic_links)
    for (const auto& [slave, master] : link.nodes) {
      EXPECT_EQ(rough.nodes[slave].z(), rough.nodes[master].z());
      n_moved += rough.nodes[slave] != box.nodes[slave] ? 1 : 0;
    }
  EXPECT_GE(n_moved, 2U * 9U);  // corners and middles of an edge of four elements, along x and y
}

TEST_F(CommandLine, TakesAnisotropicLengthsAndNumbersAsWritten) {
  const std::string job = "roughen sphere.msh --rms 0.02 -o rough.msh ";
  const auto request = [&](const std::string& arguments) {
    const Outcome outcome = run(job + arguments);
    EXPECT_EQ(outcome.exit_code, 0) << arguments << ": " << outcome.err;
    return nlohmann::json::parse(test::read_bytes(folder / "rough.report.json"))["request"];
  };
  EXPECT_EQ(request("--length 1,2")["length"], (std::vector<double>{1, 2}));
  EXPECT_EQ(request("--length=1,2,.5 --angle -30")["length"], (std::vector<double>{1, 2, 0.5}));
  EXPECT_EQ(request("--length 1,2,inf")["length"][2], "inf");
  EXPECT_EQ(request("--length 1 --seed 010")["seed"], 10U);
  EXPECT_EQ(request("--length 1 --group surface --group 1")["group"],
            (std::vector<std::string>{"surface", "1"}));
}

TEST_F(CommandLine, NeverOverwritesAFileOfTheSameRunWithItsReport) {
  for (const std::string report : {"sphere.msh", "./rough.msh", "rough.msh"})
    expect_failure(run(sphere_job + "-o rough.msh --report " + report), 2, report);
  EXPECT_EQ(read_mesh(folder / "sphere.msh").n_nodes(), 162);
}

TEST_F(CommandLine, ARealizationMayHaveItsOwnFolder) {
  for (const std::string name : {"run_0", "run_1"})
    std::filesystem::create_directory(folder / name);
  ASSERT_EQ(run(sphere_job + "-o run_{realization}/rough.msh --realizations 2").exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "rough.report.json"));
  EXPECT_TRUE(std::filesystem::exists(folder / "run_1/rough.msh"));
}

// Rq of 2e-5 is at most 340 spacings of float32 near 1 (2^-24 below, 2^-23 above), 1e11 of float64.
TEST_F(CommandLine, WarnsWhereTheOutputRoundsHeightsAndNotWhereTheInputDid) {
  const std::string job = "roughen sphere.msh --rms 2e-5 --length 0.8 ";
  EXPECT_NE(run(job + "-o a.stl --binary").err.find("spacings"), std::string::npos);
  EXPECT_EQ(run(job + "-o a.msh").err.find("spacings"), std::string::npos);
  EXPECT_EQ(run("roughen a.stl --rms 2e-5 --length 0.8 -o b.msh").err.find("spacings"),
            std::string::npos);
  const auto report = nlohmann::json::parse(test::read_bytes(folder / "a.report.json"));
  EXPECT_TRUE(report["warnings"].empty());
}

TEST_F(CommandLine, MessagesHoldNoControlCharacters) {
  const Outcome outcome = run("roughen $'no\nsuch\x1b[31mfile.msh' -o a.msh --rms 1 --length 1");
  expect_failure(outcome, 2, "control characters");
  EXPECT_EQ(outcome.err.find('\x1b'), std::string::npos);
}

TEST_F(CommandLine, WritesOverItsInput) {
  ASSERT_EQ(run(sphere_job + "-o rough.msh").exit_code, 0);
  ASSERT_EQ(run(sphere_job + "-o sphere.msh").exit_code, 0);
  EXPECT_EQ(test::read_bytes(folder / "rough.msh"), test::read_bytes(folder / "sphere.msh"));
}

// One declaration: what C++ has, --help shows, a report holds and a job takes.
TEST_F(CommandLine, HelpReportAndOptionsAgree) {
  const Outcome help = run("roughen --help");
  EXPECT_EQ(help.exit_code, 0);
  ASSERT_EQ(run(sphere_job + "-o rough.msh").exit_code, 0);
  const auto request =
      nlohmann::json::parse(test::read_bytes(folder / "rough.report.json"))["request"];
  RoughenOptions options;
  std::size_t count = 0;
  for_every_option(options, [&](const OptionText& text, auto&) {
    ++count;
    EXPECT_TRUE(request.contains(std::string(text.name))) << text.name;
    if (text.name == "mask" || text.name == "axes") return;  // for job files only
    std::string flag = "--" + std::regex_replace(std::string(text.name), std::regex("_"), "-");
    if (text.name == "input") flag = "INPUT";
    EXPECT_NE(help.out.find(flag), std::string::npos) << flag;
  });
  EXPECT_EQ(request.size(), count);
}

TEST_F(CommandLine, VersionAndHelpSucceed) {
  EXPECT_TRUE(std::regex_match(run("--version").out, std::regex("roughmesh \\d+\\.\\d+\\.\\d+\n")));
  EXPECT_NE(run("--help").out.find("roughen"), std::string::npos);
  EXPECT_EQ(run("").exit_code, 0);
  EXPECT_NE(run("info --help").out.find("--group"), std::string::npos);
}

TEST_F(CommandLine, AFileThatIsNoMeshIsCodeThree) {
  test::write_bytes(folder / "script.msh",
                    "SystemCall \"touch executed\";\nPoint(1) = {0,0,0,1};\n");
  test::write_bytes(folder / "empty.msh", "");
  const std::string whole = test::read_bytes(folder / "sphere.msh");
  test::write_bytes(folder / "half.msh", whole.substr(0, whole.size() / 2));
  for (const std::string file : {"script.msh", "empty.msh", "half.msh"}) {
    expect_failure(run("roughen " + file + " -o rough.msh --rms 1 --length 1"), 3, file);
    expect_failure(run("info " + file), 3, file);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "executed"));
}

TEST_F(CommandLine, InvertedElementsAreCodeOneAndNothingIsWritten) {
  const auto before = folder.names();
  const std::string job = "roughen ball.msh -o rough.msh --group surface --rms 0.3 --length 0.2 ";
  const Outcome refused = run(job);
  expect_failure(refused, 1, "inverted");
  EXPECT_NE(refused.err.find("--rms"), std::string::npos);
  EXPECT_EQ(folder.names(), before);
  const Outcome allowed = run(job + "--allow-invalid");
  EXPECT_EQ(allowed.exit_code, 0);
  EXPECT_NE(allowed.err.find("warning"), std::string::npos);
}

TEST_F(CommandLine, ReportsOutputsThatCannotBeWrittenBeforeTheWork) {
  // Rq of 10^9 would be refused with code 1, had anything been computed.
  const std::string job = "roughen ball.msh --group surface --rms 1e9 --length 0.3 ";
  for (const std::string output :
       {"-o rough.xyz", "-o no/rough.msh", "-o rough.msh --report no/r.json"})
    expect_failure(run(job + output), 2, output);
}

TEST_F(CommandLine, AFullDiskLeavesNoPartialFile) {
  const auto before = folder.names();
  // A file size limit of 8 blocks stands in for a full disk: the write fails in the middle.
  const Outcome outcome = run(sphere_job + "-o rough.msh; exit $?");
  ASSERT_EQ(outcome.exit_code, 0);
  std::filesystem::remove(folder / "rough.msh");
  std::filesystem::remove(folder / "rough.report.json");
  const Outcome full =
      test::run_in(folder, "ulimit -f 8; " + command + " " + sphere_job + "-o rough.msh");
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_NE(full.err.find("rough.msh"), std::string::npos) << full.err;
  EXPECT_EQ(folder.names(), before);
}

TEST_F(CommandLine, AStoppedRunDescribesTheRealizationsBefore) {
  for (const std::string name : {"0", "1", "2"}) std::filesystem::create_directory(folder / name);
  const Outcome outcome = run(sphere_job + "-o {realization}/rough.msh --realizations 5");
  expect_failure(outcome, 2, "no folder for realization 3");
  const auto report = nlohmann::json::parse(test::read_bytes(folder / "rough.report.json"));
  ASSERT_EQ(report["realizations"].size(), 3U);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(report["realizations"][k]["index"], k);
    EXPECT_EQ(report["realizations"][k]["path"], std::to_string(k) + "/rough.msh");
  }
  EXPECT_TRUE(report["warnings"].back().get<std::string>().starts_with("stopped: "));
}

TEST_F(CommandLine, AnInterruptKeepsAndDescribesFinishedRealizationsOnly) {
  // Runs until a few realizations are there, then interrupts; 10^6 would take minutes.
  const Outcome outcome = test::run_in(
      folder, command + " " + sphere_job +
                  "-o r_{realization}.msh --realizations 1000000 & pid=$!; "
                  "while [ ! -e r_3.msh ]; do sleep 0.02; done; kill -INT $pid; wait $pid");
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  const std::size_t size = std::filesystem::file_size(folder / "r_0.msh");
  std::size_t n_meshes = 0;
  for (const std::string& name : folder.names()) {
    if (name == "ball.msh" || name == "sphere.msh" || name == "r_.report.json") continue;
    ASSERT_TRUE(std::regex_match(name, std::regex("r_\\d+\\.msh"))) << name;
    const Mesh mesh = read_mesh(folder / name);  // whole
    EXPECT_EQ(mesh.n_nodes(), 162);
    EXPECT_GT(std::filesystem::file_size(folder / name), size / 2);
    ++n_meshes;
  }
  EXPECT_GE(n_meshes, 4U);
  // The report tells of each, and the message where to go on.
  const auto report = nlohmann::json::parse(test::read_bytes(folder / "r_.report.json"));
  ASSERT_EQ(report["realizations"].size(), n_meshes);
  EXPECT_EQ(report["realizations"].back()["path"], fmt::format("r_{}.msh", n_meshes - 1));
  const std::string go_on =
      fmt::format("--first {} --realizations {} --report r_.from{}.report.json", n_meshes,
                  1000000 - n_meshes, n_meshes);
  EXPECT_NE(outcome.err.find(go_on), std::string::npos) << outcome.err;
  // Without a report of its own the rest would cost what is known of the beginning.
  const Outcome forgetful = run("roughen --job r_.report.json --realizations 1 --first 2");
  EXPECT_EQ(forgetful.exit_code, 2);
  EXPECT_NE(forgetful.err.find("r_.from2.report.json"), std::string::npos) << forgetful.err;
  ASSERT_EQ(run(sphere_job + fmt::format("-o more_{{realization}}.msh --realizations 2 --first {}",
                                         n_meshes - 1))
                .exit_code,
            0);
  EXPECT_EQ(test::read_bytes(folder / fmt::format("more_{}.msh", n_meshes - 1)),
            test::read_bytes(folder / fmt::format("r_{}.msh", n_meshes - 1)));
}

TEST_F(CommandLine, ShowsItsProgressOnATerminalOnly) {
  if (test::run_in(folder, "command -v script").exit_code != 0) GTEST_SKIP() << "no script";
  const std::string job = sphere_job + "-o r_{realization}.msh --realizations 1000000";
  const auto interrupted = [&](const std::string& start) {
    test::write_bytes(folder / "run.sh", start +
                                             " & pid=$!\n"
                                             "while [ ! -e r_3.msh ]; do sleep 0.02; done\n"
                                             "sleep 0.5; kill -INT $pid; wait $pid\n");
  };
  interrupted(command + " " + job);
  const std::string shown = test::run_in(folder, "script -qec 'sh run.sh' /dev/null").out;
  EXPECT_NE(shown.find("/1000000"), std::string::npos) << shown;
  EXPECT_NE(shown.find(" left"), std::string::npos) << shown;
  std::filesystem::remove(folder / "r_3.msh");
  EXPECT_EQ(test::run_in(folder, "sh run.sh").err.find(" left"), std::string::npos);
  std::filesystem::remove(folder / "r_3.msh");
  interrupted(command + " " + job + " --quiet");
  EXPECT_EQ(test::run_in(folder, "script -qec 'sh run.sh' /dev/null").out.find(" left"),
            std::string::npos);
}

TEST_F(CommandLine, InfoStatesSizesOfTheFirstFiftyGroupsAndElementsOfAll) {
  Mesh mesh = test::icosphere(1);
  mesh.groups.clear();
  for (Tag tag = 1; tag <= 60; ++tag) mesh.groups.push_back({2, tag, fmt::format("g{}", tag)});
  for (const PhysicalGroup& group : mesh.groups)
    mesh.blocks[0].physical_groups.push_back(group.tag);
  mesh.blocks[0].physical_groups.erase(mesh.blocks[0].physical_groups.begin(),
                                       mesh.blocks[0].physical_groups.end() - 60);
  write_mesh(mesh, folder / "groups.msh");
  const std::string out = run("info groups.msh --group g60").out;
  const std::regex with_size(" g\\d+ +80  area"), with_count(" g\\d+ +80(\n|  area)");
  const auto n = [&](const std::regex& line) {
    return std::distance(std::sregex_iterator(out.begin(), out.end(), line), {});
  };
  EXPECT_EQ(n(with_size), 50) << out;
  EXPECT_EQ(n(with_count), 60) << out;
  EXPECT_NE(out.find("first 50 groups only"), std::string::npos);
}

TEST_F(CommandLine, InfoTakesThePeriodOfTheLinks) {
  write_mesh(linked_box(), folder / "box.msh");
  for (const std::string options : {"", " --distance periodic", " --distance minimum-image"}) {
    const Outcome outcome = run("info box.msh --group top" + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find(", period 1, 1, 0 mesh units"), std::string::npos) << outcome.out;
    EXPECT_EQ(outcome.out.find("a periodic link joins"), std::string::npos);
  }
  const Outcome torn = run("info box.msh --group top --distance euclidean");
  EXPECT_EQ(torn.exit_code, 0) << torn.err;
  EXPECT_NE(torn.out.find("warning: a periodic link joins"), std::string::npos) << torn.out;
  const Outcome none = run("info ball.msh --group surface --distance periodic");
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("needs --period"), std::string::npos) << none.err;
}

TEST_F(CommandLine, InfoStatesGroupsAndResolution) {
  const Outcome outcome = run("info ball.msh --group surface --length 0.3 --rms 0.01");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const std::string text :
       {"surface", "outer", "inside", "outside", "h / l", "Sal", "largest safe Rq"})
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text;
  EXPECT_EQ(run("info ball.msh").exit_code, 0);  // several surfaces: lists them
}
