// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/raster/floor_pixels.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace ptin {

namespace {

using Line = PixelCentres::GridLine;

/// Tiles between two calls of `between`: a millisecond's.
constexpr std::size_t kTilesBetween = 512;

/// Whether each position is one more than that before it.
bool is_run(const std::vector<std::int32_t>& at) {
  return std::adjacent_find(at.begin(), at.end(),
                            [](std::int32_t a, std::int32_t b) { return b - a != 1; }) == at.end();
}

/// The tile that copies a sample: the one that begins with it, but at the end of the raster.
std::uint32_t tile_of(const FloorShape& shape, std::int32_t sample, std::uint32_t tiles) {
  return std::min(static_cast<std::uint32_t>(sample) >> shape.side_log2, tiles - 1);
}

/// Some of the centres along a line: those of one tile.
struct Stretch {
  std::size_t begin, end;
};

/// The centres along a line by their tiles.
class LineTiles {
 public:
  /// @param tiles  Along the whole raster.
  LineTiles(const FloorShape& shape, const Line& line, std::uint32_t tiles)
      : side_log2_(shape.side_log2), first_(tile_of(shape, line.at.front(), tiles)) {
    for (std::size_t i = 0; i < line.at.size(); ++i) {
      begins_.resize(tile_of(shape, line.at[i], tiles) - first_ + 1, i);
    }
    begins_.push_back(line.at.size());
  }
  [[nodiscard]] std::uint32_t first() const noexcept { return first_; }
  [[nodiscard]] std::uint32_t last() const noexcept {
    return first_ + static_cast<std::uint32_t>(begins_.size()) - 2;
  }
  [[nodiscard]] Stretch of(std::uint32_t tile) const noexcept {
    return {begins_[tile - first_], begins_[tile - first_ + 1]};
  }
  /// Whether one of the tiles whose samples are those from `least` to `greatest` has a centre: the last
  /// sample of a tile is the next one's first.
  [[nodiscard]] bool has(std::int32_t least, std::int32_t greatest) const noexcept {
    const auto from = std::max(first_, static_cast<std::uint32_t>(least) >> side_log2_);
    const auto to =
        std::min(last(), static_cast<std::uint32_t>(std::max(greatest - 1, least)) >> side_log2_);
    return from <= to && of(from).begin < of(to).end;
  }

 private:
  std::uint32_t side_log2_, first_;
  std::vector<std::size_t> begins_;  ///< Of each tile; where it has none, that of the next one.
};

class PixelsOfTiles {
 public:
  PixelsOfTiles(const Floor& floor, const HeightEncoding& heights, const PixelCentres& centres,
                const PixelBuffers<double>& buffers)
      : shape_(floor.facts().shape),
        numbers_(floor.numbers()),
        heights_(heights),
        width_(centres.width()),
        columns_(centres.columns_on_grid()),
        rows_(centres.rows_on_grid()),
        is_run_(!columns_.descends && is_run(columns_.at)),
        buffers_(buffers) {}

  [[nodiscard]] const Line& columns() const noexcept { return columns_; }
  [[nodiscard]] const Line& rows() const noexcept { return rows_; }

  void copy(const Floor::TileAt& at, const FloorTile& tile, Stretch columns, Stretch rows) {
    const auto left = static_cast<std::int32_t>(shape_.first_of(at.column));
    const auto low = static_cast<std::int32_t>(shape_.first_of(at.row));
    for (std::size_t j = rows.begin; j < rows.end; ++j) {
      const auto from = static_cast<std::size_t>(rows_.at[j] - low) * tile.width;
      const std::size_t place = place_of(rows_, j) * width_ + place_of(columns_, columns.begin);
      copy_heights(tile, from, left, columns, place);
      if (!tile.is_void.empty()) take_voids(tile, from, left, columns, place);
      if (!buffers_.states.empty()) tell_states(tile, from, left, columns, place);
    }
  }

 private:
  [[nodiscard]] static std::size_t place_of(const Line& line, std::size_t i) noexcept {
    return line.descends ? line.first - i : line.first + i;
  }
  /// The pixel of a centre, where `place` is that of the first one of the stretch.
  [[nodiscard]] std::size_t pixel(std::size_t place, std::size_t i) const noexcept {
    return columns_.descends ? place - i : place + i;
  }

  void copy_heights(const FloorTile& tile, std::size_t from, std::int32_t left, Stretch columns,
                    std::size_t place) {
    if (heights_.type == HeightType::int32) {
      copy_as(tile, from, left, columns, place, [](OrderedHeight ordered) {
        return static_cast<double>(std::bit_cast<std::int32_t>(ordered ^ 0x80000000U));
      });
    } else {
      copy_as(tile, from, left, columns, place,
              [this](OrderedHeight ordered) { return heights_.code(numbers_.bits(ordered)); });
    }
  }
  template <class Code>
  void copy_as(const FloorTile& tile, std::size_t from, std::int32_t left, Stretch columns,
               std::size_t place, const Code& code) {
    const std::size_t count = columns.end - columns.begin;
    const std::int32_t* const at = columns_.at.data() + columns.begin;
    const std::int32_t first = at[0];
    const OrderedHeight* const samples = tile.heights.data() + from;
    if (is_run_) {
      const OrderedHeight* const run = samples + (first - left);
      double* const to = buffers_.heights.data() + place;
      for (std::size_t i = 0; i < count; ++i) to[i] = heights_.height_of_code(code(run[i]));
      return;
    }
    for (std::size_t i = 0; i < count; ++i) {
      buffers_.heights[pixel(place, i)] = heights_.height_of_code(code(samples[at[i] - left]));
    }
  }
  void take_voids(const FloorTile& tile, std::size_t from, std::int32_t left, Stretch columns,
                  std::size_t place) {
    for (std::size_t i = 0; i < columns.end - columns.begin; ++i) {
      if (is_void(tile, from, left, columns.begin + i)) buffers_.heights[pixel(place, i)] = kNaN;
    }
  }
  void tell_states(const FloorTile& tile, std::size_t from, std::int32_t left, Stretch columns,
                   std::size_t place) {
    for (std::size_t i = 0; i < columns.end - columns.begin; ++i) {
      buffers_.states[pixel(place, i)] =
          !tile.is_void.empty() && is_void(tile, from, left, columns.begin + i)
              ? PointState::kVoid
              : PointState::kSurface;
    }
  }
  [[nodiscard]] bool is_void(const FloorTile& tile, std::size_t from, std::int32_t left,
                             std::size_t column) const noexcept {
    return tile.is_void[from + static_cast<std::size_t>(columns_.at[column] - left)] != 0;
  }

  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const FloorShape& shape_;
  const FloorNumbers& numbers_;
  const HeightEncoding heights_;
  const std::size_t width_;
  const Line columns_, rows_;
  const bool is_run_;  ///< Columns follow one another as samples do.
  const PixelBuffers<double> buffers_;
};

}  // namespace

bool are_on_floor(const FloorShape& shape, const PixelCentres& centres) {
  if (!centres.are_on_grid()) return false;
  const Line columns = centres.columns_on_grid();
  const Line rows = centres.rows_on_grid();
  if (columns.at.empty() || rows.at.empty()) return false;
  const LineTiles across(shape, columns, shape.columns()), up(shape, rows, shape.rows());
  return columns.at.size() > across.last() - across.first() &&
         rows.at.size() > up.last() - up.first();
}

void copy_floor(const Floor& floor, const HeightEncoding& heights, const PixelCentres& centres,
                const PixelBuffers<double>& buffers, const std::function<void()>& between,
                QueryCost& cost) {
  const FloorShape& shape = floor.facts().shape;
  PixelsOfTiles pixels(floor, heights, centres, buffers);
  const LineTiles columns(shape, pixels.columns(), shape.columns());
  const LineTiles rows(shape, pixels.rows(), shape.rows());
  std::size_t tiles = 0;
  Floor::Recent recent;
  floor.visit(
      [&](const Floor::Bounds& b) {
        return columns.has(b.box.min_x, b.box.max_x) && rows.has(b.box.min_y, b.box.max_y);
      },
      [&](const Floor::TileAt& at, const FloorTile& tile) {
        if (tiles++ % kTilesBetween == 0) between();
        cost.samples_read += tile.samples();
        pixels.copy(at, tile, columns.of(at.column), rows.of(at.row));
        return true;
      },
      recent, cost.io);
}

}  // namespace ptin
