// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/measure/plane_blocks.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/geometry/infinity.h"

namespace ptin {

/// A fan triangle as samples are held against it, by column and row. `before` and `after` are the
/// cross products of its two spokes with a sample relative to w, and `link` is twice the area beside
/// the link edge: none is below 0 inside, `after` with its sign turned. All are integers.
struct PlaneBlocks::Side {
  Linear before, after, link;
  double before_z, after_z, area, inverse, w_code;
  double least_before, least_after;     ///< 1 where the spoke itself does not count, else 0.
  double plane_code, slope_x, slope_y;  ///< The plane of the triangle at column 0, row 0.
  double plane_size;                    ///< The largest term that plane_code is the sum of.
  GridBox columns;                      ///< The part of the leaf that may meet the triangle.
};

PlaneBlocks::PlaneBlocks(const Tile& leaf, const GridBox& box)
    : origin_{box.min_x, box.min_y},
      width_(box.max_x - box.min_x + 1),
      height_(box.max_y - box.min_y + 1) {
  codes_.reserve(leaf.tin.vertices.size());
  for (const Vertex& v : leaf.tin.vertices) {
    codes_.push_back(leaf.units.heights.code(v.height));
  }
  const auto [least, greatest] = std::minmax_element(codes_.begin(), codes_.end());
  least_ = *least;
  greatest_ = *greatest;
  for (std::int32_t log = kLowestLog; log <= kHighestLog; ++log) {
    for (std::int32_t y = 0; y < height_ >> log; ++y) {
      for (std::int32_t x = 0; x < width_ >> log; ++x) {
        nodes_[static_cast<std::size_t>(log)].push_back(make_node({x << log, y << log, log}));
      }
    }
  }
}

/// The slopes are those between the corners; the plane lies in the middle of what it leaves.
PlaneBlocks::Node PlaneBlocks::make_node(const Block& block) const {
  const std::int32_t last = block.side() - 1;
  const double* south = row(block.x, block.y);
  const double* north = row(block.x, block.y + last);
  Node node{};
  node.slope_x =
      static_cast<float>(((south[last] - south[0]) + (north[last] - north[0])) / (2.0 * last));
  node.slope_y =
      static_cast<float>(((north[0] - south[0]) + (north[last] - south[last])) / (2.0 * last));
  const double middle = last / 2.0;
  double low = kInfinity, high = -kInfinity;
  for (std::int32_t y = 0; y <= last; ++y) {
    const double* samples = row(block.x, block.y + y);
    const double beside = double{node.slope_y} * (y - middle);
    for (std::int32_t x = 0; x <= last; ++x) {
      const double left = samples[x] - (beside + double{node.slope_x} * (x - middle));
      low = left < low ? left : low;
      high = left > high ? left : high;
    }
  }
  node.code = (low + high) / 2.0;
  node.reach = (high - low) / 2.0;
  return node;
}

PlaneBlocks::Side PlaneBlocks::side_of(const FanFrame& fan, std::size_t i,
                                       const Centre& u) const noexcept {
  const double x = u.position.x - origin_.x + fan.w_x;  // column and row of w
  const double y = u.position.y - origin_.y + fan.w_y;
  const double ax = fan.spoke_x[i], ay = fan.spoke_y[i];
  const double bx = fan.spoke_x[i + 1], by = fan.spoke_y[i + 1];
  Side side{};
  side.before = {ay * x - ax * y, -ay, ax};
  side.after = {by * x - bx * y, -by, bx};
  side.area = fan.determinant[i];
  side.inverse = fan.inverse[i];
  side.link = {side.area - side.before.at + side.after.at, ay - by, bx - ax};
  side.before_z = fan.spoke_z[i];
  side.after_z = fan.spoke_z[i + 1];
  side.w_code = u.code + fan.w_z;
  side.least_before = u.closed && i == 0 ? 1.0 : 0.0;
  side.least_after = u.closed && i + 1 == fan.triangles() ? 1.0 : 0.0;
  side.slope_x = (side.before_z * by - side.after_z * ay) * side.inverse;
  side.slope_y = (side.after_z * ax - side.before_z * bx) * side.inverse;
  side.plane_code = side.w_code - (side.slope_x * x + side.slope_y * y);
  side.plane_size = std::abs(side.w_code) + std::abs(side.slope_x) * (std::abs(x) + width_) +
                    std::abs(side.slope_y) * (std::abs(y) + height_);
  const auto column = [&](double of) { return static_cast<std::int32_t>(of); };
  side.columns = {column(std::max(x + std::min({0.0, ax, bx}), 0.0)),
                  column(std::max(y + std::min({0.0, ay, by}), 0.0)),
                  column(std::min(x + std::max({0.0, ax, bx}), width_ - 1.0)),
                  column(std::min(y + std::max({0.0, ay, by}), height_ - 1.0))};
  return side;
}

/// Whether no sample of the block that counts can be farther than `worst`: the block lies outside of
/// the triangle, or both planes are near. Their difference over the block is that in its middle and
/// at most half a side of the difference of their slopes. It takes fewer than 32 roundings of 2^-53
/// relative to the sizes below; those of the node are relative to its own.
bool PlaneBlocks::is_bounded(const Side& side, const Block& block, double worst) const noexcept {
  const double half = (block.side() - 1) / 2.0;
  const double x = block.x + half, y = block.y + half;
  const auto greatest = [&](const Linear& f, double sign) {
    return sign * f(x, y) + half * (std::abs(f.x) + std::abs(f.y));
  };
  if (greatest(side.before, 1.0) < side.least_before ||
      greatest(side.after, -1.0) < side.least_after || greatest(side.link, 1.0) <= 0.0) {
    return true;
  }
  if (block.x + block.side() > width_ || block.y + block.side() > height_) {
    return false;
  }
  const auto log = static_cast<std::size_t>(block.log);
  const Node& node = nodes_[log][static_cast<std::size_t>(block.y >> block.log) *
                                     static_cast<std::size_t>(width_ >> block.log) +
                                 static_cast<std::size_t>(block.x >> block.log)];
  const double plane = side.plane_code + (side.slope_x * x + side.slope_y * y);
  const double slopes =
      std::abs(node.slope_x - side.slope_x) + std::abs(node.slope_y - side.slope_y);
  const double size = side.plane_size + std::abs(node.code) + node.reach +
                      half * (std::abs(node.slope_x) + std::abs(node.slope_y));
  return std::abs(node.code - plane) + half * slopes + node.reach + 0x1p-47 * size <= worst;
}

/// Raises `worst` to the largest residual in the block that counts, if that is more.
void PlaneBlocks::raise(const Side& side, const Block& block, double& worst) const {
  if (is_bounded(side, block, worst)) {
    return;
  }
  if (block.log == kLowestLog) {
    raise_by_samples(side, block, worst);
    return;
  }
  const std::int32_t h = block.side() / 2;
  const GridBox& box = side.columns;
  for (const std::int32_t y : {block.y, block.y + h}) {
    for (const std::int32_t x : {block.x, block.x + h}) {
      if (x <= box.max_x && y <= box.max_y && x + h > box.min_x && y + h > box.min_y) {
        raise(side, {x, y, block.log - 1}, worst);
      }
    }
  }
}

/// As the lanes of fan_measure.cc: in integers but for the last product.
void PlaneBlocks::raise_by_samples(const Side& side, const Block& block,
                                   double& worst) const noexcept {
  const std::int32_t end_x = std::min(block.x + block.side(), width_);
  const std::int32_t end_y = std::min(block.y + block.side(), height_);
  for (std::int32_t y = block.y; y < end_y; ++y) {
    const double* codes = row(0, y);
    for (std::int32_t x = block.x; x < end_x; ++x) {
      const double before = side.before(x, y), after = side.after(x, y);
      if (before < side.least_before || -after < side.least_after || side.link(x, y) <= 0.0) {
        continue;
      }
      const double numerator =
          side.area * (codes[x] - side.w_code) + (side.before_z * after - side.after_z * before);
      worst = std::max(worst, std::abs(numerator) * side.inverse);
    }
  }
}

double PlaneBlocks::largest_residual(const FanFrame& fan, const Centre& u, double known) const {
  double worst = known;
  for (std::size_t i = 0; i < fan.triangles(); ++i) {
    const Side side = side_of(fan, i, u);
    const GridBox& box = side.columns;
    if (box.min_x > box.max_x || box.min_y > box.max_y) {
      continue;
    }
    const auto extent =
        static_cast<std::uint32_t>(std::max(box.max_x - box.min_x, box.max_y - box.min_y));
    const std::int32_t log =
        std::clamp(static_cast<std::int32_t>(std::bit_width(extent)) - 1, kLowestLog, kHighestLog);
    for (std::int32_t y = box.min_y >> log; y <= box.max_y >> log; ++y) {
      for (std::int32_t x = box.min_x >> log; x <= box.max_x >> log; ++x) {
        raise(side, {x << log, y << log, log}, worst);
      }
    }
  }
  return worst;
}

double PlaneBlocks::largest_z(const Centre& u) const noexcept {
  return std::max(std::abs(least_ - u.code), std::abs(greatest_ - u.code));
}

}  // namespace ptin
