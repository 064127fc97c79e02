// SPDX-License-Identifier: BSD-3-Clause
// A geometry script that can run a program or touch a file is refused, whatever it hides behind.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geo_script.hpp"
#include "support/files.hpp"

using namespace roughmesh::detail;

namespace {

std::string finding(const std::string& script) {
  const auto found = find_unsafe(script);
  return found ? found->what : "";
}

bool is_refused(const std::string& script) { return find_unsafe(script).has_value(); }

}  // namespace

TEST(GeoScript, EveryCommandThatRunsAProgramOrTouchesAFileIsRefused) {
  const std::vector<std::string> scripts = {
      "SystemCall \"id\";",
      "System \"id\";",
      "NonBlockingSystemCall \"id\";",
      "OnelabRun(\"a\", \"b\");",
      "x = OnelabAction;",
      "Merge \"a.step\";",
      "MergeWithBoundingBox \"a.step\";",
      "Include \"a.geo\";",
      "v() = ShapeFromFile(\"a.brep\");",
      "x() = ListFromFile[\"a\"];",
      "Save \"a.msh\";",
      "Save View[0] \"a.pos\";",
      "Print \"a.png\";",
      "CreateDir \"a\";",
      "Plugin(MathEval).Run;",
      "Plugin(AnalyseCurvedMesh).Run;",
      "SetString(\"General.TextEditor\", \"id\");",
      "Printf(\"a\") > \"b\";",
      "Printf(\"a %g\", 1) >> \"b\";",
      "Printf (Str(\"a\"))\n>\n\"b\";",
      "Solver.Executable0 = \"id\";",
      "General.TextEditor = \"id\";",
      "General.WebBrowser = \"id\";",
      "General.DefaultFileName = \"a\";",
      "General . TextEditor = \"id\";",
      "Geometry.DoubleClickedPointCommand = \"id\";",
      "View[0].DoubleClickedCommand = \"id\";",
      "Field[1] = ExternalProcess;",
      "Field[1] = Structured; Field[1].FileName = \"a\";",
      "Field[n()] = SomethingNew;",
      "EndFor Field[1] = SomethingNew;",
      "x = GetEnv(\"HOME\");",
      "x = FileExists(\"a\");",
  };
  for (const std::string& script : scripts) EXPECT_TRUE(is_refused(script)) << script;
}

TEST(GeoScript, CommandsThatAreUnknownAreRefused) {
  EXPECT_EQ(finding("LaunchRocket \"a\";"), "LaunchRocket is a command unknown here");
  EXPECT_TRUE(is_refused("LaunchRocket(\"a\");"));
  EXPECT_TRUE(is_refused("LaunchRocket name;"));
  EXPECT_TRUE(is_refused("LaunchRocket 3;"));
  EXPECT_TRUE(is_refused("If (1) LaunchRocket Str(\"a\"); EndIf"));
}

TEST(GeoScript, WordsInCommentsAndStringsAreHarmless) {
  EXPECT_EQ(finding("// SystemCall \"id\";\nPoint(1) = {0, 0, 0};"), "");
  EXPECT_EQ(finding("/* SystemCall \"id\";\n Merge \"b\"; */ Point(1) = {0, 0, 0};"), "");
  EXPECT_EQ(finding("Physical Surface(\"Merge and Save\") = {1};"), "");
  EXPECT_EQ(finding("Physical Surface('System') = {1};"), "");
}

TEST(GeoScript, CommentsSeparateWordsAndDoNotNest) {
  // Two words for gmsh as well.
  EXPECT_EQ(finding("Syste/**/mCall \"id\";"), "Syste is a command unknown here");
  EXPECT_TRUE(is_refused("Merge/**/\"a\";"));
  EXPECT_TRUE(is_refused("Merge//\n\"a\";"));
  EXPECT_TRUE(is_refused("/* /* */ SystemCall \"id\"; */"));
  EXPECT_TRUE(is_refused("/*/ */ SystemCall \"id\"; /*/ */"));
  EXPECT_TRUE(is_refused("a = \"/*\"; SystemCall \"id\"; b = \"*/\";"));
  EXPECT_TRUE(is_refused("a = \"//\"; SystemCall \"id\";"));
  EXPECT_TRUE(is_refused("a = '\"'; SystemCall \"id\"; b = '\"';"));
  EXPECT_TRUE(is_refused("a = \"\\\"; SystemCall \"id\";"));     // a backslash quotes nothing
  EXPECT_TRUE(is_refused("x = 1; // a\\\nSystemCall \"id\";"));  // nor continues a line
}

TEST(GeoScript, NumbersDoNotSwallowWords) {
  EXPECT_TRUE(is_refused("x = 1e5SystemCall \"id\";"));
  EXPECT_TRUE(is_refused("0Merge \"a\";"));
  EXPECT_TRUE(is_refused("1.Merge \"a\";"));
}

// Each was seen to run in Gmsh 4.8.4.
TEST(GeoScript, HiddenTextThatComesToLifeIsRefused) {
  EXPECT_TRUE(is_refused("For i In {0:1} /*\nSystemCall \"id\";\n*/\nEndFor\n"));
  EXPECT_TRUE(is_refused("If(0)\nE\" EndIf SystemCall 'id'; \"\nEndIf\n"));
  EXPECT_TRUE(is_refused("If(0) E//  EndIf SystemCall \"id\";\nEndIf\n"));
  EXPECT_TRUE(is_refused("If(0)\nx = E//  EndIf SystemCall \"id\";\n;\nEndIf\n"));
  EXPECT_TRUE(is_refused("S2N[\"SystemCall\"] \"id\";\n"));
  EXPECT_TRUE(is_refused("StringToName[\"SystemCall\"] \"id\";\n"));
  EXPECT_TRUE(is_refused("x = \"" + std::string(1023, 'a') + "\";SystemCall \"id\";//\";\n"));
  EXPECT_TRUE(is_refused("x = \"" + std::string(1022, 'a') + " ;SystemCall 'id'; y = 1;\";"));
}

TEST(GeoScript, HiddenTextInALineLongerThanGmshReadsAtOnceIsRefused) {
  const std::string far(5000, ' ');
  EXPECT_TRUE(is_refused("For i In {0:1}\n" + far + "/* Merge 'a'; */ EndFor"));
  EXPECT_TRUE(is_refused("For i In {0:1}\nx = \"Merge\";" + far + "y = \"Merge 'a';\"; EndFor"));
  EXPECT_EQ(finding("For i In {0:1}\n/* Merge 'a'; */ EndFor"), "");
}

TEST(GeoScript, BytesThatEndACommentForGmshAreRefused) {
  using namespace std::string_literals;
  EXPECT_TRUE(is_refused("/* \0 SystemCall \"id\"; */"s));
  EXPECT_TRUE(is_refused("/* never closed"));
  EXPECT_TRUE(is_refused("x = \"never closed"));
}

TEST(GeoScript, OrdinaryScriptsPass) {
  const std::vector<std::string> scripts = {
      "",
      "lc = 1e-2;\nPoint(1) = {0, 0, 0, lc};\nLine(1) = {1, 2};\nCurve Loop(1) = {4, 1, -2, 3};\n",
      "SetFactory(\"OpenCASCADE\");\nSphere(1) = {0, 0, 0, 1, -Pi/2, Pi/2, 2*Pi};\n"
      "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\n",
      "Macro CheeseHole\n  p1 = newp; Point(p1) = {x, y, z, lcar3};\n  theloops[t] = "
      "newreg;\nReturn\n"
      "For t In {1:5}\n  x += 0.166;\n  Call CheeseHole;\n  Printf(\"Hole %g at %g\", t, x);\n"
      "  If (t > 3 && x >= 2) y = 1; ElseIf (t < 2) y = 2; Else y = 3; EndIf\nEndFor\n",
      "DefineConstant[ angle = {40, Min 20, Max 120, Step 1, Name \"Parameters/Angle\"},\n"
      "  n = DefineNumber[ 3, Name \"n\", Choices{0=\"No\", 1=\"Yes\"} ] ];",
      "Transfinite Curve {1, 2} = 20 Using Progression 1.1;\nTransfinite Surface {1} Right;\n"
      "Transfinite Line{1} = n Using Bump 0.05;\nRecombine Surface{1};",
      "Field[1] = Distance; Field[1].CurvesList = {1}; Field[1].Sampling = 100;\n"
      "Field[2] = MathEval; Field[2].F = \"2*Sin((x+y)/5) + 3\";\nBackground Field = 2;\n"
      "Field[3] = BoundaryLayer; BoundaryLayer Field = 3; Background Field = nfield;",
      "out[] = Extrude {0, 0, h} { Surface{1}; Layers{ {8, 2}, {0.5, 1} }; Recombine; };\n"
      "Periodic Surface {2} = {1} Translate {1, 0, 0};\nPhysical Volume(\"v\", 1) = out[1];",
      "Mesh.MeshSizeMax = 0.1; Mesh.Algorithm3D = 10; General.Terminal = 1; "
      "General.Color.Background = {255, 255, 255}; Mesh.Color.Lines = {0, 0, 0};",
      "View \"a\" { SP(0, 0, 0){1}; T3(0, 0, 0, 0){\"text\"}; };\nGeometry.OCCTargetUnit = \"M\";",
      "Mesh 2; OptimizeMesh \"Netgen\"; SetOrder 2; Delete Physicals; Coherence Mesh;",
  };
  for (const std::string& script : scripts) EXPECT_EQ(finding(script), "") << script;
}

TEST(GeoScript, TheExamplePasses) {
  EXPECT_EQ(finding(roughmesh::test::read_bytes(std::filesystem::path(ROUGHMESH_SOURCE_DIR) /
                                                "examples/gold_sphere.geo")),
            "");
}

TEST(GeoScript, TheLineIsThatOfTheCommand) {
  const auto found = find_unsafe("a = 1;\n/* two\nthree */ b = \"x\ny\";\n// c\nMerge \"a\";\n");
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->line, 6U);
  EXPECT_EQ(found->what, "Merge reads other files");
}

TEST(GeoScript, AMeshMadeByTheScriptIsSeen) {
  EXPECT_TRUE(makes_mesh("Box(1) = {0,0,0,1,1,1};\nMesh 3;"));
  EXPECT_TRUE(makes_mesh("Mesh dim;"));
  EXPECT_FALSE(makes_mesh("Mesh.MeshSizeMax = 3; Coherence Mesh; // Mesh 3;"));
}

// 2 MB of what a search that is not linear would need hours for, which the test's time limit ends.
TEST(GeoScript, HostileScriptsAreReadToTheirEnd) {
  for (const std::string piece :
       {"Field[", "\"", "/*", "If(", "'\"", "a.b=", "Printf((", "EndIf\"E\""}) {
    std::string script;
    while (script.size() < 2'000'000) script += piece;
    EXPECT_NO_THROW(find_unsafe(script)) << piece;
  }
}
