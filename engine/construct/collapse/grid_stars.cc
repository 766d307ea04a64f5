// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse/grid_stars.h"

#include <algorithm>
#include <cmath>

#include "engine/construct/measure/fan_measure.h"

namespace ptin {

namespace {

/// One of the eight neighbours of u by its place: row by row from the south-west, u left out.
constexpr std::array<GridPoint, 8> kPlaces{
    {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}};
/// The places counter-clockwise, from the east.
constexpr std::array<std::uint8_t, 8> kRound{4, 7, 6, 5, 3, 0, 1, 2};

/// A collapse into the neighbour at place w: u lies in the fan triangle (w, a, b). Its residual is
/// |area * -z_w + (z_b - z_w) * cross_a - (z_a - z_w) * cross_b| * inverse.
struct GridCandidate {
  std::uint8_t w, a, b;
  double cross_a, cross_b, area, inverse;
};

/// The candidates of one shape of star, by rising key of w.
struct GridStarShape {
  std::array<GridCandidate, 8> candidates;
  std::uint32_t count = 0;
};

double cross_of_places(std::uint8_t a, std::uint8_t b) noexcept {
  return static_cast<double>(kPlaces[a].x * kPlaces[b].y - kPlaces[a].y * kPlaces[b].x);
}

/// The link of a star: east, north, west and south, and the corners of those cells whose diagonal
/// ends at u, one bit each from the north-eastern cell counter-clockwise.
std::vector<std::uint8_t> grid_link_of(std::uint32_t shape) {
  std::vector<std::uint8_t> link;
  for (std::size_t i = 0; i < 8; ++i) {
    const bool is_corner = i % 2 != 0;
    if (!is_corner || (shape >> (i / 2) & 1U) != 0) {
      link.push_back(kRound[i]);
    }
  }
  return link;
}

/// As Screen in collapse_choice.cc. Nothing where a fan triangle would not be
/// counter-clockwise.
std::optional<GridCandidate> grid_candidate_of(const std::vector<std::uint8_t>& link,
                                               std::uint8_t w) {
  GridCandidate found{w, 0, 0, 0.0, 0.0, 1.0, 1.0};
  std::uint8_t a = link.back();
  for (const std::uint8_t b : link) {
    const double c_a = cross_of_places(a, w);  // -c(w, a)
    const double c_b = cross_of_places(b, w);
    const double area = cross_of_places(a, b) - c_a + c_b;
    if (a != w && b != w && !(area > 0.0)) {
      return std::nullopt;
    }
    if (std::min(-c_a, c_b) >= 0.0) {
      found = {w, a, b, c_a, c_b, area, 1.0 / area};
    }
    a = b;
  }
  return found;
}

GridStarShape make_shape(std::uint32_t number) {
  GridStarShape shape;
  const std::vector<std::uint8_t> link = grid_link_of(number);
  for (std::uint8_t w = 0; w < kPlaces.size(); ++w) {  // places are in the order of the keys
    if (std::find(link.begin(), link.end(), w) == link.end()) {
      continue;
    }
    if (const auto candidate = grid_candidate_of(link, w)) {
      shape.candidates[shape.count++] = *candidate;
    }
  }
  return shape;
}

const std::array<GridStarShape, 16>& shapes() {
  static const auto all = [] {
    std::array<GridStarShape, 16> made;
    for (std::uint32_t i = 0; i < made.size(); ++i) {
      made[i] = make_shape(i);
    }
    return made;
  }();
  return all;
}

}  // namespace

GridStars::GridStars(const Tile& tile, const GridBox& box)
    : tile_(tile), width_(box.max_x - box.min_x + 1), height_(box.max_y - box.min_y + 1) {
  rising_.resize(tile.tin.vertices.size());
  std::size_t cell = 0;
  for (std::int32_t y = 0; y + 1 < height_; ++y) {
    for (std::int32_t x = 0; x + 1 < width_; ++x, ++cell) {
      const std::int32_t at = y * width_ + x;
      // The last corner of the first half of a cell is its upper right one where the cut rises.
      const VertexId last = tile.tin.triangles[2 * cell].v[2];
      rising_[static_cast<std::size_t>(at)] =
          last == static_cast<VertexId>(at + width_ + 1) ? 1 : 0;
    }
  }
}

/// True when u and all its neighbours have heights, and no triangle of the star holds a witness.
bool GridStars::is_plain(std::int32_t x, std::int32_t y) const noexcept {
  if (!tile_.has_voids && tile_.samples.used() == 0) {
    return true;
  }
  for (std::int32_t row = y - 1; row <= y + 1; ++row) {
    const auto at = static_cast<std::size_t>(row * width_ + x);
    if ((tile_.tin.has_height[at - 1] & tile_.tin.has_height[at] & tile_.tin.has_height[at + 1]) ==
        0) {
      return false;
    }
  }
  for (std::int32_t row = y - 1; row <= y; ++row) {
    const auto cell = 2 * static_cast<std::size_t>(row * (width_ - 1) + x - 1);
    for (std::size_t t = cell; t < cell + 4; ++t) {
      if (tile_.carried[t].samples.count != 0) {
        return false;
      }
    }
  }
  return true;
}

/// Which corners the star of u reaches, as grid_link_of() has it.
std::uint32_t GridStars::shape_at(std::int32_t x, std::int32_t y) const noexcept {
  const auto at = static_cast<std::size_t>(y * width_ + x);
  const auto below = at - static_cast<std::size_t>(width_);
  const std::uint32_t north_east = rising_[at];
  const std::uint32_t north_west = 1U ^ rising_[at - 1];
  const std::uint32_t south_west = rising_[below - 1];
  const std::uint32_t south_east = 1U ^ rising_[below];
  return north_east | north_west << 1 | south_west << 2 | south_east << 3;
}

/// As CollapseChooser rounds an error up; nothing where exact arithmetic would have to decide
/// whether it is 0.
std::optional<double> GridStars::certified(double error, double largest_z) const noexcept {
  StarSamples s;
  s.largest_xy = 1.0;
  s.largest_z = largest_z;
  const double bound = residual_bound(s, tile_.units);
  if (bound > 0.0 && error <= bound) {
    return std::nullopt;
  }
  return certified_residual(error, s, tile_.units);
}

std::optional<GridStars::Choice> GridStars::choose(VertexId u) const noexcept {
  const std::int32_t x = static_cast<std::int32_t>(u) % width_;
  const std::int32_t y = static_cast<std::int32_t>(u) / width_;
  if (x == 0 || y == 0 || x + 1 == width_ || y + 1 == height_ || !is_plain(x, y)) {
    return std::nullopt;
  }
  const HeightEncoding& heights = tile_.units.heights;
  const auto vertex_at = [&](std::uint8_t place) {
    return static_cast<VertexId>(static_cast<std::int32_t>(u) + kPlaces[place].y * width_ +
                                 kPlaces[place].x);
  };
  const double code = heights.code(tile_.tin.vertices[u].height);
  std::array<double, 8> z;
  double largest_z = 0.0;
  for (std::uint8_t i = 0; i < z.size(); ++i) {
    z[i] = heights.code(tile_.tin.vertices[vertex_at(i)].height) - code;
  }
  const std::uint32_t number = shape_at(x, y);
  const GridStarShape& shape = shapes()[number];
  for (std::size_t i = 0; i < 8; ++i) {
    const bool in_link = i % 2 == 0 || (number >> (i / 2) & 1U) != 0;
    largest_z = in_link ? std::max(largest_z, std::abs(z[kRound[i]])) : largest_z;
  }
  const GridCandidate* best = nullptr;
  double least = 0.0;
  for (std::uint32_t i = 0; i < shape.count; ++i) {
    const GridCandidate& c = shape.candidates[i];
    const double z_w = z[c.w];
    const double error =
        std::abs(c.area * -z_w + ((z[c.b] - z_w) * c.cross_a - (z[c.a] - z_w) * c.cross_b)) *
        c.inverse;
    if (best == nullptr || error < least) {
      best = &c;
      least = error;
    }
  }
  if (best == nullptr) {
    return std::nullopt;
  }
  if (largest_z == 0.0) {
    return Choice{vertex_at(best->w), 0.0};
  }
  const std::optional<double> error = certified(least, largest_z);
  return error ? std::optional<Choice>{{vertex_at(best->w), *error}} : std::nullopt;
}

}  // namespace ptin
