// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/measure/saturation.h"

#include <algorithm>

#include "engine/geometry/infinity.h"

namespace ptin {

GridBox saturated_box(const Tile& tile, const Star& star) noexcept {
  GridBox box = box_of(tile.tin.position(star.center));
  for (const VertexId v : star.link) {
    box = united(box, tile.tin.position(v));
  }
  for (const TriangleId t : star.triangles) {
    box = united(box, tile.carried[t].roi);
  }
  return box;
}

std::uint32_t saturated_chain(const Tile& tile, const Star& star) noexcept {
  std::uint32_t chain = 0;
  for (const TriangleId t : star.triangles) {
    chain = std::max<std::uint32_t>(chain, tile.carried[t].chain);
  }
  return chain;
}

Interval saturated_heights(const Tile& tile, const Star& star) noexcept {
  Interval heights;
  const HeightEncoding& encoding = tile.units.heights;
  const auto add_vertex = [&](VertexId v) {
    if (tile.tin.has_height[v] != 0) {
      heights = united(heights, encoding.code(tile.tin.vertices[v].height));
    }
  };
  add_vertex(star.center);
  std::for_each(star.link.begin(), star.link.end(), add_vertex);
  for (const TriangleId t : star.triangles) {
    if (const std::uint32_t r = tile.carried[t].record; r != kNone) {
      const VertexSplit& record = tile.records[r];
      heights = united(heights, {encoding.code(record.height_lo), encoding.code(record.height_hi)});
    }
  }
  return heights;
}

std::pair<HeightBits, HeightBits> height_bits(const Interval& codes,
                                              const HeightEncoding& heights) {
  if (!is_empty(codes)) {
    return {heights.bits(codes.lo), heights.bits(codes.hi)};
  }
  if (heights.type == HeightType::int32) {
    return {heights.bits(INT32_MAX), heights.bits(INT32_MIN)};
  }
  return {heights.bits(kInfinity), heights.bits(-kInfinity)};
}

}  // namespace ptin
