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

PagePacker::PagePacker(std::uint32_t page_bytes, const HeightEncoding& heights,
                       const PageForm& form, Packing packing)
    : page_(page_bytes),
      heights_(heights),
      form_(form),
      packing_(packing),
      descriptor_(heights),
      frame_(empty_frame()) {}

PagePacker::Frame PagePacker::empty_frame() const {
  Frame frame;
  frame.least.fill(UINT32_MAX);
  frame.most.fill(0);
  frame.is_local = !form_.is_plain() && form_.has_floor;
  return frame;
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
  std::uint32_t height = r.has_height() ? ordered(r.height) : lo;
  PTIN_CHECK(lo <= height && height <= hi);
  const KeptInterval kept = form_.is_plain() ? KeptInterval{0, height - lo, hi - height}
                                             : kept_interval({height, lo, hi});
  if (!r.has_height() && has_heights) {
    // It stands for the least of the interval as that is kept.
    height = static_cast<std::uint32_t>(
        interval_of(height, kept.shift, kept.below, kept.above, heights_.type).low);
  }
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
           kept.below, kept.above, short_bits(r.error), short_bits(r.deviation), r.rank,
           page_flags(r, has_heights), static_cast<std::uint32_t>(ring.size()), offset_bits,
           height_bits, death_bits, kept.shift},
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
                              item.numbers[at(PageColumn::kDeathBits)]);
  frame.height_bits += degree * item.numbers[at(PageColumn::kHeightBits)];
  const GridPoint u{static_cast<std::int32_t>(item.numbers[at(PageColumn::kX)]),
                    static_cast<std::int32_t>(item.numbers[at(PageColumn::kY)])};
  frame.vertices = united(frame.vertices, u);
  for (std::size_t i = 0; i < degree; ++i) {
    const RelativeCorner& c = corners_[item.first_corner + i];
    frame.has_void |= c.is_void;
    frame.has_no_height |= !c.has_height;
    frame.vertices = united(frame.vertices, GridPoint{static_cast<std::int32_t>(u.x + c.x),
                                                      static_cast<std::int32_t>(u.y + c.y)});
  }
  constexpr std::uint32_t kNoHeight = kPageVertexVoid | kPageNoHeights;
  frame.is_local = frame.is_local && !frame.has_no_height &&
                   (item.numbers[at(PageColumn::kFlags)] & kNoHeight) == 0 &&
                   is_local_box(frame.vertices);
}

layout::PageHeader PagePacker::header_of(const Frame& frame, std::size_t records) const {
  layout::PageHeader h{};
  h.records = static_cast<std::uint16_t>(records);
  const auto least = [&](PageColumn c) { return frame.least[at(c)]; };
  h.x = least(PageColumn::kX);
  h.y = least(PageColumn::kY);
  h.height = frame.is_local ? 0 : least(PageColumn::kHeight);
  h.error = frame.error.base();
  h.deviation = frame.deviation.base();
  h.death_bits = static_cast<std::uint8_t>(least(PageColumn::kDeathBits));
  h.rank = static_cast<std::uint16_t>(least(PageColumn::kRank));
  h.degree = static_cast<std::uint8_t>(least(PageColumn::kDegree));
  h.offset_bits = static_cast<std::uint8_t>(least(PageColumn::kOffsetBits));
  h.height_bits =
      frame.is_local ? std::uint8_t{0} : static_cast<std::uint8_t>(least(PageColumn::kHeightBits));
  // No number of its width may stand for a shift above the most, so a base may be below the least number.
  const auto shift_width = static_cast<unsigned>(
      std::bit_width(frame.most[at(PageColumn::kShift)] - least(PageColumn::kShift)));
  h.shift = static_cast<std::uint8_t>(
      std::min(least(PageColumn::kShift), kMostShift + 1 - (1U << shift_width)));
  const std::array<std::uint32_t, kPageColumns> base = bases_of(h);
  const auto width = [&](std::size_t c) {
    return static_cast<std::uint8_t>(std::bit_width(frame.most[c] - base[c]));
  };
  for (std::size_t c = 0; c < h.width.size(); ++c) {
    h.width[c] = width(c);
  }
  h.shift_width = width(at(PageColumn::kShift));
  const auto set_width = [&](PageColumn c, const ShortRange& range) {
    h.width[at(c)] = static_cast<std::uint8_t>(std::bit_width(range.most_stored()));
  };
  set_width(PageColumn::kError, frame.error);
  set_width(PageColumn::kDeviation, frame.deviation);
  if (frame.is_local) {
    h.width[at(PageColumn::kHeight)] = 0;
    h.width[at(PageColumn::kHeightBits)] = 0;
    h.flags = layout::kLocalPage;
  }
  h.void_bits = frame.has_void ? 1 : 0;
  h.no_height_bits = frame.has_no_height ? 1 : 0;
  return h;
}

/// Errors that descend: from the greatest down, each above its lower bits.
void PagePacker::put_errors(const Frame& frame, Plan& plan) const {
  const std::uint32_t first = frame.most[at(PageColumn::kError)];
  const ErrorsCode code =
      code_of_errors(first - frame.least[at(PageColumn::kError)], plan.header.records);
  plan.header.error = static_cast<std::uint16_t>(first);
  plan.header.width[at(PageColumn::kError)] = static_cast<std::uint8_t>(code.low_bits);
  plan.place_bits = code.place_bits;
  plan.bytes += error_place_bytes(plan.header.records, code.place_bits);
}

PagePacker::Plan PagePacker::plan_of(const Frame& frame, std::size_t records) const {
  Plan plan;
  plan.header = header_of(frame, records);
  if (!form_.is_plain()) {
    put_errors(frame, plan);
  }
  const std::size_t common = 0U + plan.header.void_bits + plan.header.no_height_bits;
  const std::size_t own = frame.own_bits + (frame.is_local ? 0 : frame.height_bits);
  // Each run of rings may leave bits of its last byte.
  const std::size_t runs = records / layout::kRingRun + 1;
  plan.bytes += sizeof plan.header + column_bytes(widths_of(plan.header), records) +
                (own + frame.corners * common) / 8 + runs + layout::kPageTailBytes;
  return plan;
}

/// Whether so many records in this frame fit.
bool PagePacker::fits(const Frame& frame, std::size_t records) const {
  return records <= page_.size() / layout::kLeastRecordBytes &&
         plan_of(frame, records).bytes <= page_.size();
}

/// Whether a record that makes this frame of the page's may join it.
bool PagePacker::may_join(const Frame& wider) const {
  if (items_.empty()) {
    return true;
  }
  if (!fits(wider, items_.size() + 1)) {
    return false;
  }
  // A local page stays one, unless it is not yet half full: what it would take with its heights is
  // less than what is lost by ending it.
  return wider.is_local == frame_.is_local || packing_ == Packing::kAgain ||
         2 * plan_of(wider, items_.size() + 1).bytes <= page_.size();
}

bool PagePacker::add(const VertexSplit& r, std::span<const RingCorner> ring) {
  if (packing_ == Packing::kNew) {
    check(r, ring);
  }
  const std::size_t corners = corners_.size();
  const Item item = item_of(r, ring);
  Frame wider = frame_;
  widen(wider, item);
  if (!may_join(wider)) {
    corners_.resize(corners);
    return false;
  }
  PTIN_CHECK(fits(wider, items_.size() + 1));
  frame_ = wider;
  items_.push_back(item);
  descriptor_.add(as_kept(r, item), ring);
  return true;
}

/// A record with the interval of heights that the page keeps.
VertexSplit PagePacker::as_kept(const VertexSplit& r, const Item& item) const {
  VertexSplit kept = r;
  if ((item.numbers[at(PageColumn::kFlags)] & kPageNoHeights) == 0) {
    const OrderedInterval h = interval_of(
        item.numbers[at(PageColumn::kHeight)], item.numbers[at(PageColumn::kShift)],
        item.numbers[at(PageColumn::kBelow)], item.numbers[at(PageColumn::kAbove)], heights_.type);
    kept.height_lo = height_of_ordered(static_cast<std::uint32_t>(h.low), heights_.type);
    kept.height_hi = height_of_ordered(static_cast<std::uint32_t>(h.high), heights_.type);
  }
  return kept;
}

/// The number that a column holds of a record.
std::uint32_t PagePacker::stored(std::size_t column, std::size_t item,
                                 const layout::PageHeader& header) const {
  const std::uint32_t number = items_[item].numbers[column];
  if (column == at(PageColumn::kError)) {
    // The lower bits alone are written of a difference.
    return form_.is_plain() ? stored_short(static_cast<ShortBits>(number), header.error)
                            : header.error - number;
  }
  if (column == at(PageColumn::kDeviation)) {
    return stored_short(static_cast<ShortBits>(number), header.deviation);
  }
  return number - bases_of(header)[column];
}

/// Writes the columns, and returns the byte behind them.
std::size_t PagePacker::write_columns(const layout::PageHeader& header) {
  const std::array<std::uint8_t, kPageColumns> widths = widths_of(header);
  std::size_t begin = sizeof header;
  for (std::size_t c = 0; c < kPageColumns; ++c) {
    for (std::size_t i = 0; widths[c] != 0 && i < items_.size(); ++i) {
      write_bits(page_.data(), begin * 8 + i * widths[c], widths[c], stored(c, i, header));
    }
    begin += (items_.size() * widths[c] + 7) / 8;
  }
  return begin;
}

/// Writes the upper parts of errors that descend from byte `begin` on, and returns the byte behind them.
std::size_t PagePacker::write_errors(const Plan& plan, std::size_t begin) {
  const std::size_t places = begin + error_place_bytes(items_.size(), 0);
  const auto put_place = [&](std::size_t run, std::size_t place) {
    const auto kept = static_cast<std::uint16_t>(place);
    std::memcpy(page_.data() + begin + run * sizeof kept, &kept, sizeof kept);
  };
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const std::uint32_t below = plan.header.error - items_[i].numbers[at(PageColumn::kError)];
    const std::size_t place = i + (below >> plan.header.width[at(PageColumn::kError)]);
    write_bits(page_.data(), places * 8 + place, 1, 1);
    if (i % layout::kErrorRun == 0) {
      put_place(i / layout::kErrorRun, place);
    }
  }
  put_place((items_.size() - 1) / layout::kErrorRun + 1, plan.place_bits);
  return begin + error_place_bytes(items_.size(), plan.place_bits);
}

/// Writes the rings from byte `rings` on, and the places of runs from byte `runs` on.
void PagePacker::write_rings(layout::PageHeader& header, std::size_t runs, std::size_t rings) {
  const bool is_local = (header.flags & layout::kLocalPage) != 0;
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
    const unsigned height_bits = is_local ? 0 : item.numbers[at(PageColumn::kHeightBits)];
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
  if (!form_.is_plain()) {
    // Those of one error stay in the order in which they came.
    std::ranges::stable_sort(items_, std::ranges::greater(),
                             [](const Item& item) { return item.numbers[at(PageColumn::kError)]; });
  }
  Plan plan = plan_of(frame_, items_.size());
  const std::size_t runs = write_columns(plan.header);
  std::size_t rings = runs + ((items_.size() - 1) / layout::kRingRun + 1) * sizeof(std::uint16_t);
  if (!form_.is_plain()) {
    rings = write_errors(plan, rings);
  }
  write_rings(plan.header, runs, rings);
  std::memcpy(page_.data(), &plan.header, sizeof plan.header);
  entry = descriptor_.entry();
  entry.records = plan.header.records;
  entry.checksum = checksum_of(page_);
  items_.clear();
  corners_.clear();
  frame_ = empty_frame();
  descriptor_ = Descriptor(heights_);
  return page_;
}

}  // namespace ptin
