// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/mercator_pyramid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "engine/crs/credits.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "tools/facts/source_count.h"
#include "tools/formats/markup_text.h"

namespace ptin::tools {

namespace {

/// The share of a pixel's width that the TIN may be off.
constexpr double kErrorOfPixel = 1.0 / 16;
/// Pixels of 0.6 mm: no zoom of a web map is finer.
constexpr int kMostPixelLevel = 28;
/// Between the pixels that PROJ is asked for.
constexpr std::int64_t kStep = 16;

/// Tiles of a zoom along one side of a box, of `count` along the world.
struct TileSpan {
  std::int64_t first, last;
};
TileSpan tiles_along(double low, double high, std::int64_t count) {
  const auto side = static_cast<double>(count);
  return {static_cast<std::int64_t>(std::floor(low * side)),
          static_cast<std::int64_t>(std::floor(high * side))};
}

/// The distance between the samples that a terrain was built from, map units, about.
MapPoint sample_distance(const StoreFile& store) {
  if (const std::optional<MapPoint> pixel = own_pixel_of(store)) {
    return {std::abs(pixel->x), std::abs(pixel->y)};
  }
  const StoreFacts& facts = store.facts();
  const auto vertices = static_cast<double>(store.record_count() + store.t0().vertices.size());
  const double columns = static_cast<double>(facts.bounds.max_x) - facts.bounds.min_x;
  const double rows = static_cast<double>(facts.bounds.max_y) - facts.bounds.min_y;
  const double distance = std::sqrt(columns * rows / std::max(1.0, vertices));
  return {distance * std::abs(facts.map.step_x), distance * std::abs(facts.map.step_y)};
}

/// Weights of four neighbours at equal steps for what lies a share t behind the second one: the cubic
/// through them (Lagrange). At t = 0 it is the second one exactly.
std::array<double, 4> cubic_weights(double t) noexcept {
  return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
          (t + 1) * t * (t - 1) / 6};
}

double longitude_within_circle(double lon) {
  return lon - 360.0 * std::floor((lon + 180.0) / 360.0);
}

/// Places the pixels of a square, block by block.
class PixelPlacer {
 public:
  PixelPlacer(const GlobePath& path, int level, const GlobeBox& box, double most_off)
      : path_(path), world_(std::ldexp(1.0, level + kPixelsLog2)), box_(box), most_off_(most_off) {}

  void place(std::int64_t column, std::int64_t row, std::int64_t side,
             std::span<MapPoint> centres) {
    ask_nodes(column, row, side);
    for (std::int64_t j = 0; j < side; j += kStep) {
      for (std::int64_t i = 0; i < side; i += kStep) {
        place_block(column, row, {i, j, side}, centres);
      }
    }
  }

 private:
  /// A block of a square: where it begins there, and the square's side.
  struct Block {
    std::int64_t i, j, side;
  };

  [[nodiscard]] double lon_of(std::int64_t column) const noexcept {
    return longitude_of((static_cast<double>(column) + 0.5) / world_);
  }
  [[nodiscard]] double lat_of(std::int64_t row) const noexcept {
    return latitude_of((static_cast<double>(row) + 0.5) / world_);
  }
  [[nodiscard]] MapPoint by_proj(std::int64_t column, std::int64_t row) const {
    return path_.to_map(lon_of(column), lat_of(row));
  }

  /// Every 16th pixel of the square, one before it and two behind.
  void ask_nodes(std::int64_t column, std::int64_t row, std::int64_t side) {
    if (most_off_ <= 0) return;
    nodes_along_ = side / kStep + 3;
    nodes_.clear();
    for (std::int64_t j = -1; j < nodes_along_ - 1; ++j) {
      for (std::int64_t i = -1; i < nodes_along_ - 1; ++i) {
        nodes_.push_back(by_proj(column + i * kStep, row + j * kStep));
      }
    }
  }

  /// The cubic at a pixel of a block.
  [[nodiscard]] MapPoint by_nodes(const Block& b, std::int64_t i, std::int64_t j) const {
    static const std::array<std::array<double, 4>, kStep> kWeights = [] {
      std::array<std::array<double, 4>, kStep> all{};
      for (std::size_t k = 0; k < all.size(); ++k) {
        all[k] = cubic_weights(static_cast<double>(k) / static_cast<double>(kStep));
      }
      return all;
    }();
    const auto& x = kWeights[static_cast<std::size_t>(i)];
    const auto& y = kWeights[static_cast<std::size_t>(j)];
    const MapPoint* node = nodes_.data() + (b.j / kStep) * nodes_along_ + b.i / kStep;
    MapPoint sum{0, 0};
    for (std::size_t k = 0; k < 4; ++k, node += nodes_along_) {
      sum.x += y[k] * (x[0] * node[0].x + x[1] * node[1].x + x[2] * node[2].x + x[3] * node[3].x);
      sum.y += y[k] * (x[0] * node[0].y + x[1] * node[1].y + x[2] * node[2].y + x[3] * node[3].y);
    }
    return sum;
  }

  /// Whether the cubic is as good as PROJ in a block: what is not finite never is.
  [[nodiscard]] bool is_smooth(std::int64_t column, std::int64_t row, const Block& b) const {
    if (most_off_ <= 0) return false;
    for (const std::int64_t j : {std::int64_t{3}, kStep / 2, kStep - 1}) {
      for (const std::int64_t i : {std::int64_t{3}, kStep / 2, kStep - 1}) {
        const MapPoint exact = by_proj(column + b.i + i, row + b.j + j);
        const MapPoint near = by_nodes(b, i, j);
        if (!(std::abs(exact.x - near.x) <= most_off_ && std::abs(exact.y - near.y) <= most_off_))
          return false;
      }
    }
    return true;
  }

  void place_block(std::int64_t column, std::int64_t row, const Block& b,
                   std::span<MapPoint> centres) const {
    const bool is_beside = lon_of(column + b.i + kStep - 1) < box_.west ||
                           lon_of(column + b.i) > box_.east || lat_of(row + b.j) < box_.south ||
                           lat_of(row + b.j + kStep - 1) > box_.north;
    const bool uses_nodes = !is_beside && is_smooth(column, row, b);
    constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
    for (std::int64_t j = 0; j < kStep; ++j) {
      const double lat = lat_of(row + b.j + j);
      for (std::int64_t i = 0; i < kStep; ++i) {
        const double lon = lon_of(column + b.i + i);
        const bool is_on = !is_beside && box_.west <= lon && lon <= box_.east &&
                           box_.south <= lat && lat <= box_.north;
        MapPoint& centre = centres[static_cast<std::size_t>((b.j + j) * b.side + b.i + i)];
        centre = !is_on ? MapPoint{kNowhere, kNowhere}
                        : (uses_nodes ? by_nodes(b, i, j) : path_.to_map(lon, lat));
      }
    }
  }

  const GlobePath& path_;
  double world_;  ///< Pixels along the world.
  GlobeBox box_;
  double most_off_;
  std::int64_t nodes_along_ = 0;
  std::vector<MapPoint> nodes_;
};

}  // namespace

MercatorPyramid::MercatorPyramid(const Terrain& terrain, const CrsFacts& crs)
    : terrain_(terrain),
      globe_(std::make_shared<const Globe>(terrain.store().facts(), crs)),
      box_(globe_->box()),
      attribution_(credits_of(terrain.store()).attribution) {
  box_.south = std::max(box_.south, -kMostMercatorLatitude);
  box_.north = std::min(box_.north, kMostMercatorLatitude);
  if (box_.south >= box_.north) {
    refuse("the terrain lies beyond the latitudes of web maps, 85.05 degrees south to north");
  }
  low_ = world_of(box_.west, box_.north);
  high_ = world_of(box_.east, box_.south);
  const StoreFacts& facts = terrain.store().facts();
  const MapPoint middle = facts.map.to_map(0.5 * facts.bounds.min_x + 0.5 * facts.bounds.max_x,
                                           0.5 * facts.bounds.min_y + 0.5 * facts.bounds.max_y);
  if (const std::optional<MapPoint> metres = metres_per_map_unit(crs, middle)) {
    constexpr double kMostOff = 1e-4;  // metres
    most_off_ = kMostOff / std::max(metres->x, metres->y);
  }
  const int finest = level_of_samples();
  for (int level = 0; level <= finest; ++level) {
    PixelLevel made;
    const double tolerance = equator_pixel(level) * kErrorOfPixel / globe_->metres_per_height();
    if (level < finest) made.detail.tolerance = tolerance;
    made.error = certify_below(terrain.store(), level < finest ? tolerance : -1.0).error *
                 globe_->metres_per_height();
    levels_.push_back(made);
  }
}

/// The level whose pixels are about as large as samples, in the middle of the terrain.
int MercatorPyramid::level_of_samples() const {
  const StoreFacts& facts = terrain_.store().facts();
  const MapPoint distance = sample_distance(terrain_.store());
  const double x = 0.5 * facts.bounds.min_x + 0.5 * facts.bounds.max_x;
  const double y = 0.5 * facts.bounds.min_y + 0.5 * facts.bounds.max_y;
  const Globe::Lease path = globe_->path();
  const auto world = [&](double grid_x, double grid_y) {
    const GlobePoint p = path->to_globe(grid_x, grid_y, 0.0);
    return world_of(p.lon, std::clamp(p.lat, -kMostMercatorLatitude, kMostMercatorLatitude));
  };
  const MapPoint middle = world(x, y);
  const MapPoint east = world(x + distance.x / std::abs(facts.map.step_x), y);
  const MapPoint north = world(x, y + distance.y / std::abs(facts.map.step_y));
  const double area = std::abs((east.x - middle.x) * (north.y - middle.y) -
                               (east.y - middle.y) * (north.x - middle.x));
  if (!(area > 0)) return 0;
  const double level = std::round(-0.5 * std::log2(area) - kPixelsLog2);
  return static_cast<int>(std::clamp(level, 1.0, static_cast<double>(kMostPixelLevel)));
}

GlobeBox MercatorPyramid::bounds() const noexcept {
  if (box_.east - box_.west >= 360.0) return {-180.0, box_.south, 180.0, box_.north};
  const double east = longitude_within_circle(box_.east);
  return {longitude_within_circle(box_.west), box_.south, east == -180.0 ? 180.0 : east,
          box_.north};
}

nlohmann::json MercatorPyramid::place_facts(int last_zoom) const {
  const GlobeBox box = bounds(), flat = unwrapped(box);
  const MapPoint middle = middle_of(box);
  nlohmann::json facts = {{"minzoom", 0},
                          {"maxzoom", last_zoom},
                          {"bounds", {flat.west, flat.south, flat.east, flat.north}},
                          {"center", {middle.x, middle.y, last_zoom / 2}}};
  if (!attribution_.empty()) facts["attribution"] = markup_text(attribution_);
  return facts;
}

std::int64_t MercatorPyramid::unrolled_column(const WebTile& tile) const noexcept {
  const std::int64_t count = std::int64_t{1} << tile.z;
  const TileSpan columns = tiles_along(low_.x, high_.x, count);
  for (const std::int64_t x : {tile.x, tile.x + count, tile.x - count}) {
    if (columns.first <= x && x <= columns.last) return x;
  }
  return tile.x;
}

bool MercatorPyramid::has(std::int64_t z, std::int64_t x, std::int64_t y) const noexcept {
  if (z < 0 || z > kMostPixelLevel) return false;
  const std::int64_t count = std::int64_t{1} << z;
  if (x < 0 || y < 0 || x >= count || y >= count) return false;
  const TileSpan rows = tiles_along(low_.y, high_.y, count);
  if (y < rows.first || y > rows.last) return false;
  const TileSpan columns = tiles_along(low_.x, high_.x, count);
  const std::int64_t column = unrolled_column({static_cast<int>(z), x, y});
  return columns.first <= column && column <= columns.last;
}

std::vector<TileRectangle> MercatorPyramid::rectangles(int z) const {
  const std::int64_t count = std::int64_t{1} << z;
  const TileSpan rows = tiles_along(low_.y, high_.y, count);
  const TileSpan columns = tiles_along(low_.x, high_.x, count);
  const std::int64_t first_row = std::max<std::int64_t>(rows.first, 0);
  const std::int64_t last_row = std::min(rows.last, count - 1);
  if (columns.last - columns.first + 1 >= count) return {{0, first_row, count - 1, last_row}};
  std::vector<TileRectangle> all;
  for (const std::int64_t turn : {std::int64_t{0}, count, -count}) {
    const TileRectangle part{std::max<std::int64_t>(columns.first + turn, 0), first_row,
                             std::min(columns.last + turn, count - 1), last_row};
    if (part.columns() > 0 && part.rows() > 0) all.push_back(part);
  }
  return all;
}

void MercatorPyramid::place_pixels(int level, std::int64_t column, std::int64_t row,
                                   std::int64_t side, std::span<MapPoint> centres) const {
  const Globe::Lease path = globe_->path();
  PixelPlacer(*path, level, box_, most_off_).place(column, row, side, centres);
}

}  // namespace ptin::tools
