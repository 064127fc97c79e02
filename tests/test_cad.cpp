// SPDX-License-Identifier: BSD-3-Clause
// A geometry becomes a mesh with the coordinates of its file, or one clear line says why not.
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "roughmesh/cad.hpp"

#include "step_file.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"

using namespace roughmesh;
using test::message_of;

namespace {

#define NEEDS_GMSH() \
  if (!test::has_gmsh()) GTEST_SKIP() << "gmsh is not installed"

Eigen::AlignedBox3d box_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& node : mesh.nodes) box.extend(node);
  return box;
}

double volume_of(const Mesh& mesh) {
  double volume = 0;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; block.type.shape == ElementShape::tetrahedron && e < block.size(); ++e) {
      const auto corners = block.element(e);
      const auto edge = [&](int k) -> Vec3 {
        return mesh.nodes[corners[k]] - mesh.nodes[corners[0]];
      };
      volume += edge(1).dot(edge(2).cross(edge(3))) / 6;
    }
  return std::abs(volume);
}

std::set<std::string> group_names(const Mesh& mesh) {
  std::set<std::string> names;
  for (const PhysicalGroup& group : mesh.groups)
    names.insert(std::to_string(group.dimension) + " " + group.name);
  return names;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t i = 0; (i = text.find(what, i)) != std::string::npos; i += by.size())
    text.replace(i, what.size(), by);
  return text;
}

constexpr const char* millimetre = "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )";

// A box of 1 by 2 by 3 as gmsh writes it, in mm.
class Cad : public testing::Test {
 protected:
  void SetUp() override {
    NEEDS_GMSH();
    test::write_bytes(folder_ / "box.geo",
                      "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 2, 3};\n");
    step_ = written_by_gmsh("box.geo", "box.step");
    ASSERT_NE(step_.find(millimetre), std::string::npos);
  }

  std::string written_by_gmsh(const std::string& script, const std::string& name) {
    test::run("cd '" + folder_.path().string() + "' && gmsh -0 -v 0 " + script + " -o " + name +
              " > /dev/null 2>&1");
    return test::read_bytes(folder_ / name);
  }

  std::filesystem::path write(const std::string& name, const std::string& text) {
    test::write_bytes(folder_ / name, text);
    return folder_ / name;
  }

  // The box's numbers, said to be in another unit.
  std::filesystem::path step_in(const std::string& unit) {
    return write("unit.step", replaced(step_, millimetre, unit));
  }

  std::filesystem::path script(const std::string& text) { return write("script.geo", text); }

  test::TemporaryFolder folder_;
  std::string step_;
};

void expect_box(const Mesh& mesh, const Vec3& size) {
  const Eigen::AlignedBox3d box = box_of(mesh);
  // OpenCASCADE converts the numbers twice, rounding each time.
  EXPECT_NEAR((box.min()).norm(), 0, 1e-12 * size.norm());
  EXPECT_NEAR((box.max() - size).norm(), 0, 1e-12 * size.norm());
  EXPECT_NEAR(volume_of(mesh), size.prod(), 1e-11 * size.prod());  // a box has flat faces
}

template <typename E>
std::string message(const std::filesystem::path& path, const GeometryOptions& options) {
  try {
    mesh_geometry(path, options);
  } catch (const E& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST(IsGeometry, IsToldByTheExtensionInAnyCase) {
  for (const char* const name : {"a.step", "a.STP", "b.Brep", "c.geo", "/x.y/a.STEP"})
    EXPECT_TRUE(is_geometry(name)) << name;
  for (const char* const name : {"a.msh", "a.stl", "step", "a.step.msh", "", "geo", "a.geo2"})
    EXPECT_FALSE(is_geometry(name)) << name;
}

TEST_F(Cad, SolidsAreMeshedWithTheirSurfaces) {
  const Mesh mesh = mesh_geometry(folder_ / "box.step", {.mesh_size = 0.5});
  expect_box(mesh, {1, 2, 3});
  EXPECT_GT(n_elements(mesh, 2), 0);
  EXPECT_GT(n_elements(mesh, 3), 0);
  EXPECT_EQ(mesh.format, MeshFormat::msh4);
}

TEST_F(Cad, EdgesHaveTheLengthAskedFor) {
  const auto n_nodes = [&](double size) {
    return mesh_geometry(folder_ / "box.step", {.mesh_size = size}).n_nodes();
  };
  // Halving the size gives up to eight times the nodes; fewer where most lie on the surface.
  const double ratio = static_cast<double>(n_nodes(0.15)) / n_nodes(0.3);
  EXPECT_GT(ratio, 4);
  EXPECT_LT(ratio, 8.5);
}

TEST_F(Cad, CoordinatesAreThoseOfTheFileInWhateverUnit) {
  const auto si = [](const std::string& prefix) {
    return "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(" + prefix + ",.METRE.) )";
  };
  for (const std::string prefix : {"$", ".CENTI.", ".MICRO.", ".KILO.", ".NANO."}) {
    SCOPED_TRACE(prefix);
    expect_box(mesh_geometry(step_in(si(prefix)), {.mesh_size = 0.8}), {1, 2, 3});
  }
}

TEST_F(Cad, CoordinatesInInchesAndOtherMultiplesAreThoseOfTheFile) {
  for (const std::string factor : {"25.4", "304.8", "7.5"}) {
    SCOPED_TRACE(factor);
    std::string text =
        replaced(step_, millimetre,
                 "( CONVERSION_BASED_UNIT('INCH',#90001) LENGTH_UNIT() NAMED_UNIT(#90002) )");
    const std::size_t end = text.rfind("ENDSEC;");
    text.insert(end, "#90001 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(" + factor +
                         "),#90003);\n#90002 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n"
                         "#90003 = " +
                         millimetre + ";\n");
    expect_box(mesh_geometry(write("inch.stp", text), {.mesh_size = 0.8}), {1, 2, 3});
  }
}

TEST_F(Cad, ShellsAreMeshedAsSurfaces) {
  script("SetFactory(\"OpenCASCADE\");\nRectangle(1) = {0, 0, 0, 2, 3};\n");
  written_by_gmsh("script.geo", "shell.step");
  const Mesh mesh = mesh_geometry(folder_ / "shell.step", {.mesh_size = 0.5});
  EXPECT_EQ(dimension(mesh), 2);
  EXPECT_NEAR((box_of(mesh).max() - Vec3(2, 3, 0)).norm(), 0, 1e-12);
}

TEST_F(Cad, BrepFilesAreMeshed) {
  script("SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 2, 3};\nSave \"box.brep\";\n");
  written_by_gmsh("script.geo", "ignored.step");
  expect_box(mesh_geometry(folder_ / "box.brep", {.mesh_size = 0.5}), {1, 2, 3});
}

TEST_F(Cad, LabelsOfPartsBecomePhysicalGroups) {
  script(
      "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\nBox(2) = {2, 0, 0, 1, 1, 1};\n"
      "Box(3) = {4, 0, 0, 1, 1, 1};\n");
  std::string text = written_by_gmsh("script.geo", "parts.step");
  const auto name = [&](const std::string& part, const std::string& by) {
    const std::size_t before = text.size();
    text = replaced(text, "'Open CASCADE STEP translator 7.6 1" + part + "'", "'" + by + "'");
    return text.size() != before;
  };
  if (!name("", "set")) GTEST_SKIP() << "another OpenCASCADE names parts otherwise";
  name(".1", "first");
  name(".2", "second $(id) \"; Exit;");
  const Mesh mesh = mesh_geometry(write("named.step", text), {.mesh_size = 0.5});
  EXPECT_TRUE(group_names(mesh).contains("3 set/1/first"));
  EXPECT_EQ(mesh.groups.size(), 3U);
  EXPECT_NEAR(volume_of(mesh), 3, 1e-11);
}

TEST_F(Cad, SolidsThatTouchOrOverlapShareTheirFaces) {
  // Two boxes with a common face, and a third with a smaller one inside.
  script(
      "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\nBox(2) = {1, 0, 0, 1, 1, 1};\n"
      "Box(3) = {3, 0, 0, 1, 1, 1};\nBox(4) = {3.25, 0.25, 0.25, 0.5, 0.5, 0.5};\n");
  written_by_gmsh("script.geo", "parts.step");
  const auto n_places = [](const Mesh& mesh) {
    std::set<std::array<double, 3>> places;
    for (const Vec3& node : mesh.nodes) places.insert({node.x(), node.y(), node.z()});
    return static_cast<Index>(places.size());
  };
  const Mesh shared = mesh_geometry(folder_ / "parts.step", {.mesh_size = 0.3});
  EXPECT_EQ(n_places(shared), shared.n_nodes());
  EXPECT_NEAR(volume_of(shared), 3, 1e-11);
  EXPECT_EQ(shared.groups.size(), 4U);
  const Mesh apart =
      mesh_geometry(folder_ / "parts.step", {.mesh_size = 0.3, .share_faces = false});
  EXPECT_NEAR(volume_of(apart), 3 + 0.125, 1e-11);  // the inner box is meshed twice
}

TEST_F(Cad, NeitherNameNorFolderOfTheInputIsSeenByGmsh) {
  for (const std::string name : {"-run.step", "a\"; SystemCall \"touch HERE\"; .step", "a\nb.step",
                                 "$(touch HERE).step", "%s%n.step"}) {
    write(name, step_);
    expect_box(mesh_geometry(folder_ / name, {.mesh_size = 0.8}), {1, 2, 3});
    EXPECT_FALSE(std::filesystem::exists(folder_ / "HERE"));
  }
}

TEST_F(Cad, OptionFilesBesideTheInputAreNotRead) {
  write("box.step.opt", "SystemCall \"touch HERE\";\n");
  write("box.geo.opt", "Mesh.MeshSizeFactor = 10;\nSystemCall \"touch HERE\";\n");
  const Mesh mesh = mesh_geometry(folder_ / "box.step", {.mesh_size = 0.5});
  mesh_geometry(folder_ / "box.geo", {.mesh_size = 0.5});
  EXPECT_GT(mesh.n_nodes(), 50);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "HERE"));
}

TEST_F(Cad, OtherFilesCalledStepOrBrepAreRefused) {
  const auto fake = write("evil.step", "SystemCall \"touch HERE\";\n");
  EXPECT_NE(message<FormatError>(fake, {.mesh_size = 1}).find("must begin with ISO-10303-21;"),
            std::string::npos);
  EXPECT_NE(message<FormatError>(write("evil.brep", step_), {.mesh_size = 1}).find("no BREP file"),
            std::string::npos);
  EXPECT_NE(message<FormatError>(write("empty.step", ""), {.mesh_size = 1}).find("no STEP file"),
            std::string::npos);
}

TEST_F(Cad, CorruptStepFilesAreToldApart) {
  const auto cut = write("cut.step", step_.substr(0, step_.size() / 2));
  EXPECT_NE(message<FormatError>(cut, {.mesh_size = 1}).find("cut.step: gmsh cannot read it: "),
            std::string::npos);
  const auto rubbish = write("rubbish.step", replaced(step_, ",0.,", ",0.x,"));
  EXPECT_NE(message<FormatError>(rubbish, {.mesh_size = 1}).find("export it again"),
            std::string::npos);
}

TEST_F(Cad, AFileWithoutSolidOrSurfaceIsRefused) {
  script(
      "SetFactory(\"OpenCASCADE\");\nPoint(1) = {0, 0, 0};\nPoint(2) = {1, 0, 0};\n"
      "Line(1) = {1, 2};\n");
  written_by_gmsh("script.geo", "line.step");
  EXPECT_NE(message<InputError>(folder_ / "line.step", {.mesh_size = 1})
                .find("holds no solid and no surface"),
            std::string::npos);
}

TEST_F(Cad, ASizeFarTooSmallIsRefusedBeforeMeshing) {
  const std::string said = message<InputError>(folder_ / "box.step", {.mesh_size = 1e-4});
  // 6 * sqrt(2) / 1e-12 and a little for the surface.
  EXPECT_NE(said.find("mesh size 0.0001 would give about 8.5e+12 nodes, more than 2e+07"),
            std::string::npos)
      << said;
}

TEST_F(Cad, CadFilesNeedAMeshSize) {
  for (const double size : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_NE(
        message<InputError>(folder_ / "box.step", {.mesh_size = size}).find("give --mesh-size"),
        std::string::npos);
}

TEST_F(Cad, ScriptsKeepTheirSizesAndGroups) {
  const Mesh mesh = mesh_geometry(
      script("SetFactory(\"OpenCASCADE\");\nSphere(1) = {0, 0, 0, 1};\nMesh.MeshSizeMax = 0.3;\n"
             "Physical Volume(\"ball\") = {1};\nPhysical Surface(\"skin\") = {1};\n"),
      {});
  EXPECT_EQ(group_names(mesh), (std::set<std::string>{"2 skin", "3 ball"}));
  EXPECT_EQ(dimension(mesh), 3);
}

TEST_F(Cad, AMeshSizeGivenReplacesThoseOfTheScript) {
  const auto path = script(
      "SetFactory(\"OpenCASCADE\");\nSphere(1) = {0, 0, 0, 1};\n"
      "Mesh.MeshSizeMax = 0.6;\nMesh 2;\n");
  EXPECT_GT(mesh_geometry(path, {.mesh_size = 0.1}).n_nodes(),
            5 * mesh_geometry(path, {}).n_nodes());
}

TEST_F(Cad, TheDimensionIsTheHighestOfAGroupElseOfAnEntity) {
  const std::string sphere =
      "SetFactory(\"OpenCASCADE\");\nSphere(1) = {0, 0, 0, 1};\n"
      "Mesh.MeshSizeMax = 0.5;\n";
  EXPECT_EQ(dimension(mesh_geometry(script(sphere), {})), 3);
  EXPECT_EQ(dimension(mesh_geometry(script(sphere + "Physical Surface(7) = {1};\n"), {})), 2);
  EXPECT_EQ(dimension(mesh_geometry(script(sphere + "Physical Curve(7) = {1, 2, 3};\n"), {})), 1);
  EXPECT_EQ(dimension(mesh_geometry(script(sphere + "Mesh 2;\n"), {})), 2);
}

TEST_F(Cad, ScriptsThatSetTheOutputFormatAreReadAllTheSame) {
  const Mesh mesh = mesh_geometry(
      script(
          "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 2, 3};\nMesh.MshFileVersion = 2.2;\n"
          "Mesh.Format = 27;\nMesh.SaveParametric = 1;\nMesh.Binary = 0;\n"),
      {});
  EXPECT_EQ(mesh.format, MeshFormat::msh4);
  expect_box(mesh, {1, 2, 3});
}

TEST_F(Cad, ScriptsThatCouldRunProgramsAreRefusedUnlessTrusted) {
  const auto here = folder_ / "HERE";
  const auto path = script(
      "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 2, 3};\n"
      "SystemCall \"touch " +
      here.string() + "\";\n");
  EXPECT_EQ(message<InputError>(path, {}),
            path.string() + ":3: SystemCall runs programs; give --trust-scripts if you trust it");
  EXPECT_FALSE(std::filesystem::exists(here));
  expect_box(mesh_geometry(path, {.trust_scripts = true}), {1, 2, 3});
  EXPECT_TRUE(std::filesystem::exists(here));
}

TEST_F(Cad, TrustedScriptsFindTheFilesBesideThem) {
  write("size.geo", "h = 0.5;\n");
  const auto path = script(
      "Include \"size.geo\";\nSetFactory(\"OpenCASCADE\");\n"
      "Box(1) = {0, 0, 0, 1, 2, 3};\nMesh.MeshSizeMax = h;\n");
  expect_box(mesh_geometry(path, {.trust_scripts = true}), {1, 2, 3});
  EXPECT_EQ(folder_.names(),
            (std::vector<std::string>{"box.geo", "box.step", "script.geo", "size.geo"}));
}

TEST_F(Cad, ProgramsOfTrustedScriptsRunBesideThem) {
  const auto path = script(
      "SystemCall \"touch HERE\";\nSetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 2, 3};\n");
  expect_box(mesh_geometry(path, {.trust_scripts = true}), {1, 2, 3});
  EXPECT_TRUE(std::filesystem::exists(folder_ / "HERE"));
}

// HXT looks at addresses in memory, which systems make random unless asked not to.
TEST_F(Cad, EqualInputsGiveEqualMeshes) {
  const auto path = script(
      "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\nMeshSize {:} = 0.1;\n"
      "Mesh.Algorithm3D = 10;\n");
  if (test::run("setarch -R true 2> /dev/null") != 0) GTEST_SKIP() << "addresses stay random here";
  const Mesh first = mesh_geometry(path, {});
  for (int k = 0; k < 4; ++k) EXPECT_EQ(mesh_geometry(path, {}).nodes, first.nodes);
}

TEST_F(Cad, MistakesInScriptsAreToldWithTheirLine) {
  const auto path = script("x = 1;\ny = = 2;\n");
  EXPECT_EQ(message<FormatError>(path, {}).find(path.string() + ":2: syntax error"), 0U)
      << message<FormatError>(path, {});
  EXPECT_NE(message<InputError>(script("Exit;\n"), {}).find("take Exit or Abort out of it"),
            std::string::npos);
  EXPECT_NE(message<InputError>(script("x = 1;\n"), {}).find("gmsh made no element"),
            std::string::npos);
}

TEST_F(Cad, FailuresOfGmshBecomeOneLine) {
  const auto fake = write("gmsh", "#!/bin/sh\necho rubbish > mesh.msh\necho 'roughmesh: 1 6 10'\n");
  ::chmod(fake.c_str(), 0700);
  const GeometryOptions options{.mesh_size = 1, .gmsh = fake.string()};
  EXPECT_NE(message<NumericalError>(folder_ / "box.geo", options)
                .find("gmsh wrote a mesh that cannot be read (mesh.msh"),
            std::string::npos);
  write("gmsh", "#!/bin/sh\necho 'Error   : no luck'\nexit 1\n");
  EXPECT_NE(message<NumericalError>(folder_ / "box.geo", options)
                .find("gmsh could not mesh it: no luck; try another --mesh-size"),
            std::string::npos);
  write("gmsh", "#!/bin/sh\nexit 0\n");
  EXPECT_NE(message<FormatError>(folder_ / "box.step", options).find("it gave no reason"),
            std::string::npos);
  write("gmsh", "#!/bin/sh\necho 'roughmesh: 1 6 10'\nexit 0\n");
  EXPECT_NE(message<NumericalError>(folder_ / "box.step", options).find("wrote no mesh"),
            std::string::npos);
}

TEST_F(Cad, TheRealPartIsMeshed) {
  const char* const data = std::getenv("ROUGHMESH_DATA");
  if (data == nullptr) GTEST_SKIP() << "ROUGHMESH_DATA is not set";
  const Mesh mesh = mesh_geometry(std::filesystem::path(data) / "cad/block.stp", {.mesh_size = 3});
  EXPECT_TRUE(group_names(mesh).contains("3 Block"));
  EXPECT_GT(n_elements(mesh, 3), 10'000);
  EXPECT_GT(volume_of(mesh), 0);
}

TEST(StepUnit, IsThatOfTheFirstContext) {
  const auto unit = [](const std::string& data) { return detail::step_length_unit(data); };
  const std::string context =
      "#9=(GEOMETRIC_REPRESENTATION_CONTEXT(3) "
      "GLOBAL_UNIT_ASSIGNED_CONTEXT((#1,#2)) REPRESENTATION_CONTEXT('',''));";
  const std::string other = "#7=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT($,.METRE.));";
  EXPECT_EQ(unit(other + context + "#2=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MICRO.,.METRE.));"),
            1e-3);
  EXPECT_EQ(
      unit("#2 = ( NAMED_UNIT(*) /* ; */ LENGTH_UNIT ( )\n SI_UNIT ( $ , .METRE. ) );" + context),
      1000.0);
  EXPECT_EQ(unit(context + "#1=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));"),
            std::nullopt);
  EXPECT_EQ(unit("#3=PRODUCT('; #2=(LENGTH_UNIT() SI_UNIT($,.METRE.)');" + context), std::nullopt);
}

TEST(StepUnit, RubbishGivesNone) {
  for (const std::string text :
       {"", ";", "'", "/*", "#=;", "#1", "((((", "GLOBAL_UNIT_ASSIGNED_CONTEXT((#1;",
        "#1=(LENGTH_UNIT(CONVERSION_BASED_UNIT('x',#1)));"
        "#2=GLOBAL_UNIT_ASSIGNED_CONTEXT(#1);"})
    EXPECT_EQ(detail::step_length_unit(text), std::nullopt) << text;
}
