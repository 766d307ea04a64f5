// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bytes of a page: what is packed comes back, and what no reader would accept is not packed.
#include "storage/record_page.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <optional>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "storage/page_packer.h"
#include "tests/storage/failing_files.h"
#include "tests/storage/strange_records.h"
#include "tests/storage/two_records.h"

namespace ptin::test {
namespace {

constexpr float kMostError = std::numeric_limits<float>::infinity();

StarredRecords first(const StarredRecords& records, std::size_t count) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < count; ++i) {
    order.push_back(i);
  }
  return in_order(records, order);
}

RC_GTEST_PROP(RecordPage, GivesBackWhatWasPackedAndPacksItSoAgain, ()) {
  const HeightType type = *rc::gen::element(HeightType::int32, HeightType::float32);
  StrangeRecords strange(*rc::gen::arbitrary<std::uint64_t>(), type);
  const std::uint32_t page_bytes = *rc::gen::element(4096U, 65536U);
  const auto count = *rc::gen::inRange<std::size_t>(1, 80);
  StarredRecords records;
  for (std::size_t i = 0; i < count; ++i) {
    strange.add_to(records);
  }
  const PackedPage page = packed_page(records, strange.heights(), page_bytes);
  RC_ASSERT(page.records >= 1U);
  const StarredRecords back = decoded_page(page, strange.heights());
  RC_ASSERT(are_same(back, as_on_page(first(records, page.records), type)));
  const PackedPage again = packed_page(back, strange.heights(), page_bytes);
  RC_ASSERT(again.bytes == page.bytes);
  RC_ASSERT(std::memcmp(&again.entry, &page.entry, sizeof page.entry) == 0);
}

/// FORMAT.md, "Intervals", without the packer's arithmetic: ends at multiples of a power of two, at most 16
/// of these units, the least such power; an interval that holds another still does; twice changes nothing.
RC_GTEST_PROP(RecordPage, KeepsIntervalsRoundedOutward, ()) {
  const auto any = [](std::uint64_t low, std::uint64_t high) {
    return low + *rc::gen::arbitrary<std::uint64_t>() % (high - low + 1);
  };
  const std::uint64_t reach = std::uint64_t{1} << *rc::gen::inRange(0, 33);
  const std::uint64_t low = any(0, UINT32_MAX);
  const std::uint64_t high = std::min<std::uint64_t>(UINT32_MAX, low + any(0, reach - 1));
  const std::uint64_t own = any(low, high);
  const auto kept_of = [](std::uint64_t height, std::uint64_t lo, std::uint64_t hi) {
    const KeptInterval kept = kept_interval({height, lo, hi});
    return interval_of(height, kept.shift, kept.below, kept.above, HeightType::int32);
  };
  const OrderedInterval kept = kept_of(own, low, high);
  RC_ASSERT(kept.height == own && kept.low <= low && high <= kept.high && kept.high <= UINT32_MAX);
  std::uint64_t unit = 1;
  while (high / unit - low / unit + 1 > 16) unit *= 2;
  RC_ASSERT(kept.low == low / unit * unit && kept.high == high / unit * unit + unit - 1);
  const OrderedInterval again = kept_of(own, kept.low, kept.high);
  RC_ASSERT(again.low == kept.low && again.high == kept.high);
  const std::uint64_t inner_low = any(low, high);
  const std::uint64_t inner_high = any(inner_low, high);
  const OrderedInterval inner = kept_of(inner_low, inner_low, inner_high);
  RC_ASSERT(kept.low <= inner.low && inner.high <= kept.high);
}

std::span<const RingCorner> triangles_of(const VertexSplit& r,
                                         const std::vector<RingCorner>& ring) {
  return std::span(ring).first(ring.size() - (has_closed_ring(r) ? 0 : 1));
}

void expect_spanned(const VertexSplit& r, const std::vector<RingCorner>& ring, const RingSpan& span,
                    HeightType type) {
  for (const RingCorner& c : ring) {
    RC_ASSERT(span.min_x <= c.position.x && c.position.x <= span.max_x);
    RC_ASSERT(span.min_y <= c.position.y && c.position.y <= span.max_y);
    const std::uint32_t height = ordered_height(c.height, type);
    RC_ASSERT((c.flags & RingCorner::kNoHeight) != 0 ||
              (span.low <= height && height <= span.high));
  }
  const auto at = [&](auto value_of, std::int64_t wanted) {
    return std::any_of(ring.begin(), ring.end(),
                       [&](const RingCorner& c) { return value_of(c) == wanted; });
  };
  const auto x = [](const RingCorner& c) { return c.position.x; };
  const auto y = [](const RingCorner& c) { return c.position.y; };
  RC_ASSERT(at(x, span.min_x) && at(x, span.max_x) && at(y, span.min_y) && at(y, span.max_y));
  std::uint32_t least = UINT32_MAX;
  for (const RingCorner& c : triangles_of(r, ring)) {
    least = std::min<std::uint32_t>(least, death_bits(c.death));
  }
  RC_ASSERT(least == span.least_death);
}

/// The run of a record, all of it taken.
PageRun run_of(const RecordPage& page, std::size_t record) {
  PageRun run(page);
  while (run.next() && record >= run.first() + run.count()) {
  }
  run.take_all();
  return run;
}

RC_GTEST_PROP(RecordPage, GivesEachRecordAndRingByItself, ()) {
  StrangeRecords strange(*rc::gen::arbitrary<std::uint64_t>(), HeightType::float32);
  StarredRecords records;
  for (int i = 0; i < 60; ++i) {
    strange.add_to(records);
  }
  const PackedPage bytes = packed_page(records, strange.heights(), 65536);
  const StarredRecords expected = decoded_page(bytes, strange.heights());
  const RecordPage page(kPageName, PageId{0}, bytes.entry, strange.heights(), {}, bytes.bytes,
                        nullptr);
  RunRings rings;
  for (int asked = 0; asked < 40; ++asked) {
    const auto i = *rc::gen::inRange<std::size_t>(0, page.records());
    VertexSplit r, head;
    std::vector<RingCorner> ring;
    const PageRun run = run_of(page, i);
    const auto k = static_cast<std::uint32_t>(i) - run.first();
    page.find_rings(run, rings);
    RC_ASSERT(page.split(run, k, rings, r));
    RC_ASSERT(page.head(run, k, head));
    RingSpan span;
    RC_ASSERT(page.ring(run, k, rings, head, ring, span));
    expect_spanned(r, ring, span, strange.heights().type);
    RC_ASSERT(r == expected.splits[i]);
    RC_ASSERT(std::ranges::equal(ring, expected.ring(i)));
    RC_ASSERT(run.roi(k) == r.roi);
    RC_ASSERT(run.error_bits(k) == short_bits(r.error));
  }
}

TEST(RecordPage, HoldsTheWidestRecordOnTheSmallestPage) {
  const HeightEncoding heights{HeightType::int32, 1.0, 0.0};
  const GridBox grid{0, 0, kGridMax, kGridMax};
  std::mt19937_64 random(1);
  VertexSplit r;
  r.u = {0, kGridMax / 2};
  r.height = 0x80000000;
  r.error = kMostError;
  r.deviation = kMostError;
  r.rank = UINT16_MAX;
  r.flags = VertexSplit::kNoRight;
  std::vector<RingCorner> ring;
  for (const GridPoint p : made_ring(r.u, grid, 255, kGridMax, random)) {
    ring.push_back(
        {p, 0x7FFFFFFF, ring.size() % 2 == 0 ? 0.0F : short_value(1), RingCorner::kVoid});
    ring.back().position.x = p.y == r.u.y ? kGridMax : p.x;
  }
  ASSERT_EQ(ring.size(), 255U);
  ring[7].flags |= RingCorner::kNoHeight;
  ring[7].height = 0;
  ring.back().death = kLivesOn;
  ring.back().flags = 0;
  name_by_ring(r, ring);
  hold_ring(r, ring, heights);
  r.roi = grid;
  StarredRecords records;
  add_star(records, r, ring);
  const PackedPage page = packed_page(records, heights);
  const auto header = object_at<layout::PageHeader>(page.bytes, 0);
  EXPECT_EQ(header.offset_bits, 32);
  EXPECT_EQ(header.height_bits, 33);
  EXPECT_EQ(header.death_bits, 15);
  EXPECT_EQ(header.void_bits + header.no_height_bits, 2);
  EXPECT_TRUE(are_same(decoded_page(page, heights), as_on_page(records, heights.type)));
}

TEST(RecordPage, HoldsRecordsAtBothEndsOfTheGrid) {
  const HeightEncoding heights{HeightType::int32, 1.0, 0.0};
  StarredRecords records;
  for (const std::int32_t x : {0, kGridMax}) {
    VertexSplit r;
    r.u = {x, 5};
    r.flags = VertexSplit::kNoLeft;
    const std::int32_t inward = x == 0 ? 1 : -1;
    add_star(records, r, {{x, 5 - inward}, {x + inward, 5}, {x, 5 + inward}}, heights);
    records.splits.back().roi = {0, 0, kGridMax, kGridMax};
  }
  EXPECT_TRUE(are_same(decoded_page(packed_page(records, heights), heights),
                       as_on_page(records, heights.type)));
}

TEST(RecordPage, DescribesMinusZeroAsZero) {
  const HeightEncoding heights;
  StarredRecords records;
  VertexSplit r;
  r.u = {5, 5};
  r.height = 0x80000000;
  add_star(records, r, {{4, 4}, {6, 5}, {5, 6}}, heights);
  const PackedPage page = packed_page(records, heights);
  EXPECT_EQ(page.entry.height_lo, 0U);
  EXPECT_EQ(page.entry.height_hi, 0U);
  EXPECT_EQ(page.entry.star_height_lo, 0U);
  EXPECT_EQ(page.entry.star_height_hi, 0U);
  EXPECT_EQ(decoded_page(page, heights).splits[0].height, 0U);
}

TEST(ShortFloat, RoundsUpToTheUpperHalfOfAFloat) {
  EXPECT_EQ(shortened(0.0F), 0.0F);
  EXPECT_EQ(shortened(-0.0F), 0.0F);
  EXPECT_EQ(shortened(256.0F), 256.0F);
  EXPECT_EQ(shortened(257.0F), 258.0F);
  EXPECT_EQ(shortened(1.25F), 1.25F);
  EXPECT_EQ(shortened(kMostError), kMostError);
  EXPECT_EQ(shortened(std::numeric_limits<float>::max()), kMostError);
  EXPECT_GT(shortened(std::numeric_limits<float>::denorm_min()), 0.0F);
  EXPECT_EQ(death_bits(kLivesOn), 0);
  EXPECT_EQ(death_bits(0.0F), 1);
  EXPECT_EQ(death_bits(kMostError), kMostDeathBits);
}

RC_GTEST_PROP(ShortFloat, IsMonotoneAndChangesLessThanOneIn128, ()) {
  const auto any = [] {
    return layout::to_float(*rc::gen::inRange<std::uint32_t>(0, layout::kInfinityBits));
  };
  const float a = any();
  const float b = any();
  RC_ASSERT(shortened(a) >= a);
  RC_ASSERT(shortened(shortened(a)) == shortened(a));
  RC_ASSERT((a <= b) <= (shortened(a) <= shortened(b)));
  if (a > std::numeric_limits<float>::min() && shortened(a) < kMostError) {
    RC_ASSERT(shortened(a) - a < a / 128);
  }
}

TEST(Star, GoesAroundItsVertexOnce) {
  const HeightEncoding heights;
  const auto is_one = [&](std::uint16_t flags, const std::vector<GridPoint>& ring) {
    StarredRecords records;
    VertexSplit r;
    r.u = {100, 100};
    r.flags = flags;
    add_star(records, r, ring, heights);
    return is_star(records.splits[0], records.ring(0), heights);
  };
  const std::vector<GridPoint> once{{101, 100}, {100, 101}, {99, 100}, {100, 99}};
  std::vector<GridPoint> twice = once;
  for (const GridPoint p : once) {
    twice.push_back({2 * p.x - 100, 2 * p.y - 100});
  }
  EXPECT_TRUE(is_one(0, once));
  EXPECT_FALSE(is_one(0, twice));
  for (const std::uint16_t open : {VertexSplit::kNoLeft, VertexSplit::kNoRight}) {
    EXPECT_TRUE(is_one(open, {once[0], once[1], once[2]}));
    EXPECT_TRUE(is_one(open, {once[3], once[0], once[1]})) << "beside any side of the domain";
    EXPECT_TRUE(is_one(open, {once[0], {101, 101}, once[1]}));
    EXPECT_FALSE(is_one(open, once)) << "three quarters";
    EXPECT_FALSE(is_one(open, twice));
  }
}

// --- What cannot be packed is a fault of the program ---

TEST(PagePacker, RefusesRecordsThatNoReaderWouldAccept) {
  const StoreContent content = two_records();
  const HeightEncoding heights = content.facts.heights;
  using Ruin = std::function<void(VertexSplit&, std::vector<RingCorner>&)>;
  const auto code_after = [&](const Ruin& ruin) {
    VertexSplit r = content.segments[0].splits[0];
    const std::span<const RingCorner> all = content.segments[0].ring(0);
    std::vector<RingCorner> ring(all.begin(), all.end());
    ruin(r, ring);
    PagePacker packer(4096, heights, {});
    return code_of([&] { static_cast<void>(packer.add(r, ring)); });
  };
  struct Case {
    const char* name;
    Ruin ruin;
  };
  const Case cases[] = {
      {"w", [](auto& r, auto&) { r.w = r.u; }},
      {"vl", [](auto& r, auto&) { r.vl.x -= 1; }},
      {"vr", [](auto& r, auto&) { r.vr.x += 1; }},
      {"class of the left triangle", [](auto& r, auto&) { r.flags = VertexSplit::kLeftVoid; }},
      {"class of the right triangle", [](auto&, auto& c) { c.back().flags = RingCorner::kVoid; }},
      {"unknown flag", [](auto& r, auto&) { r.flags = VertexSplit::kAllFlags + 1; }},
      {"no side", [](auto& r, auto&) { r.flags = VertexSplit::kNoLeft | VertexSplit::kNoRight; }},
      {"two corners", [](auto&, auto& c) { c.resize(2); }},
      {"256 corners", [](auto&, auto& c) { c.resize(256, c[1]); }},
      {"clockwise", [](auto&, auto& c) { std::swap(c[1].position, c[2].position); }},
      {"roi without u", [](auto& r, auto&) { r.roi.max_x = 3; }},
      {"roi without a corner", [](auto& r, auto&) { r.roi.max_x = 7; }},
      {"roi off the grid", [](auto& r, auto&) { r.roi.min_y = -1; }},
      {"height of u", [](auto& r, auto&) { r.height_hi = 9; }},
      {"height of a corner", [](auto& r, auto&) { r.height_lo = 1; }},
      {"no heights", [](auto& r, auto&) { r.height_lo = 11; }},
      {"surface without a height", [](auto& r, auto&) { r.flags = VertexSplit::kVertexVoid; }},
      {"height of none", [](auto&, auto& c) { c[2].flags = RingCorner::kNoHeight; }},
      {"death above the error", [](auto&, auto& c) { c[2].death = 4.5F; }},
      {"death is no short number", [](auto&, auto& c) { c[2].death = 1.001F; }},
      {"death is no number", [](auto&, auto& c) { c[2].death = std::nanf(""); }},
      {"error is no short number", [](auto& r, auto&) { r.error = 4.001F; }},
      {"error is no number", [](auto& r, auto&) { r.error = std::nanf(""); }},
      {"deviation is negative", [](auto& r, auto&) { r.deviation = -1.0F; }},
      {"deviation is no short number", [](auto& r, auto&) { r.deviation = 4.001F; }},
  };
  EXPECT_EQ(code_after([](auto&, auto&) {}), std::nullopt);
  for (const Case& c : cases) {
    EXPECT_EQ(code_after(c.ruin), ErrorCode::internal) << c.name;
  }
}

}  // namespace
}  // namespace ptin::test
