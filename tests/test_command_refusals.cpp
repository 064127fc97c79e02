// SPDX-License-Identifier: BSD-3-Clause
// What the command refuses before any work: one line that names the option, and code 2.
#include <regex>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"
#include "roughmesh/options.hpp"

#include "support/cells.hpp"
#include "support/command_line.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/planar.hpp"
#include "support/process.hpp"

using namespace roughmesh;
using test::command;
using test::expect_failure;
using test::for_every_option;
using test::Outcome;
using test::sphere_job;

namespace {

using CommandRefusals = test::CommandLine;

TEST_F(CommandRefusals, EveryOptionRefusesNonsenseWithCodeTwo) {
  RoughenOptions options;
  for_every_option(options, [&](const OptionText& text, auto& member) {
    using Member = std::decay_t<decltype(member)>;
    const std::string name(text.name);
    std::string flag = "--" + std::regex_replace(name, std::regex("_"), "-");
    const bool is_number = std::is_arithmetic_v<Member> ||
                           std::is_same_v<Member, std::optional<double>> ||
                           std::is_same_v<Member, std::vector<double>>;
    std::vector<std::string> nonsense;
    if (std::is_same_v<Member, bool>)
      nonsense = {"=maybe"};
    else if (is_number)
      nonsense = {" x", " -1", " -1e999", " 1..2", " ''", " nan", " 0x10", " 1,"};
    else if (std::is_enum_v<Member>)
      nonsense = {" nonsense", " ''"};
    else if (name == "group")
      nonsense = {" nobody", " -7", " 99999999999999999999999"};
    else if (name == "input")
      return expect_failure(run("roughen nothing.msh -o rough.msh --rms 1 --length 1"), 2, name);
    else if (name == "output")
      nonsense = {" rough.xyz", " no/such/folder/rough.msh", " /", " ''"};
    else if (name == "report")
      nonsense = {" no/such/folder/r.json"};
    for (const std::string& value : nonsense) {
      const std::string base = name == "output" ? sphere_job : sphere_job + "-o rough.msh ";
      expect_failure(run(base + flag + value), 2, flag + value);
    }
  });
}

TEST_F(CommandRefusals, WrongUsageIsCodeTwo) {
  for (const std::string arguments :
       {"roughen", "roughen sphere.msh", "roughen sphere.msh -o a.msh", "frobnicate",
        "roughen --frob", "roughen sphere.msh -o a.msh --rms 1",
        "roughen sphere.msh -o a.msh --length 1", "info", "info nothing.msh",
        "roughen sphere.msh extra -o a.msh --rms 1 --length 1", "roughen --job nothing.json",
        "roughen sphere.msh -o a.msh --rms 1 --length 1 --realizations 2",
        "roughen ball.msh -o a.msh --rms 0.01 --length 0.3",
        "roughen . -o a.msh --rms 1 --length 1"})
    expect_failure(run(arguments), 2, arguments);
}

// Options that would do nothing, values of the wrong kind, files that are not what they are called.
TEST_F(CommandRefusals, SaysWhatCannotBeDone) {
  const std::string script = "SystemCall \"touch executed\";\nPoint(1) = {0, 0, 0};\n";
  test::write_bytes(folder / "script.geo", script);
  test::write_bytes(folder / "SCRIPT.GEO", script);
  std::filesystem::create_directory(folder / "folder.step");
  const std::string job = " -o a.msh --rms 0.02 --length 0.8 ";
  for (const auto& [input, arguments, reason] : std::vector<std::array<std::string, 3>>{
           {"sphere.msh", "--mesh-size 0.1", "is a mesh"},
           {"sphere.msh", "--mesh-size 0", "--mesh-size"},
           {"sphere.msh", "--ascii --binary", "--ascii"},
           {"sphere.msh", "--fade 1:nothing", "'nothing'"},
           {"sphere.msh", "--distance curve", "needs lines"},
           {"sphere.msh", "--period 1,2", "--period: 2 numbers"},
           {"sphere.msh", "--acf table --table missing.txt", "missing.txt"},
           {"folder.step", "", "is a directory"},
           {"script.geo", "", "script.geo:1: SystemCall"},
           {"SCRIPT.GEO", "", "SCRIPT.GEO:1: SystemCall"},
           {"script.geo", "--trust-scripts --gmsh /nonexistent", "/nonexistent: not found"}}) {
    const Outcome outcome = run("roughen " + input + job + arguments);
    expect_failure(outcome, 2, input + " " + arguments);
    EXPECT_NE(outcome.err.find(reason), std::string::npos) << outcome.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "executed"));
}

TEST_F(CommandRefusals, SaysWhatCannotBeMeshedAnew) {
  const std::string job = " --rms 0.02 --length 0.8 ";
  const std::string remesh = " --volume remesh ";
  write_mesh(test::ring(24), folder / "ring.msh");
  for (const auto& [input, arguments, reason] : std::vector<std::array<std::string, 3>>{
           {"sphere.msh", "-o a.msh --box 2", "--box: 2; the space up to the box"},
           {"sphere.msh", "-o a.msh --box 1" + remesh, "--box: 1; must be above 1"},
           {"ball.msh --group surface", "-o a.msh --box 2" + remesh,
            "--box: 2; the mesh has volumes"},
           {"sphere.msh", "-o a.stl" + remesh, "a.stl: holds surfaces only"},
           {"sphere.msh", "-o a.ply" + remesh, "a.ply: holds surfaces only"},
           {"ring.msh --group interface", "-o a.msh" + remesh, "planar mesh"},
           {"sphere.msh", "-o a.msh --gmsh /nonexistent" + remesh, "/nonexistent: not found"}}) {
    const Outcome outcome = run("roughen " + input + job + arguments);
    expect_failure(outcome, 2, input + " " + arguments);
    EXPECT_NE(outcome.err.find(reason), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"ball.msh", "ring.msh", "sphere.msh"}));
}

// One line that begins with the option, and before anything is computed: Rq of 10^9 would be
// refused with code 1.
TEST_F(CommandRefusals, RefusesFieldsThatAreNoneBeforeTheWork) {
  const std::string job = "roughen ball.msh -o a.msh --group surface --rms 1e9 ";
  for (const auto& [arguments, option] : std::vector<std::array<std::string, 2>>{
           {"--length 1e300", "--length"},
           {"--length 1e-300", "--length"},
           {"--length nan", "--length"},
           {"--length inf", "--length"},
           {"--length -1", "--length"},
           {"--length inf,inf", "--length"},
           {"--length 1,nan,1", "--length"},
           {"--length 1 --cutoff 0", "--cutoff"},
           {"--length 1 --cutoff nan", "--cutoff"},
           {"--length 1 --cutoff -0.1", "--cutoff"},
           {"--length 1 --cutoff inf", "--cutoff"},
           {"--length 1 --cutoff 0.1 --method cholesky", "--cutoff"},
           {"--length 1 --cutoff 0.1 --distance minimum-image --period 3,0,0", "--cutoff"},
           {"--length 1 --method lattice --distance great-circle", "--method"},
           {"--length 1 --tolerance 0", "--tolerance"},
           {"--length 1 --tolerance nan", "--tolerance"},
           {"--length 1 --tolerance 2", "--tolerance"},
           {"--length 1 --distance periodic --period 0,0,0", "--period"},
           {"--length 1 --distance periodic --period inf,0,0", "--period"},
           {"--length 1 --distance periodic --period 0.9,0,0", "--period"},
           {"--length 1 --distance minimum-image --period 0.9,0,0", "--period"}}) {
    const Outcome outcome = run(job + arguments);
    expect_failure(outcome, 2, arguments);
    EXPECT_TRUE(outcome.err.starts_with("roughmesh: " + option)) << outcome.err;
  }
}

}  // namespace
