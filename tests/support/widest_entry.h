// SPDX-License-Identifier: GPL-3.0-or-later
//
// A descriptor that admits every record and every star.
#pragma once

#include <cstdint>

#include "storage/descriptor.h"
#include "storage/short_float.h"

namespace ptin::test {

[[nodiscard]] inline layout::NodeEntry widest_entry(HeightType type, std::uint32_t records) {
  layout::NodeEntry e{};
  const HeightInterval none = no_heights(type);
  e.max_x = e.max_y = e.star_max_x = e.star_max_y = kGridMax;
  e.height_lo = e.star_height_lo = none.hi;
  e.height_hi = e.star_height_hi = none.lo;
  e.error_max = e.deviation_max = kShortInfinity;
  e.records = records;
  return e;
}

}  // namespace ptin::test
