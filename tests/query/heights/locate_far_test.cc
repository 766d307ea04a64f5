// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points of a file that lies elsewhere, by its directory: bit for bit the answers of the file at hand,
// in few rounds.
#include <algorithm>
#include <bit>
#include <map>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/query/questions.h"
#include "engine/query/walk/spot_set.h"
#include "tests/query/built_terrain.h"
#include "tests/query/far_file.h"
#include "tests/query/line_oracle.h"
#include "tests/query/reference_hierarchy.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::nasty_spot;
using reference::TemporaryStore;
using test::bytes_of;
using test::Far;
using test::small_cells;
using test::WithDirectory;

bool are_same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool are_same(const LocatedPoint& a, const LocatedPoint& b) {
  bool same = a.state == b.state && are_same(a.height, b.height) &&
              are_same(a.height_min, b.height_min) && are_same(a.height_max, b.height_max);
  for (std::size_t i = 0; i < 3; ++i) {
    same = same && a.triangle[i].position == b.triangle[i].position &&
           are_same(a.triangle[i].height, b.triangle[i].height);
  }
  return same;
}

std::vector<LocateRequest> levels(double error, std::uint64_t vertices) {
  std::vector<LocateRequest> requests(3);
  requests[1].detail.tolerance = error;
  requests[2].detail.vertices = vertices;
  return requests;
}

RC_GTEST_PROP(LocateFar, GivesTheAnswersOfAFileAtHand, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h, 4096, 3, small_cells(1));
  const Terrain near(file.open());
  const SpotMap map(h.facts.map, h.facts.bounds);
  std::vector<MapPoint> points;
  for (int i = 0; i < 16; ++i) {
    points.push_back(map.map(nasty_spot(random, h.full)));
  }
  const Far far(bytes_of(file.path));
  if (near.store().pages().page_count() > 0) {
    const bool has_directory = far.terrain.store().directory() != nullptr;
    RC_ASSERT(has_directory);
  }
  for (const LocateRequest& request : levels(2.0, h.t0.vertices.size() + random() % 40)) {
    const LocateResult expected = near.locate(points, request);
    const LocateResult all = far.terrain.locate(points, request);
    for (std::size_t i = 0; i < points.size(); ++i) {
      RC_ASSERT(are_same(all.points[i], expected.points[i]));
      RC_ASSERT(
          are_same(far.terrain.locate({&points[i], 1}, request).points[0], expected.points[i]));
    }
  }
}

/// Places of a terrain: within triangles mostly, on vertices and lines of the grid, and outside.
std::vector<MapPoint> places(const StoreFacts& facts, std::size_t count) {
  std::mt19937_64 random(3);
  const GridBox& b = facts.bounds;
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    double x =
        b.min_x - 1 + static_cast<double>(random() >> 11) * 0x1p-53 * (b.max_x - b.min_x + 2);
    double y =
        b.min_y - 1 + static_cast<double>(random() >> 11) * 0x1p-53 * (b.max_y - b.min_y + 2);
    if (i % 4 == 1) x = std::floor(x);
    if (i % 8 == 1) y = std::floor(y);
    points.push_back(facts.map.to_map(x, y));
  }
  return points;
}

TEST(LocateFarTerrain, AnswersAsTheFileAtHand) {
  for (const char* name : test::some_of({"mountains_257.tif", "coast_257.tif"})) {
    const StoreFile& store = reference::built_terrain(name).store();
    const WithDirectory files(store, small_cells(20));
    const Terrain near = Terrain::open(files.path);
    const Far far(files.bytes);
    const std::vector<MapPoint> points = places(store.facts(), 1500);
    for (const LocateRequest& request : levels(5.0, 3000)) {
      const LocateResult expected = near.locate(points, request);
      const LocateResult all = far.terrain.locate(points, request);
      for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_TRUE(are_same(all.points[i], expected.points[i])) << name << ", point " << i;
      }
      for (std::size_t i = 0; i < points.size(); i += 10) {
        const LocateResult one = far.terrain.locate(std::span(points).subspan(i, 1), request);
        ASSERT_TRUE(are_same(one.points[0], expected.points[i])) << name << ", point " << i;
      }
    }
    EXPECT_EQ(near.store().directory(), nullptr) << "of a file at hand nothing is read of it";
  }
}

/// One round for the node and one for the pages; a few points take a further one.
TEST(LocateFarTerrain, TakesTwoRoundsBehindTheOpening) {
  const StoreFile& store = reference::built_terrain("mountains_257.tif").store();
  const WithDirectory files(store, small_cells(40));
  std::size_t further = 0;
  const std::vector<MapPoint> points = places(store.facts(), 200);
  const std::size_t front = test::front_with_directory(files.path);
  for (const MapPoint& at : points) {
    const Far far(files.bytes, front);
    const LocateResult result = far.terrain.locate({&at, 1}, {});
    EXPECT_LE(far.source->rounds.size(), 3U);
    EXPECT_EQ(result.cost.io.remote_rounds, far.source->rounds.size());
    further += far.source->rounds.size() > 2 ? 1 : 0;
    if (!far.source->rounds.empty()) {
      EXPECT_EQ(far.source->rounds[0].size(), 1U) << "one node";
    }
  }
  EXPECT_LE(further, points.size() / 50);
}

std::string message_of(const Far& far, const MapPoint& at) {
  try {
    static_cast<void>(far.terrain.locate({&at, 1}, {}));
  } catch (const Error& e) {
    return e.code() == ErrorCode::corruption ? e.message() : "another error";
  }
  return "";
}

/// Whatever is damaged of what is read is an error, and no other answer.
TEST(LocateFarTerrain, NeverAnswersFromADamagedDirectory) {
  const StoreFile& store = reference::built_terrain("mountains_257.tif").store();
  const WithDirectory files(store, small_cells(20));
  const Terrain near = Terrain::open(files.path);
  const std::vector<MapPoint> points = places(store.facts(), 8);
  std::map<std::string, SectionInfo> section;
  for (const SectionInfo& s : near.store().sections()) section[s.name] = s;
  const std::vector<std::pair<std::string, std::string>> expected{
      {"directory", "the section \"directory\" does not match its checksum"},
      {"directory nodes", "the node does not match the checksum that the directory holds"},
      {"pages", "the page does not match the checksum in the directory"}};
  for (const auto& [name, message] : expected) {
    ASSERT_TRUE(section.contains(name)) << name;
    std::vector<std::byte> bytes = files.bytes;
    const SectionInfo& s = section[name];
    for (std::uint64_t at = s.offset; at < s.offset + s.bytes; at += 97) bytes[at] ^= std::byte{4};
    for (const MapPoint& at : points) {
      const Far far(bytes);
      if (near.locate({&at, 1}, {}).points[0].state == PointState::kOutside) continue;
      EXPECT_EQ(message_of(far, at).find(message), 0U) << message_of(far, at);
    }
  }
}

}  // namespace
}  // namespace ptin
