// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/facts.h"

#include <cmath>

namespace ptin {

void put_facts(const StoreFacts& facts, layout::FileHeader& h) noexcept {
  h.height_type = static_cast<std::uint32_t>(facts.heights.type);
  h.height_step = layout::to_bits(facts.heights.step);
  h.height_offset = layout::to_bits(facts.heights.offset);
  h.origin_x = layout::to_bits(facts.map.origin_x);
  h.origin_y = layout::to_bits(facts.map.origin_y);
  h.step_x = layout::to_bits(facts.map.step_x);
  h.step_y = layout::to_bits(facts.map.step_y);
  h.bounds = {facts.bounds.min_x, facts.bounds.min_y, facts.bounds.max_x, facts.bounds.max_y};
  h.min_height = layout::to_bits(facts.min_height);
  h.max_height = layout::to_bits(facts.max_height);
  h.base_error = layout::to_bits(facts.base_error);
  h.base_deviation = layout::to_bits(facts.base_deviation);
  h.source_samples = facts.source_samples;
  h.flags = facts.free_of_voids ? layout::kFreeOfVoids : 0;
}

StoreFacts facts_of(const layout::FileHeader& h) noexcept {
  StoreFacts facts;
  facts.map = {layout::to_double(h.origin_x), layout::to_double(h.origin_y),
               layout::to_double(h.step_x), layout::to_double(h.step_y)};
  facts.heights = {static_cast<HeightType>(h.height_type), layout::to_double(h.height_step),
                   layout::to_double(h.height_offset)};
  facts.bounds = {h.bounds[0], h.bounds[1], h.bounds[2], h.bounds[3]};
  facts.min_height = layout::to_double(h.min_height);
  facts.max_height = layout::to_double(h.max_height);
  facts.base_error = layout::to_double(h.base_error);
  facts.base_deviation = layout::to_double(h.base_deviation);
  facts.source_samples = h.source_samples;
  facts.free_of_voids = (h.flags & layout::kFreeOfVoids) != 0;
  facts.page_bytes = h.page_bytes;
  return facts;
}

const char* fault_in(const StoreFacts& f) noexcept {
  if (!std::isfinite(f.map.origin_x) || !std::isfinite(f.map.origin_y) ||
      !std::isfinite(f.map.step_x) || !std::isfinite(f.map.step_y) || f.map.step_x <= 0.0 ||
      f.map.step_y <= 0.0) {
    return "the map from grid to coordinates must be finite, with positive steps";
  }
  if (f.heights.type != HeightType::int32 && f.heights.type != HeightType::float32) {
    return "the type of heights must be int32 (0) or float32 (1)";
  }
  if (!std::isfinite(f.heights.step) || f.heights.step <= 0.0 || !std::isfinite(f.heights.offset)) {
    return "the encoding of heights must be finite, with a positive step";
  }
  if (f.heights.type == HeightType::float32 && (f.heights.step != 1.0 || f.heights.offset != 0.0)) {
    return "float32 heights have step 1 and offset 0";
  }
  if (f.bounds.min_x < 0 || f.bounds.min_y < 0 || is_empty(f.bounds) || f.bounds.max_x > kGridMax ||
      f.bounds.max_y > kGridMax) {
    return "the bounds must lie on the grid and not be empty";
  }
  if (std::isnan(f.min_height) || std::isnan(f.max_height)) {
    return "the smallest and the largest height must be numbers";
  }
  if (!(f.base_error >= 0.0) || !(f.base_deviation >= 0.0)) {
    return "base error and base deviation must not be negative";
  }
  return nullptr;
}

}  // namespace ptin
