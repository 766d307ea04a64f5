// SPDX-License-Identifier: GPL-3.0-or-later
//
// The heights of a raster in a store: tiles in, tiles out, damage, and where each tile lies.
#include "storage/floor.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "tests/storage/failing_files.h"
#include "tests/storage/made_raster.h"
#include "tests/storage/store_fixture.h"
#include "tests/support/test_folder.h"

namespace ptin {
namespace {

using test::content_of;
using test::in_order;
using test::Place;
using test::Raster;
using test::tile_of;

class FloorStore : public ::testing::Test {
 protected:
  std::string written(const Raster& raster, std::uint32_t side_log2 = 5) {
    const std::string path = folder_.file("floor.ptin");
    test::write_raster(path, raster, side_log2);
    return path;
  }
  test::TestFolder folder_;
};

void expect_all_tiles(const StoreFile& store, const Raster& raster) {
  const Floor& floor = *store.floor();
  const FloorShape& shape = floor.facts().shape;
  Floor::Recent recent;
  FloorTile tile;
  IoCounters counters;
  for (const auto& [column, row] : in_order(shape)) {
    floor.read(column, row, recent, tile, counters);
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

/// Samples of a window: whether one has a height, and how high that is.
struct Truth {
  bool has_height = false;
  double lowest = 0, highest = 0;  ///< Codes.
};
Truth truth_of(const Raster& raster, const GridBox& box) {
  Truth truth;
  for (std::int32_t y = box.min_y; y <= box.max_y; ++y) {
    for (std::int32_t x = box.min_x; x <= box.max_x; ++x) {
      const auto at_x = static_cast<std::uint32_t>(x), at_y = static_cast<std::uint32_t>(y);
      if (raster.is_void(at_x, at_y)) continue;
      const double code = static_cast<std::int32_t>(raster.at(at_x, at_y) ^ 0x80000000U);
      truth.lowest = truth.has_height ? std::min(truth.lowest, code) : code;
      truth.highest = truth.has_height ? std::max(truth.highest, code) : code;
      truth.has_height = true;
    }
  }
  return truth;
}

GridBox random_box(std::mt19937& random, std::uint32_t width, std::uint32_t height) {
  const auto two = [&](std::uint32_t all) {
    const auto a = static_cast<std::int32_t>(random() % all);
    const auto b = static_cast<std::int32_t>(random() % all);
    return std::pair{std::min(a, b), std::max(a, b)};
  };
  const auto [min_x, max_x] = two(width);
  const auto [min_y, max_y] = two(height);
  return {min_x, min_y, max_x, max_y};
}

TEST_F(FloorStore, AVisitTakesTheTilesOfAWindowAndOfNoOtherPages) {
  std::mt19937 random(20261128);
  for (const Raster& raster : {Raster{700, 900}, {34, 33}, {1, 200}, {1300, 70}}) {
    const auto store = StoreFile::open(written(raster, 4));
    const Floor& floor = *store->floor();
    for (int turn = 0; turn < 30; ++turn) {
      const GridBox box = random_box(random, raster.width, raster.height);
      std::set<Place> expected, seen;
      for (const Place& at : in_order(floor.facts().shape)) {
        if (meets(floor.facts().shape.samples_of({at.first, at.second, at.first, at.second}),
                  box)) {
          expected.insert(at);
        }
      }
      std::set<std::uint64_t> pages;
      for (const Place& at : expected) {
        Floor::Recent recent;
        FloorTile tile;
        IoCounters counters;
        floor.read(at.first, at.second, recent, tile, counters);
        pages.insert(recent.page());
      }
      IoCounters counters;
      Floor::Recent recent;
      floor.visit([&](const Floor::Bounds& b) { return meets(b.box, box); },
                  [&](const Floor::TileAt& at, const FloorTile&) {
                    EXPECT_TRUE(seen.emplace(at.column, at.row).second) << "a tile came twice";
                    return true;
                  },
                  recent, counters);
      ASSERT_EQ(seen, expected);
      ASSERT_EQ(counters.pages, pages.size());
    }
  }
}

TEST_F(FloorStore, BoundsHoldWhatLiesWithin) {
  const Raster raster{700, 900};
  const auto store = StoreFile::open(written(raster, 4));
  IoCounters counters;
  Floor::Recent recent;
  store->floor()->visit(
      [&](const Floor::Bounds& b) {
        const Truth truth = truth_of(raster, b.box);
        EXPECT_FALSE(truth.has_height && is_empty(b.codes));
        EXPECT_TRUE(!truth.has_height ||
                    (b.codes.lo <= truth.lowest && truth.highest <= b.codes.hi));
        return true;
      },
      [](const Floor::TileAt&, const FloorTile&) { return true; }, recent, counters);
}

/// Looks for the highest sample of a window.
class HighestSample final : public Floor::BestVisitor {
 public:
  HighestSample(const Raster& raster, const GridBox& box, bool wants_all)
      : raster_(raster), box_(box), wants_all_(wants_all) {}
  [[nodiscard]] Merit bound(const Floor::Bounds& b) const override {
    return meets(b.box, box_) ? Merit{b.codes.hi} : kNoMerit;
  }
  [[nodiscard]] bool wants_all() const override { return wants_all_; }
  Merit visit(const Floor::TileAt& at, const FloorTile&, Merit left) override {
    EXPECT_LE(at.bounds.codes.hi, left.value);
    EXPECT_LE(left.value, left_);
    left_ = left.value;
    const GridBox& b = at.bounds.box;
    const Truth truth =
        truth_of(raster_, {std::max(b.min_x, box_.min_x), std::max(b.min_y, box_.min_y),
                           std::min(b.max_x, box_.max_x), std::min(b.max_y, box_.max_y)});
    if (truth.has_height) {
      found = found.has_height ? Truth{true, 0, std::max(found.highest, truth.highest)} : truth;
    }
    return {found.has_height ? found.highest : -kInfinity};
  }
  Truth found;

 private:
  const Raster& raster_;
  GridBox box_;
  bool wants_all_;
  double left_ = kInfinity;
};

TEST_F(FloorStore, ABestFirstSearchFindsTheHighestSampleInFewPages) {
  const Raster raster{1001, 1001};
  const auto store = StoreFile::open(written(raster, 4));
  std::mt19937 random(20261128);
  for (int turn = 0; turn < 60; ++turn) {
    const GridBox box = random_box(random, raster.width, raster.height);
    HighestSample search(raster, box, turn % 2 == 0);
    IoCounters counters;
    Floor::Recent recent;
    store->floor()->visit_best_first(search, {-kInfinity}, recent, counters);
    const Truth truth = truth_of(raster, box);
    ASSERT_EQ(search.found.has_height, truth.has_height);
    if (truth.has_height) {
      ASSERT_EQ(search.found.highest, truth.highest);
    }
    EXPECT_LE(counters.pages, store->floor()->pages() / 4) << "most pages are too low";
  }
}

TEST_F(FloorStore, ATileIsOnePage) {
  const auto store = StoreFile::open(written({700, 900}));
  Floor::Recent recent;
  FloorTile tile;
  IoCounters counters;
  store->floor()->read(3, 4, recent, tile, counters);
  EXPECT_EQ(counters.pages, 1U);
  EXPECT_EQ(counters.index_nodes, 0U) << "the root is in memory";
  store->floor()->read(3, 4, recent, tile, counters);
  EXPECT_EQ(counters.pages, 1U);
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
          Floor::Recent recent;
          FloorTile tile;
          IoCounters counters;
          const FloorShape shape = store->floor()->facts().shape;
          for (const auto& [column, row] : in_order(shape)) {
            store->floor()->read(column, row, recent, tile, counters);
          }
        },
        Error)
        << at;
  }
}

TEST(FloorStoreFaults, LeaveTheOldFileOrTheNewOneAndNothingElse) {
  test::expect_old_or_new(content_of({400, 300}, 4));
}

TEST_F(FloorStore, AFullDiskIsResourceExhaustedAndLeavesNothing) {
  const test::SmallDisk disk(folder_.file("disk"), 2);
  if (!disk.is_mounted()) {
    GTEST_SKIP() << test::SmallDisk::kNeeded;
  }
  EXPECT_EQ(test::code_of([&] {
              test::write_store(disk.path() + "/a.ptin", content_of({2500, 1500}, 5), {});
            }),
            ErrorCode::resource_exhausted);
  EXPECT_TRUE(std::filesystem::is_empty(disk.path()));
}

TEST_F(FloorStore, AFileWithoutHeightsHasNone) {
  const std::string path = folder_.file("none.ptin");
  test::write_store(path, test::flat_square(1 << 20));
  EXPECT_EQ(StoreFile::open(path)->floor(), nullptr);
}

}  // namespace
}  // namespace ptin
