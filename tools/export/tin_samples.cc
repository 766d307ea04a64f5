// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/export/tin_samples.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/geometry/orient.h"

namespace ptin::tools {

namespace {

__extension__ using Int128 = __int128;

constexpr int kLatticeBits = PixelGrid::kLatticeBits;

/// A place on the lattice.
struct Spot {
  std::int64_t x, y;
};

/// A corner of a triangle: its position on the grid and on the lattice, and its height code.
struct Corner {
  GridPoint at;
  Spot spot;
  double code;
};

/// Twice the area of (a, b, p) in units of grid times lattice: below 2^82.
Int128 area(const Corner& a, const Corner& b, Spot p) {
  return Int128{b.at.x - a.at.x} * (p.y - a.spot.y) - Int128{b.at.y - a.at.y} * (p.x - a.spot.x);
}

/// (sum of weight * code) / (sum of weights). Where codes are whole numbers, exact up to the last
/// rounding.
double weighted(const std::array<Int128, 3>& w, const std::array<double, 3>& code, bool whole) {
  const Int128 sum = w[0] + w[1] + w[2];
  if (!whole) {
    const double inverse = 1.0 / static_cast<double>(sum);
    return code[0] + (static_cast<double>(w[1]) * (code[1] - code[0]) +
                      static_cast<double>(w[2]) * (code[2] - code[0])) *
                         inverse;
  }
  Int128 moment = 0;  // below 2^82 * 2^31
  for (std::size_t i = 0; i < 3; ++i) moment += w[i] * static_cast<std::int64_t>(code[i]);
  return static_cast<double>(moment / sum) +
         static_cast<double>(moment % sum) / static_cast<double>(sum);
}

/// A surface triangle with its corners in the order of their keys, which is asked for heights.
class Facet {
 public:
  Facet(const Tin& tin, TriangleId t, const HeightEncoding& heights)
      : Facet(heights,
              [&](std::size_t i) -> const Vertex& { return tin.vertices[tin.triangles[t].v[i]]; }) {
  }
  Facet(const LivingTriangle& t, const HeightEncoding& heights)
      : Facet(heights,
              [&](std::size_t i) -> const LivingTriangle::Corner& { return t.corner[i]; }) {}

  [[nodiscard]] std::array<std::int64_t, 2> x_range() const {
    return {std::min({corner_[0].spot.x, corner_[1].spot.x, corner_[2].spot.x}),
            std::max({corner_[0].spot.x, corner_[1].spot.x, corner_[2].spot.x})};
  }
  [[nodiscard]] std::array<std::int64_t, 2> y_range() const {
    return {corner_[0].spot.y, corner_[2].spot.y};  // keys order by y first
  }

  /// About the x at which the row `y` enters and leaves the triangle; off by rounding alone.
  [[nodiscard]] std::array<double, 2> span(std::int64_t y) const {
    double low = INFINITY;
    double high = -INFINITY;
    for (std::size_t i = 0; i < 3; ++i) {
      const Spot a = corner_[i].spot;
      const Spot b = corner_[(i + 1) % 3].spot;
      if (std::min(a.y, b.y) > y || std::max(a.y, b.y) < y) continue;
      const auto ax = static_cast<double>(a.x);
      const auto bx = static_cast<double>(b.x);
      if (a.y == b.y) {
        low = std::min({low, ax, bx});
        high = std::max({high, ax, bx});
        continue;
      }
      const double x =
          ax + static_cast<double>(y - a.y) / static_cast<double>(b.y - a.y) * (bx - ax);
      low = std::min(low, x);
      high = std::max(high, x);
    }
    return {low, high};
  }

  /// True when `p` lies in the closed triangle.
  [[nodiscard]] bool holds(Spot p) const {
    const std::array<Int128, 3> w = weights_at(p);
    return w[0] >= 0 && w[1] >= 0 && w[2] >= 0;
  }

  /// The code at `p`, when it lies in the closed triangle.
  [[nodiscard]] std::optional<double> code_at(Spot p) const {
    const std::array<Int128, 3> w = weights_at(p);
    if (w[0] < 0 || w[1] < 0 || w[2] < 0) return std::nullopt;
    for (std::size_t i = 0; i < 3; ++i) {
      if (w[i] == 0) return code_on_edge((i + 1) % 3, (i + 2) % 3, p);
    }
    return weighted(w, {corner_[0].code, corner_[1].code, corner_[2].code}, whole_);
  }

 private:
  /// @param corner  Gives position and height of corner 0, 1, 2.
  template <typename CornerOf>
  Facet(const HeightEncoding& heights, const CornerOf& corner)
      : whole_(heights.type == HeightType::int32) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& v = corner(i);
      corner_[i] = {
          v.position,
          {std::int64_t{v.position.x} << kLatticeBits, std::int64_t{v.position.y} << kLatticeBits},
          heights.code(v.height)};
    }
    std::sort(corner_.begin(), corner_.end(),
              [](const Corner& a, const Corner& b) { return key_of(a.at) < key_of(b.at); });
    is_turned_ = orient(corner_[0].at, corner_[1].at, corner_[2].at) < 0;
  }

  [[nodiscard]] std::array<Int128, 3> weights_at(Spot p) const {
    const std::array<Int128, 3> w = {area(corner_[1], corner_[2], p),
                                     area(corner_[2], corner_[0], p),
                                     area(corner_[0], corner_[1], p)};
    return is_turned_ ? std::array<Int128, 3>{-w[0], -w[1], -w[2]} : w;
  }

  /// The code at a point of the edge between two corners, from distances along the longer axis
  /// alone.
  [[nodiscard]] double code_on_edge(std::size_t i, std::size_t j, Spot p) const {
    const Corner& a = corner_[std::min(i, j)];
    const Corner& b = corner_[std::max(i, j)];
    const std::int64_t dx = std::abs(b.spot.x - a.spot.x);
    const std::int64_t dy = std::abs(b.spot.y - a.spot.y);
    const std::int64_t way = dx >= dy ? std::abs(p.x - a.spot.x) : std::abs(p.y - a.spot.y);
    const std::int64_t length = std::max(dx, dy);
    if (way == 0 || way == length) return way == 0 ? a.code : b.code;  // as it is, bit for bit
    return weighted({Int128{length - way}, Int128{way}, Int128{0}}, {a.code, b.code, a.code},
                    whole_);
  }

  std::array<Corner, 3> corner_{};
  bool whole_;
  bool is_turned_ = false;
};

/// The corners from the one with the least key on: the same for a triangle however it came about.
std::array<VertexId, 3> from_least(const Tin& tin, std::array<VertexId, 3> corners) {
  const auto by_key = [&](VertexId a, VertexId b) {
    return key_of(tin.position(a)) < key_of(tin.position(b));
  };
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), by_key),
              corners.end());
  return corners;
}

/// The centres of a part's pixels.
class Centres {
 public:
  /// @param rect  What the buffer holds, around `part`.
  Centres(const PixelGrid& grid, const PixelRect& part, const PixelRect& rect)
      : part_(part),
        rect_(rect),
        xs_(static_cast<std::size_t>(part.width)),
        ys_(static_cast<std::size_t>(part.height)) {
    for (std::size_t i = 0; i < xs_.size(); ++i) {
      xs_[i] = grid.x(part.column + static_cast<std::int64_t>(i));
    }
    for (std::size_t j = 0; j < ys_.size(); ++j) {
      ys_[ys_.size() - 1 - j] = grid.y(part.row + static_cast<std::int64_t>(j));
    }
    are_grid_positions_ = are_whole_steps(xs_) && are_whole_steps(ys_);
  }

  /// The first of ascending numbers that is not below `v`: about where they would be evenly spaced,
  /// as centres nearly are.
  [[nodiscard]] static std::size_t first_from(const std::vector<std::int64_t>& steps,
                                              std::int64_t v) {
    const auto last = static_cast<double>(steps.size() - 1);
    const auto whole = static_cast<double>(steps.back() - steps.front());
    const double share = static_cast<double>(v - steps.front()) / std::max(whole, 1.0);
    auto i = static_cast<std::size_t>(std::clamp(share * last, 0.0, last));
    while (i > 0 && steps[i - 1] >= v) --i;
    while (i < steps.size() && steps[i] < v) ++i;
    return i;
  }

  /// Whether they are the positions of the grid, each one within their box: then a triangle's
  /// corners are centres, and the smallest triangles hold no other ones.
  [[nodiscard]] bool are_grid_positions() const { return are_grid_positions_; }

  /// The place in the buffer of a position of the grid, or kNowhere.
  /// REQUIRES: are_grid_positions()
  [[nodiscard]] std::size_t place_of(GridPoint p) const {
    const std::int64_t column = p.x - (xs_.front() >> kLatticeBits);
    const std::int64_t row = (ys_.back() >> kLatticeBits) - p.y;
    if (column < 0 || column >= part_.width || row < 0 || row >= part_.height) return kNowhere;
    return static_cast<std::size_t>((part_.row + row - rect_.row) * rect_.width + part_.column +
                                    column - rect_.column);
  }
  static constexpr std::size_t kNowhere = SIZE_MAX;

  /// True when the box of a triangle holds none of them.
  [[nodiscard]] bool misses(const Facet& facet) const {
    const auto [low_y, high_y] = facet.y_range();
    const auto [low_x, high_x] = facet.x_range();
    return high_y < ys_.front() || low_y > ys_.back() || high_x < xs_.front() || low_x > xs_.back();
  }

  /// Calls `found(place, spot)` for each centre about in `facet`, and for some that are next to it;
  /// `place` is in the buffer.
  template <typename Found>
  void near(const Facet& facet, const Found& found) const {
    if (misses(facet)) return;
    const auto [low_y, high_y] = facet.y_range();
    for (std::size_t j = first_from(ys_, low_y); j < ys_.size() && ys_[j] <= high_y; ++j) {
      const auto [from, to] = facet.span(ys_[j]);
      constexpr double kRounding = 4.0;  // lattice units; exact tests follow
      const auto row = part_.row + static_cast<std::int64_t>(ys_.size() - j - 1) - rect_.row;
      for (std::size_t i = first_from(xs_, static_cast<std::int64_t>(std::floor(from - kRounding)));
           i < xs_.size() && static_cast<double>(xs_[i]) <= to + kRounding; ++i) {
        const std::int64_t column = part_.column + static_cast<std::int64_t>(i) - rect_.column;
        found(static_cast<std::size_t>(row * rect_.width + column), Spot{xs_[i], ys_[j]});
      }
    }
  }

 private:
  /// Whether numbers are whole grid units, each one more than that before it.
  static bool are_whole_steps(const std::vector<std::int64_t>& steps) {
    constexpr std::int64_t kUnit = std::int64_t{1} << kLatticeBits;
    const auto is_off = [](std::int64_t a, std::int64_t b) { return b - a != kUnit; };
    return steps.front() % kUnit == 0 &&
           std::adjacent_find(steps.begin(), steps.end(), is_off) == steps.end();
  }

  PixelRect part_, rect_;
  bool are_grid_positions_ = false;
  /// Both ascend: the row j from the north stands at ys_.size() - 1 - j.
  std::vector<std::int64_t> xs_, ys_;
};

bool is_surface(const Tin& tin, TriangleId t) {
  return tin.is_alive(t) && tin.classes[t] != TriangleClass::kVoid;
}

/// The surface triangles over `centres`, in an order that does not depend on how the TIN came
/// about: by their least corner and the one behind it, which two triangles never share.
std::vector<TriangleId> in_order(const Tin& tin, const Centres& centres,
                                 const HeightEncoding& heights) {
  struct Keyed {
    VertexKey least, next;
    TriangleId triangle;
  };
  std::vector<Keyed> keyed;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (!is_surface(tin, t) || centres.misses(Facet(tin, t, heights))) continue;
    const auto corners = from_least(tin, std::to_array(tin.triangles[t].v));
    keyed.push_back({key_of(tin.position(corners[0])), key_of(tin.position(corners[1])), t});
  }
  std::sort(keyed.begin(), keyed.end(), [](const Keyed& a, const Keyed& b) {
    return a.least != b.least ? a.least < b.least : a.next < b.next;
  });
  std::vector<TriangleId> order(keyed.size());
  std::transform(keyed.begin(), keyed.end(), order.begin(),
                 [](const Keyed& k) { return k.triangle; });
  return order;
}

}  // namespace

struct HeightSamples::Impl {
  HeightEncoding encoding;
  Centres centres;
};

HeightSamples::HeightSamples(const StoreFacts& facts, const PixelGrid& grid, const PixelRect& rect,
                             std::vector<double>& heights)
    : impl_(std::make_unique<const Impl>(Impl{facts.heights, Centres(grid, rect, rect)})),
      heights_(heights) {}
HeightSamples::~HeightSamples() = default;

void HeightSamples::add(const LivingTriangle& t) {
  if (t.is_void || (impl_->centres.are_grid_positions() && !add_corners(t))) return;
  const Facet facet(t, impl_->encoding);
  impl_->centres.near(facet, [&](std::size_t place, Spot spot) {
    if (!std::isnan(heights_[place])) return;  // another triangle gives the same height
    if (const auto code = facet.code_at(spot)) {
      heights_[place] = impl_->encoding.height_of_code(*code);
    }
  });
}

/// Sets the heights of the corners. Returns whether the triangle may hold other positions of the
/// grid: not when it is half a square unit, by Pick's theorem.
bool HeightSamples::add_corners(const LivingTriangle& t) {
  for (const LivingTriangle::Corner& c : t.corner) {
    const std::size_t place = impl_->centres.place_of(c.position);
    if (place != Centres::kNowhere && std::isnan(heights_[place])) {
      heights_[place] = impl_->encoding.height(c.height);
    }
  }
  const GridPoint a = t.corner[0].position;
  const GridPoint b = t.corner[1].position;
  const GridPoint c = t.corner[2].position;
  return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) -
             (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x) !=
         1;
}

void sample_normals(const Tin& tin, const StoreFacts& facts, const PixelGrid& grid,
                    const PixelRect& part, const PixelRect& rect,
                    std::vector<GridNormal>& normals) {
  const Centres centres(grid, part, rect);
  for (const TriangleId t : in_order(tin, centres, facts.heights)) {
    const Facet facet(tin, t, facts.heights);
    const GridNormal normal = normal_of(tin, std::to_array(tin.triangles[t].v), facts.heights);
    centres.near(facet, [&](std::size_t place, Spot spot) {
      if (!facet.holds(spot)) return;
      normals[place].x += normal.x;
      normals[place].y += normal.y;
      normals[place].z += normal.z;
    });
  }
}

GridNormal normal_of(const Tin& tin, const std::array<VertexId, 3>& corners,
                     const HeightEncoding& heights) {
  std::array<double, 3> x{}, y{}, code{};
  const auto turned = from_least(tin, corners);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vertex& v = tin.vertices[turned[i]];
    x[i] = v.position.x;
    y[i] = v.position.y;
    code[i] = heights.code(v.height);
  }
  const double ax = x[1] - x[0], ay = y[1] - y[0], ah = code[1] - code[0];
  const double bx = x[2] - x[0], by = y[2] - y[0], bh = code[2] - code[0];
  return {ay * bh - ah * by, ah * bx - ax * bh, ax * by - ay * bx};
}

Slope slope_of(const GridNormal& normal, const StoreFacts& facts, MapPoint per_map_unit) {
  const double east = facts.map.step_x * per_map_unit.x;
  const double north = facts.map.step_y * per_map_unit.y;
  const auto rise = [&](double part, double run) {
    return run > 0 ? -part / normal.z * facts.heights.step / run : 0.0;
  };
  return {rise(normal.x, east), rise(normal.y, north)};
}

}  // namespace ptin::tools
