// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/descriptor.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace ptin {

namespace {

bool is_on_grid(std::int32_t min_x, std::int32_t min_y, std::int32_t max_x, std::int32_t max_y) {
  return min_x >= 0 && min_y >= 0 && min_x <= max_x && min_y <= max_y && max_x <= kGridMax &&
         max_y <= kGridMax;
}

Interval joined(const Interval& a, const Interval& b) { return is_empty(b) ? a : united(a, b); }

}  // namespace

HeightInterval no_heights(HeightType type) noexcept {
  if (type == HeightType::int32) {
    return {std::bit_cast<HeightBits>(INT32_MAX), std::bit_cast<HeightBits>(INT32_MIN)};
  }
  constexpr float kEnd = std::numeric_limits<float>::infinity();
  return {std::bit_cast<HeightBits>(kEnd), std::bit_cast<HeightBits>(-kEnd)};
}

bool is_sound(const layout::NodeEntry& e, const HeightEncoding& heights) noexcept {
  const auto is_number = [&](HeightBits bits) { return !std::isnan(heights.code(bits)); };
  return is_on_grid(e.min_x, e.min_y, e.max_x, e.max_y) &&
         is_on_grid(e.star_min_x, e.star_min_y, e.star_max_x, e.star_max_y) &&
         e.star_min_x >= e.min_x && e.star_min_y >= e.min_y && e.star_max_x <= e.max_x &&
         e.star_max_y <= e.max_y && e.error_min <= e.error_max && e.error_max <= kShortInfinity &&
         e.deviation_max <= kShortInfinity && e.death_min <= kMostDeathBits && e.reserved == 0 &&
         is_number(e.height_lo) && is_number(e.height_hi) && is_number(e.star_height_lo) &&
         is_number(e.star_height_hi);
}

void Descriptor::add(const VertexSplit& r, std::span<const RingCorner> ring) noexcept {
  box_ = united(box_, r.roi);
  heights_ = joined(heights_, Interval{encoding_.code(r.height_lo), encoding_.code(r.height_hi)});
  error_max_ = std::max(error_max_, short_bits(r.error));
  error_min_ = std::min(error_min_, short_bits(r.error));
  deviation_max_ = std::max(deviation_max_, short_bits(r.deviation));
  star_box_ = united(star_box_, r.u);
  if (r.has_height()) {
    star_heights_ = united(star_heights_, encoding_.code(r.height));
  }
  const std::size_t triangles = ring.size() - (has_closed_ring(r) ? 0 : 1);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    star_box_ = united(star_box_, ring[i].position);
    if (ring[i].has_height()) {
      star_heights_ = united(star_heights_, encoding_.code(ring[i].height));
    }
    if (i < triangles) {
      death_min_ = std::min(death_min_, death_bits(ring[i].death));
    }
  }
}

void Descriptor::add(const layout::NodeEntry& e) noexcept {
  box_ = united(box_, GridBox{e.min_x, e.min_y, e.max_x, e.max_y});
  star_box_ = united(star_box_, GridBox{e.star_min_x, e.star_min_y, e.star_max_x, e.star_max_y});
  heights_ = joined(heights_, Interval{encoding_.code(e.height_lo), encoding_.code(e.height_hi)});
  star_heights_ = joined(
      star_heights_, Interval{encoding_.code(e.star_height_lo), encoding_.code(e.star_height_hi)});
  error_max_ = std::max(error_max_, e.error_max);
  error_min_ = std::min(error_min_, e.error_min);
  deviation_max_ = std::max(deviation_max_, e.deviation_max);
  death_min_ = std::min(death_min_, e.death_min);
}

HeightInterval Descriptor::bits_of(const Interval& heights) const noexcept {
  // A sum with 0 makes 0 of -0: records are packed so too.
  return is_empty(heights)
             ? no_heights(encoding_.type)
             : HeightInterval{encoding_.bits(heights.lo + 0.0), encoding_.bits(heights.hi + 0.0)};
}

layout::NodeEntry Descriptor::entry() const noexcept {
  layout::NodeEntry e{};
  e.min_x = box_.min_x;
  e.min_y = box_.min_y;
  e.max_x = box_.max_x;
  e.max_y = box_.max_y;
  e.star_min_x = star_box_.min_x;
  e.star_min_y = star_box_.min_y;
  e.star_max_x = star_box_.max_x;
  e.star_max_y = star_box_.max_y;
  e.height_lo = bits_of(heights_).lo;
  e.height_hi = bits_of(heights_).hi;
  e.star_height_lo = bits_of(star_heights_).lo;
  e.star_height_hi = bits_of(star_heights_).hi;
  e.error_max = error_max_;
  e.error_min = error_min_;
  e.deviation_max = deviation_max_;
  e.death_min = death_min_;
  return e;
}

}  // namespace ptin
