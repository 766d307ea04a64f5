// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/mesh_writer.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "tests/tools/mesh_reader.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::read_file;
using testing::ReadMesh;
using testing::TestFolder;

/// Two triangles far from the origin, with coordinates that need every digit of a double.
Mesh two_triangles() {
  Mesh mesh;
  mesh.vertices = {{4000000.1, 5000000.2, 100.3},
                   {4000010.1, 5000000.2, 101.0},
                   {4000010.1, 5000010.7, 1.0 / 3.0},
                   {4000000.1, 5000010.7, 98.0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.crs.code = "EPSG:32611";
  return mesh;
}

std::string written(const Mesh& mesh, const std::string& extension) {
  const TestFolder folder;
  write_mesh(mesh, folder.file("mesh." + extension), false);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"mesh." + extension});
  return read_file(folder.file("mesh." + extension));
}

TEST(WritePly, SaysExactlyWhatMdalReads) {
  const ReadMesh mesh = testing::read_ply(written(two_triangles(), "ply"));
  const std::vector<std::string> header = {"ply",
                                           "format binary_little_endian 1.0",
                                           "comment written by ptin",
                                           "comment crs: EPSG:32611",
                                           "element vertex 4",
                                           "property double x",
                                           "property double y",
                                           "property double z",
                                           "element face 2",
                                           "property list uchar int vertex_indices",
                                           "end_header"};
  EXPECT_EQ(mesh.header, header);
  EXPECT_EQ(mesh.vertices, two_triangles().vertices);
  EXPECT_EQ(mesh.triangles, two_triangles().triangles);
}

TEST(WriteObj, KeepsEveryDigit) {
  const ReadMesh mesh = testing::read_obj(written(two_triangles(), "obj"));
  EXPECT_EQ(mesh.vertices, two_triangles().vertices);
  EXPECT_EQ(mesh.triangles, two_triangles().triangles);
  EXPECT_EQ(mesh.header.at(1), "# crs: EPSG:32611");
}

TEST(WriteObj, IsThisTextForOneTriangle) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 1.5}, {1, 0, -2}, {0, 1, 1e-3}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_EQ(
      written(mesh, "obj"),
      "# written by ptin; x east, y north, z up\nv 0 0 1.5\nv 1 0 -2\nv 0 1 0.001\nf 1 2 3\n");
}

TEST(Write2dm, KeepsEveryDigit) {
  const ReadMesh mesh = testing::read_2dm(written(two_triangles(), "2dm"));
  EXPECT_EQ(mesh.vertices, two_triangles().vertices);
  EXPECT_EQ(mesh.triangles, two_triangles().triangles);
}

TEST(WriteGlb, StandsAroundALocalOriginYUp) {
  const Mesh mesh = two_triangles();
  const ReadMesh read = testing::read_glb(written(mesh, "glb"));
  const auto& extras = read.json.at("nodes").at(0).at("extras");
  EXPECT_EQ(extras.at("crs"), "EPSG:32611");
  const auto origin = extras.at("origin").get<std::array<double, 3>>();
  ASSERT_EQ(read.vertices.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_NEAR(origin[0] + read.vertices[i][0], mesh.vertices[i][0], 1e-5);
    EXPECT_NEAR(origin[1] - read.vertices[i][2], mesh.vertices[i][1], 1e-5);
    EXPECT_NEAR(origin[2] + read.vertices[i][1], mesh.vertices[i][2], 1e-5);
  }
  EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST(WriteGlb, MakesUnitsMetres) {
  Mesh mesh;
  mesh.metres_per_unit = {55'660, 111'320, 0.5};
  mesh.vertices = {{10.0, 60.0, 0.0}, {10.01, 60.0, 0.0}, {10.0, 60.01, 8.0}};
  mesh.triangles = {{0, 1, 2}};
  const ReadMesh read = testing::read_glb(written(mesh, "glb"));
  EXPECT_NEAR(read.vertices[1][0] - read.vertices[0][0], 556.5,
              1.0);  // half a degree of the equator
  EXPECT_NEAR(read.vertices[0][2] - read.vertices[2][2], 1113.2, 1.0);
  EXPECT_NEAR(read.vertices[2][1] - read.vertices[0][1], 4.0, 1e-4);
}

TEST(WriteGlb, HoldsAnEmptyMesh) {
  EXPECT_TRUE(testing::read_glb(written(Mesh{}, "glb")).triangles.empty());
}

TEST(WriteMesh, WritesEveryFormatOfAnEmptyMesh) {
  for (const MeshFormat& format : mesh_formats())
    EXPECT_FALSE(written(Mesh{}, std::string(format.extension)).empty());
}

TEST(MeshFormat, TakesExtensionsInAnyCase) {
  EXPECT_EQ(mesh_format_of("a/B.PLY").extension, "ply");
}

TEST(MeshFormat, ListsTheKnownOnesWhenItDoesNotKnow) {
  for (const char* path : {"mesh.doc", "mesh", "folder.ply/mesh"}) {
    try {
      static_cast<void>(mesh_format_of(path));
      FAIL() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
      EXPECT_NE(error.message().find(".ply, .obj, .2dm, .glb, .xml, .dxf, .stl"), std::string::npos)
          << error.message();
    }
  }
}

}  // namespace
}  // namespace ptin::tools
