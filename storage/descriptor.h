// SPDX-License-Identifier: GPL-3.0-or-later
//
// Descriptors: what an entry of the index says of a page or a subtree. They are made from records,
// and joined upwards.
#pragma once

#include <cstdint>

#include "storage/layout.h"
#include "storage/record.h"

namespace ptin {

/// The attributes in an entry of the index: the union and maximum over the page or subtree that it
/// describes. REQUIRES: is_sound(e, heights).
[[nodiscard]] inline Attributes attributes_of(const layout::NodeEntry& e,
                                              const HeightEncoding& heights) noexcept {
  return {{e.min_x, e.min_y, e.max_x, e.max_y},
          {heights.code(e.height_lo), heights.code(e.height_hi)},
          layout::to_float(e.error_max),
          layout::to_float(e.deviation_max)};
}

/// The attributes of a record, from its first bytes alone. Nothing is checked.
[[nodiscard]] inline Attributes attributes_of(const layout::RecordHead& h,
                                              const HeightEncoding& heights) noexcept {
  return {{h.min_x, h.min_y, h.max_x, h.max_y},
          {heights.code(h.height_lo), heights.code(h.height_hi)},
          layout::to_float(h.error),
          layout::to_float(h.deviation)};
}

/// True when each field of the entry is possible: the box on the grid and not empty, heights not
/// NaN, errors and deviation neither NaN nor negative, the least error not above the largest.
/// `kind_and_count` and `checksum` are not looked at.
[[nodiscard]] bool is_sound(const layout::NodeEntry& e, const HeightEncoding& heights) noexcept;

/// Makes the entry of the index over records, or over the entries of the level below.
class Descriptor {
 public:
  explicit Descriptor(const HeightEncoding& heights) : encoding_(heights) {}
  void add(const VertexSplit& r) noexcept;
  void add(const layout::NodeEntry& e) noexcept;
  /// The entry over all that was added; `kind_and_count` and `checksum` are left 0. An empty height
  /// interval has one form only: the largest int32 down to the smallest, or +infinity down to
  /// -infinity.
  /// REQUIRES: something was added.
  [[nodiscard]] layout::NodeEntry entry() const noexcept;

 private:
  void add(const GridBox& box, const Interval& heights) noexcept;

  HeightEncoding encoding_;
  GridBox box_;
  Interval heights_;
  float error_max_ = 0.0F;
  float error_min_ = layout::to_float(layout::kInfinityBits);
  float deviation_max_ = 0.0F;
};

}  // namespace ptin
