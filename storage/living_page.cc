// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/living_page.h"

#include <algorithm>
#include <bit>

#include "storage/bit_fields.h"
#include "storage/descriptor.h"
#include "storage/page_columns.h"
#include "storage/short_float.h"

namespace ptin {

/// Where the rings of a run's records lie, and what their corners are made of. Widths may be any,
/// until is_sound() is asked.
struct LivingPage::Shapes {
  using Column = std::array<std::uint64_t, kRun>;
  Column degree, offset_bits, height_bits, death_bits, bit;  // NOLINT: written before read
  Column living;  ///< Bit i: triangle i lives. Of the first 64.
  unsigned common_bits;

  [[nodiscard]] std::uint64_t corner_bits(std::uint32_t k) const noexcept {
    return 2 * offset_bits[k] + height_bits[k] + death_bits[k] + common_bits;
  }
  [[nodiscard]] std::uint64_t end(std::uint32_t k) const noexcept {
    return bit[k] + degree[k] * corner_bits(k);
  }
  [[nodiscard]] bool is_sound(std::uint32_t k, std::size_t rings_end) const noexcept {
    return is_ring_shape(degree[k], offset_bits[k], height_bits[k], death_bits[k]) &&
           end(k) <= rings_end;
  }
};

namespace {

/// The records of one run of rings, as bits of a run of records.
constexpr std::uint64_t kOneRingRun = (std::uint64_t{1} << layout::kRingRun) - 1;

}  // namespace

/// The other numbers of a run's records, as far as a living triangle needs them.
struct LivingPage::Heads {
  static constexpr std::array kColumns{
      PageColumn::kX,     PageColumn::kY,     PageColumn::kHeight, PageColumn::kBelow,
      PageColumn::kAbove, PageColumn::kError, PageColumn::kFlags,  PageColumn::kDeviation};
  std::array<std::array<std::uint64_t, kRun>, kPageColumns> column;  // NOLINT

  [[nodiscard]] std::int64_t at(PageColumn c, std::uint32_t k) const noexcept {
    return static_cast<std::int64_t>(column[static_cast<std::size_t>(c)][k]);
  }
};

struct LivingPage::Corner {
  std::int64_t x, y;  ///< From u.
  std::int64_t height;
  std::uint32_t death;
  bool is_void, has_height;
};

/// A star with what its corners are held against.
struct LivingPage::Star {
  LivingStar star;
  std::uint32_t error;     ///< Short bits.
  bool is_closed;          ///< As has_closed_ring().
  std::int64_t height;     ///< Ordered; of u, or what the corners' heights are told from.
  std::int64_t low, high;  ///< Of the corners, at most.
};

/// Takes the corners of a ring apart. A corner takes up to 112 bits, nearly always fewer than 57:
/// then one load gets all of it.
class LivingPage::Corners {
 public:
  Corners(const Shapes& shapes, std::uint32_t k, const layout::PageHeader& h) noexcept
      : offset_(static_cast<unsigned>(shapes.offset_bits[k])),
        height_(static_cast<unsigned>(shapes.height_bits[k])),
        death_(static_cast<unsigned>(shapes.death_bits[k])),
        void_(h.void_bits),
        no_height_(h.no_height_bits) {}

  [[nodiscard]] Corner at(const std::byte* bytes, std::size_t bit) const noexcept {
    if (2 * offset_ + height_ + death_ + void_ + no_height_ > kMostFieldBits) [[unlikely]] {
      return fields([&](unsigned width) {
        const std::uint64_t field = read_bits(bytes, bit, width);
        bit += width;
        return field;
      });
    }
    std::uint64_t word = read_bits(bytes, bit, kMostFieldBits);
    return fields([&](unsigned width) {
      const std::uint64_t field = word & ((std::uint64_t{1} << width) - 1);
      word >>= width;
      return field;
    });
  }

 private:
  template <class Take>
  [[nodiscard]] Corner fields(const Take& take) const noexcept {
    Corner c;
    c.x = with_sign(take(offset_), offset_);
    c.y = with_sign(take(offset_), offset_);
    c.height = with_sign(take(height_), height_);
    c.death = static_cast<std::uint32_t>(take(death_));
    c.is_void = take(void_) != 0;
    c.has_height = take(no_height_) == 0;
    return c;
  }
  unsigned offset_, height_, death_, void_, no_height_;
};

LivingPage::LivingPage(const RecordPage& page, const layout::NodeEntry& d,
                       const HeightEncoding& heights, const StarFilter& filter) noexcept
    : page_(page),
      descriptor_(d),
      heights_(heights),
      filter_(filter),
      level_(level_bits(filter.level)),
      is_within_(contains(filter.box, {d.star_min_x, d.star_min_y, d.star_max_x, d.star_max_y})),
      low_(ordered_height(d.height_lo, heights.type)),
      high_(ordered_height(d.height_hi, heights.type)),
      star_low_(ordered_height(d.star_height_lo, heights.type)),
      star_high_(ordered_height(d.star_height_hi, heights.type)),
      no_heights_(no_heights(heights.type)),
      steps_(steps_within(filter.steps, ordered_height(d.star_height_lo, heights.type),
                          ordered_height(d.star_height_hi, heights.type))) {}

std::uint32_t LivingPage::take(LivingStars& out) const {
  Shapes shapes;  // NOLINT: written before read
  Heads heads;    // NOLINT: written before read
  Star star;
  for (std::uint32_t first = 0; first < page_.records(); first += kRun) {
    const std::uint32_t count = std::min(kRun, page_.records() - first);
    std::uint64_t left = page_.near_stars(first, count, filter_, is_within_);
    if (left == 0) {
      continue;
    }
    read_shapes(first, count, left, shapes);
    left = find_living(first, left, shapes);
    read_heads(first, count, left, heads);
    for (; left != 0; left &= left - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
      if (!shapes.is_sound(k, page_.columns().rings_end()) || !read_star(heads, k, star) ||
          !take_star(shapes, star, k, out)) [[unlikely]] {
        return first + k;
      }
    }
  }
  return page_.records();
}

/// Reads the shapes of the runs of rings that hold a wanted record.
void LivingPage::read_shapes(std::uint32_t first, std::uint32_t count, std::uint64_t wanted,
                             Shapes& out) const noexcept {
  const PageColumns& columns = page_.columns();
  const std::byte* const bytes = page_.bytes();
  out.common_bits = columns.common_bits();
  for (std::uint32_t begin = 0; begin < count; begin += layout::kRingRun) {
    if ((wanted >> begin & kOneRingRun) == 0) {
      continue;
    }
    const std::uint32_t end = std::min(begin + layout::kRingRun, count);
    const auto read = [&](PageColumn c, Shapes::Column& column) {
      columns.read_run(bytes, c, first + begin, std::span(column).subspan(begin, end - begin));
    };
    read(PageColumn::kDegree, out.degree);
    read(PageColumn::kOffsetBits, out.offset_bits);
    read(PageColumn::kHeightBits, out.height_bits);
    read(PageColumn::kDeathBits, out.death_bits);
    out.bit[begin] = columns.run_begin(bytes, (first + begin) / layout::kRingRun);
    for (std::uint32_t k = begin + 1; k < end; ++k) {
      out.bit[k] = out.end(k - 1);
    }
  }
}

/// Whether a triangle of a star of this error lives, by its death as it is stored.
bool LivingPage::lives(std::uint32_t death, std::uint32_t error) const noexcept {
  // 0 lives on, 1 dies at error 0; else it dies death - kFirstAboveBase below the error.
  return level_ < 0 ? death == 0
                    : death < kFirstAboveBase ||
                          error + kFirstAboveBase <= death + static_cast<std::uint32_t>(level_);
}

/// Those of the wanted records of a run of whose stars a triangle lives, and those that are not
/// sound.
std::uint64_t LivingPage::find_living(std::uint32_t first, std::uint64_t wanted,
                                      Shapes& shapes) const noexcept {
  const std::size_t rings_end = page_.columns().rings_end();
  std::uint64_t result = 0;
  for (std::uint64_t left = wanted; left != 0; left &= left - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
    if (!shapes.is_sound(k, rings_end)) {
      result |= std::uint64_t{1} << k;
      continue;
    }
    const auto width = static_cast<unsigned>(shapes.death_bits[k]);
    if (width == 0) {  // all live on
      shapes.living[k] =
          shapes.degree[k] < 64 ? (std::uint64_t{1} << shapes.degree[k]) - 1 : ~std::uint64_t{0};
      result |= std::uint64_t{1} << k;
      continue;
    }
    const std::uint32_t error = level_ < 0 ? 0 : page_.error_bits(first + k);
    const std::uint64_t step = shapes.corner_bits(k);
    std::size_t bit = shapes.bit[k] + 2 * shapes.offset_bits[k] + shapes.height_bits[k];
    std::uint64_t living = 0;
    // Of an open ring the last corner has no triangle: take_star() knows.
    for (std::uint64_t i = 0; i < shapes.degree[k]; ++i, bit += step) {
      const bool is_one =
          lives(static_cast<std::uint32_t>(read_bits(page_.bytes(), bit, width)), error);
      living |= std::uint64_t{is_one} << (i % 64);
    }
    shapes.living[k] = living;
    result |= std::uint64_t{living != 0} << k;
  }
  return result;
}

void LivingPage::read_heads(std::uint32_t first, std::uint32_t count, std::uint64_t wanted,
                            Heads& out) const noexcept {
  // A run of numbers is unpacked four times faster than as many single ones.
  const bool are_many = 4 * static_cast<std::uint32_t>(std::popcount(wanted)) >= count;
  for (const PageColumn c : Heads::kColumns) {
    std::array<std::uint64_t, kRun>& column = out.column[static_cast<std::size_t>(c)];
    if (are_many) {
      page_.columns().read_run(page_.bytes(), c, first, std::span(column).first(count));
      continue;
    }
    for (std::uint64_t left = wanted; left != 0; left &= left - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
      column[k] = page_.columns().at(page_.bytes(), c, first + k);
    }
  }
}

/// A star without its corners. False when it cannot be one.
bool LivingPage::read_star(const Heads& heads, std::uint32_t k, Star& out) const noexcept {
  const auto at = [&](PageColumn c) { return heads.at(c, k); };
  const layout::PageHeader& h = page_.columns().header();
  const layout::NodeEntry& d = descriptor_;
  const std::int64_t x = at(PageColumn::kX);
  const std::int64_t y = at(PageColumn::kY);
  const auto flags = static_cast<unsigned>(at(PageColumn::kFlags));
  const bool has_heights = (flags & kPageNoHeights) == 0;
  const auto deviation =
      short_of_stored(static_cast<std::uint64_t>(at(PageColumn::kDeviation)), h.deviation);
  out.error = short_of_stored(static_cast<std::uint64_t>(at(PageColumn::kError)), h.error);
  out.height = at(PageColumn::kHeight);
  out.low = out.height - at(PageColumn::kBelow);
  out.high = out.height + at(PageColumn::kAbove);
  out.is_closed = (flags & (kPageNoLeft | kPageNoRight)) == 0;
  out.star.has_height = (flags & kPageVertexVoid) == 0;
  // The descriptor's boxes lie on the grid, and its heights are none but heights.
  if (x < d.star_min_x || y < d.star_min_y || x > d.star_max_x || y > d.star_max_y ||
      (has_heights && (out.low < low_ || out.high > high_)) ||
      (out.star.has_height &&
       (!has_heights || out.height < star_low_ || out.height > star_high_)) ||
      out.error < d.error_min || out.error > d.error_max || deviation > d.deviation_max) {
    return false;
  }
  out.star.u = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
  const auto bits = [&](std::int64_t ordered) {
    return height_of_ordered(static_cast<std::uint32_t>(ordered), heights_.type);
  };
  out.star.height = out.star.has_height ? bits(out.height) : 0;
  out.star.height_lo = has_heights ? bits(out.low) : no_heights_.lo;
  out.star.height_hi = has_heights ? bits(out.high) : no_heights_.hi;
  out.star.deviation = short_value(static_cast<ShortBits>(deviation));
  out.low = std::max(out.low, star_low_);
  out.high = has_heights ? std::min(out.high, star_high_) : -1;  // no corner has one
  return true;
}

bool LivingPage::take_star(const Shapes& shapes, const Star& star, std::uint32_t k,
                           LivingStars& out) const {
  const std::size_t begin = out.corners.size();
  return (is_plain(shapes, star, k) ? take_plain(shapes, star, k, out)
                                    : take_any(shapes, star, k, out)) &&
         add(star, begin, out);
}

/// Whether a star is as nearly all are: nothing is void around it, and a load gets a corner.
bool LivingPage::is_plain(const Shapes& shapes, const Star& star, std::uint32_t k) const noexcept {
  return shapes.degree[k] < 64 && shapes.corner_bits(k) <= kMostFieldBits &&
         shapes.common_bits == 0 && star.is_closed && star.star.has_height;
}

/// Appends the corners of what lives of such a star. False when one cannot be what was written.
bool LivingPage::take_plain(const Shapes& shapes, const Star& star, std::uint32_t k,
                            LivingStars& out) const {
  const layout::NodeEntry& d = descriptor_;
  const std::uint64_t step = shapes.corner_bits(k);
  const auto offset_bits = static_cast<unsigned>(shapes.offset_bits[k]);
  const auto height_bits = static_cast<unsigned>(shapes.height_bits[k]);
  const std::uint64_t offset_mask = (std::uint64_t{1} << offset_bits) - 1;
  const std::uint64_t height_mask = (std::uint64_t{1} << height_bits) - 1;
  const std::uint64_t living = shapes.living[k];
  const std::size_t begin = out.corners.size();
  out.corners.grow(begin + shapes.degree[k] + 1);
  LivingCorner* to = out.corners.data() + begin;
  std::int64_t outside = 0;  // negative as soon as a corner is
  const auto take = [&](unsigned i) {
    const std::uint64_t word = read_bits(page_.bytes(), shapes.bit[k] + i * step, kMostFieldBits);
    const std::int64_t x = star.star.u.x + with_sign(word & offset_mask, offset_bits);
    const std::int64_t y =
        star.star.u.y + with_sign((word >> offset_bits) & offset_mask, offset_bits);
    const std::int64_t height =
        star.height + with_sign((word >> (2 * offset_bits)) & height_mask, height_bits);
    outside |= (x - d.star_min_x) | (d.star_max_x - x) | (y - d.star_min_y) | (d.star_max_y - y) |
               (height - star.low) | (star.high - height);
    *to++ = {{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)},
             height_of_ordered(static_cast<std::uint32_t>(height), heights_.type),
             static_cast<std::uint8_t>((living >> i & 1) * LivingCorner::kLives)};
  };
  const std::uint64_t ends = living << 1;
  const std::uint64_t around = std::uint64_t{1} << shapes.degree[k];
  for (std::uint64_t left = (living | ends) & ~around; left != 0; left &= left - 1) {
    take(static_cast<unsigned>(std::countr_zero(left)));
  }
  if ((ends & around) != 0) {
    take(0);
    to[-1].flags = 0;
  }
  out.corners.grow(static_cast<std::size_t>(to - out.corners.data()));
  return outside >= 0;
}

/// As take_plain(), for any star.
bool LivingPage::take_any(const Shapes& shapes, const Star& star, std::uint32_t k,
                          LivingStars& out) const {
  const layout::NodeEntry& d = descriptor_;
  const auto degree = static_cast<std::uint32_t>(shapes.degree[k]);
  const Corners corners(shapes, k, page_.columns().header());
  const std::size_t begin = out.corners.size();
  out.corners.grow(begin + degree + 1);
  LivingCorner* to = out.corners.data() + begin;
  bool is_awaited = false;  // The corner before lives, if this one is the end of its triangle.
  bool is_inside = true;
  std::size_t bit = shapes.bit[k];
  for (std::uint32_t i = 0; i < degree || (i == degree && is_awaited); ++i) {
    const Corner c = corners.at(page_.bytes(), i == degree ? shapes.bit[k] : bit);
    bit += shapes.corner_bits(k);
    const bool is_wanted = i + (star.is_closed ? 0 : 1) < degree && lives(c.death, star.error);
    if (is_awaited || is_wanted) {
      const std::int64_t x = star.star.u.x + c.x;
      const std::int64_t y = star.star.u.y + c.y;
      const std::int64_t height = star.height + c.height;
      is_inside = is_inside && d.star_min_x <= x && x <= d.star_max_x && d.star_min_y <= y &&
                  y <= d.star_max_y &&
                  (!c.has_height || (star.low <= height && height <= star.high));
      *to++ = {
          {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)},
          c.has_height ? height_of_ordered(static_cast<std::uint32_t>(height), heights_.type) : 0,
          static_cast<std::uint8_t>((is_wanted ? unsigned{LivingCorner::kLives} : 0U) |
                                    (c.is_void ? unsigned{LivingCorner::kVoid} : 0U) |
                                    (c.has_height ? 0U : unsigned{LivingCorner::kNoHeight}))};
    }
    is_awaited = is_wanted;
  }
  out.corners.grow(static_cast<std::size_t>(to - out.corners.data()));
  return is_inside;
}

namespace {

/// Twice the area of a triangle. REQUIRES: its corners are on the grid, else it may be any number.
std::int64_t turn(GridPoint u, GridPoint a, GridPoint b) noexcept {
  return (std::int64_t{a.x} - u.x) * (std::int64_t{b.y} - u.y) -
         (std::int64_t{a.y} - u.y) * (std::int64_t{b.x} - u.x);
}

}  // namespace

/// Whether a step lies within the heights of a star whose corners were appended from `begin` on.
bool LivingPage::has_step(const Star& star, std::size_t begin,
                          const LivingStars& out) const noexcept {
  if (!star.star.has_height) {
    return false;
  }
  std::uint32_t low = ordered_height(star.star.height, heights_.type);
  std::uint32_t high = low;
  for (std::size_t i = begin; i < out.corners.size(); ++i) {
    const LivingCorner& c = out.corners.data()[i];
    if ((c.flags & LivingCorner::kNoHeight) == 0) {
      const std::uint32_t height = ordered_height(c.height, heights_.type);
      low = std::min(low, height);
      high = std::max(high, height);
    }
  }
  return !steps_within(steps_, low, high).empty();
}

/// Appends a star whose corners were appended from `begin` on, unless it is not asked for by its
/// heights, or none of its triangles meets the filter's box. False when a triangle cannot be what was written.
bool LivingPage::add(const Star& star, std::size_t begin, LivingStars& out) const {
  if (!filter_.steps.empty() && !has_step(star, begin, out)) {
    out.corners.grow(begin);
    return true;
  }
  bool is_sound = true;
  bool any = false;
  LivingCorner* const end = out.corners.data() + out.corners.size();
  for (LivingCorner* c = out.corners.data() + begin; c < end; ++c) {
    if ((c->flags & LivingCorner::kLives) == 0) {
      continue;
    }
    const bool has_heights =
        star.star.has_height && ((c[0].flags | c[1].flags) & LivingCorner::kNoHeight) == 0;
    is_sound &= (turn(star.star.u, c[0].position, c[1].position) > 0) &
                (has_heights || (c->flags & LivingCorner::kVoid) != 0);
    const bool is_met =
        is_within_ ||
        meets(united(united(box_of(star.star.u), c[0].position), c[1].position), filter_.box);
    c->flags &= static_cast<std::uint8_t>(is_met ? ~0U : ~unsigned{LivingCorner::kLives});
    any |= is_met;
  }
  if (!any) {
    out.corners.grow(begin);
    return is_sound;
  }
  const std::size_t stars = out.stars.size();
  out.stars.grow(stars + 1);
  out.stars.data()[stars] = star.star;
  out.stars.data()[stars].corner_end = static_cast<std::uint32_t>(out.corners.size());
  return is_sound;
}

}  // namespace ptin
