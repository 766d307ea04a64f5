// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/export/pixel_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "engine/error.h"
#include "engine/geometry/orient.h"

namespace ptin::tools {

namespace {

__extension__ using Int128 = __int128;

constexpr int kLatticeBits = 20;
constexpr double kLattice = 1048576.0;  // 2^20
constexpr std::int64_t kMostPixels = INT32_MAX;

/// Whole multiples of `size` from `origin` in [low, high], as the first and their number; the number
/// may be 0.
std::array<std::int64_t, 2> multiples_in(double origin, double size, double low, double high) {
  // The window's own rounding must not lose a centre that lies on its border.
  const double slack = 1e-9;
  const double first = std::ceil((low - origin) / size - slack);
  const double last = std::floor((high - origin) / size + slack);
  if (!(last >= first)) return {0, 0};
  if (last - first >= static_cast<double>(kMostPixels) || std::abs(first) > 0x1p53) {
    throw Error(ErrorCode::invalid_argument,
                "the raster would have more than 2^31 columns or rows; give a larger --pixel-size");
  }
  return {static_cast<std::int64_t>(first), static_cast<std::int64_t>(last - first) + 1};
}

/// Refuses what nobody means by a raster: pixels so large that one of them covers the window, as of
/// metres where the map unit is the degree.
void check_pixels(std::int64_t columns, std::int64_t rows, std::array<double, 2> size,
                  const Window& window) {
  if (columns >= 2 && rows >= 2) return;
  std::array<char, 256> text{};
  std::snprintf(
      text.data(), text.size(),
      "%lld x %lld pixels of %.10g x %.10g map units fit the window of %.10g x %.10g, and "
      "a raster has 2 x 2 at least; give a smaller size (over ground as 90m), or a larger "
      "window",
      static_cast<long long>(columns), static_cast<long long>(rows), size[0], size[1],
      window.max_x - window.min_x, window.max_y - window.min_y);
  throw Error(ErrorCode::invalid_argument, text.data(), "--pixel-size");
}

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
      : whole_(heights.type == HeightType::int32) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vertex& v = tin.vertices[tin.triangles[t].v[i]];
      corner_[i] = {
          v.position,
          {std::int64_t{v.position.x} << kLatticeBits, std::int64_t{v.position.y} << kLatticeBits},
          heights.code(v.height)};
    }
    std::sort(corner_.begin(), corner_.end(),
              [](const Corner& a, const Corner& b) { return key_of(a.at) < key_of(b.at); });
    is_turned_ = orient(corner_[0].at, corner_[1].at, corner_[2].at) < 0;
  }

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

  /// The code at `p`, when it lies in the closed triangle.
  [[nodiscard]] std::optional<double> code_at(Spot p) const {
    std::array<Int128, 3> w = {area(corner_[1], corner_[2], p), area(corner_[2], corner_[0], p),
                               area(corner_[0], corner_[1], p)};
    if (is_turned_) w = {-w[0], -w[1], -w[2]};
    if (w[0] < 0 || w[1] < 0 || w[2] < 0) return std::nullopt;
    for (std::size_t i = 0; i < 3; ++i) {
      if (w[i] == 0) return code_on_edge((i + 1) % 3, (i + 2) % 3, p);
    }
    return weighted(w, {corner_[0].code, corner_[1].code, corner_[2].code}, whole_);
  }

 private:
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

}  // namespace

PixelGrid::PixelGrid(const StoreFacts& facts, std::array<double, 2> size,
                     const std::optional<Window>& window)
    : facts_(facts), size_(size), pitch_{size[0] / facts.map.step_x, size[1] / facts.map.step_y} {
  const GridBox& b = facts.bounds;
  const MapPoint low = facts.map.to_map(b.min_x, b.min_y);
  const MapPoint high = facts.map.to_map(b.max_x, b.max_y);
  const Window w = window.value_or(Window{low.x, low.y, high.x, high.y});
  const auto across = multiples_in(low.x, size_[0], w.min_x, w.max_x);
  const auto up = multiples_in(low.y, size_[1], w.min_y, w.max_y);
  first_column_ = across[0];
  columns_ = across[1];
  first_row_ = up[0];
  rows_ = up[1];
  check_pixels(columns_, rows_, size_, w);
}

std::array<double, 6> PixelGrid::geotransform() const noexcept {
  const MapPoint corner = facts_.map.to_map(facts_.bounds.min_x, facts_.bounds.min_y);
  const double west = corner.x + (static_cast<double>(first_column_) - 0.5) * size_[0];
  const double north = corner.y + (static_cast<double>(first_row_ + rows_) - 0.5) * size_[1];
  return {west, size_[0], 0.0, north, 0.0, -size_[1]};
}

std::int64_t PixelGrid::x(std::int64_t column) const noexcept {
  const double at = facts_.bounds.min_x + static_cast<double>(first_column_ + column) * pitch_[0];
  return std::llround(std::clamp(at, -0x1p31, 0x1p31) * kLattice);
}

std::int64_t PixelGrid::y(std::int64_t row) const noexcept {
  const auto up = static_cast<double>(first_row_ + rows_ - 1 - row);
  const double at = facts_.bounds.min_y + up * pitch_[1];
  return std::llround(std::clamp(at, -0x1p31, 0x1p31) * kLattice);
}

GridBox PixelGrid::box(const PixelRect& rect) const noexcept {
  const auto down = [](std::int64_t v) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v >> kLatticeBits, -1, kGridMax + 1));
  };
  const auto up = [&](std::int64_t v) { return down(v + (std::int64_t{1} << kLatticeBits) - 1); };
  return {down(x(rect.column)), down(y(rect.row + rect.height - 1)),
          up(x(rect.column + rect.width - 1)), up(y(rect.row))};
}

void sample_tin(const RefinedTin& refined, const StoreFacts& facts, const PixelGrid& grid,
                const PixelRect& part, const PixelRect& rect, std::vector<double>& heights) {
  const Tin& tin = refined.tin;
  // The positions of columns and rows, computed once. Row j from the north stands at ys.size() - 1
  // - j, so that both ascend.
  std::vector<std::int64_t> xs(static_cast<std::size_t>(part.width));
  std::vector<std::int64_t> ys(static_cast<std::size_t>(part.height));
  for (std::size_t i = 0; i < xs.size(); ++i) {
    xs[i] = grid.x(part.column + static_cast<std::int64_t>(i));
  }
  for (std::size_t j = 0; j < ys.size(); ++j) {
    ys[ys.size() - 1 - j] = grid.y(part.row + static_cast<std::int64_t>(j));
  }
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (!tin.is_alive(t) || tin.classes[t] == TriangleClass::kVoid) continue;
    const Facet facet(tin, t, facts.heights);
    const auto [low_y, high_y] = facet.y_range();
    const auto [low_x, high_x] = facet.x_range();
    if (high_y < ys.front() || low_y > ys.back() || high_x < xs.front() || low_x > xs.back()) {
      continue;
    }
    for (auto y = std::lower_bound(ys.begin(), ys.end(), low_y); y != ys.end() && *y <= high_y;
         ++y) {
      const auto [from, to] = facet.span(*y);
      constexpr double kRounding = 4.0;  // lattice units; exact tests follow
      const auto begin = std::lower_bound(xs.begin(), xs.end(),
                                          static_cast<std::int64_t>(std::floor(from - kRounding)));
      const std::int64_t part_row = ys.end() - y - 1;
      const std::int64_t row = part.row + part_row - rect.row;
      for (auto x = begin; x != xs.end() && static_cast<double>(*x) <= to + kRounding; ++x) {
        const auto code = facet.code_at({*x, *y});
        if (!code) continue;
        const std::int64_t column = part.column + (x - xs.begin()) - rect.column;
        heights[static_cast<std::size_t>(row * rect.width + column)] =
            facts.heights.height_of_code(*code);
      }
    }
  }
}

}  // namespace ptin::tools
