// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full TIN of a file against the heights of the raster in it: where these are others, with every
// checksum right, check_hierarchy() says so.
#include "engine/query/refine/floor_check.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>
#include <span>

#include <gtest/gtest.h>

#include "engine/query/questions.h"
#include "storage/store_writer.h"
#include "storage/verify.h"
#include "tests/query/built_terrain.h"
#include "tests/storage/small_raster.h"
#include "tests/support/stored_floor.h"
#include "tests/support/test_folder.h"

namespace ptin {
namespace {

using test::Bytes;
using test::StoredFloor;

Bytes read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}
void write_file(const std::string& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

class FloorCheckOf : public ::testing::TestWithParam<const char*> {
 protected:
  [[nodiscard]] const StoreFile& built() const {
    return reference::built_terrain(GetParam()).store();
  }
  /// The faults of the file with other heights.
  std::vector<VerifyFault> faults_with(const std::function<void(StoredFloor&)>& change,
                                       std::uint64_t memory = std::uint64_t{1} << 30) {
    StoredFloor floor = test::floor_of(built());
    change(floor);
    write_file(path_, test::with_floor(read_file(built().path()), test::sections_of(floor)));
    HierarchyRequest request;
    request.limits.memory_bytes = memory;
    return Terrain(StoreFile::open(path_)).check_hierarchy(request).faults;
  }
  void expect_told(const std::string& what, const std::function<void(StoredFloor&)>& change) {
    for (const std::uint64_t memory : {std::uint64_t{1} << 30, std::uint64_t{6} << 20}) {
      const std::vector<VerifyFault> faults = faults_with(change, memory);
      ASSERT_FALSE(faults.empty()) << what;
      EXPECT_NE(faults[0].what.find(what), std::string::npos) << faults[0].what;
    }
  }

  test::TestFolder folder_;
  std::string path_ = folder_.file("other.ptin");
};

bool is_void(const FloorTile& tile, std::size_t i) {
  return !tile.is_void.empty() && tile.is_void[i] != 0;
}
/// A sample with a height of the inner part of a tile.
std::size_t inner_height(const FloorTile& tile) {
  for (std::size_t i = tile.width + 1; i < tile.samples(); ++i) {
    if (!is_void(tile, i) && i % tile.width != 0 && i % tile.width != tile.width - 1) return i;
  }
  return 0;
}
FloorTile& tile_with_heights(StoredFloor& floor) {
  auto tile = std::next(floor.tiles.begin(), 30);
  while (inner_height(tile->second) == 0) ++tile;
  return tile->second;
}

TEST_P(FloorCheckOf, FindsNothingWhereTheyAreTheSame) {
  ASSERT_NE(built().floor(), nullptr);
  const auto same = [](StoredFloor&) {};
  EXPECT_TRUE(faults_with(same).empty());
  EXPECT_TRUE(faults_with(same, std::uint64_t{6} << 20).empty()) << "cell by cell";
  EXPECT_TRUE(verify_store(path_).is_sound());
  EXPECT_EQ(read_file(path_), read_file(built().path()));
}

/// Lets `change` change a sample in each tile that has it.
void change_sample(StoredFloor& floor, GridPoint at,
                   const std::function<void(OrderedHeight&)>& change) {
  const FloorShape& shape = floor.facts.shape;
  for (std::uint32_t row = 0; row < shape.rows(); ++row) {
    for (std::uint32_t column = 0; column < shape.columns(); ++column) {
      FloorTile& tile = floor.tiles.at(FloorShape::key(column, row));
      const std::int64_t x = at.x - std::int64_t{shape.first_of(column)};
      const std::int64_t y = at.y - std::int64_t{shape.first_of(row)};
      if (x < 0 || y < 0 || x >= tile.width || y >= tile.height) continue;
      change(tile.heights[static_cast<std::size_t>(y * tile.width + x)]);
    }
  }
}

/// T0 has its own heights; those of its neighbours' rings are the samples'.
TEST_P(FloorCheckOf, FindsAnotherHeightThanThatOfT0) {
  const CoarsestTin& t0 = built().t0();
  const auto vertex =
      std::ranges::find_if(t0.vertices, [](const CoarsestTin::V& v) { return v.has_height != 0; });
  ASSERT_NE(vertex, t0.vertices.end());
  const std::vector<VerifyFault> faults = faults_with([&](StoredFloor& f) {
    change_sample(f, vertex->position, [](OrderedHeight& height) { height += 1; });
  });
  ASSERT_FALSE(faults.empty());
  EXPECT_TRUE(faults[0].what.find("differs from the vertex") != std::string::npos ||
              faults[0].what.find("holds values that no program wrote") != std::string::npos)
      << faults[0].what;
}

/// A record's interval of heights holds those of its ring, on a page that leaves these to the tiles too.
TEST_P(FloorCheckOf, FindsAHeightBeyondAnInterval) {
  expect_told("holds values that no program wrote", [](StoredFloor& f) {
    FloorTile& tile = tile_with_heights(f);
    tile.heights[inner_height(tile)] += 1U << 20;
  });
}

TEST_P(FloorCheckOf, FindsAHeightThatIsVoid) {
  for (const bool is_lone : {false, true}) {
    // The records of a local page have heights.
    expect_told("holds values that no program wrote", [=](StoredFloor& f) {
      FloorTile& tile = tile_with_heights(f);
      const std::size_t i = inner_height(tile);
      tile.is_void.resize(tile.samples());
      tile.is_void[i] = 1;
      if (is_lone) {
        tile.lone = {{static_cast<std::uint16_t>(i), tile.heights[i]}};
      }
    });
  }
}

TEST_P(FloorCheckOf, FindsATileThatDiffersFromItsNeighbour) {
  // The last column of the first tile is the first one of another.
  expect_told("differs from one beside it", [](StoredFloor& f) {
    FloorTile& tile = f.tiles.begin()->second;
    std::size_t i = tile.width - 1;
    while (is_void(tile, i)) i += tile.width;
    ASSERT_LT(i, tile.samples());
    tile.heights[i] += 1;
  });
}

INSTANTIATE_TEST_SUITE_P(Rasters, FloorCheckOf,
                         ::testing::Values("mountains_257.tif", "coast_257.tif"));

TEST(FloorCheck, FindsAnotherHeight) {
  // A file of T0 alone, whose heights no page gives.
  const test::TestFolder folder;
  test::write_small_raster(folder.file("a"));
  StoredFloor floor = test::floor_of(*StoreFile::open(folder.file("a")));
  floor.tiles.begin()->second.heights[0] += 1;
  write_file(folder.file("b"),
             test::with_floor(read_file(folder.file("a")), test::sections_of(floor)));
  const HierarchyReport report = Terrain(StoreFile::open(folder.file("b"))).check_hierarchy({});
  ASSERT_FALSE(report.is_sound());
  EXPECT_NE(report.faults[0].what.find("has another height there"), std::string::npos)
      << report.faults[0].what;
}

TEST(FloorCheck, FindsAVoidThatHasAHeight) {
  // A lone sample that is no longer one, and a void.
  const StoreFile& built = reference::built_terrain("coast_257.tif").store();
  const test::TestFolder folder;
  StoredFloor floor = test::floor_of(built);
  bool is_there = false;
  for (auto& [key, tile] : floor.tiles) {
    for (std::size_t i = tile.width + 1; i + tile.width < tile.samples() && !is_there; ++i) {
      if (!is_void(tile, i) || i % tile.width == 0 || i % tile.width == tile.width - 1) continue;
      is_there = true;
      tile.is_void[i] = 0;
      std::erase_if(tile.lone, [=](const FloorTile::Lone& l) { return l.place == i; });
    }
  }
  if (!is_there) GTEST_SKIP() << "needs a terrain with voids";
  write_file(folder.file("a"), test::with_floor(read_file(built.path()), test::sections_of(floor)));
  const HierarchyReport report = Terrain(StoreFile::open(folder.file("a"))).check_hierarchy({});
  ASSERT_FALSE(report.is_sound());
  EXPECT_NE(report.faults[0].what.find("has no height, and there it has one"), std::string::npos)
      << report.faults[0].what;
}

TEST(FloorCheck, FindsATinThatIsNotCutByTheRule) {
  // A square of two samples a side, whose TIN has the other diagonal.
  const test::TestFolder folder;
  StoreFacts content;
  content.map = {0.0, 0.0, 30.0, 30.0};
  content.heights = {HeightType::int32, 1.0, 0.0};
  content.bounds = {0, 0, 1, 1};
  content.source_samples = 4;
  content.min_height = content.max_height = 12.0;
  const HeightBits height = 12;
  CoarsestTin t0;
  t0.vertices = {
      {{0, 0}, height, 1}, {{1, 0}, height, 1}, {{1, 1}, height, 1}, {{0, 1}, height, 1}};
  t0.triangles = {{{0, 1, 2}, 0}, {{0, 2, 3}, 0}};
  for (const bool is_by_rule : {true, false}) {
    if (!is_by_rule) t0.triangles = {{{0, 1, 3}, 0}, {{1, 2, 3}, 0}};
    const auto writer = StoreWriter::create(folder.file("a"), {.overwrite = true});
    FloorFacts facts;
    facts.shape = {5, 2, 2};
    FloorTile tile;
    tile.width = tile.height = 2;
    tile.heights.assign(4, ordered_height(height, HeightType::int32));
    writer->add_floor(facts, [&](FloorWriter& to) { return to.add(0, tile); });
    writer->publish(content, t0, "{}");
    EXPECT_TRUE(verify_store(folder.file("a")).is_sound());
    const HierarchyReport report = Terrain(StoreFile::open(folder.file("a"))).check_hierarchy({});
    ASSERT_EQ(report.is_sound(), is_by_rule);
    if (!is_by_rule) {
      EXPECT_NE(report.faults[0].what.find("lacks a triangle of the square at (0, 0)"),
                std::string::npos)
          << report.faults[0].what;
    }
  }
}

}  // namespace
}  // namespace ptin
