// SPDX-License-Identifier: GPL-3.0-or-later
//
// Contours as vector tiles: neighbours meet, and every point lies on an isoline.
#include "tools/tiles/contour_tiles.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <protozero/pbf_reader.hpp>

#include "tests/tools/tiles_fixture.h"

namespace ptin::tools::testing {
namespace {

using GridLine = std::vector<std::pair<std::int64_t, std::int64_t>>;

/// Lines by their heights, in steps of the zoom's lattice.
using LinesOfHeights = std::map<double, std::vector<GridLine>>;

double read_value(protozero::pbf_reader value) {
  while (value.next()) {
    if (value.tag() == 3) return value.get_double();
    if (value.tag() == 6) return static_cast<double>(value.get_sint64());
    if (value.tag() == 7) return value.get_bool() ? 1.0 : 0.0;
    value.skip();
  }
  return std::nan("");
}

std::vector<GridLine> read_geometry(protozero::pbf_reader& feature, const WebTile& tile) {
  std::vector<GridLine> lines;
  std::int64_t x = tile.x * 4096, y = tile.y * 4096;
  const auto commands = feature.get_packed_uint32();
  for (auto at = commands.begin(); at != commands.end();) {
    const std::uint32_t id = *at & 7U, count = *at++ >> 3U;
    EXPECT_TRUE(id == 1 ? count == 1 : id == 2 && count > 0);
    if (id == 1) lines.emplace_back();
    for (std::uint32_t i = 0; i < count; ++i) {
      x += protozero::decode_zigzag32(*at++);
      y += protozero::decode_zigzag32(*at++);
      EXPECT_TRUE(lines.back().empty() || lines.back().back() != std::pair(x, y));
      lines.back().emplace_back(x, y);
    }
  }
  return lines;
}

LinesOfHeights read_vector_tile(const std::string& bytes, const WebTile& tile, double interval) {
  LinesOfHeights lines;
  protozero::pbf_reader file(bytes);
  while (file.next(3)) {
    protozero::pbf_reader layer = file.get_message();
    std::vector<std::string> keys;
    std::vector<double> values;
    std::vector<std::pair<std::vector<std::uint32_t>, std::vector<GridLine>>> features;
    while (layer.next()) {
      if (layer.tag() == 1) {
        EXPECT_EQ(layer.get_string(), "contours");
      } else if (layer.tag() == 2) {
        protozero::pbf_reader feature = layer.get_message();
        features.emplace_back();
        while (feature.next()) {
          if (feature.tag() == 2) {
            const auto tags = feature.get_packed_uint32();
            features.back().first.assign(tags.begin(), tags.end());
          } else if (feature.tag() == 4) {
            features.back().second = read_geometry(feature, tile);
          } else {
            EXPECT_EQ(feature.get_enum(), 2);
          }
        }
      } else if (layer.tag() == 3) {
        keys.push_back(layer.get_string());
      } else if (layer.tag() == 4) {
        values.push_back(read_value(layer.get_message()));
      } else {
        EXPECT_EQ(layer.get_uint32(), layer.tag() == 5 ? 4096U : 2U);
      }
    }
    for (auto& [tags, geometry] : features) {
      EXPECT_EQ(tags.size(), 4U);
      EXPECT_EQ(keys.at(tags[0]), "ele");
      EXPECT_EQ(keys.at(tags[2]), "index");
      const double ele = values.at(tags[1]);
      EXPECT_EQ(values.at(tags[3]), std::llround(ele / interval) % 5 == 0 ? 1.0 : 0.0);
      EXPECT_TRUE(lines.emplace(ele, std::move(geometry)).second);
    }
  }
  return lines;
}

struct Contoured {
  explicit Contoured(const std::string& path)
      : terrain(Terrain::open(path)), crs(crs_facts(terrain.store())), pyramid(terrain, crs) {}
  [[nodiscard]] LinesOfHeights lines(const WebTile& tile, double interval) const {
    const auto made = contour_tile(pyramid, tile, interval, limits_of());
    return made ? read_vector_tile(made->bytes, tile, interval) : LinesOfHeights();
  }
  [[nodiscard]] double interval() const {
    return std::max(0.01, (pyramid.globe().max_height() - pyramid.globe().min_height()) / 12);
  }
  Terrain terrain;
  CrsFacts crs;
  MercatorPyramid pyramid;
};

/// The points on a side of tiles, with the heights of their lines.
std::set<std::tuple<double, std::int64_t>> points_on(const LinesOfHeights& lines, bool along_y,
                                                     std::int64_t side, std::int64_t from) {
  std::set<std::tuple<double, std::int64_t>> points;
  for (const auto& [ele, all] : lines) {
    for (const GridLine& line : all) {
      for (const auto& [x, y] : line) {
        const std::int64_t across = along_y ? x : y, along = along_y ? y : x;
        if (across == side && from <= along && along <= from + 4096) points.insert({ele, along});
      }
    }
  }
  return points;
}

TEST(ContourTiles, OfNeighboursMeet) {
  const TestFolder folder;
  std::size_t shared = 0;
  for (const std::string& path :
       {built(folder, "mountains_257.tif"), built(folder, "coast_257.tif")}) {
    const Contoured web(path);
    const double interval = web.interval();
    for (int z = std::max(0, last_contour_zoom(web.pyramid) - 6);
         z <= last_contour_zoom(web.pyramid); ++z) {
      const TileRectangle r = web.pyramid.rectangles(z).front();
      const std::int64_t left = (r.min_x + r.max_x) / 2 - 1, top = (r.min_y + r.max_y) / 2 - 1;
      for (std::int64_t y = std::max(top, r.min_y); y <= std::min(r.max_y, top + 2); ++y) {
        for (std::int64_t x = std::max(left, r.min_x); x <= std::min(r.max_x, left + 2); ++x) {
          const LinesOfHeights here = web.lines({z, x, y}, interval);
          for (const bool along_y : {true, false}) {
            const WebTile next{z, x + (along_y ? 1 : 0), y + (along_y ? 0 : 1)};
            if (next.x > r.max_x || next.y > r.max_y) continue;
            const std::int64_t side = 4096 * (along_y ? next.x : next.y);
            const auto mine = points_on(here, along_y, side, 4096 * (along_y ? y : x));
            EXPECT_EQ(mine,
                      points_on(web.lines(next, interval), along_y, side, 4096 * (along_y ? y : x)))
                << path << " " << z << "/" << x << "/" << y;
            shared += mine.size();
          }
        }
      }
    }
  }
  EXPECT_GT(shared, 10U);
}

TEST(ContourTiles, LieOnIsolinesOfTheirLevel) {
  const TestFolder folder;
  for (const std::string& path :
       {built(folder, "mountains_257.tif"), built_in_feet(folder), built_wide(folder)}) {
    const Contoured web(path);
    const Transformed to_map("EPSG:3857", web.crs.wkt);
    const double metres = web.pyramid.globe().metres_per_height();
    const double interval = web.interval();
    std::size_t points = 0, beside = 0;
    const int last = last_contour_zoom(web.pyramid);
    for (const int z : {last, last - 3, last - 5}) {
      const TileRectangle r = web.pyramid.rectangles(z).front();
      const WebTile tile{z, (r.min_x + r.max_x) / 2, (r.min_y + r.max_y) / 2};
      const double girth = 2 * 6378137.0 * M_PI, step = girth / std::ldexp(4096.0, z);
      for (const auto& [ele, lines] : web.lines(tile, interval)) {
        for (const GridLine& line : lines) {
          // Around a point of a line, within a step, there is ground below its height and above it.
          std::vector<MapPoint> around;
          for (const auto& [x, y] : line) {
            for (int i = 0; i < 9; ++i) {
              const Ecef p = to_map({(static_cast<double>(x) + i % 3 - 1) * step - girth / 2,
                                     girth / 2 - (static_cast<double>(y) + i / 3 - 1) * step, 0.0});
              around.push_back({p[0], p[1]});
            }
          }
          LocateRequest request;
          request.detail = web.pyramid.level(std::min(z + 1, web.pyramid.finest_level())).detail;
          const LocateResult located = web.terrain.locate(around, request);
          for (std::size_t i = 0; i < line.size(); ++i) {
            double low = HUGE_VAL, high = -HUGE_VAL;
            bool is_within = true;
            for (std::size_t k = 9 * i; k < 9 * i + 9; ++k) {
              is_within = is_within && located.points[k].state == PointState::kSurface;
              low = std::min(low, located.points[k].height * metres);
              high = std::max(high, located.points[k].height * metres);
            }
            if (!is_within) continue;  // On the border there is ground on one side alone.
            ++points;
            if (!(low <= ele + 1e-9 && ele - 1e-9 <= high)) ++beside;
          }
        }
      }
    }
    EXPECT_GT(points, 100U) << path;
    EXPECT_LE(beside, points / 100) << path;
  }
}

TEST(ContourTiles, HaveAnIntervalThatSuitsTheZoomAndTheRelief) {
  EXPECT_EQ(contour_interval(9, 4000), 200);
  EXPECT_EQ(contour_interval(9, 212), 50) << "five levels, not one";
  EXPECT_EQ(contour_interval(9, 800), 200);
  EXPECT_EQ(contour_interval(9, 799), 100);
  EXPECT_EQ(contour_interval(15, 212), 20) << "that of the zoom";
  EXPECT_EQ(contour_interval(6, 8), 2);
  EXPECT_NEAR(contour_interval(14, 0.5), 0.1, 1e-12);
  EXPECT_NEAR(contour_interval(14, 0), 0.01, 1e-12);
}

TEST(ContourTiles, RefuseAnIntervalOfTooManyLevels) {
  const TestFolder folder;
  const Contoured web(built(folder, "mountains_257.tif"));
  EXPECT_EQ(code_of([&] {
              static_cast<void>(web.lines({0, 0, 0}, 1e-4));
            }),
            ErrorCode::invalid_argument);
  EXPECT_FALSE(contour_tile(web.pyramid, {29, 0, 0}, {}, limits_of()).has_value());
}

}  // namespace
}  // namespace ptin::tools::testing
