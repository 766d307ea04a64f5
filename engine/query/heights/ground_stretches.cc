// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/ground_stretches.h"

#include <algorithm>
#include <tuple>

#include "engine/query/living/triangle_on_line.h"

namespace ptin {

bool GroundStretches::begin(std::size_t /*most_triangles*/) { return bytes() <= most_bytes_; }

void GroundStretches::take(const LivingTriangle& t) {
  path_.visit(box_of(t), [&](std::size_t segment) {
    const SpotSegment& s = path_.segment(segment);
    const std::optional<SharedStretch> shared = shared_stretch(t, heights_, s.a, s.b);
    if (!shared) {
      return;
    }
    GroundStretch stretch;
    stretch.segment = static_cast<std::uint32_t>(segment);
    stretch.is_surface = !t.is_void;
    stretch.is_point = shared->is_point;
    stretch.is_vertex = shared->is_point && shared->from.ground.count == 1;
    stretch.from = shared->from.share();
    stretch.to = shared->to.share();
    if (!t.is_void) {
      stretch.from_code = shared->from.ground.mean();
      stretch.to_code = shared->to.ground.mean();
    }
    stretches_.push_back(stretch);
  });
}

void GroundStretches::sort() {
  std::sort(stretches_.begin(), stretches_.end(),
            [](const GroundStretch& a, const GroundStretch& b) {
              const auto key = [](const GroundStretch& s) {
                return std::tuple(s.segment, s.from, s.to, !s.is_surface, s.from_code, s.to_code);
              };
              return key(a) < key(b);
            });
}

std::span<const GroundStretch> GroundStretches::of(std::size_t segment) const noexcept {
  const auto by_segment = [](const GroundStretch& s, std::size_t of) { return s.segment < of; };
  const auto begin = std::lower_bound(stretches_.begin(), stretches_.end(), segment, by_segment);
  const auto end = std::lower_bound(begin, stretches_.end(), segment + 1, by_segment);
  return {begin, end};
}

}  // namespace ptin
