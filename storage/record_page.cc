// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/record_page.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "engine/error.h"
#include "storage/bit_fields.h"
#include "storage/box_lanes.h"
#include "storage/descriptor_bounds.h"
#include "storage/layout.h"
#include "storage/ring_check.h"

namespace ptin {

namespace {

[[noreturn]] void throw_corrupt(const std::string& what, const std::string& path, PageId id) {
  throw Error(ErrorCode::corruption, what, path + ", page " + std::to_string(index_of(id)));
}

}  // namespace

void check_descriptor(const std::string& path, PageId id, const layout::NodeEntry& descriptor,
                      const HeightEncoding& heights, std::size_t page_bytes) {
  if (descriptor.records == 0 || descriptor.records > page_bytes / layout::kLeastRecordBytes ||
      !is_sound(descriptor, heights)) [[unlikely]] {
    throw_corrupt("the descriptor of the page holds values that no program wrote", path, id);
  }
}

RecordPage::RecordPage(const std::string& path, PageId id, const layout::NodeEntry& descriptor,
                       const HeightEncoding& heights, std::span<const std::byte> bytes)
    : path_(path), id_(id), descriptor_(descriptor), heights_(heights), bytes_(bytes) {
  check_descriptor(path, id, descriptor, heights, bytes.size());
  layout::PageHeader header;
  std::memcpy(&header, bytes.data(), sizeof header);
  if (!columns_.read(header, bytes.size()) || records() != descriptor.records) [[unlikely]] {
    throw_corrupt(
        "the page begins with numbers that no program wrote, or that its descriptor excludes", path,
        id);
  }
}

void RecordPage::report(std::size_t record) const {
  throw_corrupt("record " + std::to_string(record) +
                    " holds values that no program wrote, or that its page's descriptor excludes",
                path_, id_);
}

void PageRun::read(PageColumn column, std::uint64_t records) noexcept {
  const auto c = static_cast<std::size_t>(column);
  // A run of numbers is taken out four times faster than as many single ones.
  if (4 * static_cast<std::uint32_t>(std::popcount(records)) >= count_) {
    page_.columns().read_run(page_.bytes(), column, first_, std::span(numbers_[c]).first(count_));
    taken_[c] = all();
    return;
  }
  taken_[c] |= records;
  for (; records != 0; records &= records - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(records));
    numbers_[c][k] = page_.columns().at(page_.bytes(), column, first_ + k);
  }
}

bool RecordPage::head(const PageRun& run, std::uint32_t k, VertexSplit& r) const noexcept {
  static_assert(VertexSplit::kNoLeft == kPageNoLeft << 2 &&
                VertexSplit::kNoRight == kPageNoRight << 2 &&
                VertexSplit::kVertexVoid == kPageVertexVoid << 2);
  const auto at = [&](PageColumn c) { return static_cast<std::int64_t>(run.at(c, k)); };
  const std::int64_t x = at(PageColumn::kX), y = at(PageColumn::kY);
  const std::int64_t min_x = x - at(PageColumn::kWest), min_y = y - at(PageColumn::kSouth);
  const std::int64_t max_x = x + at(PageColumn::kEast), max_y = y + at(PageColumn::kNorth);
  const std::int64_t height = at(PageColumn::kHeight);
  const std::int64_t low = height - at(PageColumn::kBelow), high = height + at(PageColumn::kAbove);
  const std::int64_t rank = at(PageColumn::kRank);
  const std::uint64_t flags = run.at(PageColumn::kFlags, k);
  const std::int64_t error = run.error_bits(k), deviation = run.deviation_bits(k);
  const bool has_height = (flags & kPageVertexVoid) == 0;
  const bool has_heights = (flags & kPageNoHeights) == 0;
  constexpr std::uint64_t kBothSides = kPageNoLeft | kPageNoRight;
  const auto [least, most] = ordered_heights(heights_.type);
  // Numbers of columns are not negative and below 2^34. So the sign of one of these differences, and
  // with it that of their bits together, is that of a number beyond its range. Where the roi lies on
  // the grid, u does.
  const std::int64_t beyond = min_x | min_y | (kGridMax - max_x) | (kGridMax - max_y) |
                              (low - least) | (most - high) | (kShortInfinity - error) |
                              (kShortInfinity - deviation) | (UINT16_MAX - rank);
  if ((beyond < 0) | (has_height & !has_heights) | ((flags & kBothSides) == kBothSides)) {
    return false;
  }
  const auto whole = [](std::int64_t v) { return static_cast<std::int32_t>(v); };
  const auto bits = [&](std::int64_t ordered) {
    return height_of_ordered(static_cast<std::uint32_t>(ordered), heights_.type);
  };
  r.u = {whole(x), whole(y)};
  r.roi = {whole(min_x), whole(min_y), whole(max_x), whole(max_y)};
  r.height = has_height ? bits(height) : 0;
  r.height_lo = bits(low);
  r.height_hi = bits(high);
  if (!has_heights) {
    r.height_lo = no_heights(heights_.type).lo;
    r.height_hi = no_heights(heights_.type).hi;
  }
  r.error = short_value(static_cast<ShortBits>(error));
  r.deviation = short_value(static_cast<ShortBits>(deviation));
  r.rank = static_cast<std::uint16_t>(rank);
  r.flags = static_cast<std::uint16_t>((flags & (kBothSides | kPageVertexVoid)) << 2);
  return true;
}

/// Finds the ring of a record: from `place`, where that is in the same run of rings and not behind
/// it, else from the begin of the run. False when the ring cannot be one, or would not lie where
/// rings lie.
bool RecordPage::find(const PageRun& run, std::uint32_t k, RingPlace& place) const noexcept {
  const std::size_t i = run.first() + k;
  if (place.record == i) {
    return place.is_sound;
  }
  const auto shape_of = [&](std::size_t record) -> RingShape {
    const auto at = [&](PageColumn c) {
      return static_cast<unsigned>(run.at(c, static_cast<std::uint32_t>(record - run.first())));
    };
    const unsigned offset_bits = at(PageColumn::kOffsetBits);
    const unsigned height_bits = at(PageColumn::kHeightBits);
    const unsigned death_bits = at(PageColumn::kDeathBits);
    return {at(PageColumn::kDegree), offset_bits, height_bits, death_bits,
            2 * offset_bits + height_bits + death_bits + columns_.common_bits()};
  };
  const std::size_t rings = i / layout::kRingRun;
  if (place.record > i || place.record < rings * layout::kRingRun) {
    place.record = rings * layout::kRingRun;
    place.bit = columns_.run_begin(bytes_.data(), rings);
    place.shape = shape_of(place.record);
  }
  while (place.record < i) {
    place.bit += place.shape.bits();
    place.shape = shape_of(++place.record);
  }
  const RingShape& shape = place.shape;
  place.is_sound =
      is_ring_shape(shape.degree, shape.offset_bits, shape.height_bits, shape.death_bits) &&
      place.bit + shape.bits() <= columns_.rings_end();
  return place.is_sound;
}

/// Where a corner lies from u, x in the lower half, modulo 2^32 each.
std::uint64_t RecordPage::corner_offset(const RingShape& shape, std::size_t bit) const noexcept {
  const unsigned width = shape.offset_bits;
  std::int64_t x, y;
  if (2 * width <= kMostFieldBits && width != 0) [[likely]] {
    std::uint64_t both;  // and what follows
    std::memcpy(&both, bytes_.data() + bit / 8, sizeof both);
    both >>= bit % 8;
    // Up to the highest bit and down again, which spreads the sign.
    x = static_cast<std::int64_t>(both << (64 - width)) >> (64 - width);
    y = static_cast<std::int64_t>(both << (64 - 2 * width)) >> (64 - width);
  } else {
    x = with_sign(read_bits(bytes_.data(), bit, width), width);
    y = with_sign(read_bits(bytes_.data(), bit + width, width), width);
  }
  return static_cast<std::uint32_t>(x) | static_cast<std::uint64_t>(y) << 32;
}

bool RecordPage::is_void(const RingShape& shape, std::size_t bit) const noexcept {
  const layout::PageHeader& h = columns_.header();
  const std::size_t at = bit + 2 * shape.offset_bits + shape.height_bits + shape.death_bits;
  return read_bits(bytes_.data(), at, h.void_bits) != 0;
}

/// Takes corner after corner apart. A corner takes up to 112 bits, nearly always fewer than 57: then
/// one load gets all of it.
template <class Visit>
void RecordPage::for_each_corner(const RingPlace& place, const Visit& visit) const {
  const layout::PageHeader& h = columns_.header();
  const RingShape shape = place.shape;
  const auto fields = [&](const auto& take) {
    RelativeCorner c;
    c.x = with_sign(take(shape.offset_bits), shape.offset_bits);
    c.y = with_sign(take(shape.offset_bits), shape.offset_bits);
    c.height = with_sign(take(shape.height_bits), shape.height_bits);
    c.death = static_cast<std::uint32_t>(take(shape.death_bits));
    c.is_void = take(h.void_bits) != 0;
    c.has_height = take(h.no_height_bits) == 0;
    return c;
  };
  std::size_t bit = place.bit;
  if (shape.corner_bits <= kMostFieldBits) [[likely]] {
    for (unsigned k = 0; k < shape.degree; ++k, bit += shape.corner_bits) {
      std::uint64_t bits = read_bits(bytes_.data(), bit, shape.corner_bits);
      visit(k, fields([&](unsigned width) {
              const std::uint64_t field = bits & ((std::uint64_t{1} << width) - 1);
              bits >>= width;
              return field;
            }));
    }
    return;
  }
  for (unsigned k = 0; k < shape.degree; ++k) {
    visit(k, fields([&](unsigned width) {
            const std::uint64_t field = read_bits(bytes_.data(), bit, width);
            bit += width;
            return field;
          }));
  }
}

/// The vertices of a split and the classes of its sides, from the ring of a record whose head is `r`.
bool RecordPage::ends_of(const RingPlace& place, VertexSplit& r) const noexcept {
  const RingShape& shape = place.shape;
  const bool no_left = (r.flags & VertexSplit::kNoLeft) != 0;
  const bool no_right = (r.flags & VertexSplit::kNoRight) != 0;
  const std::size_t last = shape.degree - 1;
  const auto bit_of = [&](std::size_t k) { return place.bit + k * shape.corner_bits; };
  const std::uint64_t w = corner_offset(shape, bit_of(no_left ? last : 0));
  const std::uint64_t vl = corner_offset(shape, bit_of(no_left ? 0 : 1));
  const std::uint64_t vr = corner_offset(shape, bit_of(no_left ? last - 1 : last));
  const auto own = std::bit_cast<std::uint64_t>(r.u);
  const lanes::Int4 w_and_vl = lanes::sum(lanes::pair(own, own), lanes::pair(w, vl));
  const lanes::Int4 twice_vr = lanes::sum(lanes::pair(own, own), lanes::pair(vr, vr));
  const auto roi = lanes::load<lanes::Int4>(&r.roi);
  const lanes::Int4 low = lanes::lower_twice(roi), high = lanes::upper_twice(roi);
  const lanes::Int4 outside =
      (w_and_vl < low) | (w_and_vl > high) | (twice_vr < low) | (twice_vr > high);
  using TwoPoints = std::array<GridPoint, 2>;
  const auto [w_point, vl_point] = std::bit_cast<TwoPoints>(w_and_vl);
  r.w = w_point;
  r.vl = vl_point;
  r.vr = std::bit_cast<TwoPoints>(twice_vr)[0];
  if (columns_.header().void_bits != 0) {
    const bool left_void = !no_left && is_void(shape, bit_of(0));
    const bool right_void = !no_right && is_void(shape, bit_of(no_left ? last - 1 : last));
    r.flags = static_cast<std::uint16_t>(unsigned{r.flags} |
                                         (left_void ? unsigned{VertexSplit::kLeftVoid} : 0U) |
                                         (right_void ? unsigned{VertexSplit::kRightVoid} : 0U));
  }
  return !lanes::any(outside) & (w != 0) & (vl != 0) & (vr != 0);
}

// One function without calls: a refinement decodes little else, and to call the three for each record
// takes a tenth of its time.
[[gnu::flatten]] bool RecordPage::split(const PageRun& run, std::uint32_t k, RingPlace& place,
                                        VertexSplit& r) const noexcept {
  return head(run, k, r) && find(run, k, place) && ends_of(place, r);
}

namespace {

void widen(RingSpan& span, std::int64_t x, std::int64_t y) noexcept {
  span.min_x = std::min(span.min_x, x);
  span.max_x = std::max(span.max_x, x);
  span.min_y = std::min(span.min_y, y);
  span.max_y = std::max(span.max_y, y);
}

bool contains(const GridBox& box, const RingSpan& span) noexcept {
  return box.min_x <= span.min_x && span.max_x <= box.max_x && box.min_y <= span.min_y &&
         span.max_y <= box.max_y;
}

}  // namespace

bool RecordPage::ring(const PageRun& run, std::uint32_t k, RingPlace& place, const VertexSplit& r,
                      std::vector<RingCorner>& out, RingSpan& span) const {
  if (!find(run, k, place)) {
    return false;
  }
  const unsigned degree = place.shape.degree;
  const OrderedInterval own = run.heights(k);
  const auto height = static_cast<std::int64_t>(own.height);
  const std::uint32_t error = short_bits(r.error);
  const bool is_closed = has_closed_ring(r);
  RingCheck check(r.has_height());
  const std::size_t first = out.size();
  out.resize(first + degree);
  RingCorner* const ring = out.data() + first;
  span = {};
  bool is_sound = true;
  for_each_corner(place, [&](unsigned n, const RelativeCorner& c) {
    check.add(c);
    widen(span, r.u.x + c.x, r.u.y + c.y);
    const std::int64_t ordered = height + c.height;
    const std::uint32_t below = c.death < kFirstAboveBase ? error : c.death - kFirstAboveBase;
    // A death above 0 that is written as one at 0 would be there in two forms.
    is_sound &=
        (ordered >= 0) & (ordered <= UINT32_MAX) & ((c.death < kFirstAboveBase) | (below < error));
    const auto known = static_cast<std::uint32_t>(ordered);
    span.low = c.has_height ? std::min(span.low, known) : span.low;
    span.high = c.has_height ? std::max(span.high, known) : span.high;
    const bool is_triangle = is_closed || n + 1 < degree;
    is_sound &= is_triangle | (c.death == 0);
    const std::uint32_t death = c.death == 0 ? 0 : error - below + 1;  // as death_bits()
    span.least_death = is_triangle ? std::min(span.least_death, death) : span.least_death;
    ring[n] = {{static_cast<std::int32_t>(r.u.x + c.x), static_cast<std::int32_t>(r.u.y + c.y)},
               c.has_height ? height_of_ordered(known, heights_.type) : 0,
               c.death == 0 ? kLivesOn : short_value(static_cast<ShortBits>(error - below)),
               static_cast<std::uint8_t>((c.is_void ? unsigned{RingCorner::kVoid} : 0U) |
                                         (c.has_height ? 0U : unsigned{RingCorner::kNoHeight}))};
  });
  const bool has_heights = (run.at(PageColumn::kFlags, k) & kPageNoHeights) == 0;
  const bool is_within =
      span.low > span.high || (has_heights && own.low <= span.low && span.high <= own.high);
  return is_sound && is_within && contains(r.roi, span) &&
         (is_closed ? check.is_closed_ring() : check.is_open_ring());
}

bool RecordPage::admits(const VertexSplit& r, const RingSpan& span) const noexcept {
  const layout::NodeEntry& d = descriptor_;
  const std::uint32_t lo = ordered_height(d.star_height_lo, heights_.type);
  const std::uint32_t hi = ordered_height(d.star_height_hi, heights_.type);
  const std::uint32_t own = ordered_height(r.height, heights_.type);
  return d.star_min_x <= std::min<std::int64_t>(span.min_x, r.u.x) &&
         d.star_min_y <= std::min<std::int64_t>(span.min_y, r.u.y) &&
         std::max<std::int64_t>(span.max_x, r.u.x) <= d.star_max_x &&
         std::max<std::int64_t>(span.max_y, r.u.y) <= d.star_max_y &&
         (!r.has_height() || (lo <= own && own <= hi)) &&
         (span.low > span.high || (lo <= span.low && span.high <= hi)) &&
         d.death_min <= span.least_death;
}

/// @param bounds     Those of the descriptor.
/// @param predicate  Null: all records are wanted. Those of a page of which all are, are not asked
///                   for their attributes one by one.
template <class Bounds>
void RecordPage::decode_within(const Bounds& bounds, const AttributePredicate* predicate,
                               std::vector<VertexSplit>& out) const {
  const bool wants_all =
      predicate == nullptr || predicate->holds_for_all(attributes_of(descriptor_, heights_),
                                                       short_value(descriptor_.error_min));
  const GridBox reach = wants_all ? GridBox{} : predicate->reach();
  const std::size_t before = out.size();
  RingPlace place;
  for (PageRun run(*this); run.next();) {
    run.take_all();
    for (std::uint32_t k = 0; k < run.count(); ++k) {
      if (!wants_all) {
        const Attributes a = run.attributes(k);
        if (!meets(a.roi, reach) || !predicate->holds(a)) {
          continue;
        }
      }
      VertexSplit r;
      if (!split(run, k, place, r) || bounds.excludes(r)) [[unlikely]] {
        out.resize(before);
        report(run.first() + k);
      }
      out.push_back(r);
    }
  }
}

void RecordPage::decode(std::vector<VertexSplit>& out) const {
  heights_.type == HeightType::int32
      ? decode_within(DescriptorBounds<std::int32_t>(descriptor_), nullptr, out)
      : decode_within(DescriptorBounds<float>(descriptor_), nullptr, out);
}

void RecordPage::decode_matching(const AttributePredicate& predicate,
                                 std::vector<VertexSplit>& out) const {
  heights_.type == HeightType::int32
      ? decode_within(DescriptorBounds<std::int32_t>(descriptor_), &predicate, out)
      : decode_within(DescriptorBounds<float>(descriptor_), &predicate, out);
}

void RecordPage::decode(StarredRecords& out) const {
  const std::size_t before = out.size();
  decode(out.splits);
  RingPlace place;
  RingSpan span;
  for (PageRun run(*this); run.next();) {
    run.take_all();
    for (std::uint32_t k = 0; k < run.count(); ++k) {
      const VertexSplit& r = out.splits[before + run.first() + k];
      if (!ring(run, k, place, r, out.corners, span) || !admits(r, span)) [[unlikely]] {
        out.resize(before);
        report(run.first() + k);
      }
      out.ring_end.push_back(static_cast<std::uint32_t>(out.corners.size()));
    }
  }
}

}  // namespace ptin
