// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin export against ptin refine, against the source, and against itself cut otherwise.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <set>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>

#include "engine/error.h"
#include "engine/query/terrain.h"
#include "tests/support/share_of_cases.h"
#include "tests/tools/mesh_reader.h"
#include "tests/tools/program.h"
#include "tools/export/raster_export.h"
#include "tools/export/tin_patch.h"
#include "tools/export/tin_samples.h"

namespace ptin::tools {
namespace {

using testing::built;
using testing::expect_done;
using testing::Outcome;
using testing::read_file;
using testing::read_ply;
using testing::ReadMesh;
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

struct ReadRaster {
  int width = 0, height = 0;
  std::array<double, 6> transform{};
  double nodata = 0.0;
  std::vector<double> values;
};

ReadRaster read_raster(const std::string& path) {
  GDALAllRegister();
  ReadRaster raster;
  GDALDataset* dataset = GDALDataset::Open(path.c_str(), GDAL_OF_RASTER);
  EXPECT_NE(dataset, nullptr);
  if (dataset == nullptr) return raster;
  raster.width = dataset->GetRasterXSize();
  raster.height = dataset->GetRasterYSize();
  raster.nodata = dataset->GetRasterBand(1)->GetNoDataValue();
  EXPECT_EQ(dataset->GetGeoTransform(raster.transform.data()), CE_None);
  raster.values.resize(static_cast<std::size_t>(raster.width) * raster.height);
  EXPECT_EQ(dataset->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, raster.width, raster.height,
                                                raster.values.data(), raster.width, raster.height,
                                                GDT_Float64, 0, 0),
            CE_None);
  GDALClose(dataset);
  return raster;
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
  EXPECT_THROW(static_cast<void>(joined_under(terrain, {}, 20'000)), Error);
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

TEST(ExportRaster, RasterOfTheFullTinIsTheSource) {
  const TestFolder folder;
  for (const char* name : test::some_of({"coast_257.tif", "mountains_257.tif"})) {
    const std::string file = built(folder, name);
    const ReadRaster source = read_raster(test_data(name));
    for (const char* format : {"GTiff", "COG"}) {
      expect_done(
          {"export", file, "--format", format, "-q", "--overwrite", "-o", folder.file("a.tif")});
      const ReadRaster made = read_raster(folder.file("a.tif"));
      ASSERT_EQ(made.width, source.width);
      ASSERT_EQ(made.height, source.height);
      for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_NEAR(made.transform[i], source.transform[i], 1e-9 * std::abs(source.transform[i]));
      }
      std::size_t lone = 0;
      for (std::size_t i = 0; i < source.values.size(); ++i) {
        const bool is_void = source.values[i] == source.nodata;
        if (!is_void && made.values[i] == made.nodata) {
          ++lone;
        } else {
          ASSERT_EQ(made.values[i], is_void ? made.nodata : source.values[i]) << name << " " << i;
        }
      }
      EXPECT_LT(lone, 5U);
    }
  }
}

TEST(ExportRaster, TellsWhichSamplesChangeBetweenSurfaceAndVoid) {
  const TestFolder folder;
  const std::string file = built(folder, "coast_257.tif");
  expect_done({"export", file, "-q", "-o", folder.file("full.tif")});
  const ReadRaster full = read_raster(folder.file("full.tif"));
  std::size_t most = 0;
  for (const char* error : {"5", "40"}) {
    const Outcome outcome = run_ptin({"export", file, "--error", error, "--json", "--overwrite",
                                      "-o", folder.file("coarse.tif")});
    const auto answer = nlohmann::json::parse(outcome.out);
    const ReadRaster coarse = read_raster(folder.file("coarse.tif"));
    std::size_t to_void = 0, to_surface = 0;
    for (std::size_t i = 0; i < full.values.size(); ++i) {
      const bool before = full.values[i] != full.nodata, after = coarse.values[i] != coarse.nodata;
      to_void += before && !after ? 1 : 0;
      to_surface += !before && after ? 1 : 0;
    }
    EXPECT_EQ(answer["samples_made_void"], to_void);
    // A void sample on the border gets a height as a pixel, and has not changed its class.
    EXPECT_LE(answer["samples_made_surface"], to_surface);
    most = std::max(most, to_void);
  }
  EXPECT_GT(most, 0U);
}

TEST(ExportRaster, TakesSeveralCreationOptions) {
  const TestFolder folder;
  const std::string file = built(folder, "coast_257.tif");
  const auto size = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"export", file, "-q", "-o", folder.file("a.tif")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    arguments.emplace_back("--overwrite");
    expect_done(arguments);
    return read_file(folder.file("a.tif")).size();
  };
  const std::size_t deflated = size({"--co", "COMPRESS=DEFLATE"});
  EXPECT_LT(deflated, size({"--co", "COMPRESS=NONE"}));
  EXPECT_NE(size({"--co", "COMPRESS=DEFLATE", "--co", "ZLEVEL=1"}), deflated);
}

TEST(ExportRaster, RasterDoesNotDependOnMemory) {
  const TestFolder folder;
  const Terrain terrain = Terrain::open(built(folder, "mountains_257.tif"));
  const StoreFacts& facts = terrain.store().facts();
  const PixelGrid grid(facts, {facts.map.step_x * 0.37, facts.map.step_y * 0.41}, std::nullopt);
  std::string first;
  for (const std::uint64_t limit : {std::uint64_t{1} << 30, std::uint64_t{2'000'000}}) {
    PartRequest request;
    request.limits.memory_bytes = limit;
    TinParts parts(terrain, request);
    const RasterTarget target{folder.file("a.tif"), true, false, {}, -9999.0, {}, {}, limit / 8};
    GDALAllRegister();
    static_cast<void>(export_raster(parts, grid, target, {}));
    const std::string bytes = read_file(target.path);
    if (first.empty()) first = bytes;
    EXPECT_TRUE(bytes == first);
  }
}

/// Height of the TIN at a grid position by brute force: NAN where no surface triangle holds it.
double height_at(const Tin& tin, const StoreFacts& facts, long double x, long double y) {
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.classes[t] == TriangleClass::kVoid) continue;
    std::array<long double, 3> w{};
    std::array<GridPoint, 3> p{};
    for (int i = 0; i < 3; ++i) p[i] = tin.position(tin.triangles[t].v[i]);
    for (int i = 0; i < 3; ++i) {
      const GridPoint a = p[next_corner(i)], b = p[previous_corner(i)];
      w[i] = (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
    }
    if (w[0] < 0 || w[1] < 0 || w[2] < 0) continue;
    long double sum = 0;
    for (int i = 0; i < 3; ++i) {
      sum += w[i] * facts.heights.height(tin.vertices[tin.triangles[t].v[i]].height);
    }
    return static_cast<double>(sum / (w[0] + w[1] + w[2]));
  }
  return NAN;
}

TEST(ExportRaster, RasterInterpolatesTheTriangles) {
  const TestFolder folder;
  std::mt19937 random(7);
  for (const char* name : test::some_of({"coast_257.tif", "ground_points.csv"})) {
    const Terrain terrain = Terrain::open(built(folder, name));
    RefineRequest request;
    request.detail.tolerance = 5.0;
    const RefinedTin refined = terrain.refine(request);
    const StoreFacts& facts = terrain.store().facts();
    const GridBox& b = facts.bounds;
    const double pitch = std::max(b.max_x - b.min_x, b.max_y - b.min_y) / 61.3;
    const PixelGrid grid(facts, {facts.map.step_x * pitch, facts.map.step_y * pitch}, std::nullopt);
    const PixelRect all{0, 0, grid.columns(), grid.rows()};
    std::vector<double> heights(static_cast<std::size_t>(all.pixels()), NAN);
    HeightSamples samples(facts, grid, all, heights);
    TinParts(terrain, {{}, request.detail, {}}).visit(facts.bounds, [&](const LivingTriangle& t) {
      samples.add(t);
    });
    std::size_t surface = 0;
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const auto column = static_cast<std::int64_t>(i) % all.width;
      const auto row = static_cast<std::int64_t>(i) / all.width;
      const double expected =
          height_at(refined.tin, facts, grid.x(column) * 0x1p-20L, grid.y(row) * 0x1p-20L);
      ASSERT_EQ(std::isnan(heights[i]), std::isnan(expected)) << name << " " << i;
      if (std::isnan(expected)) continue;
      ASSERT_NEAR(heights[i], expected, 1e-9) << name << " " << i;
      ++surface;
    }
    EXPECT_GT(surface, heights.size() / 8);
  }
}

TEST(ExportRaster, RastersOfWindowsAreCutsOfTheWhole) {
  const TestFolder folder;
  const std::string file = built(folder, "mountains_257.tif");
  const ReadRaster dem = read_raster(test_data("mountains_257.tif"));
  const std::string size = std::to_string(dem.transform[1] * 1.7);
  expect_done(
      {"export", file, "-q", "--error", "2", "--pixel-size", size, "-o", folder.file("a.tif")});
  const ReadRaster whole = read_raster(folder.file("a.tif"));
  const double x = dem.transform[0] + 80 * dem.transform[1];
  const double y = dem.transform[3] + 180 * dem.transform[5];
  expect_done({"export", file, "-q", "--error", "2", "--pixel-size", size, "-o",
               folder.file("b.tif"), "--window", std::to_string(x), std::to_string(y),
               std::to_string(x + 90 * dem.transform[1]),
               std::to_string(y - 100 * dem.transform[5])});
  const ReadRaster part = read_raster(folder.file("b.tif"));
  const double column = (part.transform[0] - whole.transform[0]) / whole.transform[1];
  const double row = (part.transform[3] - whole.transform[3]) / whole.transform[5];
  EXPECT_NEAR(column, std::round(column), 1e-6);
  EXPECT_NEAR(row, std::round(row), 1e-6);
  EXPECT_NEAR(part.width, 90 / 1.7, 1.0);
  for (int j = 0; j < part.height; ++j) {
    for (int i = 0; i < part.width; ++i) {
      const auto at =
          static_cast<std::size_t>((std::lround(row) + j) * whole.width + std::lround(column) + i);
      ASSERT_EQ(part.values[static_cast<std::size_t>(j * part.width + i)], whole.values[at]);
    }
  }
}

/// A terrain in degrees, at 59.984 degrees north; 0.032 degrees wide and high.
std::string terrain_in_degrees(const TestFolder& folder) {
  testing::RasterRecipe recipe;
  recipe.epsg = 4326;
  recipe.west = 9.0;
  recipe.north = 60.0005;
  recipe.pixel = 0.001;
  testing::make_raster(folder.file("degrees.tif"), recipe);
  expect_done({"build", folder.file("degrees.tif"), "-o", folder.file("degrees.ptin"), "-q"});
  return folder.file("degrees.ptin");
}

TEST(ExportRaster, TakesPixelSizesOverGround) {
  const TestFolder folder;
  const auto size = [&](const std::string& file, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {
        "export", file, "--json", "--overwrite", "-o", folder.file("a.tif"), "--pixel-size"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto answer = testing::answer_of(arguments);
    const ReadRaster raster = read_raster(folder.file("a.tif"));
    EXPECT_EQ(answer.at("pixel_size").at(0), raster.transform[1]);
    EXPECT_EQ(answer.at("pixel_size").at(1), -raster.transform[5]);
    return std::array<double, 2>{raster.transform[1], -raster.transform[5]};
  };
  // A degree of latitude has 111 412 m there; one of longitude has 55 824 m, and 55 800 m at 60
  // degrees.
  const std::string degrees = terrain_in_degrees(folder);
  for (const char* text : {"90m", "90 m", "0.09km", "295.27559055118110ft"}) {
    EXPECT_NEAR(size(degrees, {text})[0], 90 / 55826.0, 5e-8) << text;
    EXPECT_NEAR(size(degrees, {text})[1], 90 / 111412.0, 5e-8) << text;
  }
  EXPECT_EQ(size(degrees, {"0.002", "90m"})[0], 0.002);
  const std::vector<std::string> north = {"90m", "--window", "9", "59.999", "10", "60.001"};
  EXPECT_NEAR(size(degrees, north)[0], 90 / 55800.0, 2e-8);
  EXPECT_GT(size(degrees, north)[0], size(degrees, {"90m"})[0]);
  EXPECT_EQ(size(built(folder, "mountains_257.tif"), {"90m"}), (std::array<double, 2>{90, 90}));
}

TEST(ExportRaster, RefusesPixelsThatDoNotFit) {
  const TestFolder folder;
  const auto refuse = [&](const std::string& file, const std::vector<std::string>& more,
                          const std::string& words) {
    std::vector<std::string> arguments = {"export",      file, "-q", "-o", folder.file("a.tif"),
                                          "--pixel-size"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, 2) << words;
    EXPECT_NE(outcome.err.find("ptin: --pixel-size: " + words), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder.file("a.tif")));
  };
  const std::string degrees = terrain_in_degrees(folder);
  refuse(degrees, {"90"}, "1 x 1 pixels of 90 x 90 map units fit the window of 0.032 x 0.032");
  refuse(degrees, {"0.001", "0.04"}, "33 x 1 pixels");
  refuse(degrees, {"0.01", "--window", "9.003", "59.97", "9.004", "60"}, "0 x 3 pixels");
  for (const char* text : {"90x", "m", "-3m", "0km", "nan", "1e999", "90 90", "90m2"}) {
    refuse(degrees, {text}, std::string("\"") + text + "\" is no size");
  }
  refuse(built(folder, "ground_points.csv"), {"9m"}, "the unit of the terrain's map is unknown");
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
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  testing::write_file(file, bytes);
  for (const char* name : {"a.ply", "a.gpkg", "a.fgb", "a.tif"}) {
    const Outcome outcome = run_ptin({"export", file, "-q", "-o", folder.file(name)});
    EXPECT_EQ(outcome.status, 4) << name << outcome.err;
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"coast_257.tif.ptin"});
}

}  // namespace
}  // namespace ptin::tools
