// SPDX-License-Identifier: GPL-3.0-or-later
//
// The heights of a raster in a store: tiles in, tiles out, damage, and where each tile lies.
#include "storage/floor.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "tests/storage/store_fixture.h"
#include "tests/support/test_folder.h"

namespace ptin {
namespace {

using test::StoreContent;

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

FloorTile tile_of(const Raster& raster, const FloorShape& shape, std::uint32_t column,
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
std::vector<Place> in_order(const FloorShape& shape) {
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

class FloorStore : public ::testing::Test {
 protected:
  std::string written(const Raster& raster, std::uint32_t side_log2 = 5) {
    const std::string path = folder_.file("floor.ptin");
    const StoreContent content =
        test::flat_rectangle(static_cast<std::int32_t>(raster.width) - 1,
                             static_cast<std::int32_t>(raster.height) - 1, HeightType::int32);
    FloorFacts facts;
    facts.shape = {side_log2, raster.width, raster.height};
    facts.source = SourceNumber::kInt16;
    facts.nodata = -9999;
    facts.is_exact = true;
    StoreWriterOptions options;
    options.overwrite = true;
    const auto writer = StoreWriter::create(path, options);
    writer->add_floor(facts, [&](FloorWriter& floor) {
      for (const auto& [column, row] : in_order(facts.shape)) {
        EXPECT_TRUE(
            floor.add(FloorShape::key(column, row), tile_of(raster, facts.shape, column, row)));
      }
      return true;
    });
    writer->publish(content.facts, content.t0, content.metadata);
    return path;
  }
  test::TestFolder folder_;
};

void expect_all_tiles(const StoreFile& store, const Raster& raster) {
  const Floor& floor = *store.floor();
  const FloorShape& shape = floor.facts().shape;
  Floor::Page page;
  FloorTile tile;
  IoCounters counters;
  for (const auto& [column, row] : in_order(shape)) {
    floor.read(column, row, page, tile, counters);
    const FloorTile expected = tile_of(raster, shape, column, row);
    ASSERT_EQ(tile.samples(), expected.samples());
    for (std::size_t i = 0; i < tile.samples(); ++i) {
      const bool is_void = !tile.is_void.empty() && tile.is_void[i] != 0;
      ASSERT_EQ(is_void, expected.is_void[i] != 0);
      if (!is_void) {
        ASSERT_EQ(tile.heights[i], expected.heights[i]);
      }
    }
  }
  EXPECT_EQ(counters.pages, floor.pages()) << "along the curve each page is read once";
}

TEST_F(FloorStore, TilesComeBack) {
  for (const Raster& raster : {Raster{700, 900}, {1, 1}, {2, 2}, {33, 33}, {34, 33}, {1, 200}}) {
    for (const std::uint32_t side_log2 : {4U, 5U, 6U}) {
      const std::string path = written(raster, side_log2);
      for (const PageAccess access : {PageAccess::kMapped, PageAccess::kPread}) {
        const auto store = StoreFile::open(path, access);
        ASSERT_NE(store->floor(), nullptr);
        EXPECT_EQ(store->floor()->facts().nodata, -9999);
        EXPECT_TRUE(store->floor()->facts().is_exact);
        expect_all_tiles(*store, raster);
      }
    }
  }
}

TEST_F(FloorStore, ManyPagesHaveNodesAboveNodes) {
  const Raster raster{1001, 1001};
  const auto store = StoreFile::open(written(raster, 4));
  EXPECT_GT(store->floor()->pages(), 168U);
  expect_all_tiles(*store, raster);
}

TEST_F(FloorStore, ATileIsOnePageAndANode) {
  const auto store = StoreFile::open(written({700, 900}));
  Floor::Page page;
  FloorTile tile;
  IoCounters counters;
  store->floor()->read(3, 4, page, tile, counters);
  EXPECT_EQ(counters.pages, 1U);
  EXPECT_EQ(counters.index_nodes, 1U);
  store->floor()->read(3, 4, page, tile, counters);
  EXPECT_EQ(counters.pages, 1U);
}

TEST_F(FloorStore, AWindowReadsItsPagesAndNodesOnce) {
  const Raster raster{1500, 1500};
  const auto store = StoreFile::open(written(raster, 4));
  const Floor& floor = *store->floor();
  ASSERT_GT(floor.facts().shape.tiles(), 8192U) << "that are looked for together";
  const Floor::Tiles windows[] = {{0, 0, 93, 93}, {60, 60, 67, 70}, {5, 90, 5, 90}};
  for (const Floor::Tiles& w : windows) {
    std::set<Place> places;
    std::uint64_t last = 0;
    IoCounters counters;
    floor.visit(
        w, [](const Floor::TileBounds&) { return true; },
        [&](const Floor::TileBounds& at, const FloorTile& tile) {
          const std::uint64_t key = FloorShape::key(at.column, at.row);
          EXPECT_TRUE(places.empty() || key > last) << "along the curve";
          last = key;
          EXPECT_EQ(tile.heights.front(), raster.is_void(at.column * 16, at.row * 16)
                                              ? tile.heights.front()
                                              : raster.at(at.column * 16, at.row * 16));
          return places.emplace(at.column, at.row).second;
        },
        counters);
    EXPECT_EQ(places.size(),
              std::size_t{w.last_column - w.first_column + 1} * (w.last_row - w.first_row + 1));
    EXPECT_LE(counters.pages, floor.pages());
    EXPECT_LE(counters.index_nodes, 1 + floor.pages() / layout::kFloorFanOut + 1);
  }
}

TEST_F(FloorStore, SameTilesAreSameBytes) {
  const Raster raster{300, 200};
  const auto first = test::read_file(written(raster));
  EXPECT_EQ(test::read_file(written(raster)), first);
}

TEST_F(FloorStore, EveryDamagedByteIsFound) {
  const Raster raster{200, 200};
  const std::string path = written(raster);
  const test::Bytes whole = test::read_file(path);
  std::uint64_t begin = 0;
  for (const SectionInfo& section : StoreFile::open(path)->sections()) {
    if (section.name == "height root") begin = section.offset;
  }
  ASSERT_GT(begin, 0U);
  for (std::size_t at = begin; at < whole.size(); at += 97) {
    test::Bytes damaged = whole;
    damaged[at] ^= std::byte{1};
    test::write_file(path, damaged);
    const auto store = StoreFile::open(path);
    EXPECT_THROW(
        {
          Floor::Page page;
          FloorTile tile;
          IoCounters counters;
          const FloorShape shape = store->floor()->facts().shape;
          for (const auto& [column, row] : in_order(shape)) {
            store->floor()->read(column, row, page, tile, counters);
          }
        },
        Error)
        << at;
  }
}

TEST_F(FloorStore, AFileWithoutHeightsHasNone) {
  const std::string path = folder_.file("none.ptin");
  test::write_store(path, test::flat_square(1 << 20));
  EXPECT_EQ(StoreFile::open(path)->floor(), nullptr);
}

}  // namespace
}  // namespace ptin
