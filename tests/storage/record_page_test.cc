// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bytes of a page: what is packed comes back, and what no packer made is refused.
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
#include "storage/page_records.h"
#include "storage/short_float.h"
#include "tests/storage/failing_files.h"
#include "tests/storage/made_star.h"
#include "tests/storage/store_fixture.h"
#include "tests/storage/two_records.h"

namespace ptin::test {
namespace {

const std::string kName = "page test";
constexpr float kInfinite = std::numeric_limits<float>::infinity();

struct Page {
  std::vector<std::byte> bytes;
  layout::NodeEntry entry;
  std::size_t records;
};

/// One page of the first records; of all of them when they fit.
Page packed(const StarredRecords& records, const HeightEncoding& heights,
            std::uint32_t page_bytes = 4096) {
  PagePacker packer(page_bytes, heights);
  Page page{};
  while (page.records < records.size() &&
         packer.add(records.splits[page.records], records.ring(page.records))) {
    ++page.records;
  }
  const std::span<const std::byte> bytes = packer.finish(page.entry);
  page.bytes.assign(bytes.begin(), bytes.end());
  return page;
}

StarredRecords decoded(const Page& page, const HeightEncoding& heights) {
  const auto bytes = static_cast<std::uint32_t>(page.bytes.size());
  StarredRecords records;
  DescribedPage(kName, PageId{0}, page.entry, heights, bytes).decode(page.bytes, records);
  return records;
}

/// Admits every record of a page.
layout::NodeEntry widest(HeightType type, std::uint32_t records) {
  layout::NodeEntry e{};
  const HeightInterval none = no_heights(type);
  e.max_x = e.max_y = e.star_max_x = e.star_max_y = kGridMax;
  e.height_lo = e.star_height_lo = none.hi;
  e.height_hi = e.star_height_hi = none.lo;
  e.error_max = e.deviation_max = kShortInfinity;
  e.records = records;
  return e;
}

// --- What is packed comes back ---

/// Records at the ends of what a page can hold, by chance.
class StrangeRecords {
 public:
  StrangeRecords(std::uint64_t seed, HeightType type) : random_(seed), type_(type) {
    const std::int32_t side = one_of<std::int32_t>({8, 1000, 1 << 20, kGridMax});
    const std::int32_t low = one_of<std::int32_t>({0, kGridMax - side, (kGridMax - side) / 2});
    box_ = {low, low, low + side, low + side};
    least_degree_ = one_of<std::size_t>({3, 3, 3, 240});
  }
  [[nodiscard]] HeightEncoding heights() const { return {type_, 1.0, 0.0}; }

  void add_to(StarredRecords& records) {
    VertexSplit r;
    r.u = {inner(), inner()};
    if (chance(4)) {  // on one of the four sides
      (chance(2) ? r.u.x : r.u.y) = chance(2) ? box_.min_x : box_.max_x;
      r.flags = chance(2) ? VertexSplit::kNoLeft : VertexSplit::kNoRight;
    }
    const std::size_t degree = chance(8) ? 255 : least_degree_ + random_() % 9;
    const std::int32_t reach = one_of<std::int32_t>({1, 30, 5000, kGridMax});
    std::vector<RingCorner> ring;
    for (const GridPoint p : made_ring(r.u, box_, degree, reach, random_)) {
      ring.push_back({p, height(), kLivesOn, 0});
    }
    r.error = error();
    r.deviation = error();
    r.rank = static_cast<std::uint16_t>(one_of<std::uint64_t>({0, 7, 65535, random_()}));
    r.height = height();
    fill_classes(r, ring);
    for (RingCorner& c : ring) {
      c.death = one_of<float>({kLivesOn, 0.0F, r.error, std::min(error(), r.error)});
    }
    if (!has_closed_ring(r)) {
      ring.back().death = kLivesOn;
      ring.back().flags &= RingCorner::kNoHeight;
    }
    name_by_ring(r, ring);
    r.height_lo = no_heights(type_).lo;
    r.height_hi = no_heights(type_).hi;
    hold_ring(r, ring, heights());
    if (chance(3)) {
      r.roi = box_;
    }
    add_star(records, r, ring);
  }

 private:
  bool chance(unsigned one_in) { return random_() % one_in == 0; }
  template <class T>
  T one_of(std::initializer_list<T> choices) {
    return choices.begin()[random_() % choices.size()];
  }
  std::int32_t inner() {
    return box_.min_x + 1 +
           static_cast<std::int32_t>(random_() %
                                     static_cast<unsigned>(box_.max_x - box_.min_x - 1));
  }
  float error() {
    const auto any = static_cast<ShortBits>(random_() % (kShortInfinity + 1U));
    return one_of<float>({0.0F, 1.0F, 1.5F, kInfinite, short_value(any)});
  }
  HeightBits height() {
    if (type_ == HeightType::int32) {
      return one_of<HeightBits>(
          {0, 5, 0xFFFFFFFF, 0x80000000, 0x7FFFFFFF, static_cast<HeightBits>(random_())});
    }
    const auto any = static_cast<HeightBits>(random_() % (layout::kInfinityBits + 1U)) |
                     (chance(2) ? 0x80000000U : 0U);
    return one_of<HeightBits>({0, 0x80000000, layout::to_bits(3.5F), layout::to_bits(-3.5F), any});
  }
  /// Voids, and vertices without a height in the middle of them.
  void fill_classes(VertexSplit& r, std::vector<RingCorner>& ring) {
    const unsigned voids = one_of<unsigned>({0, 0, 3, 1});
    const bool has_no_height = voids == 1 && chance(2);
    if (has_no_height) {
      r.flags |= VertexSplit::kVertexVoid;
      r.height = 0;
    }
    const bool no_heights_at_all = has_no_height && chance(2);
    for (RingCorner& c : ring) {
      c.flags = voids != 0 && random_() % voids == 0 ? RingCorner::kVoid : 0;
    }
    for (std::size_t i = 0; i < ring.size(); ++i) {
      RingCorner& before = ring[i == 0 ? ring.size() - 1 : i - 1];
      const bool is_between_voids = (ring[i].flags & before.flags & RingCorner::kVoid) != 0;
      if (no_heights_at_all || (is_between_voids && chance(2))) {
        ring[i].flags |= RingCorner::kNoHeight;
        ring[i].height = 0;
      }
    }
  }

  std::mt19937_64 random_;
  HeightType type_;
  GridBox box_;
  std::size_t least_degree_;
};

/// As a page gives them back: 0 in the place of -0.
StarredRecords without_minus_zeros(StarredRecords records, HeightType type) {
  const auto normalize = [&](HeightBits& h) {
    h = type == HeightType::float32 && h == 0x80000000 ? 0 : h;
  };
  for (VertexSplit& r : records.splits) {
    normalize(r.height);
    normalize(r.height_lo);
    normalize(r.height_hi);
  }
  for (RingCorner& c : records.corners) {
    normalize(c.height);
  }
  return records;
}

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
  const Page page = packed(records, strange.heights(), page_bytes);
  RC_ASSERT(page.records >= 1U);
  const StarredRecords back = decoded(page, strange.heights());
  RC_ASSERT(are_same(back, without_minus_zeros(first(records, page.records), type)));
  const Page again = packed(back, strange.heights(), page_bytes);
  RC_ASSERT(again.bytes == page.bytes);
  RC_ASSERT(std::memcmp(&again.entry, &page.entry, sizeof page.entry) == 0);
}

RC_GTEST_PROP(RecordPage, GivesEachRecordAndRingByItself, ()) {
  StrangeRecords strange(*rc::gen::arbitrary<std::uint64_t>(), HeightType::float32);
  StarredRecords records;
  for (int i = 0; i < 60; ++i) {
    strange.add_to(records);
  }
  const Page bytes = packed(records, strange.heights(), 65536);
  const StarredRecords expected = decoded(bytes, strange.heights());
  const RecordPage page(bytes.bytes, strange.heights());
  RC_ASSERT(page.is_sound());
  RingPlace place;
  for (int asked = 0; asked < 40; ++asked) {
    const auto i = *rc::gen::inRange<std::size_t>(0, page.records());
    place = *rc::gen::arbitrary<bool>() ? RingPlace{} : place;
    VertexSplit r, head;
    std::vector<RingCorner> ring;
    RC_ASSERT(page.split(i, place, r));
    RC_ASSERT(page.head(i, head));
    RC_ASSERT(page.ring(i, place, head, ring));
    RC_ASSERT(r == expected.splits[i]);
    RC_ASSERT(std::ranges::equal(ring, expected.ring(i)));
    RC_ASSERT(page.roi(i) == r.roi);
    RC_ASSERT(page.error_bits(i) == short_bits(r.error));
  }
}

TEST(RecordPage, HoldsTheWidestRecordOnTheSmallestPage) {
  const HeightEncoding heights{HeightType::int32, 1.0, 0.0};
  const GridBox grid{0, 0, kGridMax, kGridMax};
  std::mt19937_64 random(1);
  VertexSplit r;
  r.u = {0, kGridMax / 2};
  r.height = 0x80000000;
  r.error = kInfinite;
  r.deviation = kInfinite;
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
  const Page page = packed(records, heights);
  const auto header = object_at<layout::PageHeader>(page.bytes, 0);
  EXPECT_EQ(header.offset_bits, 32);
  EXPECT_EQ(header.height_bits, 33);
  EXPECT_EQ(header.death_bits, 15);
  EXPECT_EQ(header.void_bits + header.no_height_bits, 2);
  EXPECT_TRUE(are_same(decoded(page, heights), records));
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
  EXPECT_TRUE(are_same(decoded(packed(records, heights), heights), records));
}

TEST(ShortFloat, RoundsUpToTheUpperHalfOfAFloat) {
  EXPECT_EQ(shortened(0.0F), 0.0F);
  EXPECT_EQ(shortened(-0.0F), 0.0F);
  EXPECT_EQ(shortened(256.0F), 256.0F);
  EXPECT_EQ(shortened(257.0F), 258.0F);
  EXPECT_EQ(shortened(1.25F), 1.25F);
  EXPECT_EQ(shortened(kInfinite), kInfinite);
  EXPECT_EQ(shortened(std::numeric_limits<float>::max()), kInfinite);
  EXPECT_GT(shortened(std::numeric_limits<float>::denorm_min()), 0.0F);
  EXPECT_EQ(death_bits(kLivesOn), 0);
  EXPECT_EQ(death_bits(0.0F), 1);
  EXPECT_EQ(death_bits(kInfinite), kMostDeathBits);
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
  if (a > std::numeric_limits<float>::min() && shortened(a) < kInfinite) {
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
    PagePacker packer(4096, heights);
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

// --- What no packer made is refused ---

/// A page of two records, and changes of its numbers.
class DamagedPage : public testing::Test {
 protected:
  DamagedPage() : page_(packed(content_.segments[0], heights_)) {
    EXPECT_TRUE(columns_.read(header(), page_.bytes.size()));
  }
  [[nodiscard]] layout::PageHeader header() const {
    return object_at<layout::PageHeader>(page_.bytes, 0);
  }

  /// Whether the page is decoded: by a descriptor that admits everything, if none is given.
  [[nodiscard]] bool is_accepted(const Page& page) const {
    StarredRecords records;
    try {
      DescribedPage(kName, PageId{0}, page.entry, heights_, 4096).decode(page.bytes, records);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::corruption);
      EXPECT_NE(e.context().find(kName + ", page 0"), std::string::npos);
      EXPECT_TRUE(records.empty() && records.corners.empty() && records.ring_end.empty());
      return false;
    }
    return true;
  }
  void expect_header_refused(const char* name,
                             const std::function<void(layout::PageHeader&)>& change) const {
    Page page = page_;
    layout::PageHeader h = header();
    change(h);
    set_object(page.bytes, 0, h);
    page.entry = widest(heights_.type, header().records);
    EXPECT_FALSE(is_accepted(page)) << name;
  }
  void expect_excluded(const char* name,
                       const std::function<void(layout::NodeEntry&)>& change) const {
    Page page = page_;
    change(page.entry);
    EXPECT_FALSE(is_accepted(page)) << name;
  }
  /// Changes the bits [at, at + width) of the page.
  void expect_bits_refused(const char* name, std::size_t at, unsigned width,
                           std::uint64_t value) const {
    Page page = page_;
    for (unsigned i = 0; i < width; ++i) {
      std::byte& b = page.bytes[(at + i) / 8];
      const auto bit = static_cast<std::byte>(1U << (at + i) % 8);
      b = (value >> i & 1U) != 0 ? b | bit : b & ~bit;
    }
    page.entry = widest(heights_.type, header().records);
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
  Page page_;
  PageColumns columns_;
};

TEST_F(DamagedPage, IsAcceptedAsLongAsItIsNotDamaged) {
  EXPECT_TRUE(is_accepted(page_));
  Page page = page_;
  page.entry = widest(heights_.type, header().records);
  EXPECT_TRUE(is_accepted(page));
}

TEST_F(DamagedPage, RefusesHeadersThatCannotBe) {
  expect_header_refused("no record", [](auto& h) { h.records = 0; });
  expect_header_refused("fewer records", [](auto& h) { h.records = 1; });
  expect_header_refused("more than fit", [](auto& h) { h.records = 513; });
  expect_header_refused("endless records", [](auto& h) { h.records = UINT16_MAX; });
  for (std::size_t c = 0; c < kPageColumns; ++c) {
    for (const unsigned width : {kMostColumnBits[c] + 1U, 58U, 64U, 255U}) {
      expect_header_refused("width", [=](auto& h) { h.width[c] = std::uint8_t(width); });
    }
  }
  for (const unsigned width : {2U, 16U, 57U, 255U}) {
    expect_header_refused("void bits", [=](auto& h) { h.void_bits = std::uint8_t(width); });
    expect_header_refused("height bits", [=](auto& h) { h.no_height_bits = std::uint8_t(width); });
    expect_header_refused("death bits", [=](auto& h) { h.death_bits = std::uint8_t(width | 16U); });
  }
  expect_header_refused("rings beyond the page", [](auto& h) { h.ring_bytes = 4060; });
  expect_header_refused("rings beyond the page", [](auto& h) { h.ring_bytes = UINT16_MAX; });
  expect_header_refused("no rings", [](auto& h) { h.ring_bytes = 0; });
  expect_header_refused("fewer rings", [](auto& h) { h.ring_bytes -= 1; });
  expect_header_refused("reserved", [](auto& h) { h.reserved[1] = 1; });
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
  expect_header_refused("error", [](auto& h) { h.error = kShortInfinity; });
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
  Page page = page_;
  page.entry = widest(heights_.type, header().records);
  // A column of flags, which the page has none of, takes the place of that of ranks.
  const auto flags = static_cast<std::size_t>(PageColumn::kFlags);
  const auto rank = static_cast<std::size_t>(PageColumn::kRank);
  layout::PageHeader h = header();
  ASSERT_TRUE(h.width[flags] == 0 && h.width[rank] == 1);
  h.width[rank] = 0;
  h.width[flags] = 4;
  ASSERT_TRUE(columns_.read(h, page.bytes.size()));
  std::size_t at = sizeof h;
  for (std::size_t c = 0; c < flags; ++c) {
    at += (2U * h.width[c] + 7) / 8;
  }
  set_object(page.bytes, 0, h);
  for (const unsigned both : {0U, 1U, 2U, 3U, 4U, 8U, 12U}) {
    page.bytes[at] = static_cast<std::byte>(both);
    // With one of the first two the star is open, and goes around more than half of u.
    EXPECT_EQ(is_accepted(page), both == 0) << both;
  }
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
  page_ = packed(records, heights_);
  ASSERT_TRUE(columns_.read(header(), page_.bytes.size()));
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
  page_ = packed(records, heights_);
  ASSERT_TRUE(columns_.read(header(), page_.bytes.size()) && is_accepted(page_));
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
  expect_excluded("more records", [](auto& e) { e.records = 3; });
  expect_excluded("no record", [](auto& e) { e.records = 0; });
}

TEST(RecordPage, RefusesHeightsThatAreNoNumbers) {
  const HeightEncoding heights;
  StarredRecords records;
  VertexSplit r;
  r.u = {5, 5};
  r.height = layout::to_bits(kInfinite);
  add_star(records, r, {{4, 4}, {6, 5}, {5, 6}}, heights);
  Page page = packed(records, heights);
  EXPECT_TRUE(are_same(decoded(page, heights), records));
  auto h = object_at<layout::PageHeader>(page.bytes, 0);
  h.height += 1;
  set_object(page.bytes, 0, h);
  page.entry = widest(heights.type, 1);
  EXPECT_EQ(code_of([&] { static_cast<void>(decoded(page, heights)); }), ErrorCode::corruption);
}

// Any change of a bit: refused, or a page of records that packs to other bytes, which `verify`
// notices, or an honest page of other records.
TEST(RecordPage, SurvivesEachFlippedBit) {
  for (const HeightType type : {HeightType::int32, HeightType::float32}) {
    StrangeRecords strange(type == HeightType::int32 ? 3 : 4, type);
    StarredRecords records;
    for (int i = 0; i < 5; ++i) {
      strange.add_to(records);
    }
    Page page = packed(records, strange.heights());
    page.entry = widest(type, static_cast<std::uint32_t>(page.records));
    std::size_t accepted = 0;
    for (std::size_t bit = 0; bit < page.bytes.size() * 8; ++bit) {
      Page flipped = page;
      flipped.bytes[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
      const auto code = code_of([&] {
        static_cast<void>(packed(decoded(flipped, strange.heights()), strange.heights()));
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
  Page page = packed(records, strange.heights());
  for (int change = *rc::gen::inRange(1, 4); change > 0; --change) {
    const auto at = *rc::gen::inRange<std::size_t>(0, 140);
    page.bytes[at] = *rc::gen::element(std::byte{0}, std::byte{1}, std::byte{31}, std::byte{32},
                                       std::byte{57}, std::byte{127}, std::byte{255});
  }
  page.entry = widest(HeightType::int32, object_at<layout::PageHeader>(page.bytes, 0).records);
  const auto code = code_of([&] { static_cast<void>(decoded(page, strange.heights())); });
  RC_ASSERT(!code || code == ErrorCode::corruption);
}

}  // namespace
}  // namespace ptin::test
