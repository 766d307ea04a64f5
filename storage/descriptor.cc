// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/descriptor.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace ptin {

bool is_sound(const layout::NodeEntry& e, const HeightEncoding& heights) noexcept {
  return e.min_x >= 0 && e.min_y >= 0 && e.min_x <= e.max_x && e.min_y <= e.max_y &&
         e.max_x <= kGridMax && e.max_y <= kGridMax && e.error_min <= e.error_max &&
         e.error_max <= layout::kInfinityBits && e.deviation_max <= layout::kInfinityBits &&
         !std::isnan(heights.code(e.height_lo)) && !std::isnan(heights.code(e.height_hi));
}

void Descriptor::add(const GridBox& box, const Interval& heights) noexcept {
  box_ = united(box_, box);
  if (!is_empty(heights)) {
    heights_ = united(heights_, heights);
  }
}

void Descriptor::add(const VertexSplit& r) noexcept {
  add(r.roi, Interval{encoding_.code(r.height_lo), encoding_.code(r.height_hi)});
  error_max_ = std::max(error_max_, r.error);
  error_min_ = std::min(error_min_, r.error);
  deviation_max_ = std::max(deviation_max_, r.deviation);
}

void Descriptor::add(const layout::NodeEntry& e) noexcept {
  add(GridBox{e.min_x, e.min_y, e.max_x, e.max_y},
      Interval{encoding_.code(e.height_lo), encoding_.code(e.height_hi)});
  error_max_ = std::max(error_max_, layout::to_float(e.error_max));
  error_min_ = std::min(error_min_, layout::to_float(e.error_min));
  deviation_max_ = std::max(deviation_max_, layout::to_float(e.deviation_max));
}

layout::NodeEntry Descriptor::entry() const noexcept {
  layout::NodeEntry e{};
  e.min_x = box_.min_x;
  e.min_y = box_.min_y;
  e.max_x = box_.max_x;
  e.max_y = box_.max_y;
  Interval heights = heights_;
  if (is_empty(heights) && encoding_.type == HeightType::int32) {
    heights = {INT32_MAX, INT32_MIN};
  }
  e.height_lo = encoding_.bits(heights.lo);
  e.height_hi = encoding_.bits(heights.hi);
  e.error_max = layout::to_bits(error_max_);
  e.error_min = layout::to_bits(error_min_);
  e.deviation_max = layout::to_bits(deviation_max_);
  return e;
}

}  // namespace ptin
