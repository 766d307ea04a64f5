// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/refine/floor_check.h"

#include <algorithm>
#include <array>

namespace ptin {

namespace {

std::string name_of_position(GridPoint p) {
  return "(" + std::to_string(p.x) + ", " + std::to_string(p.y) + ")";
}

bool is_lower(GridPoint a, GridPoint b) { return a.y != b.y ? a.y < b.y : a.x < b.x; }

/// The corner of a triangle by which it belongs to a cell.
GridPoint lowest(const std::array<GridPoint, 3>& corners) {
  return *std::min_element(corners.begin(), corners.end(), is_lower);
}

/// The square whose half a triangle is; none: it is no half of one.
std::optional<GridPoint> square_of(const std::array<GridPoint, 3>& corners) {
  const auto [min_x, max_x] = std::minmax({corners[0].x, corners[1].x, corners[2].x});
  const auto [min_y, max_y] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
  if (max_x - min_x != 1 || max_y - min_y != 1) return std::nullopt;
  return GridPoint{min_x, min_y};
}

}  // namespace

std::optional<VerifyFault> FloorCheck::fault_in(const Tin& tin, const GridCell& cell,
                                                IoCounters& counters) {
  const GridBox box = cell.box();
  const GridBox& bounds = facts_.bounds;
  samples_ = {std::max(box.min_x - 1, bounds.min_x), std::max(box.min_y, bounds.min_y),
              std::min(box.max_x + 1, bounds.max_x), std::min(box.max_y + 1, bounds.max_y)};
  if (is_empty(samples_)) return std::nullopt;
  width_ = static_cast<std::size_t>(samples_.max_x - samples_.min_x) + 1;
  if (auto fault = read(counters)) return fault;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const auto& v = tin.triangles[t].v;
    const std::array<GridPoint, 3> corners{tin.position(v[0]), tin.position(v[1]),
                                           tin.position(v[2])};
    if (!cell.holds(lowest(corners)) || !square_of(corners)) continue;
    if (std::string fault = fault_in_triangle(tin, t); !fault.empty()) {
      return VerifyFault{std::move(fault), "the heights of the raster"};
    }
  }
  if (const std::optional<GridPoint> square = missing(cell)) {
    return VerifyFault{"the full TIN lacks a triangle of the square at " +
                           name_of_position(*square) +
                           ", which follows from the heights of the raster",
                       "the full TIN"};
  }
  return std::nullopt;
}

/// Reads the samples of the box, those that tiles share from each of them.
std::optional<VerifyFault> FloorCheck::read(IoCounters& counters) {
  const std::size_t all = width_ * (static_cast<std::size_t>(samples_.max_y - samples_.min_y) + 1);
  heights_.assign(all, 0);
  state_.assign(all, Sample::kUnread);
  found_.assign(all, 0);
  std::optional<VerifyFault> fault;
  Floor::Recent recent;
  floor_.visit([&](const Floor::Bounds& b) { return meets(b.box, samples_); },
               [&](const Floor::TileAt& at, const FloorTile& t) {
                 if (put(at, t)) return true;
                 fault = {"the tile in column " + std::to_string(at.column) + ", row " +
                              std::to_string(at.row) +
                              " differs from one beside it in a sample of both",
                          "the heights of the raster"};
                 return false;
               },
               recent, counters);
  return fault;
}

/// Copies the samples of a tile that lie in the box. False: one is there already, and differs.
bool FloorCheck::put(const Floor::TileAt& at, const FloorTile& tile) {
  const FloorShape& shape = floor_.facts().shape;
  const FloorNumbers& numbers = floor_.numbers();
  const std::int64_t left = shape.first_of(at.column), low = shape.first_of(at.row);
  const std::int64_t first_x = std::max<std::int64_t>(left, samples_.min_x);
  const std::int64_t end_x = std::min<std::int64_t>(left + tile.width, samples_.max_x + 1LL);
  const std::int64_t end_y = std::min<std::int64_t>(low + tile.height, samples_.max_y + 1LL);
  bool is_same = true;
  const auto put_sample = [&](std::size_t place, Sample state, HeightBits height) {
    is_same = is_same && (state_[place] == Sample::kUnread ||
                          (state_[place] == state && heights_[place] == height));
    state_[place] = state;
    heights_[place] = height;
  };
  for (std::int64_t y = std::max<std::int64_t>(low, samples_.min_y); y < end_y; ++y) {
    auto i = static_cast<std::size_t>((y - low) * tile.width + first_x - left);
    for (std::int64_t x = first_x; x < end_x; ++x, ++i) {
      if (!tile.is_void.empty() && tile.is_void[i] != 0) {
        const auto lone = std::ranges::lower_bound(tile.lone, i, {}, &FloorTile::Lone::place);
        const bool is_lone = lone != tile.lone.end() && lone->place == i;
        put_sample(place_of(x, y), is_lone ? Sample::kLone : Sample::kVoid,
                   is_lone ? numbers.bits(lone->height) : 0);
      } else {
        put_sample(place_of(x, y), Sample::kHeight, numbers.bits(tile.heights[i]));
      }
    }
  }
  return is_same;
}

Diagonal FloorCheck::diagonal_at(GridPoint square) const {
  RasterCell cell{};
  for (std::size_t i = 0; i < 4; ++i) {
    const GridPoint p = cell_corner(square, i);
    cell.code[i] = facts_.heights.code(heights_[place_of(p.x, p.y)]);
    cell.has_height[i] = has_height(p) ? 1 : 0;
  }
  return cell_diagonal(cell, square);
}

/// Notes a triangle that is one half of a square. @returns what is wrong with it, or nothing
std::string FloorCheck::fault_in_triangle(const Tin& tin, TriangleId t) {
  const auto& v = tin.triangles[t].v;
  bool is_void = false;
  for (const VertexId corner : v) {
    const GridPoint p = tin.position(corner);
    if (!contains(samples_, p)) return "the vertex " + name_of_position(p) + " is no sample of it";
    if ((tin.has_height[corner] != 0) != has_height(p)) {
      return "the vertex " + name_of_position(p) +
             (has_height(p) ? " has no height, and there it has one"
                            : " has a height, and there it has none");
    }
    // A float -0 is written as 0 in both.
    if (has_height(p) && tin.vertices[corner].height != heights_[place_of(p.x, p.y)]) {
      return "the vertex " + name_of_position(p) + " has another height there";
    }
    is_void = is_void || !has_height(p);
  }
  const std::array<GridPoint, 3> corners{tin.position(v[0]), tin.position(v[1]),
                                         tin.position(v[2])};
  const GridPoint square = *square_of(corners);
  if (is_void != (tin.classes[t] == TriangleClass::kVoid)) {
    return "the class of a triangle of the square at " + name_of_position(square) +
           " is not the one that follows from them";
  }
  const CellTriangles triangles = cell_triangles(diagonal_at(square));
  for (std::size_t half = 0; half < 2; ++half) {
    const bool is_it = std::ranges::all_of(triangles[half], [&](std::uint8_t i) {
      return std::ranges::find(corners, cell_corner(square, i)) != corners.end();
    });
    if (is_it) found_[place_of(square.x, square.y)] |= static_cast<std::uint8_t>(1U << half);
  }
  return {};
}

/// A square of which a triangle that belongs to the cell was not found.
std::optional<GridPoint> FloorCheck::missing(const GridCell& cell) const {
  for (std::int32_t y = samples_.min_y; y < samples_.max_y; ++y) {
    for (std::int32_t x = samples_.min_x; x < samples_.max_x; ++x) {
      const GridPoint square{x, y};
      const std::uint8_t found = found_[place_of(x, y)];
      if (found == 3) continue;
      const CellTriangles triangles = cell_triangles(diagonal_at(square));
      for (std::size_t half = 0; half < 2; ++half) {
        const std::array<GridPoint, 3> corners{cell_corner(square, triangles[half][0]),
                                               cell_corner(square, triangles[half][1]),
                                               cell_corner(square, triangles[half][2])};
        if ((found >> half & 1) == 0 && cell.holds(lowest(corners))) return square;
      }
    }
  }
  return std::nullopt;
}

}  // namespace ptin
