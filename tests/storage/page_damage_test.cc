// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pages that no packer made (FORMAT.md, "A reader must reject"), with each of their numbers changed.
#include <bit>
#include <cstring>
#include <functional>
#include <limits>
#include <span>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "storage/record_page.h"
#include "tests/storage/failing_files.h"
#include "tests/storage/strange_records.h"
#include "tests/storage/two_records.h"
#include "tests/support/share_of_cases.h"

namespace ptin::test {
namespace {

/// A page of two records, and changes of its numbers.
class DamagedPage : public testing::Test {
 protected:
  DamagedPage() : page_(packed_page(content_.segments[0], heights_)) {
    EXPECT_TRUE(columns_.read(page_.bytes, {}));
  }
  [[nodiscard]] layout::PageHeader header() const {
    return object_at<layout::PageHeader>(page_.bytes, 0);
  }

  /// Whether the page is decoded: by a descriptor that admits everything, if none is given.
  [[nodiscard]] bool is_accepted(const PackedPage& page) const {
    StarredRecords records;
    try {
      RecordPage(kPageName, PageId{0}, page.entry, heights_, {}, page.bytes, nullptr)
          .decode(records);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::corruption);
      EXPECT_NE(e.context().find(kPageName + ", page 0"), std::string::npos);
      EXPECT_TRUE(records.empty() && records.corners.empty() && records.ring_end.empty());
      return false;
    }
    return true;
  }
  void expect_header_refused(const char* name,
                             const std::function<void(layout::PageHeader&)>& change) const {
    PackedPage page = page_;
    layout::PageHeader h = header();
    change(h);
    set_object(page.bytes, 0, h);
    page.entry = widest_entry(heights_.type, header().records);
    EXPECT_FALSE(is_accepted(page)) << name;
  }
  /// The same, before any number is looked at.
  void expect_frame_refused(const char* name,
                            const std::function<void(layout::PageHeader&)>& change) const {
    PackedPage page = page_;
    layout::PageHeader h = header();
    change(h);
    set_object(page.bytes, 0, h);
    EXPECT_FALSE(PageColumns().read(page.bytes, {})) << name;
    expect_header_refused(name, change);
  }
  void expect_excluded(const char* name,
                       const std::function<void(layout::NodeEntry&)>& change) const {
    PackedPage page = page_;
    change(page.entry);
    EXPECT_FALSE(is_accepted(page)) << name;
  }
  /// Changes the bits [at, at + width) of the page.
  void expect_bits_refused(const char* name, std::size_t at, unsigned width,
                           std::uint64_t value) const {
    PackedPage page = page_;
    for (unsigned i = 0; i < width; ++i) {
      std::byte& b = page.bytes[(at + i) / 8];
      const auto bit = static_cast<std::byte>(1U << (at + i) % 8);
      b = (value >> i & 1U) != 0 ? b | bit : b & ~bit;
    }
    page.entry = widest_entry(heights_.type, header().records);
    EXPECT_NE(page.bytes, page_.bytes) << name;
    EXPECT_FALSE(is_accepted(page)) << name;
  }
  /// First bit of corner k of record 0, whose ring is the first one.
  [[nodiscard]] std::size_t corner_at(std::size_t k) const {
    const std::size_t bits =
        2 * offset_bits() + height_bits() + death_bits_of_ring() + columns_.common_bits();
    return columns_.run_begin(page_.bytes.data(), 0) + k * bits;
  }
  [[nodiscard]] unsigned offset_bits() const {
    return static_cast<unsigned>(columns_.at(page_.bytes.data(), PageColumn::kOffsetBits, 0));
  }
  [[nodiscard]] unsigned height_bits() const {
    return static_cast<unsigned>(columns_.at(page_.bytes.data(), PageColumn::kHeightBits, 0));
  }

  [[nodiscard]] unsigned death_bits_of_ring() const {
    return static_cast<unsigned>(columns_.at(page_.bytes.data(), PageColumn::kDeathBits, 0));
  }

  StoreContent content_ = two_records();
  HeightEncoding heights_ = content_.facts.heights;
  PackedPage page_;
  PageColumns columns_;
};

TEST_F(DamagedPage, IsAcceptedAsLongAsItIsNotDamaged) {
  EXPECT_TRUE(is_accepted(page_));
  PackedPage page = page_;
  page.entry = widest_entry(heights_.type, header().records);
  EXPECT_TRUE(is_accepted(page));
}

TEST_F(DamagedPage, RefusesHeadersThatCannotBe) {
  expect_frame_refused("no record", [](auto& h) { h.records = 0; });
  expect_header_refused("fewer records", [](auto& h) { h.records = 1; });
  expect_frame_refused("more than fit", [](auto& h) { h.records = 513; });
  expect_frame_refused("endless records", [](auto& h) { h.records = UINT16_MAX; });
  for (std::size_t c = 0; c < header().width.size(); ++c) {
    for (const unsigned width : {kMostColumnBits[c] + 1U, 58U, 64U, 255U}) {
      expect_frame_refused("width", [=](auto& h) { h.width[c] = std::uint8_t(width); });
    }
  }
  for (const unsigned width : {2U, 16U, 57U, 255U}) {
    expect_frame_refused("void bits", [=](auto& h) { h.void_bits = std::uint8_t(width); });
    expect_frame_refused("height bits", [=](auto& h) { h.no_height_bits = std::uint8_t(width); });
  }
  expect_frame_refused("rings beyond the page", [](auto& h) { h.ring_bytes = 4060; });
  expect_frame_refused("rings beyond the page", [](auto& h) { h.ring_bytes = UINT16_MAX; });
  expect_header_refused("no rings", [](auto& h) { h.ring_bytes = 0; });
  expect_header_refused("fewer rings", [](auto& h) { h.ring_bytes -= 1; });
  expect_frame_refused("another flag", [](auto& h) { h.flags = 2; });
  expect_frame_refused("local without heights of a raster",
                       [](auto& h) { h.flags = layout::kLocalPage; });
  for (const unsigned shift : {32U, 255U}) {
    expect_frame_refused("shift", [=](auto& h) { h.shift = std::uint8_t(shift); });
  }
  for (const unsigned width : {6U, 64U, 255U}) {
    expect_frame_refused("width of shifts", [=](auto& h) { h.shift_width = std::uint8_t(width); });
  }
  for (const PageColumn c : {PageColumn::kBelow, PageColumn::kAbove}) {
    expect_frame_refused("units", [=](auto& h) { h.width[static_cast<std::size_t>(c)] = 5; });
  }
}

TEST_F(DamagedPage, RefusesNumbersThatCannotBe) {
  expect_header_refused("x", [](auto& h) { h.x = kGridMax; });
  expect_header_refused("x", [](auto& h) { h.x = UINT32_MAX; });
  expect_header_refused("y", [](auto& h) { h.y = UINT32_MAX; });
  expect_header_refused("roi west of the grid", [](auto& h) { h.x = 3; });
  expect_header_refused("roi south of the grid", [](auto& h) { h.y = 0; });
  expect_header_refused("roi east of the grid", [](auto& h) { h.x = kGridMax - 3; });
  expect_header_refused("roi north of the grid", [](auto& h) { h.y = kGridMax - 4; });
  expect_header_refused("height", [](auto& h) { h.height = UINT32_MAX - 3; });
  expect_header_refused("interval of heights", [](auto& h) { h.height = 0; });
  expect_header_refused("an error below 0", [](auto& h) { h.error = 0; });
  expect_header_refused("error", [](auto& h) { h.error = kShortInfinity + 1; });
  expect_header_refused("error", [](auto& h) { h.error = UINT16_MAX; });
  expect_header_refused("deviation", [](auto& h) { h.deviation = UINT16_MAX; });
  expect_header_refused("rank", [](auto& h) { h.rank = UINT16_MAX; });
  for (const unsigned base : {0U, 1U, 2U, 255U}) {
    expect_header_refused("degree", [=](auto& h) { h.degree = std::uint8_t(base); });
  }
  for (const unsigned base : {0U, 33U, 255U}) {
    expect_header_refused("offsets", [=](auto& h) { h.offset_bits = std::uint8_t(base); });
  }
  for (const unsigned base : {34U, 58U, 255U}) {
    expect_header_refused("heights", [=](auto& h) { h.height_bits = std::uint8_t(base); });
    expect_header_refused("deaths", [=](auto& h) { h.death_bits = std::uint8_t(base); });
  }
}

/// The place of the only run, which lies before the rings.
TEST_F(DamagedPage, RefusesARunBeyondTheRings) {
  const std::size_t at = columns_.run_begin(page_.bytes.data(), 0) - 16;
  for (const std::uint64_t place :
       {std::uint64_t{header().ring_bytes}, std::uint64_t{4000}, std::uint64_t{UINT16_MAX}}) {
    expect_bits_refused("place", at, 16, place);
  }
}

TEST_F(DamagedPage, RefusesFlagsThatCannotBe) {
  PackedPage page = page_;
  page.entry = widest_entry(heights_.type, header().records);
  // A column of flags, which the page has none of, takes the place of that of ranks.
  const auto flags = static_cast<std::size_t>(PageColumn::kFlags);
  const auto rank = static_cast<std::size_t>(PageColumn::kRank);
  layout::PageHeader h = header();
  ASSERT_TRUE(h.width[flags] == 0 && h.width[rank] == 1);
  h.width[rank] = 0;
  h.width[flags] = 4;
  std::size_t at = sizeof h;
  for (std::size_t c = 0; c < flags; ++c) {
    at += (2U * h.width[c] + 7) / 8;
  }
  set_object(page.bytes, 0, h);
  ASSERT_TRUE(columns_.read(page.bytes, {}));
  for (const unsigned both : {0U, 1U, 2U, 3U, 4U, 8U, 12U}) {
    page.bytes[at] = static_cast<std::byte>(both);
    // With one of the first two the star is open, and goes around more than half of u.
    EXPECT_EQ(is_accepted(page), both == 0) << both;
  }
}

/// The widest fields that a corner may have, and one bit more of each.
TEST(RingShape, HasTheWidthsOfNumbersOnTheGrid) {
  EXPECT_TRUE(is_ring_shape(3, 0, 0, 0));
  EXPECT_TRUE(
      is_ring_shape(layout::kMostDegree, kMostOffsetWidth, kMostHeightWidth, kMostShortWidth));
  EXPECT_FALSE(is_ring_shape(2, 0, 0, 0));
  EXPECT_FALSE(is_ring_shape(layout::kMostDegree + 1, 0, 0, 0));
  EXPECT_FALSE(is_ring_shape(3, kMostOffsetWidth + 1, 0, 0));
  EXPECT_FALSE(is_ring_shape(3, 0, kMostHeightWidth + 1, 0));
  EXPECT_FALSE(is_ring_shape(3, 0, 0, kMostShortWidth + 1));
  const std::int64_t farthest = kGridMax;
  EXPECT_EQ(std::bit_width(static_cast<std::uint64_t>(farthest)) + 1, kMostOffsetWidth);
  EXPECT_EQ(std::bit_width(std::uint64_t{UINT32_MAX}) + 1, kMostHeightWidth);
  EXPECT_EQ(std::bit_width(std::uint64_t{kShortInfinity}), kMostShortWidth);
}

TEST_F(DamagedPage, RefusesCornersThatCannotBe) {
  const unsigned width = offset_bits();
  expect_bits_refused("w is u", corner_at(0), 2 * width, 0);
  expect_bits_refused("vl is u", corner_at(1), 2 * width, 0);
  expect_bits_refused("vr is u", corner_at(3), 2 * width, 0);
  expect_bits_refused("clockwise", corner_at(2), width, static_cast<std::uint64_t>(-4));
  expect_bits_refused("outside of the roi", corner_at(2), width, 5);
  expect_bits_refused("height below all", corner_at(2) + 2 * width, height_bits(),
                      static_cast<std::uint64_t>(-11));
  expect_bits_refused("height above all", corner_at(2) + 2 * width, height_bits(), 1);
}

TEST_F(DamagedPage, RefusesDeathsThatCannotBe) {
  StarredRecords records = content_.segments[0];
  const float least = short_value(1);
  records.corners[2].death = least;
  page_ = packed_page(records, heights_);
  ASSERT_TRUE(columns_.read(page_.bytes, {}));
  const unsigned width = death_bits_of_ring();
  const std::size_t at = corner_at(2) + 2 * offset_bits() + height_bits();
  const std::uint32_t death = stored_death(least, short_bits(records.splits[0].error));
  ASSERT_EQ(read_bits(page_.bytes.data(), at, width), death);
  expect_bits_refused("0 in another form", at, width, death + 1);
  expect_bits_refused("below 0", at, width, death + 2);
}

TEST_F(DamagedPage, RefusesSurfaceWithoutHeightsAndMoreVoidThanTriangles) {
  StarredRecords records = content_.segments[0];
  for (RingCorner& c : records.ring(0)) {
    c.flags = RingCorner::kVoid;
  }
  records.ring(0)[2].flags |= RingCorner::kNoHeight;
  records.ring(0)[2].height = 0;
  name_by_ring(records.splits[0], records.ring(0));
  page_ = packed_page(records, heights_);
  ASSERT_TRUE(columns_.read(page_.bytes, {}) && is_accepted(page_));
  const auto flags_at = [&](std::size_t k) { return corner_at(k + 1) - 2; };
  expect_bits_refused("surface after it", flags_at(2), 1, 0);
  expect_bits_refused("surface before it", flags_at(1), 1, 0);
  expect_bits_refused("in the surface", flags_at(3), 2, 2);
}

TEST_F(DamagedPage, RefusesRecordsThatItsDescriptorExcludes) {
  expect_excluded("min x", [](auto& e) { e.min_x += 1; });
  expect_excluded("max y", [](auto& e) { e.max_y -= 1; });
  expect_excluded("heights", [](auto& e) { e.height_lo += 1; });
  expect_excluded("heights", [](auto& e) { e.height_hi -= 1; });
  expect_excluded("largest error", [](auto& e) { e.error_max -= 1; });
  expect_excluded("least error", [](auto& e) { e.error_min += 1; });
  expect_excluded("deviation", [](auto& e) { e.deviation_max -= 1; });
  expect_excluded("box of stars", [](auto& e) { e.star_min_x += 1; });
  expect_excluded("box of stars", [](auto& e) { e.star_max_y -= 1; });
  expect_excluded("heights of stars", [](auto& e) { e.star_height_lo += 1; });
  expect_excluded("heights of stars", [](auto& e) { e.star_height_hi -= 1; });
  expect_excluded("death", [](auto& e) { e.death_min = 1; });
  expect_excluded("fewer records", [](auto& e) { e.records = 1; });
  expect_excluded("more records", [](auto& e) { e.records = 3; });
  expect_excluded("no record", [](auto& e) { e.records = 0; });
}

TEST_F(DamagedPage, RefusesDescriptorsThatCannotBe) {
  using Ruin = std::function<void(layout::NodeEntry&)>;
  const Ruin ruins[] = {
      [](auto& e) { e.min_x = -1; },
      [](auto& e) { e.max_y = kGridMax + 1; },
      [](auto& e) { e.min_x = e.max_x + 1; },
      [](auto& e) { e.min_y = e.max_y + 1; },
      [](auto& e) { e.star_min_x = -1; },
      [](auto& e) { e.star_min_x = e.star_max_x + 1; },
      [](auto& e) { e.star_min_y = e.star_max_y + 1; },
      [](auto& e) { e.min_x = e.star_min_x + 1; },
      [](auto& e) { e.min_y = e.star_min_y + 1; },
      [](auto& e) { e.max_x = e.star_max_x - 1; },
      [](auto& e) { e.max_y = e.star_max_y - 1; },
      [](auto& e) { e.error_min = e.error_max + 1; },
      [](auto& e) { e.error_max = kShortInfinity + 1; },
      [](auto& e) { e.deviation_max = kShortInfinity + 1; },
      [](auto& e) { e.death_min = kMostDeathBits + 1; },
      [](auto& e) { e.reserved = 1; },
  };
  EXPECT_TRUE(is_sound(page_.entry, heights_));
  for (const Ruin& ruin : ruins) {
    layout::NodeEntry e = page_.entry;
    ruin(e);
    EXPECT_FALSE(is_sound(e, heights_)) << &ruin - ruins;
  }
  for (HeightBits layout::NodeEntry::*height :
       {&layout::NodeEntry::height_lo, &layout::NodeEntry::height_hi,
        &layout::NodeEntry::star_height_lo, &layout::NodeEntry::star_height_hi}) {
    layout::NodeEntry e = widest_entry(HeightType::float32, 1);
    EXPECT_TRUE(is_sound(e, {}));
    e.*height = 0x7FC00000;
    EXPECT_FALSE(is_sound(e, {}));
  }
}

TEST(RecordPage, RefusesHeightsThatAreNoNumbers) {
  const HeightEncoding heights;
  StarredRecords records;
  VertexSplit r;
  r.u = {5, 5};
  r.height = layout::to_bits(std::numeric_limits<float>::infinity());
  add_star(records, r, {{4, 4}, {6, 5}, {5, 6}}, heights);
  PackedPage page = packed_page(records, heights);
  EXPECT_TRUE(are_same(decoded_page(page, heights), as_on_page(records, heights.type)));
  auto h = object_at<layout::PageHeader>(page.bytes, 0);
  h.height += 1;
  set_object(page.bytes, 0, h);
  page.entry = widest_entry(heights.type, 1);
  EXPECT_EQ(code_of([&] { static_cast<void>(decoded_page(page, heights)); }),
            ErrorCode::corruption);
}

// Any change of a bit: refused, or a page of records that packs to other bytes, which `verify`
// notices, or an honest page of other records.
// Each third bit, where not all cases are asked for: eight bits of three bytes.
TEST(RecordPage, SurvivesEachFlippedBit) {
  const auto step = static_cast<std::size_t>(share_of_cases(3));
  for (const HeightType type : {HeightType::int32, HeightType::float32}) {
    StrangeRecords strange(type == HeightType::int32 ? 3 : 4, type);
    StarredRecords records;
    for (int i = 0; i < 5; ++i) {
      strange.add_to(records);
    }
    PackedPage page = packed_page(records, strange.heights());
    page.entry = widest_entry(type, static_cast<std::uint32_t>(page.records));
    std::size_t accepted = 0;
    for (std::size_t bit = 0; bit < page.bytes.size() * 8; bit += step) {
      PackedPage flipped = page;
      flipped.bytes[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
      const auto code = code_of([&] {
        static_cast<void>(packed_page(decoded_page(flipped, strange.heights()), strange.heights()));
        ++accepted;
      });
      ASSERT_TRUE(!code || code == ErrorCode::corruption) << bit;
    }
    EXPECT_GT(accepted, 0U);
    EXPECT_LT(accepted, page.bytes.size() * 8);
  }
}

RC_GTEST_PROP(RecordPage, IsSafeToAskWhateverItsHeadSays, ()) {
  StrangeRecords strange(*rc::gen::arbitrary<std::uint64_t>(), HeightType::int32);
  StarredRecords records;
  for (int i = 0; i < 20; ++i) {
    strange.add_to(records);
  }
  PackedPage page = packed_page(records, strange.heights());
  for (int change = *rc::gen::inRange(1, 4); change > 0; --change) {
    const auto at = *rc::gen::inRange<std::size_t>(0, 140);
    page.bytes[at] = *rc::gen::element(std::byte{0}, std::byte{1}, std::byte{31}, std::byte{32},
                                       std::byte{57}, std::byte{127}, std::byte{255});
  }
  page.entry =
      widest_entry(HeightType::int32, object_at<layout::PageHeader>(page.bytes, 0).records);
  const auto code = code_of([&] { static_cast<void>(decoded_page(page, strange.heights())); });
  RC_ASSERT(!code || code == ErrorCode::corruption);
}

}  // namespace
}  // namespace ptin::test
