// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/living_page.h"

#include <array>
#include <bit>
#include <cstddef>

#include "engine/query/living/star_choice.h"
#include "storage/bit_fields.h"
#include "storage/descriptor.h"
#include "storage/page_columns.h"
#include "storage/short_float.h"

namespace ptin {

namespace {

constexpr std::uint32_t kRun = PageRun::kMost;
/// The records of one run of rings, as bits of a run of records.
constexpr std::uint64_t kOneRingRun = (std::uint64_t{1} << layout::kRingRun) - 1;

/// Where the rings of a run's records lie, and what their corners are made of. Widths may be any,
/// until is_sound() is asked.
struct Shapes {
  using Column = std::array<std::uint64_t, kRun>;
  Column degree, offset_bits, height_bits, death_bits, bit;  // NOLINT: written before read
  Column living;  ///< Bit i: triangle i of the first 64 lives.
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

struct Corner {
  std::int64_t x, y;  ///< From u.
  std::int64_t height;
  std::uint32_t death;
  bool is_void, has_height;
};

/// A star with what its corners are held against.
struct PageStar {
  LivingStar star;
  std::uint32_t error;     ///< Short bits.
  bool is_closed;          ///< As has_closed_ring().
  std::int64_t height;     ///< Ordered; of u, or what the corners' heights are relative to.
  std::int64_t low, high;  ///< Limits of the corners' heights.
};

/// Takes the corners of a ring apart. A corner takes up to 114 bits, nearly always at most 57: then
/// one load gets all of it.
class Corners {
 public:
  Corners(const Shapes& shapes, std::uint32_t k, const layout::PageHeader& h) noexcept
      : offset_(static_cast<unsigned>(shapes.offset_bits[k])),
        height_(static_cast<unsigned>(shapes.height_bits[k])),
        death_(static_cast<unsigned>(shapes.death_bits[k])),
        void_(h.void_bits),
        no_height_(h.no_height_bits) {}

  [[nodiscard]] Corner at(const std::byte* bytes, std::size_t bit) const noexcept {
    // No single field has more than 33 bits (kMostHeightWidth), so one load gets each by itself.
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

/// Takes out of a page what a filter asks for.
class LivingPage {
 public:
  LivingPage(const RecordPage& page, const LivingFilter& filter) noexcept;

  /// Returns records(), or the first record that cannot be what was written, or that the descriptor
  /// excludes: then what was appended is not to be used.
  [[nodiscard]] std::uint32_t take(LivingStars& out) const;

 private:
  void read_shapes(const PageRun& run, std::uint64_t wanted, Shapes& out) const noexcept;
  [[nodiscard]] std::uint64_t find_living(PageRun& run, std::uint64_t wanted, Shapes& shapes) const;
  [[nodiscard]] bool lives(std::uint32_t death, std::uint32_t error) const noexcept;
  [[nodiscard]] bool is_tie(std::uint32_t death, std::uint32_t error) const noexcept;
  [[nodiscard]] bool has_no_more(const PageRun& run) const noexcept;
  [[nodiscard]] bool read_star(const PageRun& run, std::uint32_t k, PageStar& out) const noexcept;
  [[nodiscard]] bool read_heights(PageRun& run, std::uint32_t k, PageStar& out) const;
  [[nodiscard]] bool take_star(PageRun& run, const Shapes& shapes, std::uint32_t k, PageStar& star,
                               LivingStars& out) const;
  [[nodiscard]] bool is_plain(const Shapes& shapes, const PageStar& star,
                              std::uint32_t k) const noexcept;
  template <bool kIsLocal>
  [[nodiscard]] bool take_plain(const Shapes& shapes, const PageStar& star, std::uint32_t k,
                                LivingStars& out) const;
  [[nodiscard]] bool take_any(const Shapes& shapes, const PageStar& star, std::uint32_t k,
                              LivingStars& out) const;
  [[nodiscard]] bool look_up(const PageStar& star, std::size_t begin, LivingStars& out) const;
  [[nodiscard]] bool has_step(const PageStar& star, std::size_t begin,
                              const LivingStars& out) const noexcept;
  [[nodiscard]] bool meet_box(const PageStar& star, std::size_t begin, LivingStars& out) const;
  [[nodiscard]] bool are_heights_sound(const PageStar& star, std::size_t begin,
                                       const LivingStars& out) const noexcept;

  const RecordPage& page_;
  const layout::NodeEntry& descriptor_;
  HeightType type_;
  const LivingFilter& filter_;
  std::int32_t level_;
  bool is_within_;  ///< All stars lie in the filter's box.
  /// The heights of vertices are looked up, once a triangle of theirs is known to meet the box.
  bool is_local_;
  std::int64_t low_, high_, star_low_, star_high_;  ///< Heights of the descriptor, ordered.
  HeightInterval no_heights_;
  std::span<const std::uint64_t> steps_;  ///< Those of the filter that lie within the page.
};

LivingPage::LivingPage(const RecordPage& page, const LivingFilter& filter) noexcept
    : page_(page),
      descriptor_(page.descriptor()),
      type_(page.heights().type),
      filter_(filter),
      level_(level_bits(filter.level)),
      is_within_(contains(filter.box, {descriptor_.star_min_x, descriptor_.star_min_y,
                                       descriptor_.star_max_x, descriptor_.star_max_y})),
      is_local_(page.columns().is_local()),
      low_(ordered_height(descriptor_.height_lo, type_)),
      high_(ordered_height(descriptor_.height_hi, type_)),
      star_low_(ordered_height(descriptor_.star_height_lo, type_)),
      star_high_(ordered_height(descriptor_.star_height_hi, type_)),
      no_heights_(no_heights(type_)),
      steps_(steps_within(filter.steps, ordered_height(descriptor_.star_height_lo, type_),
                          ordered_height(descriptor_.star_height_hi, type_))) {}

std::uint32_t LivingPage::take(LivingStars& out) const {
  // The numbers of a star beside its shape, as far as a living triangle needs them.
  constexpr std::array kHead{PageColumn::kX, PageColumn::kY, PageColumn::kError, PageColumn::kFlags,
                             PageColumn::kDeviation};
  Shapes shapes;  // NOLINT: written before read
  PageStar star;
  for (PageRun run(page_); run.next();) {
    if (has_no_more(run)) {
      break;
    }
    std::uint64_t left = chosen_stars(page_, filter_, is_within_, run);
    if (left == 0) {
      continue;
    }
    read_shapes(run, left, shapes);
    left = find_living(run, left, shapes);
    // Deaths were looked at first: other numbers are taken only for the stars that are left.
    for (const PageColumn c : kHead) {
      run.take_some(c, left);
    }
    if (!is_local_) {
      run.take_heights(left);
    }
    if (filter_.with_ties) {
      run.take_some(PageColumn::kRank, left);
    }
    for (; left != 0; left &= left - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
      // The first record that cannot be ends all: what was appended of the page is dropped with it.
      if (!shapes.is_sound(k, page_.columns().rings_end()) || !read_star(run, k, star) ||
          !take_star(run, shapes, k, star, out)) [[unlikely]] {
        return run.first() + k;
      }
    }
  }
  return page_.records();
}

/// Whether errors descend, and none is above the level from a run on.
bool LivingPage::has_no_more(const PageRun& run) const noexcept {
  const std::int64_t below = most_error_below(filter_);
  if (below < 0 || !page_.columns().has_descending_errors()) {
    return false;
  }
  std::array<std::uint64_t, 1> first{};
  page_.columns().read_errors(page_.bytes(), run.first(), first);
  return static_cast<std::int64_t>(first[0]) <= below;
}

/// Reads the shapes of the runs of rings that hold a wanted record.
void LivingPage::read_shapes(const PageRun& run, std::uint64_t wanted, Shapes& out) const noexcept {
  const PageColumns& columns = page_.columns();
  const std::byte* const bytes = page_.bytes();
  out.common_bits = columns.common_bits();
  for (std::uint32_t begin = 0; begin < run.count(); begin += layout::kRingRun) {
    // A ring begins where the one before ends, so a record needs the shapes of its whole run.
    if ((wanted >> begin & kOneRingRun) == 0) {
      continue;
    }
    const std::uint32_t end = std::min(begin + layout::kRingRun, run.count());
    const auto read = [&](PageColumn c, Shapes::Column& column) {
      columns.read_run(bytes, c, run.first() + begin,
                       std::span(column).subspan(begin, end - begin));
    };
    read(PageColumn::kDegree, out.degree);
    read(PageColumn::kOffsetBits, out.offset_bits);
    read(PageColumn::kHeightBits, out.height_bits);
    read(PageColumn::kDeathBits, out.death_bits);
    out.bit[begin] = columns.run_begin(bytes, (run.first() + begin) / layout::kRingRun);
    for (std::uint32_t k = begin + 1; k < end; ++k) {
      // A damaged shape moves the rings behind it. No bit is read before is_sound() has held a
      // ring's end against that of all rings; eight bytes follow these, so loads stay in the page.
      out.bit[k] = out.end(k - 1);
    }
  }
}

/// Whether a triangle of a star of this error lives, by its death as it is stored.
bool LivingPage::lives(std::uint32_t death, std::uint32_t error) const noexcept {
  // A death of 0 lives on, 1 dies at error 0; any other lies death - kFirstAboveBase below the
  // error. Sums stand on both sides: a damaged death may exceed the error, and a difference would
  // wrap.
  return level_ < 0 ? death == 0
                    : death < kFirstAboveBase ||
                          error + kFirstAboveBase <= death + static_cast<std::uint32_t>(level_);
}

/// Whether a triangle that lives dies at the level's own error, which tells it from others with
/// `with_ties` alone.
bool LivingPage::is_tie(std::uint32_t death, std::uint32_t error) const noexcept {
  // Below level 0 only a death of 0 lives, which is no tie; the 0 keeps the cast from wrapping.
  return death == 1 ? level_ == 0
                    : death > 1 && error + kFirstAboveBase ==
                                       death + static_cast<std::uint32_t>(std::max(level_, 0));
}

/// Those of the wanted records of a run of whose stars a triangle lives, and those that are not
/// sound.
std::uint64_t LivingPage::find_living(PageRun& run, std::uint64_t wanted, Shapes& shapes) const {
  // Below level 0 only what lives on lives, and lives() then looks at no error.
  if (level_ >= 0) {
    run.take_some(PageColumn::kError, wanted);
  }
  const std::size_t rings_end = page_.columns().rings_end();
  std::uint64_t result = 0;
  for (std::uint64_t left = wanted; left != 0; left &= left - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
    // An unsound record stays in the result, so that take() reports it.
    if (!shapes.is_sound(k, rings_end)) {
      result |= std::uint64_t{1} << k;
      continue;
    }
    const auto width = static_cast<unsigned>(shapes.death_bits[k]);
    // Deaths of no width are all 0, so every triangle lives on.
    if (width == 0) {
      shapes.living[k] =
          shapes.degree[k] < 64 ? (std::uint64_t{1} << shapes.degree[k]) - 1 : ~std::uint64_t{0};
      result |= std::uint64_t{1} << k;
      continue;
    }
    const std::uint32_t error = level_ < 0 ? 0 : run.error_bits(k);
    const std::uint64_t step = shapes.corner_bits(k);
    std::size_t bit = shapes.bit[k] + 2 * shapes.offset_bits[k] + shapes.height_bits[k];
    std::uint64_t living = 0;
    // The last corner of an open ring has death 0 but no triangle; take_any() leaves it out.
    for (std::uint64_t i = 0; i < shapes.degree[k]; ++i, bit += step) {
      const bool is_one =
          lives(static_cast<std::uint32_t>(read_bits(page_.bytes(), bit, width)), error);
      // Bits of a ring of more than 64 corners wrap around: they only say whether any triangle
      // lives, and take_any() reads its deaths again.
      living |= std::uint64_t{is_one} << (i % 64);
    }
    shapes.living[k] = living;
    const bool is_tied = filter_.with_ties && static_cast<std::int64_t>(error) == level_;
    result |= std::uint64_t{living != 0 || is_tied} << k;
  }
  return result;
}

/// A star without its corners and its heights. False when it cannot be one.
bool LivingPage::read_star(const PageRun& run, std::uint32_t k, PageStar& out) const noexcept {
  const auto at = [&](PageColumn c) { return static_cast<std::int64_t>(run.at(c, k)); };
  const layout::NodeEntry& d = descriptor_;
  const std::int64_t x = at(PageColumn::kX);
  const std::int64_t y = at(PageColumn::kY);
  const auto flags = static_cast<unsigned>(at(PageColumn::kFlags));
  const std::uint32_t deviation = run.deviation_bits(k);
  out.error = run.error_bits(k);
  out.is_closed = (flags & (kPageNoLeft | kPageNoRight)) == 0;
  out.star.has_height = (flags & kPageVertexVoid) == 0;
  // The descriptor was checked: what lies within its boxes is on the grid.
  if (x < d.star_min_x || y < d.star_min_y || x > d.star_max_x || y > d.star_max_y ||
      out.error < d.error_min || out.error > d.error_max || deviation > d.deviation_max) {
    return false;
  }
  out.star.u = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
  out.star.is_tied = filter_.with_ties && static_cast<std::int64_t>(out.error) == level_;
  out.star.ends_at_w = (flags & kPageNoLeft) != 0;
  // The rank decides among records of one error alone: only tied stars need theirs.
  out.star.rank =
      out.star.is_tied ? static_cast<std::uint16_t>(at(PageColumn::kRank)) : std::uint16_t{0};
  out.star.deviation = short_value(static_cast<ShortBits>(deviation));
  return true;
}

/// The heights of a star that has been read. False when they cannot be its.
bool LivingPage::read_heights(PageRun& run, std::uint32_t k, PageStar& out) const {
  run.take_heights(std::uint64_t{1} << k);
  const OrderedInterval heights = run.heights(k);
  out.height = static_cast<std::int64_t>(heights.height);
  out.low = static_cast<std::int64_t>(heights.low);
  out.high = static_cast<std::int64_t>(heights.high);
  const bool has_heights = (run.at(PageColumn::kFlags, k) & kPageNoHeights) == 0;
  // The descriptor was checked: what lies within its intervals is a height, no NaN.
  if ((has_heights && (out.low < low_ || out.high > high_)) ||
      (out.star.has_height && (!has_heights || out.height < star_low_ || out.height > star_high_ ||
                               out.height < page_.least_height()))) {
    return false;
  }
  const auto bits = [&](std::int64_t ordered) {
    return height_of_ordered(static_cast<std::uint32_t>(ordered), type_);
  };
  out.star.height = out.star.has_height ? bits(out.height) : 0;
  out.star.height_lo = has_heights ? bits(out.low) : no_heights_.lo;
  out.star.height_hi = has_heights ? bits(out.high) : no_heights_.hi;
  out.low = std::max(out.low, star_low_);
  // Ordered heights are never negative, so -1 refuses each corner that has a height all the same.
  out.high = has_heights ? std::min(out.high, star_high_) : -1;
  return true;
}

/// Appends what lives of a star, unless none of its triangles meets the filter's box, or it is not
/// asked for by its heights. False when it cannot be what was written.
bool LivingPage::take_star(PageRun& run, const Shapes& shapes, std::uint32_t k, PageStar& star,
                           LivingStars& out) const {
  const std::size_t begin = out.corners.size();
  const auto take_corners = [&] {
    if (!is_plain(shapes, star, k)) return take_any(shapes, star, k, out);
    return is_local_ ? take_plain<true>(shapes, star, k, out)
                     : take_plain<false>(shapes, star, k, out);
  };
  if ((!is_local_ && !read_heights(run, k, star)) || !take_corners() ||
      !meet_box(star, begin, out)) {
    return false;
  }
  if (out.corners.size() == begin) {
    return true;
  }
  if (is_local_ && !(read_heights(run, k, star) && look_up(star, begin, out))) {
    return false;
  }
  if (!are_heights_sound(star, begin, out)) {
    return false;
  }
  if (!filter_.steps.empty() && !star.star.is_tied && !has_step(star, begin, out)) {
    out.corners.grow(begin);
    return true;
  }
  const std::size_t stars = out.stars.size();
  out.stars.grow(stars + 1);
  out.stars.data()[stars] = star.star;
  out.stars.data()[stars].corner_end = static_cast<std::uint32_t>(out.corners.size());
  return true;
}

/// Whether a star is as nearly all are: nothing is void around it, a load gets a corner, and where no
/// triangle is tied.
bool LivingPage::is_plain(const Shapes& shapes, const PageStar& star,
                          std::uint32_t k) const noexcept {
  // A degree of 64 is one too many: take_plain() marks the corner behind the last one by a bit too.
  return !filter_.with_ties && shapes.degree[k] < 64 && shapes.corner_bits(k) <= kMostFieldBits &&
         shapes.common_bits == 0 && star.is_closed && star.star.has_height;
}

/// Appends the corners of what lives of such a star, without heights where these are looked up. False
/// when one cannot be what was written.
template <bool kIsLocal>
bool LivingPage::take_plain(const Shapes& shapes, const PageStar& star, std::uint32_t k,
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
  // The sign of a difference says whether a corner is out of bounds. Differences are joined by `|`,
  // so the loop has no branch for them, and one test at the end judges the star.
  std::int64_t outside = 0;
  const auto take = [&](unsigned i) {
    const std::uint64_t word = read_bits(page_.bytes(), shapes.bit[k] + i * step, kMostFieldBits);
    const std::int64_t x = star.star.u.x + with_sign(word & offset_mask, offset_bits);
    const std::int64_t y =
        star.star.u.y + with_sign((word >> offset_bits) & offset_mask, offset_bits);
    outside |= (x - d.star_min_x) | (d.star_max_x - x) | (y - d.star_min_y) | (d.star_max_y - y);
    HeightBits bits = 0;
    if constexpr (!kIsLocal) {
      const std::int64_t height =
          star.height + with_sign((word >> (2 * offset_bits)) & height_mask, height_bits);
      outside |= (height - star.low) | (star.high - height);
      bits = height_of_ordered(static_cast<std::uint32_t>(height), type_);
    }
    *to++ = {{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)},
             bits,
             static_cast<std::uint8_t>((living >> i & 1) * LivingCorner::kLives)};
  };
  // Corner i is wanted as the beginning of triangle i, or as the end of triangle i - 1.
  const std::uint64_t ends = living << 1;
  const std::uint64_t around = std::uint64_t{1} << shapes.degree[k];
  for (std::uint64_t left = (living | ends) & ~around; left != 0; left &= left - 1) {
    take(static_cast<unsigned>(std::countr_zero(left)));
  }
  if ((ends & around) != 0) {
    // The first corner comes once more, as the end of the last triangle, and begins none there.
    take(0);
    to[-1].flags = 0;
  }
  out.corners.grow(static_cast<std::size_t>(to - out.corners.data()));
  return outside >= 0;
}

/// As take_plain(), for any star.
bool LivingPage::take_any(const Shapes& shapes, const PageStar& star, std::uint32_t k,
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
    if (is_awaited || is_wanted || (star.star.is_tied && i < degree)) {
      const std::int64_t x = star.star.u.x + c.x;
      const std::int64_t y = star.star.u.y + c.y;
      const std::int64_t height = is_local_ ? 0 : star.height + c.height;
      is_inside = is_inside && d.star_min_x <= x && x <= d.star_max_x && d.star_min_y <= y &&
                  y <= d.star_max_y &&
                  (is_local_ || !c.has_height || (star.low <= height && height <= star.high));
      *to++ = {
          {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)},
          c.has_height && !is_local_ ? height_of_ordered(static_cast<std::uint32_t>(height), type_)
                                     : 0,
          static_cast<std::uint8_t>((is_wanted ? unsigned{LivingCorner::kLives} : 0U) |
                                    (is_wanted && filter_.with_ties && is_tie(c.death, star.error)
                                         ? unsigned{LivingCorner::kTied}
                                         : 0U) |
                                    (c.is_void ? unsigned{LivingCorner::kVoid} : 0U) |
                                    (c.has_height ? 0U : unsigned{LivingCorner::kNoHeight}))};
    }
    is_awaited = is_wanted;
  }
  out.corners.grow(static_cast<std::size_t>(to - out.corners.data()));
  return is_inside;
}

/// Twice the area of a triangle. REQUIRES: its corners are on the grid, else it may be any number.
std::int64_t turn(GridPoint u, GridPoint a, GridPoint b) noexcept {
  return (std::int64_t{a.x} - u.x) * (std::int64_t{b.y} - u.y) -
         (std::int64_t{a.y} - u.y) * (std::int64_t{b.x} - u.x);
}

/// Whether a step lies within the heights of a star whose corners were appended from `begin` on.
bool LivingPage::has_step(const PageStar& star, std::size_t begin,
                          const LivingStars& out) const noexcept {
  if (!star.star.has_height) {
    return false;
  }
  std::uint32_t low = ordered_height(star.star.height, type_);
  std::uint32_t high = low;
  for (std::size_t i = begin; i < out.corners.size(); ++i) {
    const LivingCorner& c = out.corners.data()[i];
    if ((c.flags & LivingCorner::kNoHeight) == 0) {
      const std::uint32_t height = ordered_height(c.height, type_);
      low = std::min(low, height);
      high = std::max(high, height);
    }
  }
  return !steps_within(steps_, low, high).empty();
}

/// Looks up the heights of a star's corners, of which each has one. False when one cannot be the star's.
bool LivingPage::look_up(const PageStar& star, std::size_t begin, LivingStars& out) const {
  std::int64_t outside = 0;
  LivingCorner* const end = out.corners.data() + out.corners.size();
  for (LivingCorner* c = out.corners.data() + begin; c < end; ++c) {
    const std::int64_t height = page_.sample(c->position.x, c->position.y);
    outside |= (height - star.low) | (star.high - height) | (height - page_.least_height());
    c->height = height_of_ordered(static_cast<std::uint32_t>(height), type_);
  }
  return outside >= 0;
}

/// Lets no triangle live whose box does not meet the filter's, and drops the corners that were appended
/// from `begin` on if none is left. False when a triangle cannot be what was written.
bool LivingPage::meet_box(const PageStar& star, std::size_t begin, LivingStars& out) const {
  bool is_sound = true;
  // A tied star stays even if no triangle of it meets the box: its fan says which others are gone.
  bool any = star.star.is_tied;
  LivingCorner* const end = out.corners.data() + out.corners.size();
  for (LivingCorner* c = out.corners.data() + begin; c < end; ++c) {
    if ((c->flags & LivingCorner::kLives) == 0) {
      continue;
    }
    // All corners lie within the descriptor's box, thus on the grid, as turn() requires.
    is_sound &= turn(star.star.u, c[0].position, c[1].position) > 0;
    const bool is_met =
        is_within_ ||
        meets(united(united(box_of(star.star.u), c[0].position), c[1].position), filter_.box);
    c->flags &= static_cast<std::uint8_t>(is_met ? ~0U : ~unsigned{LivingCorner::kLives});
    any |= is_met;
  }
  if (!any) {
    out.corners.grow(begin);
  }
  return is_sound;
}

/// Whether each living triangle that is not void has three heights.
bool LivingPage::are_heights_sound(const PageStar& star, std::size_t begin,
                                   const LivingStars& out) const noexcept {
  if (star.star.has_height && page_.columns().common_bits() == 0) {
    return true;
  }
  const LivingCorner* const end = out.corners.data() + out.corners.size();
  for (const LivingCorner* c = out.corners.data() + begin; c < end; ++c) {
    if ((c->flags & (LivingCorner::kLives | LivingCorner::kVoid)) == LivingCorner::kLives &&
        (!star.star.has_height || ((c[0].flags | c[1].flags) & LivingCorner::kNoHeight) != 0)) {
      return false;
    }
  }
  return true;
}

}  // namespace

void take_living(const RecordPage& page, const LivingFilter& filter, LivingStars& out) {
  const std::size_t before = out.stars.size();
  const std::uint32_t sound = LivingPage(page, filter).take(out);
  if (sound < page.records()) [[unlikely]] {
    out.keep(before);
    page.report(sound);
  }
}

}  // namespace ptin
