// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/record_page.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "engine/geometry/infinity.h"
#include "storage/bit_fields.h"
#include "storage/descriptor.h"
#include "storage/layout.h"
#include "storage/ring_check.h"

namespace ptin {

RecordPage::RecordPage(std::span<const std::byte> bytes, const HeightEncoding& heights) noexcept
    : bytes_(bytes), heights_(heights) {
  layout::PageHeader header;
  if (bytes.size() >= layout::kMinPageBytes) {
    std::memcpy(&header, bytes.data(), sizeof header);
    is_sound_ = columns_.read(header, bytes.size());
  }
}

GridBox RecordPage::roi(std::size_t i) const noexcept {
  // Columns hold at most 32 bits, so sums fit 64. What leaves the grid is cut down to 32 bits, and
  // lies off the grid still, or is found to be no roi of u.
  const auto at = [&](PageColumn c) { return static_cast<std::int64_t>(number(c, i)); };
  const std::int64_t x = at(PageColumn::kX);
  const std::int64_t y = at(PageColumn::kY);
  const auto whole = [](std::int64_t v) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, INT32_MIN, INT32_MAX));
  };
  return {whole(x - at(PageColumn::kWest)), whole(y - at(PageColumn::kSouth)),
          whole(x + at(PageColumn::kEast)), whole(y + at(PageColumn::kNorth))};
}

/// The records of a run whose roi meets a box: the roi is looked at where u lies outside of the box,
/// but no farther from it than any roi of the page reaches.
std::uint64_t RecordPage::near_box(std::uint32_t first, std::uint32_t count,
                                   const GridBox& box) const noexcept {
  const auto reach = [&](PageColumn c) {
    return static_cast<std::int64_t>(
        (std::uint64_t{1} << columns_.header().width[static_cast<std::size_t>(c)]) - 1);
  };
  const std::int64_t low_x = box.min_x - reach(PageColumn::kEast);
  const std::int64_t high_x = box.max_x + reach(PageColumn::kWest);
  const std::int64_t low_y = box.min_y - reach(PageColumn::kNorth);
  const std::int64_t high_y = box.max_y + reach(PageColumn::kSouth);
  Run xs, ys;  // NOLINT: written before read
  read_run(PageColumn::kX, first, count, xs);
  read_run(PageColumn::kY, first, count, ys);
  std::uint64_t near = 0;
  std::uint64_t within = 0;  // u lies in the box
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto x = static_cast<std::int64_t>(xs[k]);
    const auto y = static_cast<std::int64_t>(ys[k]);
    const bool is_near = (low_x <= x) & (x <= high_x) & (low_y <= y) & (y <= high_y);
    const bool is_within =
        (box.min_x <= x) & (x <= box.max_x) & (box.min_y <= y) & (y <= box.max_y);
    near |= std::uint64_t{is_near} << k;
    within |= std::uint64_t{is_within} << k;
  }
  for (std::uint64_t left = near & ~within; left != 0; left &= left - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
    near ^= std::uint64_t{!meets(roi(first + k), box)} << k;
  }
  return near;
}

/// The records of a run whose heights may be those that a filter asks for.
std::uint64_t RecordPage::with_heights(std::uint32_t first, std::uint32_t count,
                                       const StarFilter& filter) const noexcept {
  Run heights, below, above, flags;  // NOLINT: written before read
  read_run(PageColumn::kHeight, first, count, heights);
  read_run(PageColumn::kBelow, first, count, below);
  read_run(PageColumn::kAbove, first, count, above);
  read_run(PageColumn::kFlags, first, count, flags);
  const auto code = [&](std::uint64_t ordered) {
    return heights_.code(height_of_ordered(static_cast<std::uint32_t>(ordered), heights_.type));
  };
  std::uint64_t wanted = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    const Interval codes = (flags[k] & kPageNoHeights) != 0
                               ? Interval{}
                               : Interval{code(heights[k] - below[k]), code(heights[k] + above[k])};
    wanted |= std::uint64_t{meets(codes, filter.heights)} << k;
  }
  return wanted;
}

/// The records of a run within whose heights a step lies. A record without heights spans none.
std::uint64_t RecordPage::with_steps(std::uint32_t first, std::uint32_t count,
                                     std::span<const std::uint64_t> steps) const noexcept {
  Run low, high, above;  // NOLINT: written before read
  read_run(PageColumn::kHeight, first, count, high);
  read_run(PageColumn::kBelow, first, count, low);
  read_run(PageColumn::kAbove, first, count, above);
  std::uint64_t least = UINT64_MAX;
  std::uint64_t most = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    low[k] = high[k] - low[k];
    high[k] += above[k];
    least = std::min(least, low[k]);
    most = std::max(most, high[k]);
  }
  std::uint64_t wanted = 0;
  for (const std::uint64_t step : steps_within(steps, least, most)) {
    for (std::uint32_t k = 0; k < count; ++k) {
      wanted |= static_cast<std::uint64_t>((low[k] < step) & (step <= high[k])) << k;
    }
  }
  return wanted;
}

std::uint64_t RecordPage::near_stars(std::uint32_t first, std::uint32_t count,
                                     const StarFilter& filter, bool is_within) const noexcept {
  std::uint64_t wanted =
      is_within ? ~std::uint64_t{0} >> (kRun - count) : near_box(first, count, filter.box);
  if (wanted != 0 && filter.heights != kAllHeights) {
    wanted &= with_heights(first, count, filter);
  }
  if (wanted != 0 && !filter.steps.empty()) {
    wanted &= with_steps(first, count, filter.steps);
  }
  for (std::uint64_t left = filter.also_of_stars ? wanted : 0; left != 0; left &= left - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
    const StarAttributes star{roi(first + k), {}, kInfinity, -kInfinity};
    wanted ^= std::uint64_t{!filter.also->may_hold(star)} << k;
  }
  const std::int64_t below = level_bits(filter.level) - (filter.with_ties ? 1 : 0);
  for (std::uint64_t left = wanted; left != 0 && below >= 0; left &= left - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
    wanted ^= std::uint64_t{static_cast<std::int64_t>(error_bits(first + k)) <= below} << k;
  }
  return wanted;
}

void RecordPage::read_run(std::uint32_t first, std::uint32_t count, RecordRun& run) const noexcept {
  run.first = first;
  run.count = count;
  for (std::size_t c = 0; c < kPageColumns; ++c) {
    read_run(static_cast<PageColumn>(c), first, count, run.numbers[c]);
  }
}

Attributes RecordPage::attributes(const RecordRun& run, std::uint32_t k) const noexcept {
  const auto at = [&](PageColumn c) { return run.numbers[static_cast<std::size_t>(c)][k]; };
  const auto code = [&](std::uint64_t ordered) {
    return heights_.code(height_of_ordered(static_cast<std::uint32_t>(ordered), heights_.type));
  };
  const auto bound = [](std::uint64_t stored, ShortBits base) {
    return static_cast<double>(short_value(static_cast<ShortBits>(short_of_stored(stored, base))));
  };
  const auto whole = [](std::uint64_t v) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(v));
  };
  const std::uint64_t height = at(PageColumn::kHeight);
  Attributes a;
  a.roi = {whole(at(PageColumn::kX) - at(PageColumn::kWest)),
           whole(at(PageColumn::kY) - at(PageColumn::kSouth)),
           whole(at(PageColumn::kX) + at(PageColumn::kEast)),
           whole(at(PageColumn::kY) + at(PageColumn::kNorth))};
  if ((at(PageColumn::kFlags) & kPageNoHeights) == 0) {
    a.heights = {code(height - at(PageColumn::kBelow)), code(height + at(PageColumn::kAbove))};
  }
  a.error = bound(at(PageColumn::kError), columns_.header().error);
  a.deviation = bound(at(PageColumn::kDeviation), columns_.header().deviation);
  return a;
}

/// The head of a record whose numbers are at(column).
template <class NumberOf>
inline bool RecordPage::head_of(const NumberOf& at, VertexSplit& r) const noexcept {
  static_assert(VertexSplit::kNoLeft == kPageNoLeft << 2 &&
                VertexSplit::kNoRight == kPageNoRight << 2 &&
                VertexSplit::kVertexVoid == kPageVertexVoid << 2);
  const std::uint64_t x = at(PageColumn::kX);
  const std::uint64_t y = at(PageColumn::kY);
  // Numbers of 33 bits at most, and those that wrap around are the largest ones.
  const std::uint64_t west = x - at(PageColumn::kWest);
  const std::uint64_t south = y - at(PageColumn::kSouth);
  const std::uint64_t east = x + at(PageColumn::kEast);
  const std::uint64_t north = y + at(PageColumn::kNorth);
  const std::uint64_t flags = at(PageColumn::kFlags);
  const std::uint64_t rank = at(PageColumn::kRank);
  const std::uint32_t error = short_of_stored(at(PageColumn::kError), columns_.header().error);
  const std::uint32_t deviation =
      short_of_stored(at(PageColumn::kDeviation), columns_.header().deviation);
  const std::uint64_t height = at(PageColumn::kHeight);
  const std::uint64_t low = height - at(PageColumn::kBelow);
  const std::uint64_t high = height + at(PageColumn::kAbove);
  const bool has_height = (flags & kPageVertexVoid) == 0;
  const bool has_heights = (flags & kPageNoHeights) == 0;
  constexpr std::uint64_t kBothSides = kPageNoLeft | kPageNoRight;
  const auto [least, most] = ordered_heights(heights_.type);
  constexpr std::uint64_t kEnd = kGridMax;
  if ((x > kEnd) | (y > kEnd) | (west > kEnd) | (south > kEnd) | (east > kEnd) | (north > kEnd) |
      (low > height) | (low < least) | (high > most) | (error > kShortInfinity) |
      (deviation > kShortInfinity) | (rank > UINT16_MAX) | (has_height & !has_heights) |
      ((flags & kBothSides) == kBothSides)) {
    return false;
  }
  const auto bits = [&](std::uint64_t ordered) {
    return height_of_ordered(static_cast<std::uint32_t>(ordered), heights_.type);
  };
  r.u = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
  r.roi = {static_cast<std::int32_t>(west), static_cast<std::int32_t>(south),
           static_cast<std::int32_t>(east), static_cast<std::int32_t>(north)};
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

bool RecordPage::head(std::size_t i, VertexSplit& r) const noexcept {
  return head_of([&](PageColumn c) { return number(c, i); }, r);
}

template <class NumberOf>
inline RingShape RecordPage::shape_of(const NumberOf& at) const noexcept {
  const auto degree = static_cast<unsigned>(at(PageColumn::kDegree));
  const auto offset_bits = static_cast<unsigned>(at(PageColumn::kOffsetBits));
  const auto height_bits = static_cast<unsigned>(at(PageColumn::kHeightBits));
  const auto death_bits = static_cast<unsigned>(at(PageColumn::kDeathBits));
  return {degree, offset_bits, height_bits, death_bits,
          2 * offset_bits + height_bits + death_bits + columns_.common_bits()};
}

/// Finds the ring of record i: from `place`, where that is in the same run and not behind it, else
/// from the begin of the run. False when the ring cannot be one, or would not lie where rings lie.
/// @param shape  Tells the shape of a record's ring.
template <class ShapeOf>
inline bool RecordPage::find(std::size_t i, RingPlace& place,
                             const ShapeOf& shape_of_record) const noexcept {
  if (place.record == i) {
    return place.is_sound;
  }
  const std::size_t run = i / layout::kRingRun;
  if (place.record > i || place.record < run * layout::kRingRun) {
    place.record = run * layout::kRingRun;
    place.bit = columns_.run_begin(bytes_.data(), run);
    place.shape = shape_of_record(place.record);
  }
  while (place.record < i) {
    place.bit += place.shape.bits();
    place.shape = shape_of_record(++place.record);
  }
  const RingShape& shape = place.shape;
  place.is_sound =
      is_ring_shape(shape.degree, shape.offset_bits, shape.height_bits, shape.death_bits) &&
      place.bit + shape.bits() <= columns_.rings_end();
  return place.is_sound;
}

bool RecordPage::find(std::size_t i, RingPlace& place) const noexcept {
  return find(i, place, [this](std::size_t record) {
    return shape_of([&](PageColumn c) { return number(c, record); });
  });
}

inline GridPoint RecordPage::corner_position(GridPoint u, const RingShape& shape,
                                             std::size_t bit) const noexcept {
  const unsigned width = shape.offset_bits;
  std::uint64_t x, y;
  if (2 * width <= kMostFieldBits) [[likely]] {
    const std::uint64_t both = read_bits(bytes_.data(), bit, 2 * width);
    x = both & ((std::uint64_t{1} << width) - 1);
    y = both >> width;
  } else {
    x = read_bits(bytes_.data(), bit, width);
    y = read_bits(bytes_.data(), bit + width, width);
  }
  return {static_cast<std::int32_t>(u.x + with_sign(x, width)),
          static_cast<std::int32_t>(u.y + with_sign(y, width))};  // 2^30 + 2^31 at most
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
    StoredCorner c;
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
inline bool RecordPage::ends_of(const RingPlace& place, VertexSplit& r) const noexcept {
  const RingShape& shape = place.shape;
  const bool no_left = (r.flags & VertexSplit::kNoLeft) != 0;
  const bool no_right = (r.flags & VertexSplit::kNoRight) != 0;
  const std::size_t last = shape.degree - 1;
  const auto bit_of = [&](std::size_t k) { return place.bit + k * shape.corner_bits; };
  r.w = corner_position(r.u, shape, bit_of(no_left ? last : 0));
  r.vl = corner_position(r.u, shape, bit_of(no_left ? 0 : 1));
  r.vr = corner_position(r.u, shape, bit_of(no_left ? last - 1 : last));
  if (columns_.header().void_bits != 0) {
    const bool left_void = !no_left && is_void(shape, bit_of(0));
    const bool right_void = !no_right && is_void(shape, bit_of(no_left ? last - 1 : last));
    r.flags = static_cast<std::uint16_t>(unsigned{r.flags} |
                                         (left_void ? unsigned{VertexSplit::kLeftVoid} : 0U) |
                                         (right_void ? unsigned{VertexSplit::kRightVoid} : 0U));
  }
  return contains(r.roi, r.w) && contains(r.roi, r.vl) && contains(r.roi, r.vr) && r.w != r.u &&
         r.vl != r.u && r.vr != r.u;
}

bool RecordPage::split(std::size_t i, RingPlace& place, VertexSplit& r) const noexcept {
  return head(i, r) && find(i, place) && ends_of(place, r);
}

bool RecordPage::split(const RecordRun& run, std::uint32_t k, RingPlace& place,
                       VertexSplit& r) const noexcept {
  const auto at = [&](std::size_t j) {
    return [&run, j](PageColumn c) { return run.numbers[static_cast<std::size_t>(c)][j]; };
  };
  // Runs begin where runs of rings begin, so every record that find() looks at is in this one.
  static_assert(kRun % layout::kRingRun == 0);
  return head_of(at(k), r) &&
         find(run.first + k, place,
              [&](std::size_t record) { return shape_of(at(record - run.first)); }) &&
         ends_of(place, r);
}

bool RecordPage::may_live(std::size_t i, RingPlace& place, std::int32_t level) const noexcept {
  if (!find(i, place)) {
    return true;
  }
  const RingShape& shape = place.shape;
  // 0 lives on, 1 dies at error 0, and from `first` on deaths are at or below the level.
  const std::uint32_t all_below = level < 0 ? 0 : 1;
  const std::uint32_t first =
      level < 0 ? UINT32_MAX : error_bits(i) - static_cast<std::uint32_t>(level) + kFirstAboveBase;
  const std::uint64_t border = number(PageColumn::kFlags, i) & (kPageNoLeft | kPageNoRight);
  const unsigned triangles = shape.degree - (border == 0 ? 0 : 1);
  std::size_t bit = place.bit + 2 * shape.offset_bits + shape.height_bits;
  bool lives = false;
  for (unsigned k = 0; k < triangles; ++k, bit += shape.corner_bits) {
    const auto death = static_cast<std::uint32_t>(read_bits(bytes_.data(), bit, shape.death_bits));
    lives |= (death <= all_below) | (death >= first);
  }
  return lives;
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

bool RecordPage::ring(std::size_t i, RingPlace& place, const VertexSplit& r,
                      std::vector<RingCorner>& out, RingSpan& span) const {
  if (!find(i, place)) {
    return false;
  }
  const unsigned degree = place.shape.degree;
  const auto height = static_cast<std::int64_t>(number(PageColumn::kHeight, i));
  const std::uint32_t error = short_bits(r.error);
  const bool is_closed = has_closed_ring(r);
  RingCheck check((r.flags & VertexSplit::kVertexVoid) == 0);
  const std::size_t first = out.size();
  out.resize(first + degree);
  RingCorner* const ring = out.data() + first;
  span = {};
  bool is_sound = true;
  for_each_corner(place, [&](unsigned k, const StoredCorner& c) {
    check.add({c.x, c.y, c.has_height, c.is_void});
    widen(span, r.u.x + c.x, r.u.y + c.y);
    const std::int64_t ordered = height + c.height;
    const std::uint32_t below = c.death < kFirstAboveBase ? error : c.death - kFirstAboveBase;
    // A death above 0 that is written as one at 0 would be there in two forms.
    is_sound &=
        (ordered >= 0) & (ordered <= UINT32_MAX) & ((c.death < kFirstAboveBase) | (below < error));
    const auto known = static_cast<std::uint32_t>(ordered);
    span.low = c.has_height ? std::min(span.low, known) : span.low;
    span.high = c.has_height ? std::max(span.high, known) : span.high;
    const bool is_triangle = is_closed || k + 1 < degree;
    is_sound &= is_triangle | (c.death == 0);
    const std::uint32_t death = c.death == 0 ? 0 : error - below + 1;  // as death_bits()
    span.least_death = is_triangle ? std::min(span.least_death, death) : span.least_death;
    ring[k] = {{static_cast<std::int32_t>(r.u.x + c.x), static_cast<std::int32_t>(r.u.y + c.y)},
               c.has_height ? height_of_ordered(known, heights_.type) : 0,
               c.death == 0 ? kLivesOn : short_value(static_cast<ShortBits>(error - below)),
               static_cast<std::uint8_t>((c.is_void ? unsigned{RingCorner::kVoid} : 0U) |
                                         (c.has_height ? 0U : unsigned{RingCorner::kNoHeight}))};
  });
  const bool has_heights = (number(PageColumn::kFlags, i) & kPageNoHeights) == 0;
  const bool is_within =
      span.low > span.high ||
      (has_heights &&
       height - static_cast<std::int64_t>(number(PageColumn::kBelow, i)) <= span.low &&
       span.high <= height + static_cast<std::int64_t>(number(PageColumn::kAbove, i)));
  return is_sound && is_within && contains(r.roi, span) &&
         (is_closed ? check.is_closed_ring() : check.is_open_ring());
}

}  // namespace ptin
