// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/floor_tin.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "engine/geometry/sample_range.h"
#include "engine/mesh/raster_tin.h"

namespace ptin {

namespace {

/// What make_raster_tin() takes for a sample, and the height and mask that it is given.
constexpr std::uint64_t kBytesASample = 67 + sizeof(HeightBits) + 1;

/// The samples from `least` to `greatest` that a raster has along one side, two at least.
void take_along(std::int64_t least, std::int64_t greatest, std::int64_t all, std::int64_t& first,
                std::int64_t& count) {
  first = std::clamp<std::int64_t>(least, 0, all - 2);
  count = std::clamp<std::int64_t>(greatest, first + 1, all - 1) - first + 1;
}

class SamplesOfWindow {
 public:
  SamplesOfWindow(const Floor& floor, const SampleRange& window)
      : shape_(floor.facts().shape),
        numbers_(floor.numbers()),
        window_(window),
        heights(window.samples()),
        valid(window.samples()) {}

  void take(const Floor::TileAt& at, const FloorTile& tile) {
    const std::int64_t left = shape_.first_of(at.column), low = shape_.first_of(at.row);
    const std::int64_t first_x = std::max(left, window_.x0);
    const std::int64_t end_x = std::min(left + tile.width, window_.x0 + window_.width);
    const std::int64_t end_y = std::min(low + tile.height, window_.y0 + window_.height);
    for (std::int64_t y = std::max(low, window_.y0); y < end_y; ++y) {
      auto from = static_cast<std::size_t>((y - low) * tile.width + first_x - left);
      auto to = static_cast<std::size_t>((y - window_.y0) * window_.width + first_x - window_.x0);
      for (std::int64_t x = first_x; x < end_x; ++x, ++from, ++to) {
        heights[to] = numbers_.bits(tile.heights[from]);
        valid[to] = tile.is_void.empty() || tile.is_void[from] == 0 ? 1 : 0;
      }
    }
  }

 private:
  const FloorShape& shape_;
  const FloorNumbers& numbers_;
  const SampleRange& window_;

 public:
  std::vector<HeightBits> heights;
  std::vector<std::uint8_t> valid;
};

}  // namespace

Tin floor_tin(const Floor& floor, const HeightEncoding& heights, const GridBox& box,
              const std::function<bool(const GridBox&)>& wants, QueryContext& context) {
  const FloorShape& shape = floor.facts().shape;
  SampleRange window;
  // A cell to each side: the eye on a sample, say, has cells on all sides.
  take_along(std::int64_t{box.min_x} - 1, std::int64_t{box.max_x} + 1, shape.width, window.x0,
             window.width);
  take_along(std::int64_t{box.min_y} - 1, std::int64_t{box.max_y} + 1, shape.height, window.y0,
             window.height);
  context.admit(window.samples() * kBytesASample);
  const GridBox wanted{static_cast<std::int32_t>(window.x0), static_cast<std::int32_t>(window.y0),
                       static_cast<std::int32_t>(window.x0 + window.width - 1),
                       static_cast<std::int32_t>(window.y0 + window.height - 1)};
  SamplesOfWindow samples(floor, window);
  Floor::Recent recent;
  floor.visit([&](const Floor::Bounds& b) { return meets(b.box, wanted) && wants(b.box); },
              [&](const Floor::TileAt& at, const FloorTile& tile) {
                context.check_stop();
                context.cost.samples_read += tile.samples();
                samples.take(at, tile);
                return true;
              },
              recent, context.cost.io);
  return make_raster_tin(samples.heights, samples.valid, window, heights);
}

}  // namespace ptin
