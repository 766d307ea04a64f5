// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights as colours of tiles: decoded by GDAL, placed by GDAL, and held to what locate() gives.
#include "tools/tiles/height_tiles.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/error.h"
#include "tests/tools/program.h"
#include "tests/tools/tiles_fixture.h"
#include "tools/tiles/pmtiles.h"

namespace ptin::tools::testing {
namespace {

namespace fs = std::filesystem;

/// A picture by GDAL: opacity 255 where it has none.
struct Picture {
  explicit Picture(const std::string& bytes) {
    GDALAllRegister();
    const char* const name = "/vsimem/height_tile";
    auto* const data = reinterpret_cast<GByte*>(const_cast<char*>(bytes.data()));
    VSIFCloseL(VSIFileFromMemBuffer(name, data, bytes.size(), FALSE));
    const std::unique_ptr<GDALDataset> set(GDALDataset::Open(name));
    if (set == nullptr) throw std::runtime_error("GDAL cannot read the picture");
    side = set->GetRasterXSize();
    bands = set->GetRasterCount();
    pixels.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 4, 255);
    EXPECT_EQ(set->RasterIO(GF_Read, 0, 0, side, side, pixels.data(), side, side, GDT_Byte, bands,
                            nullptr, 4, 4 * side, 1, nullptr),
              CE_None);
    VSIUnlink(name);
  }
  [[nodiscard]] const std::uint8_t* at(int column, int row) const {
    return pixels.data() + 4 * static_cast<std::size_t>(row * side + column);
  }
  /// Metres, by the encodings' own words.
  [[nodiscard]] double height(int column, int row, HeightCode code) const {
    const std::uint8_t* const p = at(column, row);
    if (code == HeightCode::kMapbox) return -10000 + (p[0] * 65536 + p[1] * 256 + p[2]) * 0.1;
    return p[0] * 256.0 + p[1] + p[2] / 256.0 - 32768;
  }
  int side = 0, bands = 0;
  std::vector<std::uint8_t> pixels;
};

struct Webbed {
  explicit Webbed(const std::string& path)
      : terrain(Terrain::open(path)), crs(crs_facts(terrain.store())), pyramid(terrain, crs) {}
  [[nodiscard]] Picture picture(const HeightTileStyle& style, const WebTile& tile) const {
    return Picture(height_tile(pyramid, style, tile, limits_of())->bytes);
  }
  /// The tile of a zoom around the middle of the terrain.
  [[nodiscard]] WebTile middle(int z) const {
    const TileRectangle r = pyramid.rectangles(z).front();
    return {z, (r.min_x + r.max_x) / 2, (r.min_y + r.max_y) / 2};
  }
  Terrain terrain;
  CrsFacts crs;
  MercatorPyramid pyramid;
};

constexpr double kGirth = 2 * 6378137.0 * M_PI;

TEST(HeightTiles, HaveTheHeightsThatLocateGivesAtTheirPixels) {
  const TestFolder folder;
  for (const std::string& path : {built(folder, "mountains_257.tif"), built_with_holes(folder),
                                  built_in_feet(folder), built_across_180(folder)}) {
    const Webbed web(path);
    const Transformed to_map("EPSG:3857", web.crs.wkt);
    const double metres = web.pyramid.globe().metres_per_height();
    std::size_t surface = 0, beside = 0;
    for (const HeightCode code : {HeightCode::kMapbox, HeightCode::kTerrarium}) {
      HeightTileStyle style;
      style.code = code;
      const int last = last_zoom(web.pyramid, style);
      for (const int z : {last, last - 2}) {
        const WebTile tile = web.middle(z);
        const Picture picture = web.picture(style, tile);
        const double pixel = kGirth / std::ldexp(256.0, z);
        std::vector<MapPoint> points;
        for (int i = 0; i < 256 * 256; ++i) {
          const double x = (static_cast<double>(tile.x * 256 + i % 256) + 0.5) * pixel - kGirth / 2;
          const double y = kGirth / 2 - (static_cast<double>(tile.y * 256 + i / 256) + 0.5) * pixel;
          const Ecef p = to_map({x, y, 0.0});
          points.push_back({p[0], p[1]});
        }
        LocateRequest request;
        request.detail = web.pyramid.level(z).detail;
        const LocateResult located = web.terrain.locate(points, request);
        for (int i = 0; i < 256 * 256; ++i) {
          const LocatedPoint& p = located.points[static_cast<std::size_t>(i)];
          const bool is_surface = picture.at(i % 256, i / 256)[3] == 255;
          if (is_surface != (p.state == PointState::kSurface)) {
            ++beside;
          } else if (is_surface) {
            ++surface;
            // GDAL and PROJ differ by fractions of a millimetre in the plane.
            ASSERT_NEAR(picture.height(i % 256, i / 256, code), p.height * metres,
                        step_of(code) / 2 + 1e-3);
          }
        }
      }
    }
    EXPECT_GT(surface, 1000U) << path;
    EXPECT_LE(beside, 4U) << path;
  }
}

TEST(HeightTiles, DependOnThePixelAlone) {
  const TestFolder folder;
  const Webbed web(built_with_holes(folder));
  HeightTileStyle large;
  large.side = 512;
  for (int z = 0; z <= last_zoom(web.pyramid, large); z += 2) {
    const WebTile tile = web.middle(z);
    const Picture whole = web.picture(large, tile);
    ASSERT_EQ(whole.side, 512);
    for (int quarter = 0; quarter < 4; ++quarter) {
      const int i = quarter % 2, j = quarter / 2;
      const auto bytes =
          height_tile(web.pyramid, {}, {z + 1, 2 * tile.x + i, 2 * tile.y + j}, limits_of());
      if (!bytes) continue;
      const Picture part(bytes->bytes);
      for (int row = 0; row < 256; ++row) {
        ASSERT_EQ(std::vector(part.at(0, row), part.at(0, row) + 4 * 256),
                  std::vector(whole.at(256 * i, 256 * j + row),
                              whole.at(256 * i, 256 * j + row) + 4 * 256));
      }
    }
  }
}

TEST(HeightTiles, AreTheSameAsWebp) {
  const TestFolder folder;
  const Webbed web(built_with_holes(folder));
  HeightTileStyle webp;
  webp.format = TileFormat::kWebp;
  const WebTile tile = web.middle(last_zoom(web.pyramid, webp));
  EXPECT_EQ(web.picture(webp, tile).pixels, web.picture({}, tile).pixels);
}

TEST(HeightTiles, FillVoidsWithTheColourOfZero) {
  const TestFolder folder;
  const Webbed web(built_with_holes(folder));
  HeightTileStyle filled;
  filled.fills_voids = true;
  const WebTile tile = web.middle(last_zoom(web.pyramid, filled) - 1);
  const Picture open = web.picture({}, tile), full = web.picture(filled, tile);
  EXPECT_EQ(open.bands, 4);
  EXPECT_EQ(full.bands, 3);
  std::size_t voids = 0;
  for (int i = 0; i < 256 * 256; ++i) {
    if (open.at(i % 256, i / 256)[3] != 0) continue;
    ++voids;
    EXPECT_EQ(full.height(i % 256, i / 256, HeightCode::kMapbox), 0.0);
    EXPECT_EQ(open.height(i % 256, i / 256, HeightCode::kMapbox), 0.0);
  }
  EXPECT_GT(voids, 0U);
}

TEST(HeightTiles, RefuseWhatAnEncodingDoesNotHold) {
  const TestFolder folder;
  RasterRecipe recipe;
  recipe.value = [](int column, int row) { return 40000.0 + hills(column, row); };
  make_raster(folder.file("high.tif"), recipe);
  build_terrain(folder.file("high.tif"), folder.file("high.ptin"));
  const Webbed web(folder.file("high.ptin"));
  EXPECT_EQ(code_of([&] { check_heights(web.pyramid, HeightCode::kTerrarium); }),
            ErrorCode::invalid_argument);
  check_heights(web.pyramid, HeightCode::kMapbox);
}

/// What the reader of PMTiles says of a file whose tiles it puts into a folder.
std::string read_pmtiles(const std::string& path, const std::string& folder, int some = 1) {
  fs::create_directories(folder);
  const std::string told = folder + "/told";
  const std::string reader = std::string(PTIN_TEST_DATA) + "/../tools/pmtiles_reader.py";
  const std::string command = "python3 '" + reader + "' '" + path + "' '" + folder + "' " +
                              std::to_string(some) + " > '" + told + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  return read_file(told);
}

TEST(Pmtiles, HoldTheTilesOfTheService) {
  const TestFolder folder;
  const std::string store = built(folder, "coast_257.tif");
  const std::string path = folder.file("coast.pmtiles");
  ASSERT_EQ(
      run_ptin({"tiles", store, "-o", path, "--encoding", "terrarium", "--threads", "2"}).status,
      0);
  static_cast<void>(read_pmtiles(path, folder.file("tiles")));
  const Webbed web(store);
  HeightTileStyle style;
  style.code = HeightCode::kTerrarium;
  std::size_t tiles = 0;
  for (int z = 0; z <= last_zoom(web.pyramid, style); ++z) {
    for (const TileRectangle& r : web.pyramid.rectangles(z)) {
      for (std::int64_t y = r.min_y; y <= r.max_y; ++y) {
        for (std::int64_t x = r.min_x; x <= r.max_x; ++x, ++tiles) {
          const std::string name =
              std::to_string(z) + "-" + std::to_string(x) + "-" + std::to_string(y);
          EXPECT_EQ(read_file(folder.file("tiles/" + name)),
                    height_tile(web.pyramid, style, {z, x, y}, limits_of())->bytes);
        }
      }
    }
  }
  // Beside the tiles: metadata, and what the reader told.
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.file("tiles")), {}),
            static_cast<std::ptrdiff_t>(tiles) + 2);
  const auto metadata = nlohmann::json::parse(read_file(folder.file("tiles/metadata.json")));
  EXPECT_EQ(metadata.at("encoding"), "terrarium");
  EXPECT_NE(run_ptin({"tiles", store, "-o", folder.file("coast.mbtiles")}).status, 0);
}

TEST(Pmtiles, TellOfATerrainAcrossTheAntimeridianThatItGoesAround) {
  const TestFolder folder;
  RasterRecipe recipe;
  recipe.value = hills;
  recipe.epsg = 4326;
  recipe.pixel = 1.0 / 16;
  recipe.west = 179 - 1.0 / 32;
  recipe.north = 10.5;
  make_raster(folder.file("a.tif"), recipe);
  build_terrain(folder.file("a.tif"), folder.file("a.ptin"));
  const Webbed web(folder.file("a.ptin"));
  const nlohmann::json facts = height_facts(web.pyramid, {});
  EXPECT_EQ(facts.at("bounds")[0], -180.0);
  EXPECT_EQ(facts.at("bounds")[2], 180.0);
  EXPECT_NEAR(facts.at("center")[0].get<double>(), 180.0, 1e-6);
  EXPECT_LE(facts.at("center")[2], facts.at("maxzoom"));
  ASSERT_EQ(run_ptin({"tiles", folder.file("a.ptin"), "-o", folder.file("a.pmtiles")}).status, 0);
  const std::string file = read_file(folder.file("a.pmtiles"));
  const auto number_at = [&](std::size_t at) {
    std::int32_t number = 0;
    std::memcpy(&number, file.data() + at, sizeof number);
    return number;
  };
  // The header has west, east and the longitude of the middle.
  EXPECT_EQ(number_at(102), -1800000000);
  EXPECT_EQ(number_at(110), 1800000000);
  EXPECT_NEAR(number_at(119), 1800000000, 10);
}

TEST(Pmtiles, DivideTheDirectoryAndKeepEqualTilesOnce) {
  const TestFolder folder;
  const std::string path = folder.file("many.pmtiles");
  std::vector<WebTile> all;
  for (std::int64_t y = 0; y < 128; ++y) {
    for (std::int64_t x = 0; x < 128; ++x) all.push_back({7, x, y});
  }
  std::sort(all.begin(), all.end(),
            [](const WebTile& a, const WebTile& b) { return pmtiles_id(a) < pmtiles_id(b); });
  // Lengths that do not pack well; a sixteenth of the tiles are one, in runs.
  std::mt19937_64 random(5);
  std::map<std::uint64_t, std::string> contents;
  for (const WebTile& t : all) {
    const std::uint64_t id = pmtiles_id(t);
    contents[id] =
        t.x < 32 && t.y < 32 ? "sea" : std::to_string(id) + std::string(random() % 997, '.');
  }
  PmtilesWriter writer(path, false);
  for (const WebTile& t : all) writer.add(t, contents.at(pmtiles_id(t)));
  const PmtilesCounts counts = writer.publish({PmtilesType::kPng, 7, 7, {-180, -85, 180, 85}}, {});
  EXPECT_EQ(counts.tiles, all.size());
  EXPECT_EQ(counts.contents, all.size() - 32 * 32 + 1);
  EXPECT_GT(counts.leaves, 1U);
  constexpr int kSome = 97;
  EXPECT_EQ(read_pmtiles(path, folder.file("tiles"), kSome),
            std::to_string(counts.tiles) + " " + std::to_string(counts.entries) + " " +
                std::to_string(counts.contents) + " " + std::to_string(counts.leaves) + "\n");
  std::size_t looked_at = 0;
  for (const WebTile& t : all) {
    const std::uint64_t id = pmtiles_id(t);
    if (id % kSome != 0) continue;
    ++looked_at;
    EXPECT_EQ(read_file(folder.file("tiles/7-" + std::to_string(t.x) + "-" + std::to_string(t.y))),
              contents.at(id));
  }
  EXPECT_GT(looked_at, 100U);
}

}  // namespace
}  // namespace ptin::tools::testing
