// SPDX-License-Identifier: GPL-3.0-or-later
//
// What lives on a page: the triangles that whole rings have, no others, and none that cannot be.
#include "engine/query/living/living_page.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/geometry/orient.h"
#include "storage/page_columns.h"
#include "tests/storage/failing_files.h"
#include "tests/storage/strange_records.h"
#include "tests/support/share_of_cases.h"

namespace ptin::test {
namespace {

/// A triangle as a tuple: three times position, height and whether there is one; then whether it is
/// void, and what its record says of the ground below it.
using Corner = std::tuple<std::int32_t, std::int32_t, HeightBits, bool>;
using Made = std::tuple<std::array<Corner, 3>, bool, float, HeightBits, HeightBits>;

Corner corner_of(const VertexSplit& r) {
  return {r.u.x, r.u.y, r.height, (r.flags & VertexSplit::kVertexVoid) == 0};
}
Corner corner_of(const RingCorner& c) {
  return {c.position.x, c.position.y, c.height, (c.flags & RingCorner::kNoHeight) == 0};
}
Corner corner_of(const LivingStar& s) { return {s.u.x, s.u.y, s.height, s.has_height}; }
Corner corner_of(const LivingCorner& c) {
  return {c.position.x, c.position.y, c.height, (c.flags & LivingCorner::kNoHeight) == 0};
}
GridPoint position_of(const Corner& c) { return {std::get<0>(c), std::get<1>(c)}; }

GridBox box_of_corners(const std::array<Corner, 3>& c) {
  return united(united(box_of(position_of(c[0])), position_of(c[1])), position_of(c[2]));
}

/// By whole rings, one triangle after the other.
std::vector<Made> made_by_rings(const StarredRecords& records, const LivingFilter& filter) {
  std::vector<Made> made;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const VertexSplit& r = records.splits[i];
    const auto ring = records.ring(i);
    for (std::size_t k = 0; k + (has_closed_ring(r) ? 0 : 1) < ring.size(); ++k) {
      const std::array<Corner, 3> corners{corner_of(r), corner_of(ring[k]),
                                          corner_of(ring[(k + 1) % ring.size()])};
      if (static_cast<double>(r.error) > filter.level &&
          static_cast<double>(ring[k].death) <= filter.level &&
          meets(box_of_corners(corners), filter.box)) {
        made.push_back({corners, (ring[k].flags & RingCorner::kVoid) != 0, r.deviation, r.height_lo,
                        r.height_hi});
      }
    }
  }
  return made;
}

std::vector<Made> made_of(const LivingStars& living) {
  std::vector<Made> made;
  std::size_t at = 0;
  for (std::size_t i = 0; i < living.stars.size(); ++i) {
    const LivingStar& s = living.stars.data()[i];
    for (; at < s.corner_end; ++at) {
      const LivingCorner* const c = living.corners.data() + at;
      if ((c->flags & LivingCorner::kLives) != 0) {
        made.push_back({{corner_of(s), corner_of(c[0]), corner_of(c[1])},
                        (c->flags & LivingCorner::kVoid) != 0,
                        s.deviation,
                        s.height_lo,
                        s.height_hi});
      }
    }
  }
  return made;
}

LivingStars living_of(const PackedPage& page, const HeightEncoding& heights,
                      const LivingFilter& filter) {
  LivingStars living;
  take_living(RecordPage(kPageName, PageId{0}, page.entry, heights, {}, page.bytes, nullptr),
              filter, living);
  return living;
}

StarredRecords strange_records(StrangeRecords& strange, int count) {
  StarredRecords records;
  for (int i = 0; i < count; ++i) {
    strange.add_to(records);
  }
  return records;
}

RC_GTEST_PROP(LivingPage, HandsOutWhatWholeRingsHave, (bool are_whole)) {
  StrangeRecords strange(*rc::gen::arbitrary<std::uint64_t>(),
                         are_whole ? HeightType::int32 : HeightType::float32);
  const StarredRecords given = strange_records(strange, 100);
  const PackedPage page = packed_page(given, strange.heights(), 65536);
  const StarredRecords records = decoded_page(page, strange.heights());
  LivingFilter filter;
  for (int asked = 0; asked < 20; ++asked) {
    const VertexSplit& r = records.splits[*rc::gen::inRange<std::size_t>(0, records.size())];
    filter.level = *rc::gen::element(-1.0, 0.0, static_cast<double>(r.error), r.error / 2.0);
    const std::int32_t side = *rc::gen::element(0, 20, 3000);
    filter.box = *rc::gen::arbitrary<bool>()
                     ? LivingFilter().box
                     : GridBox{r.u.x - side, r.u.y, r.u.x + side, r.u.y + side};
    RC_ASSERT(made_of(living_of(page, strange.heights(), filter)) ==
              made_by_rings(records, filter));
  }
}

/// The stars between whose corners a step lies; those around a vertex without a height are void.
LivingStars with_steps(const LivingStars& living, std::span<const std::uint64_t> steps,
                       HeightType type) {
  LivingStars wanted;
  std::size_t at = 0;
  for (std::size_t i = 0; i < living.stars.size(); ++i) {
    LivingStar star = living.stars.data()[i];
    const std::span corners(living.corners.data() + at, living.corners.data() + star.corner_end);
    at = star.corner_end;
    std::vector<std::uint32_t> heights{ordered_height(star.height, type)};
    for (const LivingCorner& c : corners) {
      if ((c.flags & LivingCorner::kNoHeight) == 0) {
        heights.push_back(ordered_height(c.height, type));
      }
    }
    const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
    if (!star.has_height || std::none_of(steps.begin(), steps.end(), [&](std::uint64_t step) {
          return *low < step && step <= *high;
        })) {
      continue;
    }
    const std::size_t before = wanted.corners.size();
    wanted.corners.grow(before + corners.size());
    std::copy(corners.begin(), corners.end(), wanted.corners.data() + before);
    star.corner_end = static_cast<std::uint32_t>(wanted.corners.size());
    wanted.stars.grow(wanted.stars.size() + 1);
    wanted.stars.data()[wanted.stars.size() - 1] = star;
  }
  return wanted;
}

RC_GTEST_PROP(LivingPage, HandsOutTheStarsAcrossSteps, (bool are_whole)) {
  const HeightType type = are_whole ? HeightType::int32 : HeightType::float32;
  StrangeRecords strange(*rc::gen::arbitrary<std::uint64_t>(), type);
  const StarredRecords given = strange_records(strange, 100);
  const PackedPage page = packed_page(given, strange.heights(), 65536);
  const StarredRecords records = decoded_page(page, strange.heights());
  for (int asked = 0; asked < 20; ++asked) {
    LivingFilter filter;
    filter.level = *rc::gen::element(-1.0, 0.0, 3.0);
    const LivingStars all = living_of(page, strange.heights(), filter);
    std::vector<std::uint64_t> steps{*rc::gen::element(std::uint64_t{0}, std::uint64_t{1} << 32)};
    for (int i = 0; i < asked; ++i) {
      const VertexSplit& r = records.splits[*rc::gen::inRange<std::size_t>(0, records.size())];
      steps.push_back(std::uint64_t{ordered_height(r.height, type)} + *rc::gen::inRange(0, 2));
    }
    std::sort(steps.begin(), steps.end());
    filter.steps = steps;
    RC_ASSERT(made_of(living_of(page, strange.heights(), filter)) ==
              made_of(with_steps(all, steps, type)));
  }
}

/// Looks at a page that a stranger wrote, by a descriptor that admits everything.
void expect_possible(const PackedPage& page, const HeightEncoding& heights, double level) {
  LivingFilter filter;
  filter.level = level;
  LivingStars living;
  const auto code = code_of([&] {
    take_living(RecordPage(kPageName, PageId{0}, page.entry, heights, {}, page.bytes, nullptr),
                filter, living);
  });
  if (code) {
    ASSERT_EQ(code, ErrorCode::corruption);
    ASSERT_EQ(living.stars.size() + living.corners.size(), 0U);
  }
  for (const auto& [corner, is_void, deviation, lo, hi] : made_of(living)) {
    for (const Corner& c : corner) {
      ASSERT_TRUE(contains(GridBox{0, 0, kGridMax, kGridMax}, position_of(c)));
      ASSERT_TRUE(is_void || std::get<3>(c));
    }
    ASSERT_GT(orient(position_of(corner[0]), position_of(corner[1]), position_of(corner[2])), 0);
    ASSERT_GE(deviation, 0.0F);
  }
}

// Each third bit, where not all cases are asked for: eight bits of three bytes.
TEST(LivingPage, GivesPossibleTrianglesAtEachFlippedBit) {
  const auto step = static_cast<std::size_t>(share_of_cases(3));
  for (const HeightType type : {HeightType::int32, HeightType::float32}) {
    StrangeRecords strange(type == HeightType::int32 ? 3 : 4, type);
    PackedPage page = packed_page(strange_records(strange, 5), strange.heights());
    page.entry = widest_entry(type, static_cast<std::uint32_t>(page.records));
    for (std::size_t bit = 0; bit < page.bytes.size() * 8; bit += step) {
      PackedPage flipped = page;
      flipped.bytes[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
      ASSERT_NO_FATAL_FAILURE(expect_possible(flipped, strange.heights(), -1.0)) << bit;
      ASSERT_NO_FATAL_FAILURE(expect_possible(flipped, strange.heights(), 3.0)) << bit;
    }
  }
}

/// A descriptor that does not hold what its page has.
TEST(LivingPage, RefusesWhatTheDescriptorExcludes) {
  StrangeRecords strange(2, HeightType::int32);
  const PackedPage page = packed_page(strange_records(strange, 20), strange.heights());
  LivingFilter filter;
  filter.level = 0.0;
  ASSERT_GT(living_of(page, strange.heights(), filter).stars.size(), 5U);
  const auto expect_refused = [&](const char* name, const auto& change) {
    PackedPage other = page;
    change(other.entry);
    EXPECT_EQ(code_of([&] { (void)living_of(other, strange.heights(), filter); }),
              ErrorCode::corruption)
        << name;
  };
  using E = layout::NodeEntry;
  expect_refused("west", [](E& e) { ++e.star_min_x; });
  expect_refused("south", [](E& e) { ++e.star_min_y; });
  expect_refused("east", [](E& e) { --e.star_max_x; });
  expect_refused("north", [](E& e) { --e.star_max_y; });
  expect_refused("records", [](E& e) { --e.records; });
  expect_refused("error", [](E& e) { e.error_max = e.error_min; });
  expect_refused("deviation", [](E& e) { e.deviation_max = 0; });
}

}  // namespace
}  // namespace ptin::test
