// SPDX-License-Identifier: BSD-3-Clause
// The words of Gmsh's scripting language, by what they can do: from the reference manual, the
// commands of Gmsh 4.8 to 4.14, and `gmsh -help_options`.
#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "geo_script.hpp"

namespace roughmesh::detail {
namespace {

using Words = std::unordered_set<std::string_view>;

// The words of a text, which lives as long as the program.
Words split(std::string_view text) {
  Words words;
  const std::string_view space = " \n";
  for (std::size_t begin = 0; (begin = text.find_first_not_of(space, begin)) < text.size();) {
    const std::size_t end = std::min(text.find_first_of(space, begin), text.size());
    words.insert(text.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

constexpr std::string_view runs = "runs programs";
constexpr std::string_view reads = "reads other files";
constexpr std::string_view writes = "writes files";
constexpr std::string_view names = "can spell any command";
constexpr std::string_view tells = "tells what is on this machine";

const std::unordered_map<std::string_view, std::string_view> refused_words = {
    {"System", runs},
    {"SystemCall", runs},
    {"NonBlockingSystemCall", runs},
    {"OnelabRun", runs},
    {"OnelabAction", runs},
    {"Plugin", runs},
    {"Solver", runs},
    {"ExternalProcess", runs},
    {"Slide", runs},
    {"Merge", reads},
    {"MergeFile", reads},
    {"MergeWithBoundingBox", reads},
    {"Include", reads},
    {"ShapeFromFile", reads},
    {"ListFromFile", reads},
    {"Structured", reads},
    {"Centerline", reads},
    {"Save", writes},
    {"Print", writes},
    {"CreateDir", writes},
    {"SendToServer", writes},
    {"SetString", "sets options by name"},
    {"StringToName", names},
    {"S2N", names},
    {"GetEnv", tells},
    {"FileExists", tells},
};

const Words& control_words() {
  static const Words words = split(R"(
    Call Else ElseIf EndFor EndIf For Function If Macro Return)");
  return words;
}

// What draws, measures and meshes.
const Words& geometry_words() {
  static const Words words = split(R"(
    Affine Attractor BSpline Bezier Block BooleanCoherence BooleanCommon BooleanCut
    BooleanDifference BooleanFragments BooleanFuse BooleanIntersection BooleanSection
    BooleanUnion Boundary BoundingBox Box CatmullRom CenterOfMass Chamfer Characteristic Circle
    Closest Coherence CombinedBoundary Compound Cone Coordinates Curvature Curve Cylinder
    Degenerated Delete Dilate Disk Duplicata Ellipse Ellipsis Ellipsoid Elliptic Embedded
    Euclidian Extrude Field Fillet Geometry HealShapes Hole In Intersect Knots Layers Length
    Levelset Line Loop Mass MatrixOfInertia MeshSize Normal Nurbs Order Parametric Parent
    Periodic Physical Plane Point PointsOf PolarSphere Quadric Rectangle Recursive Rotate Ruled
    SetFactory SetMaxTag SetTag Sewing Sphere Spline Split Surface Symmetry ThickSolid
    ThruSections Torus Translate Unique Using Volume Wedge Wire newc newcl newf newl newll newp
    newreg news newsl newv)");
  return words;
}

const Words& meshing_words() {
  static const Words words = split(R"(
    AdaptMesh Alternate AlternateLeft AlternateRight Background Betti BoundaryLayer
    ClassifySurfaces Cohomology Combine CreateGeometry CreateOverlaps CreateTopology CutMesh
    CutMeshTri Homology Left Mesh MeshAlgorithm MeshSizeFromBoundary OptimizeMesh PartitionMesh
    QuadTriAddVerts QuadTriNoNewVerts RecombLaterals Recombine RecombineMesh RefineMesh
    RelocateMesh Remesh RenumberMeshElements RenumberMeshNodes ReorientMesh Reverse ReverseMesh
    Right ScaleLastLayer SetOrder SetPartition Smoother SplitMesh TransfQuadTri Transfinite
    TransformMesh)");
  return words;
}

// Arithmetic, strings, variables, and what concerns the window only.
const Words& other_words() {
  static const Words words = split(R"(
    Abort Abs AbsolutePath Acos AffectModel Alias AliasWithOptions Append ArcCos ArcSin ArcTan
    ArcTan2 Asin Atan Atan2 AutoCheck Catenary Ceil Choices Closed CodeName Color ColorTable
    CopyOptions Cos Cosh Cpu CurrentDir CurrentDirectory CurrentFileName DefineConstant
    DefineNumber DefineString DimNameSpace DirName Draw Empty Error Exists Exit Exp Fabs Find
    FixRelativePath Floor Fmod GMSH_MAJOR_VERSION GMSH_MINOR_VERSION GMSH_PATCH_VERSION General
    GeoEntity GetForced GetForcedStr GetNumber GetString GetStringValue GetValue
    GmshExecutableName Graph Help Hide Highlight Hypot INTERPOLATION_SCHEME Kind Label LinSpace
    List Log Log10 LogSpace LowerCase LowerCaseIn MPI_Rank MPI_Size Max Memory Min Modulo
    MultipleSelection N2S Name NameStruct NameToString NewModel NumberFormat Options Path Pi
    PostProcessing Printf Rand Range ReadOnly ReadOnlyRange Round ServerAction SetChanged
    SetCurrentWindow SetName SetNumber ShortHelp Show Sin Sinh Sleep
    SplitCurrentWindowHorizontal SplitCurrentWindowVertical Sprintf Sqrt Step Str StrCat
    StrChoice StrCmp StrFind StrLen StrPrefix StrRelative StrReplace StrSub Struct SyncModel T2
    T3 TIME Tan Tanh TestLevel TextAttributes Today TotalMemory UndefineConstant Units
    UnsplitWindow UpperCase View Views Visible Warning)");
  return words;
}

// Options of the General category that are numbers or colours and change nothing outside the run.
bool is_safe_general_option(std::string_view name) {
  static const Words beginnings = split(R"(
    AbortOnError AlphaBlending Antialiasing ArrowHead ArrowStem Axes Background Camera Clip
    Color ColorScheme Draw ExpertMode Fast Foreground Graphics Light MinX NumThreads
    Orthographic Rotation Scale SmallAxes Terminal Trackball Verbosity)");
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](std::string_view beginning) { return name.starts_with(beginning); });
}

bool names_file_or_program(std::string_view name) {
  static const Words parts =
      split("Browser Command Editor Executable File Interpreter Pattern Script Socket");
  return std::any_of(parts.begin(), parts.end(), [&](std::string_view part) {
    return name.find(part) != std::string_view::npos;
  });
}

}  // namespace

std::string_view refusal_of(std::string_view word) {
  const auto found = refused_words.find(word);
  return found == refused_words.end() ? std::string_view() : found->second;
}

bool is_control_word(std::string_view word) { return control_words().contains(word); }

bool is_known_word(std::string_view word) {
  return is_control_word(word) || geometry_words().contains(word) ||
         meshing_words().contains(word) || other_words().contains(word);
}

bool is_safe_field(std::string_view type) {
  static const Words types = split(R"(
    Attractor AttractorAnisoCurve AutomaticMeshSizeField Ball BoundaryLayer Box Constant
    Curvature Cylinder Distance Extend Frustum Gradient Intersect IntersectAniso Laplacian
    LonLat MathEval MathEvalAniso Max MaxEigenHessian Mean Min MinAniso Octree Param PostView
    Restrict Sphere Threshold)");
  return types.contains(type);
}

// All options of the Mesh category are numbers.
bool is_safe_option(std::string_view category, std::string_view name) {
  if (category == "Mesh") return true;
  if (names_file_or_program(name) || category == "Solver" || category == "Print") return false;
  return category != "General" || is_safe_general_option(name);
}

}  // namespace roughmesh::detail
