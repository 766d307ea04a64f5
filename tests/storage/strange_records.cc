// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/storage/strange_records.h"

#include <algorithm>
#include <limits>

#include "storage/descriptor.h"
#include "storage/page_packer.h"
#include "storage/record_page.h"
#include "tests/storage/made_star.h"

namespace ptin::test {

namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

}  // namespace

PackedPage packed_page(const StarredRecords& records, const HeightEncoding& heights,
                       std::uint32_t page_bytes) {
  PagePacker packer(page_bytes, heights, {});
  PackedPage page{};
  while (page.records < records.size() &&
         packer.add(records.splits[page.records], records.ring(page.records))) {
    ++page.records;
  }
  const std::span<const std::byte> bytes = packer.finish(page.entry);
  page.bytes.assign(bytes.begin(), bytes.end());
  return page;
}

StarredRecords decoded_page(const PackedPage& page, const HeightEncoding& heights) {
  StarredRecords records;
  RecordPage(kPageName, PageId{0}, page.entry, heights, {}, page.bytes, nullptr).decode(records);
  return records;
}

StrangeRecords::StrangeRecords(std::uint64_t seed, HeightType type) : random_(seed), type_(type) {
  const std::int32_t side = one_of<std::int32_t>({8, 1000, 1 << 20, kGridMax});
  const std::int32_t low = one_of<std::int32_t>({0, kGridMax - side, (kGridMax - side) / 2});
  box_ = {low, low, low + side, low + side};
  least_degree_ = one_of<std::size_t>({3, 3, 3, 240});
}

void StrangeRecords::add_to(StarredRecords& records) {
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

float StrangeRecords::error() {
  const auto any = static_cast<ShortBits>(random_() % (kShortInfinity + 1U));
  return one_of<float>({0.0F, 1.0F, 1.5F, kInfinite, short_value(any)});
}

HeightBits StrangeRecords::height() {
  if (type_ == HeightType::int32) {
    return one_of<HeightBits>(
        {0, 5, 0xFFFFFFFF, 0x80000000, 0x7FFFFFFF, static_cast<HeightBits>(random_())});
  }
  const auto any = static_cast<HeightBits>(random_() % (layout::kInfinityBits + 1U)) |
                   (chance(2) ? 0x80000000U : 0U);
  return one_of<HeightBits>({0, 0x80000000, layout::to_bits(3.5F), layout::to_bits(-3.5F), any});
}

void StrangeRecords::fill_classes(VertexSplit& r, std::vector<RingCorner>& ring) {
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

}  // namespace ptin::test
