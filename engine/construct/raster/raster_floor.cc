// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_floor.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/error.h"
#include "engine/mesh/raster_tin.h"
#include "engine/stop.h"

namespace ptin {

namespace {

/// Tiles are read in squares of 2^kSquareLog2 samples a side, so that a raster in strips is decoded once
/// for many tiles. A square is a run of the curve of tiles.
constexpr std::uint32_t kSquareLog2 = 10;

/// Steps in which floats of a terrain are often written, and of which each is float(step * k).
constexpr std::array kSteps = {1.0, 0.1, 0.01, 0.001, 0.5, 0.25, 0.125, 0.0625, 0.03125};
constexpr double kMostStep = 2147483647.0;  ///< Of k.

bool is_of_step(float height, double step) {
  const double k = std::nearbyint(height / step);
  return std::abs(k) <= kMostStep && std::bit_cast<std::uint32_t>(static_cast<float>(step * k)) ==
                                         std::bit_cast<std::uint32_t>(height);
}

/// What stands against a choice of tiles and numbers.
enum class Outcome : std::uint8_t { kDone, kTileTooLarge, kHeightsOfNoStep };

class FloorTiles {
 public:
  /// @param kept  Gets to know what is lost.
  FloorTiles(const RasterSource& source, const FloorFacts& facts, KeptRaster& kept,
             const std::stop_token& stop)
      : source_(source),
        facts_(facts),
        numbers_(source.frame().heights, facts.step),
        kept_(kept),
        stop_(stop) {}

  /// Adds all tiles, until something stands against it.
  Outcome add_all(FloorWriter& floor) {
    for (const std::uint64_t square : squares()) {
      stop_if_asked(stop_, "the build");
      const HilbertCell corner = hilbert_cell(square);
      read_square(corner);
      if (!are_heights_of_step()) return Outcome::kHeightsOfNoStep;
      for (const std::uint64_t key : tiles_of_square(corner)) {
        if (!floor.add(key, tile(hilbert_cell(key)))) return Outcome::kTileTooLarge;
      }
    }
    return Outcome::kDone;
  }

 private:
  [[nodiscard]] std::uint32_t tiles_along_square() const noexcept {
    return 1U << (kSquareLog2 - facts_.shape.side_log2);
  }
  /// Keys of the first tiles in the corners of all squares, in the order of the squares.
  [[nodiscard]] std::vector<std::uint64_t> squares() const {
    const std::uint32_t step = tiles_along_square();
    const auto run = [step](std::uint64_t key) {  // the square's place along the curve
      return key / (std::uint64_t{step} * step);
    };
    std::vector<std::uint64_t> keys;
    for (std::uint32_t row = 0; row < facts_.shape.rows(); row += step) {
      for (std::uint32_t column = 0; column < facts_.shape.columns(); column += step) {
        keys.push_back(FloorShape::key(column, row));
      }
    }
    std::sort(keys.begin(), keys.end(),
              [&](std::uint64_t a, std::uint64_t b) { return run(a) < run(b); });
    return keys;
  }
  [[nodiscard]] std::vector<std::uint64_t> tiles_of_square(HilbertCell corner) const {
    std::vector<std::uint64_t> keys;
    const std::uint32_t end_row = std::min(corner.y + tiles_along_square(), facts_.shape.rows());
    const std::uint32_t end_column =
        std::min(corner.x + tiles_along_square(), facts_.shape.columns());
    for (std::uint32_t row = corner.y; row < end_row; ++row) {
      for (std::uint32_t column = corner.x; column < end_column; ++column) {
        keys.push_back(FloorShape::key(column, row));
      }
    }
    std::sort(keys.begin(), keys.end());
    return keys;
  }

  /// Reads the samples of a square's tiles, and one more on each side, by which lone ones are known.
  void read_square(HilbertCell corner) {
    const auto along = [this](std::uint32_t tile, std::int64_t all) {
      const std::int64_t first = facts_.shape.first_of(tile);
      const std::int64_t from = std::max<std::int64_t>(first - 1, 0);
      return std::pair{from, std::min(first + (1 << kSquareLog2) + 2, all) - from};
    };
    std::tie(window_.x0, window_.width) = along(corner.x, source_.width());
    std::tie(window_.y0, window_.height) = along(corner.y, source_.height());
    heights_.resize(window_.samples());
    valid_.resize(window_.samples());
    source_.read(window_, heights_, valid_, kept_);
    lone_.assign(window_.samples(), 0);
    for (const std::uint64_t i : find_lone_samples(valid_, window_)) lone_[i] = 1;
  }

  [[nodiscard]] bool are_heights_of_step() const {
    if (facts_.step == 0) return true;
    for (std::size_t i = 0; i < heights_.size(); ++i) {
      if (valid_[i] != 0 && !is_of_step(std::bit_cast<float>(heights_[i]), facts_.step)) {
        return false;
      }
    }
    return true;
  }

  [[nodiscard]] const FloorTile& tile(HilbertCell at) {
    const FloorShape& shape = facts_.shape;
    tile_.width = shape.samples_of(at.x, shape.width);
    tile_.height = shape.samples_of(at.y, shape.height);
    tile_.heights.assign(tile_.samples(), 0);
    tile_.is_void.assign(tile_.samples(), 0);
    tile_.lone.clear();
    std::size_t place = 0;
    for (std::uint32_t y = 0; y < tile_.height; ++y) {
      const std::int64_t row = shape.first_of(at.y) + std::int64_t{y} - window_.y0;
      std::int64_t i = row * window_.width + shape.first_of(at.x) - window_.x0;
      for (std::uint32_t x = 0; x < tile_.width; ++x, ++i, ++place) {
        put_sample(static_cast<std::size_t>(i), place);
      }
    }
    return tile_;
  }
  void put_sample(std::size_t i, std::size_t place) {
    if (valid_[i] == 0) {
      tile_.is_void[place] = 1;
      return;
    }
    const OrderedHeight height = numbers_.ordered(heights_[i]);
    if (numbers_.bits(height) != heights_[i] && kept_.lost.empty()) {
      kept_.lost = "the sign of each zero";
    }
    if (lone_[i] == 0) {
      tile_.heights[place] = height;
      return;
    }
    tile_.is_void[place] = 1;
    tile_.lone.push_back({static_cast<std::uint16_t>(place), height});
  }

  const RasterSource& source_;
  const FloorFacts& facts_;
  const FloorNumbers numbers_;
  KeptRaster& kept_;
  const std::stop_token& stop_;
  SampleRange window_;
  std::vector<HeightBits> heights_;
  std::vector<std::uint8_t> valid_, lone_;
  FloorTile tile_;
};

}  // namespace

KeptRaster add_raster_floor(const RasterSource& source, StoreWriter& writer,
                            const std::stop_token& stop) {
  KeptRaster kept;
  FloorFacts facts;
  facts.shape = {5, static_cast<std::uint32_t>(source.width()),
                 static_cast<std::uint32_t>(source.height())};
  // Steps are tried one by one; a wrong one is found in the first square, as a rule.
  std::size_t next_step = source.frame().heights.type == HeightType::float32 ? 0 : kSteps.size();
  facts.step = next_step < kSteps.size() ? kSteps[next_step] : 0.0;
  Outcome outcome = Outcome::kDone;
  do {
    kept = source.kept();
    facts.source = kept.number;
    facts.nodata = kept.nodata;
    writer.add_floor(facts, [&](FloorWriter& floor) {
      outcome = FloorTiles(source, facts, kept, stop).add_all(floor);
      facts.is_exact = kept.lost.empty();  // written behind the tiles
      return outcome == Outcome::kDone;
    });
    if (outcome == Outcome::kHeightsOfNoStep) {
      ++next_step;
      facts.step = next_step < kSteps.size() ? kSteps[next_step] : 0.0;
    } else if (outcome == Outcome::kTileTooLarge) {
      --facts.shape.side_log2;  // tiles of 16 cells a side fit whatever their heights are
    }
  } while (outcome != Outcome::kDone);
  return kept;
}

}  // namespace ptin
