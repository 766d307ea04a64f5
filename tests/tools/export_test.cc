// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin export against ptin refine, against the source, and against itself cut otherwise.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>

#include "engine/error.h"
#include "engine/query/questions.h"
#include "tests/support/share_of_cases.h"
#include "tests/tools/mesh_reader.h"
#include "tests/tools/program.h"
#include "tests/tools/raster_reader.h"
#include "tools/export/tin_patch.h"

namespace ptin::tools {
namespace {

using testing::built;
using testing::expect_done;
using testing::Outcome;
using testing::read_file;
using testing::read_ply;
using testing::read_raster;
using testing::ReadMesh;
using testing::ReadRaster;
using testing::run_ptin;
using testing::test_data;
using testing::TestFolder;
using Point = std::array<double, 3>;
using Facet = std::array<Point, 3>;

/// Corners from the smallest on, in the same sense.
Facet turned(Facet f) {
  std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
  return f;
}

std::multiset<Facet> facets_of(const ReadMesh& mesh) {
  std::multiset<Facet> facets;
  for (const auto& t : mesh.triangles) {
    facets.insert(turned({mesh.vertices.at(t[0]), mesh.vertices.at(t[1]), mesh.vertices.at(t[2])}));
  }
  return facets;
}

std::multiset<Facet> facets_in(const std::string& path) {
  return facets_of(read_ply(read_file(path)));
}

/// Every feature of the only layer.
std::multiset<Facet> features_in(const std::string& path) {
  GDALAllRegister();
  std::multiset<Facet> facets;
  GDALDataset* dataset = GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR);
  EXPECT_NE(dataset, nullptr);
  if (dataset == nullptr) return facets;
  EXPECT_EQ(dataset->GetLayerCount(), 1);
  for (const auto& feature : *dataset->GetLayer(0)) {
    const OGRPolygon* polygon = feature->GetGeometryRef()->toPolygon();
    EXPECT_EQ(polygon->getGeometryType(), wkbPolygon25D);
    const OGRLinearRing* ring = polygon->getExteriorRing();
    EXPECT_EQ(ring->getNumPoints(), 4);
    Facet f;
    for (int i = 0; i < 3; ++i) f[i] = {ring->getX(i), ring->getY(i), ring->getZ(i)};
    facets.insert(turned(f));
  }
  GDALClose(dataset);
  return facets;
}

TEST(Export, WritesTextMeshesPieceByPieceAsRefineDoes) {
  const TestFolder folder;
  const std::string store = built(folder, "coast_257.tif", "c.ptin");
  for (const auto& [name, read] :
       {std::pair{"a.obj", &testing::read_obj}, std::pair{"a.2dm", &testing::read_2dm}}) {
    const std::string path = folder.file(name);
    expect_done({"refine", store, "--error", "5", "-q", "-o", path});
    const ReadMesh refined = read(read_file(path));
    expect_done(
        {"export", store, "--error", "5", "-q", "--memory", "32M", "-o", path, "--overwrite"});
    const ReadMesh exported = read(read_file(path));
    EXPECT_GT(exported.triangles.size(), 100U);
    EXPECT_EQ(facets_of(exported), facets_of(refined)) << name;
    EXPECT_EQ(exported.header, refined.header);
  }
  const Outcome glb = run_ptin({"export", store, "-o", folder.file("a.glb")});
  EXPECT_EQ(glb.status, 2);
  EXPECT_NE(glb.err.find("which `ptin refine` does"), std::string::npos) << glb.err;
}

TEST(Export, EqualsRefineAsASetOfTriangles) {
  const TestFolder folder;
  for (const char* name :
       test::some_of({"coast_257.tif", "mountains_257.tif", "ground_points.csv"})) {
    const std::string file = built(folder, name);
    for (const std::vector<std::string>& level :
         {std::vector<std::string>{}, {"--error", "0"}, {"--error", "3"}}) {
      std::vector<std::string> refine = {"refine", file, "-o", folder.file("a.ply"), "--overwrite"};
      std::vector<std::string> exported = {"export",      file, "-o", folder.file("b.ply"),
                                           "--overwrite", "-q"};
      refine.insert(refine.end(), level.begin(), level.end());
      exported.insert(exported.end(), level.begin(), level.end());
      expect_done(refine);
      expect_done(exported);
      EXPECT_EQ(facets_in(folder.file("a.ply")), facets_in(folder.file("b.ply"))) << name;
    }
  }
}

TEST(Export, OfARegionIsWhatRefineClips) {
  const TestFolder folder;
  const std::string file = built(folder, "coast_257.tif");
  const ReadRaster dem = read_raster(test_data("coast_257.tif"));
  const auto& g = dem.transform;
  const auto at = [&](double share, int axis) {
    return std::to_string(axis == 0 ? g[0] + share * dem.width * g[1]
                                    : g[3] + share * dem.height * g[5]);
  };
  const std::vector<std::string> window = {"--window", at(0.3, 0), at(0.8, 1), at(0.7, 0),
                                           at(0.2, 1)};
  for (const char* error : {"0", "2"}) {
    std::vector<std::string> refine = {"refine",      file,     "-o",      folder.file("a.ply"),
                                       "--overwrite", "--clip", "--error", error};
    std::vector<std::string> exported = {"export",      file,      "-o",  folder.file("b.ply"),
                                         "--overwrite", "--error", error, "-q"};
    refine.insert(refine.end(), window.begin(), window.end());
    exported.insert(exported.end(), window.begin(), window.end());
    expect_done(refine);
    expect_done(exported);
    const auto facets = facets_in(folder.file("b.ply"));
    EXPECT_FALSE(facets.empty());
    EXPECT_EQ(facets_in(folder.file("a.ply")), facets);
  }
}

TEST(Export, WindowsAgreeOnTheTrianglesThatMeetBoth) {
  const TestFolder folder;
  const std::string file = built(folder, "mountains_257.tif");
  const ReadRaster dem = read_raster(test_data("mountains_257.tif"));
  const auto& g = dem.transform;
  const double west = g[0], east = g[0] + dem.width * g[1], north = g[3];
  const double south = g[3] + dem.height * g[5], middle = (west + east) / 2;
  const auto part = [&](double from, double to, const char* name) {
    expect_done({"export", file, "--error", "4", "-q", "-o", folder.file(name), "--window",
                 std::to_string(from), std::to_string(south), std::to_string(to),
                 std::to_string(north)});
    return facets_in(folder.file(name));
  };
  const auto left = part(west, middle, "left.ply");
  const auto right = part(middle, east, "right.ply");
  expect_done({"export", file, "--error", "4", "-q", "-o", folder.file("all.ply")});
  const auto all = facets_in(folder.file("all.ply"));
  std::set<Facet> joined(left.begin(), left.end());
  joined.insert(right.begin(), right.end());
  EXPECT_EQ(joined, std::set<Facet>(all.begin(), all.end()));
  EXPECT_LT(left.size(), all.size());
}

TEST(Export, NumbersEveryVertexOnceAndBeforeItsTriangles) {
  const TestFolder folder;
  expect_done({"export", built(folder, "coast_257.tif"), "-q", "-o", folder.file("a.ply")});
  const ReadMesh mesh = read_ply(read_file(folder.file("a.ply")));
  const std::set<Point> distinct(mesh.vertices.begin(), mesh.vertices.end());
  EXPECT_EQ(distinct.size(), mesh.vertices.size());
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const auto& t : mesh.triangles) {
    EXPECT_GT(t[0], t[1]) << "the last corner comes first";
    EXPECT_GT(t[0], t[2]);
    for (const auto v : t) used.at(v) = true;
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
}

/// All patches of a walk as one sequence.
struct Joined {
  std::vector<Point> vertices;
  std::vector<std::array<std::uint64_t, 3>> triangles;
  std::uint64_t cells = 0;
};

Joined joined_under(const Terrain& terrain, PartRequest request, std::uint64_t limit) {
  request.limits.memory_bytes = limit;
  TinParts tin_parts(terrain, request);
  PatchMaker maker(terrain.store(), request.region);
  Joined all;
  walk_cells(tin_parts, [&](const GridCell& cell, const Tin& part, double) {
    const TinPatch patch = maker.make(cell, part, std::uint64_t{1} << 30);
    EXPECT_EQ(patch.first_vertex, all.vertices.size());
    all.vertices.insert(all.vertices.end(), patch.vertices.begin(), patch.vertices.end());
    for (const auto& t : patch.triangles) {
      for (const auto& corner : t) {
        EXPECT_EQ(all.vertices.at(corner.number), patch.point(corner));
      }
      all.triangles.push_back({t[0].number, t[1].number, t[2].number});
    }
    ++all.cells;
  });
  maker.finish();
  return all;
}

/// A limit that the part of every single vertex fits, and of few larger ones.
std::uint64_t tightest_limit(const Terrain& terrain, PartRequest request) {
  const std::vector<Vertex> vertices = terrain.refine({}).tin.vertices;
  request.limits.memory_bytes = 1024;
  std::optional<TinParts> parts(std::in_place, terrain, request);
  for (const Vertex& v : vertices) {
    while (parts->part(united(GridBox{}, v.position)) == nullptr) {
      request.limits.memory_bytes += request.limits.memory_bytes / 4;
      parts.emplace(terrain, request);
    }
  }
  return 2 * request.limits.memory_bytes;
}

TEST(Export, DoesNotDependOnTheCells) {
  const TestFolder folder;
  for (const char* name : test::some_of({"coast_257.tif", "ground_points.csv"})) {
    const Terrain terrain = Terrain::open(built(folder, name));
    std::array<PartRequest, 3> levels;
    levels[1].detail.tolerance = 1.0;
    levels[2].detail.vertices = terrain.store().t0().vertices.size() + 200;
    for (const PartRequest& request : levels) {
      const Joined whole = joined_under(terrain, request, std::uint64_t{1} << 30);
      EXPECT_EQ(whole.cells, 1U);
      const bool is_raster = terrain.store().record_count() > 10'000;
      for (const std::uint64_t limit :
           {std::uint64_t{is_raster ? 4'000'000U : 700'000U}, tightest_limit(terrain, request)}) {
        const Joined parts = joined_under(terrain, request, limit);
        const bool is_full = !request.detail.tolerance && !request.detail.vertices;
        EXPECT_GT(parts.cells, is_full ? 3U : 0U) << name;
        EXPECT_EQ(parts.vertices, whole.vertices);
        EXPECT_EQ(parts.triangles, whole.triangles);
      }
    }
  }
}

TEST(Export, NoticesAStoreThatIsReplacedOnTheWay) {
  const TestFolder folder;
  const std::string file = built(folder, "coast_257.tif");
  std::filesystem::copy_file(file, folder.file("other"));
  const Terrain terrain = Terrain::open(file);
  PartRequest request;
  request.limits.memory_bytes = 4'000'000;
  int cells = 0;
  try {
    TinParts parts(terrain, request);
    walk_cells(parts, [&](const GridCell&, const Tin&, double) {
      if (++cells == 2) std::filesystem::rename(folder.file("other"), file);
    });
    FAIL() << "not noticed";
  } catch (const Error& e) {
    EXPECT_EQ(cells, 2);
    EXPECT_TRUE(e.code() == ErrorCode::corruption || e.code() == ErrorCode::io_error) << e.what();
  }
}

TEST(Export, RefusesMemoryThatASinglePositionDoesNotFit) {
  const TestFolder folder;
  const Terrain terrain = Terrain::open(built(folder, "coast_257.tif"));
  EXPECT_THROW(static_cast<void>(joined_under(terrain, {}, 500)), Error);
  Terrain stars = terrain;
  stars.use_floor(false);
  EXPECT_THROW(static_cast<void>(joined_under(stars, {}, 20'000)), Error);
}

TEST(Export, WritesTheFirstVerticesAsRefineDoes) {
  const TestFolder folder;
  const std::string file = built(folder, "mountains_257.tif");
  for (const char* vertices : {"300", "5000"}) {
    expect_done({"export", file, "--vertices", vertices, "--memory", "32M", "-q", "--overwrite",
                 "-o", folder.file("a.ply")});
    expect_done(
        {"refine", file, "--vertices", vertices, "--overwrite", "-o", folder.file("b.ply")});
    EXPECT_EQ(facets_in(folder.file("a.ply")), facets_in(folder.file("b.ply"))) << vertices;
  }
}

TEST(Export, WritesTheSameTrianglesAsFeatures) {
  const TestFolder folder;
  const std::string file = built(folder, "coast_257.tif");
  expect_done({"export", file, "--error", "2", "-q", "-o", folder.file("a.ply")});
  const auto facets = facets_in(folder.file("a.ply"));
  for (const char* name : {"a.gpkg", "a.fgb"}) {
    expect_done({"export", file, "--error", "2", "-q", "-o", folder.file(name)});
    EXPECT_EQ(features_in(folder.file(name)), facets) << name;
  }
  EXPECT_EQ(folder.names(),
            (std::vector<std::string>{"a.fgb", "a.gpkg", "a.ply", "coast_257.tif.ptin"}));
}

TEST(Export, RefusesWhatMeansNothing) {
  const TestFolder folder;
  const std::string points = built(folder, "ground_points.csv");
  testing::write_file(folder.file("old.ply"), "old");
  const auto fails = [&](std::vector<std::string> arguments, const char* what) {
    arguments.insert(arguments.begin(), {"export", points, "-q"});
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, 2) << what;
    EXPECT_NE(outcome.err.find(what), std::string::npos) << outcome.err;
    EXPECT_EQ(testing::lines_in(outcome.err), 1U);
  };
  fails({"-o", folder.file("a.doc")}, "names no format");
  fails({"-o", folder.file("a.doc"), "--format", "doc"}, "unknown format");
  fails({"-o", folder.file("old.ply")}, "exists already");
  fails({"-o", folder.file("a.tif")}, "--pixel-size");
  fails({"-o", folder.file("a.tif"), "--pixel-size", "0"}, "--pixel-size");
  fails({"-o", folder.file("a.tif"), "--pixel-size", "1e-12"}, "--pixel-size");
  fails({"-o", folder.file("a.tif"), "--pixel-size", "5", "--window", "0", "0", "1", "1"},
        "window");
  fails({"-o", folder.file("a.ply"), "--pixel-size", "5"}, "are for rasters");
  fails({"-o", folder.file("a.ply"), "--error", "-1"}, "--error");
  fails({"-o", folder.file("a.ply"), "--memory", "1M"}, "--memory");
  fails({"-o", folder.file("a.tif"), "--pixel-size", "5", "--co", "COMPRESS=NONSENSE"}, "COMPRESS");
  fails({"-o", folder.file("a.gpkg"), "--format", "FlatGeobuf"}, ".fgb");
  fails({"-o", "-"}, "extension");
  EXPECT_EQ(run_ptin({"export", points, "-o", folder.file("a.tif"), "--pixel-size", "0.0002",
                      "--memory", "32M"})
                .status,
            7)
      << "the table of blocks alone is larger";
  EXPECT_EQ(read_file(folder.file("old.ply")), "old");
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"ground_points.csv.ptin", "old.ply"}));
}

TEST(Export, OfADamagedStoreLeavesNothingBehind) {
  const TestFolder folder;
  const std::string file = built(folder, "coast_257.tif");
  std::string bytes = read_file(file);
  // The last page of heights, which the full TIN is made of, and a page of records, for levels.
  for (const std::size_t at : {bytes.size() - 2000, bytes.size() / 2}) {
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
  }
  testing::write_file(file, bytes);
  for (const std::vector<std::string>& level : {std::vector<std::string>{}, {"--error", "0"}}) {
    for (const char* name : {"a.ply", "a.gpkg", "a.fgb", "a.tif"}) {
      std::vector<std::string> asked = {"export", file, "-q", "-o", folder.file(name)};
      asked.insert(asked.end(), level.begin(), level.end());
      const Outcome outcome = run_ptin(asked);
      EXPECT_EQ(outcome.status, 4) << name << outcome.err;
    }
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"coast_257.tif.ptin"});
}

}  // namespace
}  // namespace ptin::tools
