// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/facts.h"

#include <cmath>
#include <limits>

#include "engine/geometry/affine_rounding.h"

namespace ptin {

namespace {

/// One axis of the map from grid to coordinates.
struct Axis {
  double origin, step;
  std::int32_t min, max;
};

/// True when coordinates as doubles tell the positions of the axis apart: those of its ends are
/// finite and lead back to them. A reader would find no other place of the terrain.
bool is_invertible(const Axis& axis) {
  for (const double grid : {static_cast<double>(axis.min), static_cast<double>(axis.max)}) {
    // False for NaN and infinity too. Twice what is allowed to a build.
    if (!(rounding_to_grid(axis.origin + axis.step * grid, axis.origin, axis.step, grid) < 1.0)) {
      return false;
    }
  }
  return true;
}

/// True when squares of lengths along the axis neither vanish nor overflow, so that distances can
/// be computed.
bool has_lengths(const Axis& axis) {
  const double longest = axis.step * (static_cast<double>(axis.max) - axis.min);
  return axis.step * axis.step >= std::numeric_limits<double>::min() &&
         std::isfinite(4 * longest * longest);
}

/// True when the encoding reaches as far as `height`.
bool is_code(const HeightEncoding& heights, double height) {
  const double farthest = heights.type == HeightType::int32
                              ? -static_cast<double>(INT32_MIN)
                              : static_cast<double>(std::numeric_limits<float>::max());
  return heights.height_of_code(-farthest) <= height && height <= heights.height_of_code(farthest);
}

}  // namespace

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
  for (const Axis& axis : {Axis{f.map.origin_x, f.map.step_x, f.bounds.min_x, f.bounds.max_x},
                           Axis{f.map.origin_y, f.map.step_y, f.bounds.min_y, f.bounds.max_y}}) {
    if (!is_invertible(axis)) {
      return "the map from grid to coordinates must tell the places of the terrain apart: its "
             "origin is too far away for its steps, or a corner of the bounds has no finite "
             "coordinates";
    }
    if (!has_lengths(axis)) {
      return "the map from grid to coordinates has steps of which no distance can be computed";
    }
  }
  if (std::isnan(f.min_height) || std::isnan(f.max_height)) {
    return "the smallest and the largest height must be numbers";
  }
  if (f.min_height <= f.max_height &&
      !(is_code(f.heights, f.min_height) && is_code(f.heights, f.max_height))) {
    return "the smallest and the largest height must be such as the encoding of heights holds";
  }
  if (!(f.base_error >= 0.0) || !(f.base_deviation >= 0.0)) {
    return "base error and base deviation must not be negative";
  }
  return nullptr;
}

}  // namespace ptin
