// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a page's descriptor says of its records, held against one of them.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "storage/box_lanes.h"
#include "storage/layout.h"
#include "storage/record.h"
#include "storage/short_float.h"

namespace ptin {

/// The bounds that a page's descriptor sets for its records. `Code` is the type in which heights are
/// stored, and that of the lanes. Errors and deviations may be compared as either type: they are not
/// negative, so their bits have the same order as their values.
template <class Code>
class DescriptorBounds {
 public:
  using Int4 = lanes::Int4;
  using Lanes = std::conditional_t<std::is_same_v<Code, float>, lanes::Float4, Int4>;

  explicit DescriptorBounds(const layout::NodeEntry& e) : box_(lanes::load<Int4>(&e.min_x)) {
    const auto lane = [](auto bits) { return std::bit_cast<Code>(bits); };
    const auto bound = [&](ShortBits bits) { return lane(layout::to_bits(short_value(bits))); };
    least_ = Lanes{lane(e.height_lo), least_code(), bound(e.error_min), Code{0}};
    most_ = Lanes{most_code(), lane(e.height_hi), bound(e.error_max), bound(e.deviation_max)};
  }

  [[nodiscard]] bool excludes(const VertexSplit& r) const {
    const auto roi = lanes::load<Int4>(&r.roi.min_x);
    const Int4 minima{-1, -1, 0, 0};
    const Int4 outside = ((roi < box_) & minima) | ((roi > box_) & ~minima);
    const auto values = lanes::load<Lanes>(&r.height_lo);
    // Both comparisons are false for a NaN, so that a NaN is not within the bounds.
    const Int4 within = (values >= least_) & (values <= most_);
    // An empty interval of heights (lo > hi) lies in every interval.
    const std::int32_t is_empty = values[0] > values[1] ? -1 : 0;
    const Int4 excused{is_empty, is_empty, 0, 0};
    const auto height = std::bit_cast<Code>(r.height);
    const bool is_nan = !(height == height);  // NOLINT(misc-redundant-expression)
    return lanes::any(outside | ~(within | excused)) || is_nan;
  }

 private:
  static constexpr Code least_code() {
    using Limits = std::numeric_limits<Code>;
    return Limits::has_infinity ? -Limits::infinity() : Limits::lowest();
  }
  static constexpr Code most_code() {
    using Limits = std::numeric_limits<Code>;
    return Limits::has_infinity ? Limits::infinity() : Limits::max();
  }

  Int4 box_;
  Lanes least_, most_;
};

}  // namespace ptin
