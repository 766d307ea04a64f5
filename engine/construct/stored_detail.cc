// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/stored_detail.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "engine/geometry/rounding.h"
#include "storage/short_float.h"

namespace ptin {

float StoredDetail::rounded(float bound) const noexcept {
  return shortened(height_rounding > 0.0 ? rounded_up(static_cast<double>(bound) + height_rounding)
                                         : bound);
}

bool StoredDetail::leaves_out(float error) const noexcept {
  return max_error > 0.0 && static_cast<double>(error) <= max_error;
}

float StoredDetail::death(float built) const noexcept {
  if (built == kLivesOn) {
    return kLivesOn;
  }
  const float error = rounded(built);
  return leaves_out(error) ? kLivesOn : error;
}

void StoredDetail::add_rounding(StarredRecords& records) const noexcept {
  for (VertexSplit& r : records.splits) {
    r.error = rounded(r.error);
    r.deviation = rounded(r.deviation);
  }
  for (RingCorner& c : records.corners) {
    c.death = death(c.death);
  }
}

RecordBounds StoredDetail::leave_out(StarredRecords& records) const noexcept {
  RecordBounds worst;
  if (max_error <= 0.0) {
    return worst;
  }
  std::size_t kept = 0;
  std::uint32_t begin = 0, kept_end = 0;  // of rings: of the one at hand, of those kept
  for (std::size_t i = 0; i < records.size(); ++i) {
    const VertexSplit& r = records.splits[i];
    const std::uint32_t end = records.ring_end[i];
    if (leaves_out(r.error)) {
      worst.error = std::max(worst.error, r.error);
      worst.deviation = std::max(worst.deviation, r.deviation);
    } else {
      if (kept_end != begin) {
        std::copy(records.corners.begin() + begin, records.corners.begin() + end,
                  records.corners.begin() + kept_end);
      }
      kept_end += end - begin;
      records.splits[kept] = r;
      records.ring_end[kept++] = kept_end;
    }
    begin = end;
  }
  records.splits.resize(kept);
  records.ring_end.resize(kept);
  records.corners.resize(kept_end);
  return worst;
}

}  // namespace ptin
