// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/page_packer.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "engine/check.h"
#include "storage/file/checksum.h"
#include "storage/short_float.h"

namespace ptin {

namespace {

constexpr std::size_t at(PageColumn column) { return static_cast<std::size_t>(column); }

/// Bits of a number in two's complement; 0 for 0.
unsigned signed_width(std::int64_t v) {
  return v == 0
             ? 0U
             : static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(v < 0 ? ~v : v))) +
                   1U;
}

std::uint32_t distance(std::int64_t from, std::int64_t to) {
  PTIN_CHECK(from <= to);
  return static_cast<std::uint32_t>(to - from);
}

std::uint32_t page_flags(const VertexSplit& r, bool has_heights) {
  const auto flag = [&](VertexSplit::Flag from, PageFlag to) {
    return (r.flags & from) != 0 ? std::uint32_t{to} : 0U;
  };
  return flag(VertexSplit::kNoLeft, kPageNoLeft) | flag(VertexSplit::kNoRight, kPageNoRight) |
         flag(VertexSplit::kVertexVoid, kPageVertexVoid) |
         (has_heights ? 0U : std::uint32_t{kPageNoHeights});
}

/// Whether w, vl, vr and the classes of (u, w, vl) and (u, vr, w) are those of the ring.
bool agrees(const VertexSplit& r, std::span<const RingCorner> ring) {
  const bool no_left = (r.flags & VertexSplit::kNoLeft) != 0;
  const bool no_right = (r.flags & VertexSplit::kNoRight) != 0;
  const std::size_t last = ring.size() - 1;
  const std::size_t vr = no_left ? last - 1 : last;
  return r.flags <= VertexSplit::kAllFlags && !(no_left && no_right) &&
         r.w == ring[no_left ? last : 0].position && r.vl == ring[no_left ? 0 : 1].position &&
         r.vr == ring[vr].position &&
         ((r.flags & VertexSplit::kLeftVoid) != 0) == (!no_left && ring[0].is_void()) &&
         ((r.flags & VertexSplit::kRightVoid) != 0) == (!no_right && ring[vr].is_void());
}

}  // namespace

PagePacker::PagePacker(std::uint32_t page_bytes, const HeightEncoding& heights, bool is_checked)
    : page_(page_bytes), heights_(heights), is_checked_(is_checked), descriptor_(heights) {
  frame_.least.fill(UINT32_MAX);
  frame_.most.fill(0);
}

/// What add() REQUIRES.
void PagePacker::check(const VertexSplit& r, std::span<const RingCorner> ring) const {
  PTIN_CHECK(ring.size() >= 3 && ring.size() <= layout::kMostDegree && agrees(r, ring));
  PTIN_CHECK(on_grid(r.u) && contains(GridBox{0, 0, kGridMax, kGridMax}, r.roi) &&
             contains(r.roi, r.u) && is_star(r, ring, heights_));
  PTIN_CHECK(r.error >= 0 && shortened(r.error) == r.error && r.deviation >= 0 &&
             shortened(r.deviation) == r.deviation);
  for (const RingCorner& c : ring) {
    PTIN_CHECK(c.death == kLivesOn || (c.death >= 0 && shortened(c.death) == c.death));
  }
}

/// The numbers of a record, and its corners at the end of corners_.
PagePacker::Item PagePacker::item_of(const VertexSplit& r, std::span<const RingCorner> ring) {
  const bool has_heights = heights_.code(r.height_lo) <= heights_.code(r.height_hi);
  const auto ordered = [&](HeightBits h) { return ordered_height(h, heights_.type); };
  PTIN_CHECK(has_heights || !r.has_height());
  const std::uint32_t lo = has_heights ? ordered(r.height_lo) : ordered(0);
  const std::uint32_t hi = has_heights ? ordered(r.height_hi) : lo;
  const std::uint32_t height = r.has_height() ? ordered(r.height) : lo;
  unsigned offset_bits = 0;
  unsigned height_bits = 0;
  unsigned death_bits = 0;
  const std::size_t first = corners_.size();
  for (const RingCorner& c : ring) {
    const RelativeCorner own{std::int64_t{c.position.x} - r.u.x,
                             std::int64_t{c.position.y} - r.u.y,
                             c.has_height() ? std::int64_t{ordered(c.height)} - height : 0,
                             stored_death(c.death, short_bits(r.error)),
                             c.is_void(),
                             c.has_height()};
    offset_bits = std::max({offset_bits, signed_width(own.x), signed_width(own.y)});
    height_bits = std::max(height_bits, signed_width(own.height));
    death_bits = std::max(death_bits, static_cast<unsigned>(std::bit_width(own.death)));
    corners_.push_back(own);
  }
  return {{distance(0, r.u.x), distance(0, r.u.y), height, distance(r.roi.min_x, r.u.x),
           distance(r.roi.min_y, r.u.y), distance(r.u.x, r.roi.max_x), distance(r.u.y, r.roi.max_y),
           distance(lo, height), distance(height, hi), short_bits(r.error), short_bits(r.deviation),
           r.rank, page_flags(r, has_heights), static_cast<std::uint32_t>(ring.size()), offset_bits,
           height_bits, death_bits},
          first};
}

void PagePacker::ShortRange::add(ShortBits bits) noexcept {
  has_infinity |= bits == kShortInfinity;
  if (!is_beside_base(bits)) {
    least = std::min(least, bits);
    most = std::max(most, bits);
  }
}

std::uint32_t PagePacker::ShortRange::most_stored() const noexcept {
  return most != 0 ? stored_short(most, least) : (has_infinity ? 1U : 0U);
}

void PagePacker::widen(Frame& frame, const Item& item) const {
  for (std::size_t c = 0; c < kPageColumns; ++c) {
    frame.least[c] = std::min(frame.least[c], item.numbers[c]);
    frame.most[c] = std::max(frame.most[c], item.numbers[c]);
  }
  frame.error.add(static_cast<ShortBits>(item.numbers[at(PageColumn::kError)]));
  frame.deviation.add(static_cast<ShortBits>(item.numbers[at(PageColumn::kDeviation)]));
  const std::size_t degree = item.numbers[at(PageColumn::kDegree)];
  frame.corners += degree;
  frame.own_bits += degree * (2 * item.numbers[at(PageColumn::kOffsetBits)] +
                              item.numbers[at(PageColumn::kHeightBits)] +
                              item.numbers[at(PageColumn::kDeathBits)]);
  for (std::size_t i = 0; i < degree; ++i) {
    const RelativeCorner& c = corners_[item.first_corner + i];
    frame.has_void |= c.is_void;
    frame.has_no_height |= !c.has_height;
  }
}

layout::PageHeader PagePacker::header_of(const Frame& frame, std::size_t records) const {
  layout::PageHeader h{};
  h.records = static_cast<std::uint16_t>(records);
  const auto least = [&](PageColumn c) { return frame.least[at(c)]; };
  h.x = least(PageColumn::kX);
  h.y = least(PageColumn::kY);
  h.height = least(PageColumn::kHeight);
  h.error = frame.error.base();
  h.deviation = frame.deviation.base();
  h.death_bits = static_cast<std::uint8_t>(least(PageColumn::kDeathBits));
  h.rank = static_cast<std::uint16_t>(least(PageColumn::kRank));
  h.degree = static_cast<std::uint8_t>(least(PageColumn::kDegree));
  h.offset_bits = static_cast<std::uint8_t>(least(PageColumn::kOffsetBits));
  h.height_bits = static_cast<std::uint8_t>(least(PageColumn::kHeightBits));
  const std::array<std::uint32_t, kPageColumns> base = bases_of(h);
  for (std::size_t c = 0; c < kPageColumns; ++c) {
    h.width[c] = static_cast<std::uint8_t>(std::bit_width(frame.most[c] - base[c]));
  }
  const auto set_width = [&](PageColumn c, const ShortRange& range) {
    h.width[at(c)] = static_cast<std::uint8_t>(std::bit_width(range.most_stored()));
  };
  set_width(PageColumn::kError, frame.error);
  set_width(PageColumn::kDeviation, frame.deviation);
  h.void_bits = frame.has_void ? 1 : 0;
  h.no_height_bits = frame.has_no_height ? 1 : 0;
  return h;
}

/// Whether so many records in this frame fit. Each run of rings may leave bits of its last byte.
bool PagePacker::fits(const Frame& frame, std::size_t records) const {
  const layout::PageHeader h = header_of(frame, records);
  const std::size_t common = 0U + h.void_bits + h.no_height_bits;
  const std::size_t runs = records / layout::kRingRun + 1;
  const std::size_t rings = (frame.own_bits + frame.corners * common) / 8 + runs;
  return records <= page_.size() / layout::kLeastRecordBytes &&
         sizeof h + column_bytes(h.width, records) + rings + layout::kPageTailBytes <= page_.size();
}

bool PagePacker::add(const VertexSplit& r, std::span<const RingCorner> ring) {
  if (is_checked_) {
    check(r, ring);
  }
  const std::size_t corners = corners_.size();
  const Item item = item_of(r, ring);
  Frame wider = frame_;
  widen(wider, item);
  if (!fits(wider, items_.size() + 1)) {
    PTIN_CHECK(!items_.empty());
    corners_.resize(corners);
    return false;
  }
  frame_ = wider;
  items_.push_back(item);
  descriptor_.add(r, ring);
  return true;
}

/// Writes the columns, and returns the byte behind them.
std::size_t PagePacker::write_columns(const layout::PageHeader& header) {
  const std::array<std::uint32_t, kPageColumns> base = bases_of(header);
  std::size_t begin = sizeof header;
  for (std::size_t c = 0; c < kPageColumns; ++c) {
    const unsigned width = header.width[c];
    for (std::size_t i = 0; i < items_.size(); ++i) {
      const std::uint32_t number = items_[i].numbers[c];
      std::uint32_t stored = number - base[c];
      if (c == at(PageColumn::kError)) {
        stored = stored_short(static_cast<ShortBits>(number), header.error);
      } else if (c == at(PageColumn::kDeviation)) {
        stored = stored_short(static_cast<ShortBits>(number), header.deviation);
      }
      write_bits(page_.data(), begin * 8 + i * width, width, stored);
    }
    begin += (items_.size() * width + 7) / 8;
  }
  return begin;
}

/// Writes the rings, and before them the places of runs from byte `runs` on.
void PagePacker::write_rings(layout::PageHeader& header, std::size_t runs) {
  const std::size_t count = (items_.size() - 1) / layout::kRingRun + 1;
  const std::size_t rings = runs + count * sizeof(std::uint16_t);
  std::size_t bit = rings * 8;
  const auto put = [&](unsigned width, std::int64_t value) {
    write_bits(page_.data(), bit, width, static_cast<std::uint64_t>(value));
    bit += width;
  };
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const Item& item = items_[i];
    if (i % layout::kRingRun == 0) {
      bit = (bit + 7) / 8 * 8;
      const auto place = static_cast<std::uint16_t>(bit / 8 - rings);
      std::memcpy(page_.data() + runs + i / layout::kRingRun * sizeof place, &place, sizeof place);
    }
    const unsigned offset_bits = item.numbers[at(PageColumn::kOffsetBits)];
    const unsigned height_bits = item.numbers[at(PageColumn::kHeightBits)];
    const unsigned death_bits = item.numbers[at(PageColumn::kDeathBits)];
    for (std::size_t k = 0; k < item.numbers[at(PageColumn::kDegree)]; ++k) {
      const RelativeCorner& c = corners_[item.first_corner + k];
      put(offset_bits, c.x);
      put(offset_bits, c.y);
      put(height_bits, c.height);
      put(death_bits, c.death);
      put(header.void_bits, c.is_void ? 1 : 0);
      put(header.no_height_bits, c.has_height ? 0 : 1);
    }
  }
  header.ring_bytes = static_cast<std::uint16_t>((bit + 7) / 8 - rings);
}

std::span<const std::byte> PagePacker::finish(layout::NodeEntry& entry) {
  PTIN_CHECK(!items_.empty());
  std::fill(page_.begin(), page_.end(), std::byte{0});
  layout::PageHeader header = header_of(frame_, items_.size());
  write_rings(header, write_columns(header));
  std::memcpy(page_.data(), &header, sizeof header);
  entry = descriptor_.entry();
  entry.records = header.records;
  entry.checksum = checksum_of(page_);
  items_.clear();
  corners_.clear();
  frame_ = {};
  frame_.least.fill(UINT32_MAX);
  frame_.most.fill(0);
  descriptor_ = Descriptor(heights_);
  return page_;
}

}  // namespace ptin
