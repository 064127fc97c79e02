// SPDX-License-Identifier: BSD-3-Clause
// VTU: read back by meshio, an independent reader.
#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "support/files.hpp"
#include "support/format_files.hpp"
#include "support/meshes.hpp"
#include "support/msh_files.hpp"
#include "support/quadratic.hpp"

using namespace roughmesh;

namespace {

Mesh first_order_zoo() {
  Mesh mesh = test::zoo();
  std::erase_if(mesh.blocks, [](const ElementBlock& block) { return block.type.order > 1; });
  return mesh;
}

// What meshio prints of a file, cell block by cell block.
std::string seen_by_meshio(const test::TemporaryFolder& folder, const std::filesystem::path& file) {
  test::write_bytes(folder / "show.py",
                    "import meshio, sys\n"
                    "m = meshio.read(sys.argv[1])\n"
                    "for i, c in enumerate(m.cells):\n"
                    "    print(c.type, c.data.tolist(), m.cell_data['entity'][i].tolist(),\n"
                    "          m.cell_data['physical_group'][i].tolist())\n"
                    "print([float(x).hex() for x in m.points.flatten()])\n"
                    "for k in sorted(m.point_data): print(k, m.point_data[k].tolist())\n");
  const std::string printed = (folder / "printed").string();
  test::run("/usr/bin/python3 " + (folder / "show.py").string() + " " + file.string() + " > " +
            printed + " 2>&1");
  return test::read_bytes(printed);
}

const char* meshio_name(ElementShape shape) {
  constexpr std::array names = {"vertex", "line",       "triangle", "quad",
                                "tetra",  "hexahedron", "wedge",    "pyramid"};
  return names[static_cast<std::size_t>(shape)];
}

// meshio numbers the corners of a wedge as Gmsh does and turns those of VTK files round.
std::string expected_from_meshio(const Mesh& mesh) {
  std::string text;
  for (const ElementBlock& block : mesh.blocks) {
    std::vector<std::vector<Index>> cells;
    for (Index e = 0; e < block.size(); ++e) {
      const auto element = block.element(e);
      cells.emplace_back(element.begin(), element.end());
    }
    const Tag group = block.physical_groups.empty() ? 0 : block.physical_groups.front();
    const std::vector<Tag> entities(cells.size(), block.entity), groups(cells.size(), group);
    std::vector<std::string> rows;
    for (const auto& cell : cells) rows.push_back(fmt::format("[{}]", fmt::join(cell, ", ")));
    text += fmt::format("{} [{}] [{}] [{}]\n", meshio_name(block.type.shape), fmt::join(rows, ", "),
                        fmt::join(entities, ", "), fmt::join(groups, ", "));
  }
  return text;
}

}  // namespace

TEST(Vtu, IsReadByMeshioWithEveryShapeAndGroup) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  const test::TemporaryFolder folder;
  const Mesh mesh = first_order_zoo();
  PointField height{"height < \"0\" & more", 1, {}}, displacement{"displacement", 3, {}};
  for (Index i = 0; i < mesh.n_nodes(); ++i) {
    height.values.push_back(0.5 * i);
    for (int k = 0; k < 3; ++k) displacement.values.push_back(i + 0.25 * k);
  }
  write_mesh(mesh, folder / "a.vtu", {.fields = {height, displacement}});
  const std::string seen = seen_by_meshio(folder, folder / "a.vtu");
  EXPECT_EQ(seen.substr(0, seen.find("['")), expected_from_meshio(mesh));
  EXPECT_NE(seen.find("displacement [[0.0, 0.25, 0.5], [1.0, 1.25, 1.5]"), std::string::npos)
      << seen;
  EXPECT_NE(seen.find("height < \"0\" & more [0.0, 0.5, 1.0"), std::string::npos) << seen;
  // The second node is (1, 0, 0), the tenth holds numbers that only survive bit for bit.
  EXPECT_NE(seen.find("'0x1.0000000000000p+0', '0x0.0p+0', '0x0.0p+0'"), std::string::npos) << seen;
  EXPECT_NE(seen.find("'-0x1.4f8b588e368f1p-17', '0x1.5555555555555p-2', '0x1.5af1d78b58c40p+66'"),
            std::string::npos)
      << seen;
}

TEST(Vtu, CarriesMovedMeshesOfEveryFormat) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.ply2", "3 1\n0 0 0 1 0 0 0 1 0\n3 0 1 2");
  Mesh mesh = read_mesh(folder / "a.ply2");
  mesh.nodes[0][2] = 4;
  write_mesh(mesh, folder / "a.vtu");
  const std::string seen = seen_by_meshio(folder, folder / "a.vtu");
  EXPECT_NE(seen.find("triangle [[0, 1, 2]] [0] [0]"), std::string::npos) << seen;
  EXPECT_NE(seen.find("['0x0.0p+0', '0x0.0p+0', '0x1.0000000000000p+2'"), std::string::npos)
      << seen;
}

// meshio keeps VTK's order of nodes of second order elements, which tests/test_vtk.cpp compares
// with that of gmsh: legacy and XML files share one table.
TEST(Vtu, CarriesElementsOfSecondOrder) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  const test::TemporaryFolder folder;
  std::vector<ElementType> types = test::quadratic_types();
  std::erase_if(types, [](const ElementType& type) {
    // meshio 5.0 stumbles over these two
    return type == ElementType{ElementShape::prism, 2, 15} || type.shape == ElementShape::pyramid;
  });
  const Mesh mesh = test::quadratic_elements(types);
  write_mesh(mesh, folder / "a.vtu");
  write_mesh(mesh, folder / "a.vtk");
  const std::string show =
      "for c in m.cells: print(c.type, c.data.tolist())\nprint(m.points.tolist())\n";
  const std::string seen = test::seen_by_meshio(folder, "a.vtu", show);
  EXPECT_EQ(seen, test::seen_by_meshio(folder, "a.vtk", show));
  EXPECT_EQ(seen.find("line3 [[0, 1, 2]]\ntriangle6 [[3, 4, 5, 6, 7, 8]]\nquad8 "), 0) << seen;
  // Nodes 26 to 35: Gmsh's last two edges of a tetrahedron change places.
  EXPECT_NE(seen.find("tetra10 [[26, 27, 28, 29, 30, 31, 32, 33, 35, 34]]"), std::string::npos)
      << seen;
}

TEST(Vtu, RefusesFieldsOfTheWrongLength) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(write_mesh(test::plate(1), folder / "a.vtu", {.fields = {{"z", 1, {1, 2, 3}}}}),
               InputError);
  EXPECT_THROW(write_mesh(test::plate(1), folder / "a.vtu", {.fields = {{"z", 0, {}}}}),
               InputError);
  EXPECT_EQ(folder.n_files(), 0);
}
