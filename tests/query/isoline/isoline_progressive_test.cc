// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progressive isolines against direct extractions: after every split, after the last one, through a
// stream; and what each step costs.
#include "engine/query/isoline/isoline_progressive.h"

#include <algorithm>
#include <optional>
#include <random>
#include <stop_token>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/mesh/star.h"
#include "engine/query/questions.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/total_order.h"
#include "engine/query/stream/stream_reader.h"
#include "engine/query/stream/stream_writer.h"
#include "tests/query/isoline/isoline_listing.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::Listing;
using reference::listing;
using reference::random_levels;
using reference::TemporaryStore;

struct IsolineCase {
  explicit IsolineCase(std::uint64_t seed)
      : random(seed),
        hierarchy(reference::random_hierarchy(seed)),
        file(hierarchy),
        store(file.open()),
        terrain(store),
        levels(random_levels(random, hierarchy, 1 + static_cast<int>(random() % 5)),
               hierarchy.facts.heights) {}
  [[nodiscard]] ProgressiveIsolines over(const Tin& tin) const {
    return {tin, levels, hierarchy.facts.heights, hierarchy.facts.map};
  }
  /// Of any TIN, from all its triangles.
  [[nodiscard]] std::uint64_t segments_of(const Tin& tin) const {
    std::uint64_t segments = 0;
    for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
      if (tin.classes[t] != TriangleClass::kSurface) continue;
      std::vector<std::uint32_t> bands;
      for (const VertexId v : tin.triangles[t].v) {
        bands.push_back(levels.band_of(hierarchy.facts.heights.code(tin.vertices[v].height)));
      }
      segments += *std::max_element(bands.begin(), bands.end()) -
                  *std::min_element(bands.begin(), bands.end());
    }
    return segments;
  }
  [[nodiscard]] Listing of_the_terrain(std::optional<double> tolerance = {}) const {
    IsolineRequest request;
    request.levels = levels.heights();
    request.detail.tolerance = tolerance;
    return listing(isolines(terrain, request));
  }
  /// The records that isolines need, in the total order.
  [[nodiscard]] std::vector<PendingSplit> splits() const {
    std::vector<PendingSplit> splits;
    for (const VertexSplit& r : hierarchy.records) {
      if (levels.crossing()->holds(attributes_of(r, hierarchy.facts.heights))) {
        splits.push_back(pending_of(r, PageId{0}));
      }
    }
    std::sort(splits.begin(), splits.end(), is_before);
    return splits;
  }
  std::mt19937_64 random;
  Hierarchy hierarchy;
  TemporaryStore file;
  std::shared_ptr<const StoreFile> store;
  Terrain terrain;
  LevelSet levels;
};

QueryContext context() { return {{.memory_bytes = std::uint64_t{1} << 30}, "test"}; }

RC_GTEST_PROP(ProgressiveIsolines, FollowEverySplit, (std::uint64_t seed)) {
  const IsolineCase asked(seed);
  QueryContext query = context();
  Refinement mesh(asked.terrain.t0());
  ProgressiveIsolines kept = asked.over(mesh.tin());
  const std::vector<PendingSplit> splits = asked.splits();
  Star star;
  for (std::size_t i = 0; i < splits.size(); ++i) {
    const std::uint64_t before = kept.pieces();
    mesh.apply({&splits[i], 1}, query);
    const IsolineChange change = kept.advance(mesh.tin());
    walk_star(mesh.tin(), mesh.find(splits[i].u), star);
    RC_ASSERT(change.splits == 1u);
    RC_ASSERT(change.triangles == star.triangles.size());
    RC_ASSERT(kept.pieces() == before + change.added - change.removed);
    if (i % 16 == 0) {
      RC_ASSERT(kept.pieces() == asked.segments_of(mesh.tin()));
      RC_ASSERT(listing(kept.lines(mesh.tin(), query)) ==
                listing(asked.over(mesh.tin()).lines(mesh.tin(), query)));
    }
  }
  RC_ASSERT(kept.advance(mesh.tin()) == IsolineChange{});
  RC_ASSERT(listing(kept.lines(mesh.tin(), query)) == asked.of_the_terrain());
}

RC_GTEST_PROP(ProgressiveIsolines, OfAStreamAreThoseOfTheTerrainInTheEnd, (std::uint64_t seed)) {
  IsolineCase asked(seed);
  StreamRequest request;
  request.wanted = asked.levels.crossing();
  std::optional<double> tolerance;
  if (asked.random() % 2 == 0 && !asked.hierarchy.records.empty()) {
    tolerance = asked.hierarchy.records[asked.random() % asked.hierarchy.records.size()].error;
    request.wanted = all_of({request.wanted, error_above(*tolerance)});
    request.tolerance = tolerance;
  }
  std::vector<std::byte> bytes;
  write_stream(OpenedTerrain(asked.store), request, [&](std::span<const std::byte> piece) {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
  });
  StreamReader reader("stream");
  std::optional<ProgressiveIsolines> kept;
  std::uint64_t splits = 0;
  for (std::size_t at = 0; at < bytes.size();) {  // in pieces of any size
    const std::size_t n = std::min<std::size_t>(1 + asked.random() % 900, bytes.size() - at);
    reader.feed(std::span(bytes).subspan(at, n));
    at += n;
    if (!reader.has_mesh()) continue;
    if (!kept) {
      kept.emplace(asked.over(reader.tin()));
    } else {
      splits += kept->advance(reader.tin()).splits;
    }
    RC_ASSERT(kept->pieces() == asked.segments_of(reader.tin()));
  }
  RC_ASSERT(listing(kept->lines(reader.tin(), context())) == asked.of_the_terrain(tolerance));
  RC_ASSERT(splits <= reader.splits());
}

/// The law that makes `stream --level` enough: what is not sent changes no isoline.
RC_GTEST_PROP(ProgressiveIsolines, NeedOnlyTheSplitsOfTheirLevels, (std::uint64_t seed)) {
  const IsolineCase asked(seed);
  QueryContext query = context();
  Refinement mesh(asked.terrain.t0());
  const std::vector<PendingSplit> needed = asked.splits();
  mesh.apply(needed, query);
  ProgressiveIsolines kept = asked.over(mesh.tin());
  const Listing lines = listing(kept.lines(mesh.tin(), query));
  std::vector<PendingSplit> others;
  for (const VertexSplit& r : asked.hierarchy.records) {
    if (!asked.levels.crossing()->holds(attributes_of(r, asked.hierarchy.facts.heights))) {
      others.push_back(pending_of(r, PageId{0}));
    }
  }
  mesh.apply(others, query);
  kept.advance(mesh.tin());
  RC_ASSERT(listing(kept.lines(mesh.tin(), query)) == lines);
}

TEST(ProgressiveIsolines, CostWhatChanges) {
  std::mt19937_64 random(7);
  const Hierarchy h =
      reference::simplify_unmeasured(reference::random_grid(random, 90, 80, 8, 0.03), random);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  const LevelSet levels(random_levels(random, h, 20), h.facts.heights);
  QueryContext query = context();
  Refinement mesh(terrain.t0());
  ProgressiveIsolines kept(mesh.tin(), levels, h.facts.heights, h.facts.map);
  std::vector<PendingSplit> splits;
  for (const VertexSplit& r : h.records) splits.push_back(pending_of(r, PageId{0}));
  std::sort(splits.begin(), splits.end(), is_before);
  IsolineChange all;
  for (const PendingSplit& s : splits) {
    mesh.apply({&s, 1}, query);
    const IsolineChange change = kept.advance(mesh.tin());
    all.splits += change.splits, all.triangles += change.triangles;
    all.removed += change.removed, all.added += change.added;
  }
  EXPECT_EQ(all.splits, splits.size());
  EXPECT_LT(all.triangles, 8 * all.splits);  // six on average when the last one came
  // In one step the same triangles are looked at once, however often they changed.
  Refinement again(terrain.t0());
  ProgressiveIsolines at_once(again.tin(), levels, h.facts.heights, h.facts.map);
  again.apply(splits, query);
  const IsolineChange change = at_once.advance(again.tin());
  EXPECT_EQ(change.splits, all.splits);
  EXPECT_LE(change.triangles, again.tin().triangles.size());
  EXPECT_LT(change.added, all.added);
  EXPECT_EQ(listing(at_once.lines(again.tin(), query)), listing(kept.lines(mesh.tin(), query)));
  // Places of pieces that went are used again.
  EXPECT_LT(kept.bytes(), 2 * at_once.bytes());
}

TEST(ProgressiveIsolines, BeginAnewWithAnotherNumbering) {
  const IsolineCase asked(5);
  QueryContext query = context();
  Refinement mesh(asked.terrain.t0());
  ProgressiveIsolines kept = asked.over(mesh.tin());
  mesh.apply(asked.splits(), query);
  const Tin other = stream::numbered_by_key(mesh.tin());
  kept.restart(other);
  EXPECT_EQ(listing(kept.lines(other, query)), asked.of_the_terrain());
  const QueryContext small({.memory_bytes = 100}, "test");
  EXPECT_THROW(static_cast<void>(kept.lines(other, small)), Error);
}

TEST(ProgressiveIsolines, KeepToTheirLimitAndStop) {
  const IsolineCase asked(5);
  const auto fault = [&](std::uint64_t limit, std::stop_token stop) {
    QueryContext query = context();
    Refinement mesh(asked.terrain.t0());
    try {
      ProgressiveIsolines kept(mesh.tin(), asked.levels, asked.hierarchy.facts.heights,
                               asked.hierarchy.facts.map, {{limit, std::move(stop)}, "test"});
      mesh.apply(asked.splits(), query);
      kept.advance(mesh.tin());
      EXPECT_LE(kept.bytes(), limit);
      return ErrorCode::internal;  // none
    } catch (const Error& e) {
      return e.code();
    }
  };
  ProgressiveIsolines whole = asked.over(Refinement(asked.terrain.t0()).tin());
  QueryContext query = context();
  Refinement mesh(asked.terrain.t0());
  mesh.apply(asked.splits(), query);
  const std::uint64_t before = whole.bytes();
  whole.advance(mesh.tin());
  ASSERT_GT(whole.bytes(), before);
  EXPECT_EQ(fault(4 * whole.bytes(), {}), ErrorCode::internal);
  EXPECT_EQ(fault(whole.bytes() - 1, {}), ErrorCode::resource_exhausted);  // in advance()
  EXPECT_EQ(fault(before - 1, {}), ErrorCode::resource_exhausted);         // in restart()
  std::stop_source stopped;
  stopped.request_stop();
  EXPECT_EQ(fault(4 * whole.bytes(), stopped.get_token()), ErrorCode::cancelled);
}

}  // namespace
}  // namespace ptin
