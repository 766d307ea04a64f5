// SPDX-License-Identifier: GPL-3.0-or-later
//
// Many questions at once of the heights of one file: run under the thread sanitizer too.
#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "storage/floor.h"
#include "storage/store_file.h"
#include "tests/storage/made_raster.h"
#include "tests/support/test_folder.h"

namespace ptin::test {
namespace {

bool is_as(const FloorTile& found, const FloorTile& expected) {
  bool same = found.samples() == expected.samples();
  for (std::size_t i = 0; same && i < expected.samples(); ++i) {
    const bool is_void = !found.is_void.empty() && found.is_void[i] != 0;
    same = is_void == (expected.is_void[i] != 0) &&
           (is_void || found.heights[i] == expected.heights[i]);
  }
  return same;
}

/// Nodes that one question has verified serve the next ones: there are two levels of them.
TEST(FloorConcurrency, GivesEveryThreadTheSameTiles) {
  const TestFolder folder;
  const Raster raster{1001, 1001};
  write_raster(folder.file("a"), raster, 4);
  for (const PageAccess access : {PageAccess::kMapped, PageAccess::kPread}) {
    const auto store = StoreFile::open(folder.file("a"), access);
    std::atomic<int> failures{0};
    const auto ask = [&](std::size_t thread) {
      const Floor& floor = *store->floor();  // made by the first that comes
      const FloorShape& shape = floor.facts().shape;
      Floor::Recent recent;
      IoCounters counters;
      FloorTile tile;
      const std::vector<Place> places = in_order(shape);
      for (std::size_t i = thread; i < places.size(); i += 37) {
        const auto& [column, row] = places[i * 61 % places.size()];
        floor.read(column, row, recent, tile, counters);
        failures += is_as(tile, tile_of(raster, shape, column, row)) ? 0 : 1;
      }
      std::size_t taken = 0;
      floor.visit([](const Floor::Bounds&) { return true; },
                  [&](const Floor::TileAt&, const FloorTile&) { return ++taken > 0; }, recent,
                  counters);
      failures += taken == places.size() && floor.pages() > 168 ? 0 : 1;
    };
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 8; ++t) threads.emplace_back(ask, t);
    for (std::thread& t : threads) t.join();
    EXPECT_EQ(failures, 0);
  }
}

}  // namespace
}  // namespace ptin::test
