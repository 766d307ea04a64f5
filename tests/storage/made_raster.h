// SPDX-License-Identifier: GPL-3.0-or-later
//
// A raster of any size with voids, whose heights a store has.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "storage/floor.h"
#include "storage/store_writer.h"
#include "tests/storage/store_fixture.h"

namespace ptin::test {

/// A raster whose heights are those of an int32 code, some void.
struct Raster {
  std::uint32_t width, height;
  [[nodiscard]] OrderedHeight at(std::uint32_t x, std::uint32_t y) const {
    const double h = 3000 + 500 * std::sin(x * 0.05) * std::cos(y * 0.03) + (x * 7 + y * 13) % 9;
    return static_cast<OrderedHeight>(h) ^ 0x80000000U;
  }
  [[nodiscard]] bool is_void(std::uint32_t x, std::uint32_t y) const {
    return (x / 40 + y / 40) % 5 == 3 || (x * 31 + y * 17) % 211 == 0;
  }
};

inline FloorTile tile_of(const Raster& raster, const FloorShape& shape, std::uint32_t column,
                         std::uint32_t row) {
  FloorTile tile;
  tile.width = shape.samples_of(column, shape.width);
  tile.height = shape.samples_of(row, shape.height);
  for (std::uint32_t y = 0; y < tile.height; ++y) {
    for (std::uint32_t x = 0; x < tile.width; ++x) {
      const std::uint32_t at_x = shape.first_of(column) + x, at_y = shape.first_of(row) + y;
      tile.heights.push_back(raster.at(at_x, at_y));
      tile.is_void.push_back(raster.is_void(at_x, at_y) ? 1 : 0);
    }
  }
  return tile;
}

using Place = std::pair<std::uint32_t, std::uint32_t>;

/// Columns and rows of all tiles, along the curve.
inline std::vector<Place> in_order(const FloorShape& shape) {
  std::vector<Place> places;
  for (std::uint32_t row = 0; row < shape.rows(); ++row) {
    for (std::uint32_t column = 0; column < shape.columns(); ++column) {
      places.emplace_back(column, row);
    }
  }
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return FloorShape::key(a.first, a.second) < FloorShape::key(b.first, b.second);
  });
  return places;
}

/// Two triangles, and all tiles of the raster.
inline StoreContent content_of(const Raster& raster, std::uint32_t side_log2) {
  StoreContent content =
      flat_rectangle(static_cast<std::int32_t>(raster.width) - 1,
                     static_cast<std::int32_t>(raster.height) - 1, HeightType::int32);
  FloorFacts facts;
  facts.shape = {side_log2, raster.width, raster.height};
  facts.source = SourceNumber::kInt16;
  facts.nodata = -9999;
  facts.is_exact = true;
  content.add_floor = [raster, facts](StoreWriter& writer) {
    writer.add_floor(facts, [&](FloorWriter& floor) {
      for (const auto& [column, row] : in_order(facts.shape)) {
        EXPECT_TRUE(
            floor.add(FloorShape::key(column, row), tile_of(raster, facts.shape, column, row)));
      }
      return true;
    });
  };
  return content;
}

/// Writes a store of them.
inline void write_raster(const std::string& path, const Raster& raster, std::uint32_t side_log2) {
  StoreWriterOptions options;
  options.overwrite = true;
  write_store(path, content_of(raster, side_log2), options);
}

}  // namespace ptin::test
