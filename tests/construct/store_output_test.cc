// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/store_output.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/query/select/coarsest.h"
#include "storage/sample_heights.h"
#include "storage/short_float.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/surface_oracle.h"
#include "tests/support/kept_interval.h"

namespace ptin {
namespace {

TerrainFrame frame_of(const oracle::TestTerrain& terrain, double rounding) {
  TerrainFrame frame;
  frame.heights = terrain.tile.units.heights;
  frame.height_quantum = 1.0;
  frame.height_rounding = rounding;
  frame.min_height = -100;
  frame.max_height = 100;
  return frame;
}

/// The records of a simplified tile with their stars, as two segments.
std::pair<StarredRecords, StarredRecords> halves(const Tile& tile) {
  StarredRecords all = starred_records(std::vector(tile.records), 0, RecordStars(tile.stars));
  const std::size_t half = all.size() / 2;
  const std::uint32_t corner = half == 0 ? 0 : all.ring_end[half - 1];
  StarredRecords second;
  second.splits.assign(all.splits.begin() + static_cast<std::ptrdiff_t>(half), all.splits.end());
  second.corners.assign(all.corners.begin() + corner, all.corners.end());
  for (std::size_t i = half; i < all.size(); ++i) {
    second.ring_end.push_back(all.ring_end[i] - corner);
  }
  all.splits.resize(half);
  all.corners.resize(corner);
  all.ring_end.resize(half);
  return {std::move(all), std::move(second)};
}

/// Packs a segment, places it behind all that were added before, and adds it.
void add_segment(StoreOutput& output, StarredRecords& records) {
  const PreparedSegment segment = output.packer().prepare(records);
  output.packer().place(segment.pages, output.page_bytes());
  output.add(segment);
}

/// Writes the records of a random terrain and returns what the store says of them.
std::vector<VertexSplit> written(const oracle::TestTerrain& terrain, const BuildOptions& options,
                                 double rounding, StoreFacts& facts, BuildReport& report) {
  const oracle::ScratchFolder folder;
  std::filesystem::create_directory(folder.file("work"));
  StoreOutput output(folder.file("out.ptin"), options, false, frame_of(terrain, rounding), false,
                     FileLayer::system(), folder.file("work"));
  auto [first, second] = halves(terrain.tile);
  add_segment(output, first);
  add_segment(output, second);
  output.publish(terrain.tile.tin, deaths_of(terrain.tile), {"/some/folder/dem.tif"}, report);
  const auto store = StoreFile::open(folder.file("out.ptin"));
  facts = store->facts();
  const nlohmann::json metadata = nlohmann::json::parse(store->metadata_json());
  EXPECT_EQ(metadata["source"]["files"][0], "dem.tif");
  EXPECT_EQ(store->record_count(), report.records);
  EXPECT_EQ(store->max_rank(), report.max_rank);
  EXPECT_TRUE(oracle::named_triangles(mesh_of(store->t0(), "t0")) ==
              oracle::named_triangles(terrain.tile.tin));
  std::vector<VertexSplit> all;
  IoCounters counters;
  SampleHeights samples;
  for (std::uint64_t page = 0; all.size() < store->record_count(); ++page) {
    store->read_records(PageId{page}, all, samples, counters);
  }
  return all;
}

std::vector<VertexSplit> sorted(std::vector<VertexSplit> records) {
  std::sort(records.begin(), records.end(),
            [](const VertexSplit& a, const VertexSplit& b) { return key_of(a.u) < key_of(b.u); });
  return records;
}

/// The records with the short numbers and the intervals that a store keeps.
std::vector<VertexSplit> kept_records(const oracle::TestTerrain& terrain) {
  std::vector<VertexSplit> records = terrain.tile.records;
  for (VertexSplit& r : records) {
    r.error = shortened(r.error);
    r.deviation = shortened(r.deviation);
    test::keep_interval(r, terrain.tile.units.heights.type);
  }
  return records;
}

TEST(StoreOutput, KeepsEveryRecordButForTheLengthOfItsNumbers) {
  const oracle::TestTerrain terrain = oracle::simplified(oracle::random_terrain(9, 400));
  StoreFacts facts;
  BuildReport report;
  EXPECT_TRUE(sorted(written(terrain, {}, 0.0, facts, report)) == sorted(kept_records(terrain)));
  EXPECT_EQ(facts.base_error, 0.0);
  EXPECT_EQ(facts.base_deviation, 0.0);
}

TEST(StoreOutput, AddsTheRoundingToEveryErrorAndDeviation) {
  const oracle::TestTerrain terrain = oracle::simplified(oracle::random_terrain(9, 400));
  StoreFacts facts;
  BuildReport report;
  const auto with = sorted(written(terrain, {}, 0.001, facts, report));
  const auto without = sorted(terrain.tile.records);
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_GE(static_cast<double>(with[i].error), static_cast<double>(without[i].error) + 0.001);
    EXPECT_GE(static_cast<double>(with[i].deviation),
              static_cast<double>(without[i].deviation) + 0.001);
    EXPECT_LE(with[i].error, (without[i].error + 0.001F) * (1 + 1.0F / 128));
  }
  EXPECT_EQ(facts.base_error, 0.001);
  EXPECT_EQ(facts.base_deviation, 0.001);
}

TEST(StoreOutput, LeavesOutRecordsUpToTheLargestErrorAndKeepsTheirWorst) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const oracle::TestTerrain terrain = oracle::simplified(oracle::random_terrain(seed, 300));
    BuildOptions options;
    const std::vector<VertexSplit> all = kept_records(terrain);
    options.max_error = all[all.size() / 2].error;
    if (!std::isfinite(options.max_error)) {
      continue;
    }
    StoreFacts facts;
    BuildReport report;
    const auto kept = sorted(written(terrain, options, 0.0, facts, report));
    std::vector<VertexSplit> expected;
    double error = 0.0, deviation = 0.0;
    for (const VertexSplit& r : all) {
      if (options.max_error == 0.0 || static_cast<double>(r.error) > options.max_error) {
        expected.push_back(r);
      } else {
        error = std::max(error, static_cast<double>(r.error));
        deviation = std::max(deviation, static_cast<double>(r.deviation));
      }
    }
    EXPECT_TRUE(kept == sorted(expected));
    EXPECT_EQ(facts.base_error, error);
    EXPECT_EQ(facts.base_deviation, deviation);
  }
}

TEST(StoreOutput, LeavesNothingBehindButItsWorkWithoutPublish) {
  const oracle::TestTerrain terrain = oracle::simplified(oracle::random_terrain(9, 200));
  const oracle::ScratchFolder folder;
  {
    std::filesystem::create_directory(folder.file("work"));
    StoreOutput output(folder.file("out.ptin"), {}, false, frame_of(terrain, 0.0), false,
                       FileLayer::system(), folder.file("work"));
    auto records = halves(terrain.tile).first;
    add_segment(output, records);
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"work"});
}

}  // namespace
}  // namespace ptin
