// SPDX-License-Identifier: GPL-3.0-or-later
//
// Descriptors: what an entry of the index says of a page or a subtree. They are made from records,
// and joined upwards.
#pragma once

#include <cstdint>
#include <span>

#include "storage/layout.h"
#include "storage/short_float.h"
#include "storage/star.h"

namespace ptin {

/// The attributes in an entry of the index: the union and maximum over the page or subtree that it
/// describes. REQUIRES: is_sound(e, heights).
[[nodiscard]] inline Attributes attributes_of(const layout::NodeEntry& e,
                                              const HeightEncoding& heights) noexcept {
  return {{e.min_x, e.min_y, e.max_x, e.max_y},
          {heights.code(e.height_lo), heights.code(e.height_hi)},
          short_value(e.error_max),
          short_value(e.deviation_max)};
}

/// What an entry says of the stars of the page or subtree. REQUIRES: is_sound(e, heights).
[[nodiscard]] inline StarAttributes star_attributes_of(const layout::NodeEntry& e,
                                                       const HeightEncoding& heights) noexcept {
  return {{e.star_min_x, e.star_min_y, e.star_max_x, e.star_max_y},
          {heights.code(e.star_height_lo), heights.code(e.star_height_hi)},
          short_value(e.error_max),
          e.death_min == 0 ? kLivesOn : short_value(static_cast<ShortBits>(e.death_min - 1))};
}

/// The ends of an interval of heights as bits.
struct HeightInterval {
  HeightBits lo, hi;
};
/// The empty interval in its one form: the largest int32 down to the smallest, or +infinity down to
/// -infinity.
[[nodiscard]] HeightInterval no_heights(HeightType type) noexcept;

/// True when each field of the entry is possible: the boxes on the grid and not empty, that of the
/// stars within that of the rois, heights not NaN, errors and deviation neither NaN
/// nor negative, the least error not above the largest, `reserved` 0. `records` and `checksum` are
/// not looked at.
[[nodiscard]] bool is_sound(const layout::NodeEntry& e, const HeightEncoding& heights) noexcept;

/// Makes the entry of the index over records, or over the entries of the level below.
class Descriptor {
 public:
  explicit Descriptor(const HeightEncoding& heights) : encoding_(heights) {}
  void add(const VertexSplit& r, std::span<const RingCorner> ring) noexcept;
  void add(const layout::NodeEntry& e) noexcept;
  /// The entry over all that was added; `records` and `checksum` are left 0. Empty intervals are
  /// no_heights().
  /// REQUIRES: something was added.
  [[nodiscard]] layout::NodeEntry entry() const noexcept;

 private:
  [[nodiscard]] HeightInterval bits_of(const Interval& heights) const noexcept;

  HeightEncoding encoding_;
  GridBox box_, star_box_;
  Interval heights_, star_heights_;
  ShortBits error_max_ = 0;
  ShortBits error_min_ = kShortInfinity;
  ShortBits deviation_max_ = 0;
  ShortBits death_min_ = kMostDeathBits;
};

}  // namespace ptin
