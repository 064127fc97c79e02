// SPDX-License-Identifier: BSD-3-Clause
// Files that are not what they claim to be: one line that names the file, never a crash. Run under
// the sanitizers.
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "roughmesh/mesh_io.hpp"

#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/msh_files.hpp"
#include "support/refusals.hpp"

using namespace roughmesh;
using test::expect_error;
using test::Kind;
using test::MshStyle;
using test::replaced;

namespace {

using Case = test::Refusal;

Mesh triangle() {
  Mesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.node_tags = {1, 2, 3};
  mesh.blocks = {test::make_block(test::triangle_type, 1, {5}, {0, 1, 2}, 1)};
  mesh.groups = {{2, 5, "side"}};
  mesh.periodic_links = {{1, 1, 2, {}, {{1, 0}}}};
  return mesh;
}

const char* const text2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 5 \"side\"\n$EndPhysicalNames\n"
    "$Nodes\n3\n1 0.5 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n"
    "$Elements\n1\n1 2 2 5 1 1 2 3\n$EndElements\n"
    "$Periodic\n1\n1 1 2\nAffine 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n1\n2 1\n$EndPeriodic\n";

const char* const text4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n1 0 0 0 1 1 1 1 5 0\n$EndEntities\n"
    "$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0.5 0 0\n1 0 0\n0 1 0\n$EndNodes\n"
    "$Elements\n1 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n"
    "$Periodic\n1\n1 1 2\n0\n1\n2 1\n$EndPeriodic\n";

/// Adds cases that replace a part of the file of version 2.2.
class Text2Cases {
 public:
  explicit Text2Cases(std::vector<Case>& cases) : cases_(cases) {}

  void operator()(const std::string& name, const std::string& what, const std::string& by,
                  const std::string& message, Kind kind = Kind::format_error) const {
    cases_.push_back({"msh2_" + name, "a.msh", replaced(text2, what, by), kind, message});
  }

 private:
  std::vector<Case>& cases_;
};

void add_text2_nodes(const Text2Cases& add) {
  add("count_too_large", "$Nodes\n3", "$Nodes\n4", ":13: $Nodes: expected a whole number");
  add("count_too_small", "$Nodes\n3", "$Nodes\n2", ":12: $Nodes: expected $EndNodes");
  add("count_huge", "$Nodes\n3", "$Nodes\n2000000000", "do not fit");
  add("count_beyond_index", "$Nodes\n3", "$Nodes\n3000000000", "split the mesh", Kind::input_error);
  add("count_beyond_integers", "$Nodes\n3", "$Nodes\n99999999999999999999", ":9: $Nodes");
  add("count_negative", "$Nodes\n3", "$Nodes\n-3", "cannot be negative");
  add("count_zero", "$Nodes\n3", "$Nodes\n0", "no nodes");
  add("count_missing", "$Nodes\n3\n", "$Nodes\n", "$Nodes: ");
  add("count_not_whole", "$Nodes\n3", "$Nodes\n3.0", "found \"3.0\"");
  add("node_duplicate", "2 1 0 0", "1 1 0 0", ":11: $Nodes: two nodes have the number 1");
  add("node_negative", "2 1 0 0", "-2 1 0 0", "negative");
  add("node_nan", "2 1 0 0", "2 1 nan 0", ":11: $Nodes: a number is not finite");
  add("node_infinite", "2 1 0 0", "2 1 -inf 0", "not finite");
  add("node_overflow", "2 1 0 0", "2 1 1e400 0", "beyond the range");
  add("node_not_a_number", "2 1 0 0", "2 1 zero 0", "found \"zero\"");
  add("node_half_a_number", "2 1 0 0", "2 1 0.5x 0", "found \"0.5x\"");
  add("node_with_nul", "2 1 0 0", std::string("2 1 0\0 0", 8), "found \"0?\"");
  add("node_missing", "2 1 0 0\n", "", "$Nodes: ");
  const std::string text = text2;
  add("no_nodes_section",
      text.substr(text.find("$Nodes"), text.find("$Elements") - text.find("$Nodes")), "",
      "$Elements: stands before $Nodes");
  add("end_of_nodes_missing", "$EndNodes\n", "", "expected $EndNodes, found \"$Elements\"");
  add("end_of_nodes_misspelt", "$EndNodes", "$EndNods", "expected $EndNodes");
}

void add_text2_elements(const Text2Cases& add) {
  add("element_dangling", "5 1 1 2 3", "5 1 1 2 4", ":16: $Elements: node 4 is not in $Nodes");
  add("element_dangling_negative", "5 1 1 2 3", "5 1 1 2 -3", "node -3 is not in $Nodes");
  add("element_dangling_far", "5 1 1 2 3", "5 1 1 2 9223372036854775807", "is not in $Nodes");
  add("element_type_unknown", "1 2 2 5 1", "1 999 2 5 1", "element type 999");
  add("element_type_polygon", "1 2 2 5 1", "1 34 2 5 1", "element type 34");
  add("element_type_negative", "1 2 2 5 1", "1 -2 2 5 1", "element type -2");
  add("element_tags_huge", "1 2 2 5 1", "1 2 2000000000 5 1", "tags do not fit");
  add("element_tags_negative", "1 2 2 5 1", "1 2 -1 5 1", "cannot be negative");
  add("element_number_negative", "1 2 2 5 1", "-1 2 2 5 1", "negative");
  add("element_count_huge", "$Elements\n1", "$Elements\n1000000000", "do not fit");
  add("element_count_beyond_index", "$Elements\n1", "$Elements\n4294967296", "split the mesh",
      Kind::input_error);
  add("element_count_too_large", "$Elements\n1", "$Elements\n2", "$Elements: ");
  add("element_count_too_small", "$Elements\n1", "$Elements\n0", "expected $EndElements");
}

void add_text2_sections(const Text2Cases& add) {
  add("second_nodes", "$Periodic", "$Nodes\n1\n1 0 0 0\n$EndNodes\n$Periodic", "a second $Nodes");
  add("second_elements", "$Periodic", "$Elements\n0\n$EndElements\n$Periodic",
      "a second $Elements");
  add("second_format", "$Periodic", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Periodic",
      "a second $MeshFormat");
  add("elements_first", "$Nodes", "$Elements\n0\n$EndElements\n$Nodes", "stands before $Nodes");
  add("periodic_first", "$Nodes", "$Periodic\n0\n$EndPeriodic\n$Nodes", "stands before $Nodes");
  add("periodic_dimension", "1 1 2\nAffine", "4 1 2\nAffine", "dimension 4");
  add("periodic_affine_short", " 0 0 0 1\n1\n2 1", "\n1\n2 1", "$Periodic");
  add("periodic_pairs_huge", "1\n2 1\n$EndP", "1000000\n2 1\n$EndP", "do not fit");
  add("names_huge", "$PhysicalNames\n1", "$PhysicalNames\n1000000", "do not fit");
  add("names_without_quotes", "\"side\"", "side", "lacks its quotes");
  add("names_dimension", "2 5 \"side\"", "7 5 \"side\"", "dimension 7");
  add("names_tag_beyond", "2 5 \"side\"", "2 -9223372036854775808 \"side\"", "beyond 2^63 - 1");
  add("element_group_beyond", "1 2 2 5 1", "1 2 2 -9223372036854775808 1", "beyond 2^63 - 1");
  add("section_name_long", "$EndPeriodic\n",
      "$EndPeriodic\n$\x1b[31m" + std::string(9999, 'x') + "\n", "$?[31mxxx");
  add("text_between_sections", "$Nodes\n3", "stray\n$Nodes\n3", "\"stray\" stands outside");
  add("text_at_the_end", "$EndPeriodic\n", "$EndPeriodic\nstray", "\"stray\" stands outside");
  add("nul_at_the_end", "$EndPeriodic\n", std::string("$EndPeriodic\n\0\0\0", 16),
      "stands outside");
  add("unknown_section_without_end", "$EndPeriodic\n", "$EndPeriodic\n$Stuff\n1 2 3\n",
      "$EndStuff is missing");
  add("end_without_section", "$EndPeriodic\n", "$EndPeriodic\n$EndStuff\n", "without a section");
  add("section_without_name", "$EndPeriodic\n", "$EndPeriodic\n$\n", "without a name");
  add("parametric_nodes", "$Nodes\n3", "$ParametricNodes\n3", "Mesh.SaveParametric",
      Kind::input_error);
}

void add_text2_headers(const Text2Cases& add) {
  add("version_1", "2.2 0 8", "1.0 0 8", "gmsh -save", Kind::input_error);
  add("version_3", "2.2 0 8", "3 0 8", "MSH version 3", Kind::input_error);
  add("version_4_0", "2.2 0 8", "4.0 0 8", "MSH version 4.0", Kind::input_error);
  add("version_word", "2.2 0 8", "new 0 8", "\"new\" is no version");
  add("file_type", "2.2 0 8", "2.2 2 8", "file type 2");
  add("data_size", "2.2 0 8", "2.2 0 16", "numbers of 16 bytes", Kind::input_error);
  add("no_format", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "", "before $MeshFormat");
}

void add_text4(std::vector<Case>& cases) {
  const auto add = [&](const std::string& name, const std::string& what, const std::string& by,
                       const std::string& message, Kind kind = Kind::format_error) {
    cases.push_back({"msh4_" + name, "a.msh", replaced(text4, what, by), kind, message});
  };
  add("blocks_huge", "$Nodes\n1 3", "$Nodes\n100000 3", "blocks do not fit");
  add("blocks_too_many", "$Nodes\n1 3", "$Nodes\n2 3", "$Nodes: ");
  add("blocks_too_few", "$Nodes\n1 3", "$Nodes\n0 3", "hold 0 nodes where 3");
  add("count_too_large", "$Nodes\n1 3", "$Nodes\n1 4", "hold 3 nodes where 4");
  add("count_too_small", "$Nodes\n1 3", "$Nodes\n1 2", "3 nodes in a block where 2 remain");
  add("count_huge", "$Nodes\n1 3", "$Nodes\n1 2000000000", "do not fit");
  add("count_beyond_index", "$Nodes\n1 3", "$Nodes\n1 2147483648", "split the mesh",
      Kind::input_error);
  add("count_negative", "$Nodes\n1 3", "$Nodes\n1 -3", "negative");
  add("block_negative", "2 1 0 3\n", "2 1 0 -3\n", "negative");
  add("block_dimension", "2 1 0 3\n", "4 1 0 3\n", "dimension 4");
  add("block_parametric", "2 1 0 3\n", "2 1 2 3\n", "parametric is 2");
  add("block_parametric_without", "2 1 0 3\n", "2 1 1 3\n", "$Nodes: ");
  add("node_duplicate", "\n1\n2\n3\n", "\n1\n2\n2\n", ":16: $Nodes: two nodes have the number 2");
  add("node_negative", "\n1\n2\n3\n", "\n1\n-2\n3\n", "negative");
  add("node_nan", "\n1 0 0\n", "\n1 NaN 0\n", ":15: $Nodes: a number is not finite");
  add("element_dangling", "1 1 2 3\n", "1 1 2 7\n", ":21: $Elements: node 7 is not in $Nodes");
  add("element_of_other_dimension", "2 1 2 1\n", "3 1 2 1\n",
      "a triangle in an entity of dimension 3");
  add("element_type_unknown", "2 1 2 1\n", "2 1 68 1\n", "element type 68");
  add("element_block_huge", "2 1 2 1\n", "2 1 2 9223372036854775807\n", "do not fit");
  add("element_block_too_many", "2 1 2 1\n", "2 1 2 2\n", "2 elements in a block where 1 remain");
  add("element_count_too_large", "$Elements\n1 1", "$Elements\n1 2",
      "1 elements fewer than announced");
  add("element_count_beyond_index", "$Elements\n1 1", "$Elements\n1 2147483648", "split the mesh",
      Kind::input_error);
  add("entities_huge", "0 0 1 0\n", "0 0 1000000000 0\n", "entities do not fit");
  add("entities_groups_huge", "1 1 1 1 5 0\n", "1 1 1 9999999 5 0\n", "groups do not fit");
  add("entities_group_beyond", "1 1 1 1 5 0\n", "1 1 1 1 -9223372036854775808 0\n",
      "beyond 2^63 - 1");
  add("entities_before_format", "$MeshFormat\n4.1", "$Entities\n$EndEntities\n$MeshFormat\n4.1",
      "stands before $MeshFormat");
  add("entities_cut", "1 0 0 0 1 1 1 1 5 0\n", "1 0 0\n", "$Entities: ");
  add("periodic_affine", "1 1 2\n0\n", "1 1 2\n9\n1 0 0 0 1 0 0 0 1\n",
      "9 numbers of an affine map");
  add("periodic_pairs_huge", "0\n1\n2 1", "0\n1000000000\n2 1", "do not fit");
}

// A file cut short before the last of its needed sections is whole is never taken for a mesh.
void add_truncations(std::vector<Case>& cases) {
  for (const MshStyle& style : test::all_msh_styles()) {
    const std::string whole = test::msh_bytes(test::zoo(), style);
    const std::size_t end = whole.find("$EndElements") + 11;
    for (std::size_t k = 0; k < 12; ++k)
      cases.push_back({fmt::format("{}_cut_{}", name(style), k), "cut.msh",
                       whole.substr(0, 1 + (end - 1) * k / 11)});
    cases.push_back(
        {name(style) + "_cut_in_periodic", "cut.msh", whole.substr(0, whole.find("$EndPeriodic"))});
    cases.push_back({name(style) + "_cut_in_periodic_end", "cut.msh",
                     whole.substr(0, whole.find("$EndPeriodic") + 5)});
  }
}

std::string with_bytes(std::string bytes, std::size_t place, std::string_view by) {
  return bytes.replace(place, by.size(), by);
}

void add_binary(std::vector<Case>& cases) {
  using namespace std::string_literals;
  const std::string two = test::msh_bytes(triangle(), {.version = 2, .binary = true});
  const std::string four = test::msh_bytes(triangle(), {.version = 4, .binary = true});
  const std::size_t mark = two.find(" 1 8\n") + 5;
  const std::size_t nodes2 = two.find("$Nodes\n") + 9, nodes4 = four.find("$Nodes\n") + 7;
  const std::size_t elements2 = two.find("$Elements\n") + 12;
  const std::size_t elements4 = four.find("$Elements\n") + 10;
  const std::string huge = "\xff\xff\xff\xff\xff\xff\xff\x7f", infinite = "\0\0\0\0\0\0\xf0\x7f"s;
  const auto add = [&](const std::string& name, const std::string& bytes,
                       const std::string& message, Kind kind = Kind::format_error) {
    cases.push_back({"binary_" + name, "b.msh", bytes, kind, message});
  };
  add("byte_order", with_bytes(two, mark, "\2\0\0\0"s),
      fmt::format("byte {}: $MeshFormat: the mark", mark));
  add("data_size", replaced(four, "4.1 1 8", "4.1 1 4"), "numbers of 4 bytes", Kind::input_error);
  add("count2_huge", replaced(two, "$Nodes\n3", "$Nodes\n9999999"), "do not fit");
  add("count2_without_line", replaced(two, "$Nodes\n3\n", "$Nodes\n3 4\n"), "behind the count");
  add("node2_infinite", with_bytes(two, nodes2 + 4, infinite),
      fmt::format("byte {}: $Nodes: a number is not finite", nodes2 + 4));
  add("element2_type", with_bytes(two, elements2, "\xff\xff\xff\xff"), "element type -1");
  add("element2_run_zero", with_bytes(two, elements2 + 4, "\0\0\0\0"s),
      "0 elements in a run where 1");
  add("element2_run_negative", with_bytes(two, elements2 + 4, "\xff\xff\xff\xff"),
      "-1 elements in a run");
  add("element2_tags", with_bytes(two, elements2 + 8, "\xff\xff\xff\x7f"), "tags do not fit");
  add("element2_dangling", with_bytes(two, elements2 + 24, "\x63\0\0\0"s),
      "node 99 is not in $Nodes");
  add("blocks4_huge", with_bytes(four, nodes4, huge), "do not fit");
  add("blocks4_above_63_bits", with_bytes(four, nodes4, "\xff\xff\xff\xff\xff\xff\xff\xff"),
      "2^63 - 1");
  add("count4_huge", with_bytes(four, nodes4 + 8, "\xff\xff\xff\x70\0\0\0\0"s), "do not fit");
  add("count4_beyond_index", with_bytes(four, nodes4 + 8, huge), "split the mesh",
      Kind::input_error);
  add("elements4_blocks_huge", with_bytes(four, elements4, huge), "do not fit");
  add("garbage_behind_format", four.substr(0, mark + 4) + std::string(300, '\xa5'), "");
  add("garbage_in_nodes", with_bytes(four, nodes4, std::string(60, '\xa5')), "");
  add("text_as_binary", replaced(text4, "4.1 0 8", "4.1 1 8"), "");
  add("binary_as_text", replaced(four, "4.1 1 8", "4.1 0 8"), "");
}

std::string noise(std::size_t n) {
  std::mt19937 random(7);
  std::string bytes(n, '\0');
  for (char& c : bytes) c = static_cast<char>(random());
  return bytes;
}

void add_others(std::vector<Case>& cases) {
  using namespace std::string_literals;
  cases.push_back({"empty", "a.msh", "", Kind::format_error, "empty"});
  cases.push_back({"spaces", "a.msh", " \n\n ", Kind::format_error, "$MeshFormat"});
  cases.push_back({"script", "evil.msh",
                   "SystemCall \"touch /tmp/roughmesh-was-here\";\nPoint(1) = {0,0,0};",
                   Kind::format_error, "called .geo"});
  cases.push_back({"script_with_dollar", "evil.msh", "$x = 1;\nSystemCall \"ls\";"});
  cases.push_back({"noise_msh", "a.msh", noise(1000)});
  cases.push_back({"noise_stl", "a.stl", noise(1000)});
  cases.push_back({"noise_unknown", "a.dat", noise(1000), Kind::input_error, "convert it"});
  cases.push_back({"unread_kind", "a.3mf", "v 0 0 0\n", Kind::input_error, "convert it"});
  cases.push_back(
      {"msh_version_1", "a.msh", "$NOD\n1\n1 0 0 0\n$ENDNOD\n", Kind::input_error, "version 1"});
  cases.push_back(
      {"ply2_dangling", "a.ply2", "3 1 0 0 0 1 0 0 0 1 0 3 0 1 3", Kind::format_error, "node 3"});
  cases.push_back({"ply2_pentagon", "a.ply2", "3 1 0 0 0 1 0 0 0 1 0 5 0 1 2 0 1",
                   Kind::format_error, "5 corners"});
  cases.push_back(
      {"ply2_cut", "a.ply2", "3 1 0 0 0 1 0 0 0 1 0 3 0 1 ", Kind::format_error, "cut short"});
  cases.push_back({"ply2_longer", "a.ply2", "3 1 0 0 0 1 0 0 0 1 0 3 0 1 2 7", Kind::format_error,
                   "last face"});
  cases.push_back({"ply2_huge", "a.ply2", "1000000 1 0 0 0", Kind::format_error, "do not fit"});
  cases.push_back(
      {"ply2_beyond_index", "a.ply2", "3000000000 1 0 0 0", Kind::input_error, "split"});
  cases.push_back(
      {"ply2_nan", "a.ply2", "3 1 0 0 0 1 nan 0 0 1 0 3 0 1 2", Kind::format_error, "not finite"});
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
      "0\nendloop\nendfacet\n";
  cases.push_back(
      {"stl_cut_solid", "a.stl", "solid a\n" + facet, Kind::format_error, "inside a solid"});
  cases.push_back(
      {"stl_cut_facet", "a.stl", "solid a\n" + facet.substr(0, 60), Kind::format_error, ":6: "});
  cases.push_back({"stl_nan", "a.stl", "solid a\n" + replaced(facet, "1 0 0", "1 nan 0"),
                   Kind::format_error, ":5: "});
  cases.push_back({"stl_misspelt", "a.stl", "solid a\n" + replaced(facet, "endloop", "endlop"),
                   Kind::format_error, "expected endloop"});
  cases.push_back({"stl_without_triangles", "a.stl", "solid a\nendsolid a\n", Kind::format_error,
                   "no triangles"});
  cases.push_back({"stl_binary_without_triangles", "a.stl", std::string(84, '\0'),
                   Kind::format_error, "no triangles"});
  cases.push_back({"stl_binary_cut", "a.stl",
                   std::string(80, 'x') + "\2\0\0\0"s + std::string(99, '\0'), Kind::format_error,
                   "cut short"});
  cases.push_back({"stl_binary_infinite", "a.stl",
                   std::string(80, 'x') + "\1\0\0\0"s + std::string(14, '\0') + "\x80\x7f"s +
                       std::string(34, '\0'),
                   Kind::format_error, "byte 96"});
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  add_text2_nodes(Text2Cases(cases));
  add_text2_elements(Text2Cases(cases));
  add_text2_sections(Text2Cases(cases));
  add_text2_headers(Text2Cases(cases));
  add_text4(cases);
  add_truncations(cases);
  add_binary(cases);
  add_others(cases);
  return cases;
}

class Malformed : public testing::TestWithParam<Case> {};

TEST_P(Malformed, IsRefusedInOneLine) {
  const test::TemporaryFolder folder;
  test::expect_refusal(folder, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Files, Malformed, testing::ValuesIn(all_cases()),
                         [](const auto& test) { return test.param.name; });

}  // namespace

TEST(ReadMesh, RefusesWhatIsNoFile) {
  const test::TemporaryFolder folder;
  expect_error(folder / "missing.msh", Kind::input_error, "No such file");
  expect_error(folder / "missing/a.msh", Kind::input_error, "No such file");
  expect_error(folder.path(), Kind::input_error, "is a directory");
  ASSERT_EQ(::mkfifo((folder / "pipe.msh").c_str(), 0600), 0);
  expect_error(folder / "pipe.msh", Kind::input_error, "is a pipe or device");
  expect_error("/dev/zero", Kind::input_error, "is a pipe or device");
}

TEST(ReadMesh, RefusesFilesWithoutPermission) {
  if (::geteuid() == 0) GTEST_SKIP() << "permissions do not bind root";
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.msh", text2);
  ::chmod((folder / "a.msh").c_str(), 0);
  expect_error(folder / "a.msh", Kind::input_error, "Permission denied");
}

TEST(ReadMesh, NeverRunsAScript) {
  const test::TemporaryFolder folder;
  const std::string trace = (folder / "trace").string();
  test::write_bytes(folder / "evil.msh", "SystemCall \"touch " + trace + "\";\n");
  EXPECT_THROW(read_mesh(folder / "evil.msh"), FormatError);
  EXPECT_FALSE(std::filesystem::exists(trace));
}

// The unchanged texts are good, so that each case above fails for its own reason.
TEST(ReadMesh, TakesTheFilesThatTheCasesAreMadeFrom) {
  const test::TemporaryFolder folder;
  for (const std::string text : {text2, text4}) {
    test::write_bytes(folder / "a.msh", text);
    EXPECT_EQ(n_elements(read_mesh(folder / "a.msh")), 1);
    test::write_bytes(folder / "a.msh", text.substr(0, text.find("$Periodic")));  // optional
    EXPECT_EQ(read_mesh(folder / "a.msh").n_nodes(), 3);
  }
}

// Whatever a few damaged bytes make of a file, it is read or refused.
TEST(ReadMesh, SurvivesDamagedBytes) {
  const test::TemporaryFolder folder;
  std::mt19937 random(11);
  for (const MshStyle& style : test::all_msh_styles()) {
    const std::string whole = test::msh_bytes(test::zoo(), style);
    for (int k = 0; k < 200; ++k) {
      std::string bytes = whole;
      for (int damage = 0; damage < 1 + k % 4; ++damage)
        bytes[random() % bytes.size()] = static_cast<char>(random());
      test::write_bytes(folder / "a.msh", bytes);
      try {
        write_mesh(read_mesh(folder / "a.msh"), folder / "b.msh");
        EXPECT_EQ(test::read_bytes(folder / "b.msh"), bytes);
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find_first_of("\n\r"), std::string::npos);
      }
    }
  }
}

// A hundred thousand sections, blocks and solids take about as long as that many lines, not its
// square: at a microsecond for each pair, a quadratic reader would need hours.
TEST(ReadMesh, TakesLinearTimeForManySmallParts) {
  const test::TemporaryFolder folder;
  constexpr int n = 100'000;
  std::string sections = text2, blocks = "$Elements\n100000\n", solids;
  for (int i = 0; i < n; ++i) {
    sections += "$A\n$EndA\n";
    blocks += fmt::format("{} 2 2 {} {} 1 2 3\n", i + 1, i + 1, n - i);
    solids += fmt::format("solid s{}\nendsolid\n", i);
  }
  test::write_bytes(folder / "a.msh", sections);
  EXPECT_EQ(read_mesh(folder / "a.msh").n_nodes(), 3);
  const std::string head(text2, std::string(text2).find("$Elements"));
  test::write_bytes(folder / "b.msh", head + blocks + "$EndElements\n");
  EXPECT_EQ(read_mesh(folder / "b.msh").groups.size(), n);
  solids +=
      "solid\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop "
      "endfacet\nendsolid\n";
  test::write_bytes(folder / "c.stl", solids);
  EXPECT_EQ(read_mesh(folder / "c.stl").groups.size(), n);
}
