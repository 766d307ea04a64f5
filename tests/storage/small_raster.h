// SPDX-License-Identifier: GPL-3.0-or-later
//
// The worked example of FORMAT.md, "Heights of a raster": four samples, of which one is void.
#pragma once

#include <algorithm>
#include <map>
#include <string>

#include "tests/storage/store_fixture.h"

namespace ptin::test {

inline StoreContent small_raster() {
  StoreContent c;
  c.facts.map = {1000.0, 2000.0, 10.0, 10.0};
  c.facts.heights = {HeightType::int32, 0.5, 100.0};
  c.facts.bounds = {0, 0, 1, 1};
  c.facts.min_height = 100.0;
  c.facts.max_height = 103.0;
  c.facts.source_samples = 3;
  c.metadata = "{}";
  c.t0.vertices = {{{0, 0}, 0, 1}, {{1, 0}, 2, 1}, {{1, 1}, 0, 0}, {{0, 1}, 6, 1}};
  c.t0.triangles = {{{0, 1, 3}, 0}, {{1, 2, 3}, 1}};
  return c;
}

inline void write_small_raster(const std::string& path) {
  const StoreContent c = small_raster();
  FloorFacts facts;
  facts.shape = {5, 2, 2};
  facts.source = SourceNumber::kInt16;
  facts.nodata = -9999.0;
  facts.is_exact = true;
  FloorTile tile;
  tile.width = tile.height = 2;
  tile.heights = {0x80000000U, 0x80000002U, 0x80000006U, 0};
  tile.is_void = {0, 0, 0, 1};
  const auto writer = StoreWriter::create(path, {.overwrite = true});
  writer->add_floor(facts, [&](FloorWriter& to) { return to.add(0, tile); });
  writer->publish(c.facts, c.t0, c.metadata);
}

/// Some pages of rough ground of 90 x 70 samples with voids of all kinds and lone samples.
inline void write_rough_raster(const std::string& path, bool is_float) {
  const HeightType type = is_float ? HeightType::float32 : HeightType::int32;
  const StoreContent c = flat_rectangle(89, 69, type);
  FloorFacts facts;
  facts.shape = {4, 90, 70};
  std::map<std::uint64_t, FloorTile> tiles;
  for (std::uint32_t row = 0; row < facts.shape.rows(); ++row) {
    for (std::uint32_t column = 0; column < facts.shape.columns(); ++column) {
      FloorTile& tile = tiles[FloorShape::key(column, row)];
      tile.width = facts.shape.samples_of(column, 90);
      tile.height = facts.shape.samples_of(row, 70);
      for (std::size_t i = 0; i < tile.samples(); ++i) {
        const std::uint32_t x = 16 * column + static_cast<std::uint32_t>(i % tile.width);
        const std::uint32_t y = 16 * row + static_cast<std::uint32_t>(i / tile.width);
        const double height = 300.0 + (x * 37 + y * 101) % 61 + x * y * 0.1;
        tile.heights.push_back(ordered_height(c.facts.heights.bits(height), type));
        const bool is_void = x / 32 == 1 ? y < 40 : (x * 31 + y * 17) % 13 == 0 && y > 30;
        tile.is_void.push_back(is_void ? 1 : 0);
        if (is_void && (x + y) % 7 == 0) {
          tile.lone.push_back({static_cast<std::uint16_t>(i), tile.heights.back()});
        }
      }
    }
  }
  const auto writer = StoreWriter::create(path, {.overwrite = true});
  writer->add_floor(facts, [&](FloorWriter& to) {
    return std::ranges::all_of(tiles, [&](const auto& t) { return to.add(t.first, t.second); });
  });
  writer->publish(c.facts, c.t0, c.metadata);
}

}  // namespace ptin::test
