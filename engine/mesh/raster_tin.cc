// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/raster_tin.h"

#include <cmath>
#include <cstring>

#include "engine/error.h"
#include "engine/large_array.h"

namespace ptin {
namespace {

/// The diagonals of one row of cells. Two rows are all that the construction keeps beside the Tin.
using DiagonalRow = std::vector<std::uint8_t>;

/// Decodes a height of type T (int32 or float) from its bits, as a double.
template <class T>
double decode(HeightBits bits) noexcept {
  return static_cast<double>(std::bit_cast<T>(bits));
}

/// 1 where x + y is odd, else 0. The sum itself may not fit.
std::uint32_t parity_of(GridPoint p) noexcept { return static_cast<std::uint32_t>(p.x ^ p.y) & 1; }

struct Window {
  std::span<const HeightBits> heights;
  std::span<const std::uint8_t> valid;
  std::int32_t width;
  std::int32_t height;
  GridPoint origin;

  [[nodiscard]] std::size_t at(std::int32_t x, std::int32_t y) const noexcept {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] std::int32_t cells_x() const noexcept { return width - 1; }
};

/// Fills `row` with the diagonals of the cells of row `y`.
template <class T>
void find_diagonals(const Window& w, std::int32_t y, DiagonalRow& row) {
  const HeightBits* south = &w.heights[w.at(0, y)];
  const HeightBits* north = &w.heights[w.at(0, y + 1)];
  const std::uint8_t* south_valid = &w.valid[w.at(0, y)];
  const std::uint8_t* north_valid = &w.valid[w.at(0, y + 1)];
  const std::uint32_t first = parity_of({w.origin.x, w.origin.y + y});
  for (std::int32_t x = 0; x < w.cells_x(); ++x) {
    const double rising = std::abs(decode<T>(south[x]) - decode<T>(north[x + 1]));
    const double falling = std::abs(decode<T>(south[x + 1]) - decode<T>(north[x]));
    const std::uint32_t parity = (first + static_cast<std::uint32_t>(x)) & 1;
    row[x] = static_cast<std::uint8_t>(rising == falling ? parity : (falling < rising ? 1U : 0U));
  }
  if (std::memchr(south_valid, 0, w.width) == nullptr &&
      std::memchr(north_valid, 0, w.width) == nullptr) {
    return;
  }
  for (std::int32_t x = 0; x < w.cells_x(); ++x) {
    const std::uint8_t has[4] = {south_valid[x], south_valid[x + 1], north_valid[x + 1],
                                 north_valid[x]};
    if (has[0] && has[1] && has[2] && has[3]) {
      continue;
    }
    const RasterCell cell{{0, 0, 0, 0}, {has[0], has[1], has[2], has[3]}};
    row[x] = static_cast<std::uint8_t>(cell_diagonal(cell, {w.origin.x + x, w.origin.y + y}));
  }
}

/// The triangle of cell `c` at its eastern (western) edge. The one at the southern edge is 2c, at
/// the northern 2c + 1.
TriangleId eastern(std::uint32_t c, std::uint8_t diagonal) noexcept { return 2 * c + diagonal; }
TriangleId western(std::uint32_t c, std::uint8_t diagonal) noexcept { return 2 * c + 1 - diagonal; }

/// Writes the two triangles of cell `x` of a row. Corners a b c d counter-clockwise from the lower
/// left: rising gives (a, b, c) and (a, c, d), falling (a, b, d) and (b, c, d).
void add_cell(Tin& tin, const Window& w, std::int32_t x, std::int32_t y, const DiagonalRow& row) {
  const auto cells = static_cast<std::uint32_t>(w.cells_x());
  const std::uint32_t cell = static_cast<std::uint32_t>(y) * cells + static_cast<std::uint32_t>(x);
  const auto a = static_cast<VertexId>(w.at(x, y));
  const VertexId b = a + 1, d = a + static_cast<VertexId>(w.width), c = d + 1;
  const TriangleId south = y == 0 ? kNone : 2 * (cell - cells) + 1;
  const TriangleId north = y + 2 == w.height ? kNone : 2 * (cell + cells);
  const TriangleId west = x == 0 ? kNone : eastern(cell - 1, row[x - 1]);
  const TriangleId east = x + 1 == w.cells_x() ? kNone : western(cell + 1, row[x + 1]);
  const TriangleId first = 2 * cell, second = first + 1;
  Triangle* out = &tin.triangles[first];
  TriangleClass* classes = &tin.classes[first];
  const auto class_of = [](std::uint8_t p, std::uint8_t q, std::uint8_t r) {
    return static_cast<TriangleClass>(1 - (p & q & r));
  };
  const std::uint8_t* has = tin.has_height.data();
  if (row[x] == static_cast<std::uint8_t>(Diagonal::kRising)) {
    out[0] = {{a, b, c}, {east, second, south}};
    out[1] = {{a, c, d}, {north, west, first}};
    classes[0] = class_of(has[a], has[b], has[c]);
    classes[1] = class_of(has[a], has[c], has[d]);
  } else {
    out[0] = {{a, b, d}, {second, west, south}};
    out[1] = {{b, c, d}, {north, first, east}};
    classes[0] = class_of(has[a], has[b], has[d]);
    classes[1] = class_of(has[b], has[c], has[d]);
  }
}

/// Writes the vertices of row `y`, each with one of its triangles: on the border the one at which
/// the counter-clockwise walk around the vertex begins, inside any.
/// @param below, above  The diagonals of the cells below and above the row, where there are such.
void add_vertices(Tin& tin, const Window& w, std::int32_t y, const DiagonalRow& below,
                  const DiagonalRow& above) {
  const auto cells = static_cast<std::uint32_t>(w.cells_x());
  const std::uint32_t row_above = static_cast<std::uint32_t>(y) * cells;
  const bool top = y + 1 == w.height;
  for (std::int32_t x = 0; x < w.width; ++x) {
    const std::size_t i = w.at(x, y);
    const auto ux = static_cast<std::uint32_t>(x);
    TriangleId t = kNone;
    if (x == 0 && y > 0) {  // western border: the walk begins at the border edge to the south
      t = western(row_above - cells, below[0]);
    } else if (top) {  // northern border: at the edge to the west
      t = 2 * (row_above - cells + ux - 1) + 1;
    } else if (x + 1 == w.width) {  // eastern border: at the edge to the north
      t = eastern(row_above + cells - 1, above[cells - 1]);
    } else {  // southern border: at the edge to the east; or inside
      t = 2 * (row_above + ux);
    }
    const bool has = w.valid[i] != 0;
    tin.has_height[i] = has;
    tin.vertices[i] = {{w.origin.x + x, w.origin.y + y}, has ? w.heights[i] : 0, t};
  }
}

void check(const SampleRange& w, std::span<const HeightBits> heights,
           std::span<const std::uint8_t> valid) {
  if (w.width < 2 || w.height < 2) {
    throw Error(ErrorCode::invalid_argument, "a raster TIN needs at least 2 x 2 samples");
  }
  if (heights.size() != w.samples() || valid.size() != w.samples()) {
    throw Error(ErrorCode::invalid_argument,
                "a raster TIN needs one height and one mask byte for each sample");
  }
  if (w.x0 < 0 || w.y0 < 0 || w.width - 1 > kGridMax - w.x0 || w.height - 1 > kGridMax - w.y0) {
    throw Error(ErrorCode::invalid_argument, "the window reaches beyond the grid of 2^30 steps");
  }
  if (w.samples() > (kNone - 1) / 2) {
    throw Error(
        ErrorCode::resource_exhausted,
        "the window has more samples than one mesh in memory counts; build it in smaller tiles");
  }
}

template <class T>
Tin make(const Window& w) {
  const std::size_t samples = w.heights.size();
  const std::size_t cells =
      static_cast<std::size_t>(w.width - 1) * static_cast<std::size_t>(w.height - 1);
  Tin tin;
  reserve_large(tin.vertices, samples);
  reserve_large(tin.triangles, 2 * cells);
  tin.vertices.resize(samples);
  tin.has_height.resize(samples);
  tin.triangles.resize(2 * cells);
  tin.classes.resize(2 * cells);
  DiagonalRow below(w.cells_x()), above(w.cells_x());
  find_diagonals<T>(w, 0, above);
  add_vertices(tin, w, 0, below, above);
  for (std::int32_t y = 0; y + 1 < w.height; ++y) {
    std::swap(below, above);
    if (y + 2 < w.height) {
      find_diagonals<T>(w, y + 1, above);
    }
    add_vertices(tin, w, y + 1, below, above);
    for (std::int32_t x = 0; x < w.cells_x(); ++x) {
      add_cell(tin, w, x, y, below);
    }
  }
  return tin;
}

}  // namespace

Tin make_raster_tin(std::span<const HeightBits> heights, std::span<const std::uint8_t> valid,
                    const SampleRange& window, const HeightEncoding& encoding) {
  check(window, heights, valid);
  const Window w{heights,
                 valid,
                 static_cast<std::int32_t>(window.width),
                 static_cast<std::int32_t>(window.height),
                 {static_cast<std::int32_t>(window.x0), static_cast<std::int32_t>(window.y0)}};
  return encoding.type == HeightType::int32 ? make<std::int32_t>(w) : make<float>(w);
}

std::vector<std::uint64_t> find_lone_samples(std::span<const std::uint8_t> valid,
                                             const SampleRange& window) {
  const std::int64_t width = window.width, height = window.height;
  std::vector<std::uint64_t> lone;
  if (std::memchr(valid.data(), 0, valid.size()) == nullptr) {
    return lone;
  }
  const auto has = [&](std::int64_t x, std::int64_t y) -> int {
    return x >= 0 && y >= 0 && x < width && y < height &&
           valid[static_cast<std::size_t>(y * width + x)] != 0;
  };
  const auto cell_is_surface = [&](std::int64_t x, std::int64_t y) {
    return x >= 0 && y >= 0 && x + 1 < width && y + 1 < height &&
           has(x, y) + has(x + 1, y) + has(x, y + 1) + has(x + 1, y + 1) >= 3;
  };
  for (std::int64_t y = 0; y < height; ++y) {
    for (std::int64_t x = 0; x < width; ++x) {
      if (has(x, y) && !cell_is_surface(x, y) && !cell_is_surface(x - 1, y) &&
          !cell_is_surface(x, y - 1) && !cell_is_surface(x - 1, y - 1)) {
        lone.push_back(static_cast<std::uint64_t>(y * width + x));
      }
    }
  }
  return lone;
}

}  // namespace ptin
