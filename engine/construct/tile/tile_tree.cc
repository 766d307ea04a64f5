// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/tile_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/geometry/hilbert.h"

namespace ptin {

namespace {

/// Number of leaves along a length of `units` grid units. A rest of less than half a side is added
/// to the last leaf.
std::int64_t leaves_along(std::int64_t units, std::int64_t side) {
  return std::max<std::int64_t>((units + side / 2) / side, 1);
}

}  // namespace

TileTree::TileTree(std::int64_t width, std::int64_t height, std::int64_t side)
    : width_(width),
      height_(height),
      side_(side),
      leaves_x_(leaves_along(width - 1, side)),
      leaves_y_(leaves_along(height - 1, side)) {
  while ((std::int64_t{1} << (levels_ - 1)) < std::max(leaves_x_, leaves_y_)) {
    ++levels_;
  }
}

TileTree TileTree::over_points(std::uint64_t points, std::optional<std::int64_t> side,
                               std::shared_ptr<const ConvexHull> hull) {
  const auto across = static_cast<std::int64_t>(std::ceil(std::sqrt(static_cast<double>(points))));
  const auto along = static_cast<std::uint64_t>(side.value_or(default_side(across, across)));
  const std::uint64_t most = along * along;
  int halvings = 0;
  while (points > 0 && ((points - 1) >> (2 * halvings)) + 1 > most) {
    ++halvings;
  }
  const double in_leaf = std::ceil(std::ldexp(static_cast<double>(points), -2 * halvings));
  const auto leaf_side =
      std::max<std::int64_t>(static_cast<std::int64_t>(std::ceil(std::sqrt(in_leaf))), 2);
  const std::int64_t width = (leaf_side << halvings) + 1;
  TileTree tree(width, width, leaf_side);
  tree.hull_ = std::move(hull);
  return tree;
}

std::uint64_t TileTree::leaf_number(const SampleRange& window) const noexcept {
  // The curve of order 32 begins with the 4^k leaves. It visits them as the curve of order k does,
  // or mirrored at the diagonal, always the same for one k.
  return hilbert_position(static_cast<std::uint32_t>(window.x0 / side_),
                          static_cast<std::uint32_t>(window.y0 / side_));
}

std::int64_t TileTree::default_side(std::int64_t width, std::int64_t height) noexcept {
  constexpr std::int64_t kStep = 32;
  const std::int64_t longer = std::max(width, height) - 1;
  std::int64_t side = 256;
  while (side * side < 4 * longer) {
    side += kStep;
  }
  return longer + 1 <= side + side / 2 ? longer + 1 : side;
}

std::vector<TileId> TileTree::children(const TileId& id) const {
  std::vector<TileId> tiles;
  if (id.level == 0) {
    return tiles;
  }
  const int level = id.level - 1;
  const auto count = [level](std::int64_t leaves) {
    return (leaves + (std::int64_t{1} << level) - 1) >> level;
  };
  for (std::int64_t y = 2 * id.y; y < std::min(2 * id.y + 2, count(leaves_y_)); ++y) {
    for (std::int64_t x = 2 * id.x; x < std::min(2 * id.x + 2, count(leaves_x_)); ++x) {
      tiles.push_back({level, x, y});
    }
  }
  return tiles;
}

SampleRange TileTree::window(const TileId& id) const noexcept {
  const std::int64_t span = side_ << id.level;
  const auto begin = [&](std::int64_t i) { return i * span; };
  const auto end = [&](std::int64_t i, std::int64_t leaves, std::int64_t units) {
    return ((i + 1) << id.level) >= leaves ? units : (i + 1) * span;
  };
  const std::int64_t x0 = begin(id.x);
  const std::int64_t y0 = begin(id.y);
  return {x0, y0, end(id.x, leaves_x_, width_ - 1) - x0 + 1,
          end(id.y, leaves_y_, height_ - 1) - y0 + 1};
}

bool TileTree::on_seam(const TileId& id, std::int64_t x, std::int64_t y) const noexcept {
  const SampleRange w = window(id);
  const auto seam = [](std::int64_t v, std::int64_t first, std::int64_t count, std::int64_t whole) {
    return (v == first && first > 0) || (v == first + count - 1 && v < whole - 1);
  };
  return seam(x, w.x0, w.width, width_) || seam(y, w.y0, w.height, height_);
}

}  // namespace ptin
