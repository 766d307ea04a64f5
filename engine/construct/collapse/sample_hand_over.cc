// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse/sample_hand_over.h"

#include <algorithm>
#include <cmath>

#include "engine/construct/measure/sample_blocks.h"
#include "engine/construct/measure/void_measure.h"

namespace ptin {

void SampleHandOver::run(Tile& tile, const StarSamples& s, const FanFrame& frame,
                         const FanAssignment& assignment, std::span<const TriangleId> receivers,
                         bool drop_center) {
  drop_center_ = drop_center;
  for (const TriangleId t : s.star.triangles) {
    CarriedState& carried = tile.carried[t];
    tile.samples.give_back(carried.samples);
    carried.samples = {};
    carried.holds_heights = carried.holds_voids = false;
  }
  lists_.resize(std::max(lists_.size(), frame.triangles()));
  for (std::size_t i = 0; i < frame.triangles(); ++i) {
    lists_[i].samples.clear();
  }
  for (std::size_t k = 0; k < s.source.size(); ++k) {
    const bool is_center = s.x[k] == 0.0 && s.y[k] == 0.0 && s.source[k].direction == kNoDirection;
    if (s.source[k].side_log == 0 && !(drop_center && is_center)) {
      lists_[static_cast<std::size_t>(assignment.triangle[k])].add(s.source[k],
                                                                   assignment.residual[k]);
    }
  }
  for (const SampleBlock& b : s.blocks) {
    add_block(tile, s, frame, s.source[b.source]);
  }
  for (std::size_t i = 0; i < frame.triangles(); ++i) {
    store(tile, frame, i, tile.carried[receivers[i]]);
  }
}

void SampleHandOver::add_block(const Tile& tile, const StarSamples& s, const FanFrame& frame,
                               const Sample& block) {
  const GridPoint u = tile.tin.position(s.star.center);
  const double x = static_cast<double>(block.position.x) - u.x;
  const double y = static_cast<double>(block.position.y) - u.y;
  const auto reach = static_cast<double>((std::int64_t{1} << block.side_log) - 1);
  const bool holds_center = x <= 0.0 && y <= 0.0 && x + reach >= 0.0 && y + reach >= 0.0;
  if (block.side_log == 0) {
    if (drop_center_ && holds_center) {
      return;
    }
    lists_[triangle_of_sample(tile, s, frame, x, y, block.reach >= 0.0F)].add(block, 0.0);
    return;
  }
  const std::size_t i = triangle_of_box(frame, x, y, x + reach, y + reach);
  if (i < frame.triangles() && !(drop_center_ && holds_center)) {
    lists_[i].add(block, 0.0);
    return;
  }
  const std::int32_t half = std::int32_t{1} << (block.side_log - 1);
  for (const GridPoint offset : {GridPoint{0, 0}, {half, 0}, {0, half}, {half, half}}) {
    Sample quarter = block;
    quarter.position = {block.position.x + offset.x, block.position.y + offset.y};
    --quarter.side_log;
    add_block(tile, s, frame, quarter);
  }
}

void SampleHandOver::store(Tile& tile, const FanFrame& frame, std::size_t i,
                           CarriedState& carried) {
  std::vector<Sample>& list = lists_[i].samples;
  carried.holds_voids =
      tile.has_voids &&
      std::any_of(list.begin(), list.end(), [](const Sample& a) { return a.reach < 0.0F; });
  carried.holds_heights =
      !tile.has_voids ||
      std::any_of(list.begin(), list.end(), [](const Sample& a) { return !(a.reach < 0.0F); });
  const double length = std::abs(frame.spoke_x[i]) + std::abs(frame.spoke_y[i]) +
                        std::abs(frame.spoke_x[i + 1]) + std::abs(frame.spoke_y[i + 1]);
  if (tile.samples_fill_grid) {
    join_where_alike(list, length);
  }
  carried.samples = tile.samples.take(static_cast<std::uint32_t>(list.size()));
  std::copy(list.begin(), list.end(), tile.samples.samples(carried.samples).begin());
}

}  // namespace ptin
