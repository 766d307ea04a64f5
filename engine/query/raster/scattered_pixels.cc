// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/raster/scattered_pixels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/query/living/living_place.h"
#include "engine/query/living/spot_in_triangle.h"
#include "engine/query/select/opened_terrain.h"

namespace ptin {

namespace {

/// Centres in a cell of the bins, about: a triangle of the level is about as large as a pixel.
constexpr double kCentresOfCell = 2.0;
/// With more records of the level for each centre, centres are located one by one, as raster() does.
constexpr double kRecordsOfCentre = 128.0;

/// A centre on the lattice of spots, and its number in the request.
struct Centre {
  Spot spot;
  std::size_t place;
};

/// The centres by square cells of their box. Threads: immutable.
class CentreBins {
 public:
  explicit CentreBins(const std::vector<Centre>& centres) {
    for (const Centre& c : centres) {
      low_ = {std::min(low_.x, c.spot.x), std::min(low_.y, c.spot.y)};
      high_ = {std::max(high_.x, c.spot.x), std::max(high_.y, c.spot.y)};
    }
    const double width = static_cast<double>(high_.x - low_.x) + 1;
    const double height = static_cast<double>(high_.y - low_.y) + 1;
    const double cells = std::ceil(static_cast<double>(centres.size()) / kCentresOfCell);
    // A line of centres gets a row of cells: a side is a share of the longer side at least.
    const double side =
        std::max(std::sqrt(width / cells * height), std::max(width, height) / cells);
    per_unit_ = 1 / side;
    columns_ = column_of(high_.x) + 1;
    rows_ = row_of(high_.y) + 1;
    begins_.assign(columns_ * rows_ + 1, 0);
    for (const Centre& c : centres) ++begins_[cell_of(c.spot) + 1];
    for (std::size_t i = 1; i < begins_.size(); ++i) begins_[i] += begins_[i - 1];
    sorted_.resize(centres.size());
    std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
    for (const Centre& c : centres) sorted_[next[cell_of(c.spot)]++] = c;
  }

  /// A box of the grid around all centres.
  [[nodiscard]] GridBox box() const noexcept { return united(box_around(low_), box_around(high_)); }

  /// Calls found(centre) for each centre in a box of the grid, and for some next to it.
  template <class Found>
  void near(const GridBox& box, const Found& found) const {
    const Spot from = spot_of(GridPoint{box.min_x, box.min_y});
    const Spot to = spot_of(GridPoint{box.max_x, box.max_y});
    if (to.x < low_.x || to.y < low_.y || from.x > high_.x || from.y > high_.y) return;
    const std::size_t first = column_of(std::max(from.x, low_.x));
    const std::size_t last = column_of(std::min(to.x, high_.x));
    const std::size_t last_row = row_of(std::min(to.y, high_.y));
    for (std::size_t row = row_of(std::max(from.y, low_.y)); row <= last_row; ++row) {
      const std::size_t* const begin = begins_.data() + row * columns_;
      for (std::size_t i = begin[first]; i < begin[last + 1]; ++i) found(sorted_[i]);
    }
  }

 private:
  // Rounding never falls while a coordinate grows, so that a centre's cell is among those of any box
  // that holds it.
  [[nodiscard]] std::size_t column_of(std::int64_t x) const noexcept {
    return static_cast<std::size_t>(static_cast<double>(x - low_.x) * per_unit_);
  }
  [[nodiscard]] std::size_t row_of(std::int64_t y) const noexcept {
    return static_cast<std::size_t>(static_cast<double>(y - low_.y) * per_unit_);
  }
  [[nodiscard]] std::size_t cell_of(Spot s) const noexcept {
    return row_of(s.y) * columns_ + column_of(s.x);
  }

  Spot low_{std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::max()};
  Spot high_{std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::min()};
  double per_unit_ = 1.0;
  std::size_t columns_ = 1, rows_ = 1;
  std::vector<std::size_t> begins_;  ///< Of each cell, in `sorted_`.
  std::vector<Centre> sorted_;
};

/// The centres in the box of the terrain: those beside it lie on nothing.
std::vector<Centre> centres_on(const StoreFacts& facts, std::span<const MapPoint> points) {
  const SpotMap map(facts.map, facts.bounds);
  std::vector<Centre> centres;
  centres.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(points[i].x) || !std::isfinite(points[i].y)) continue;
    const std::optional<Spot> spot = map.spot(points[i]);
    if (spot && contains(facts.bounds, *spot)) centres.push_back({*spot, i});
  }
  return centres;
}

/// Whether the centres are few for the level's records around them, were these spread evenly.
bool are_sparse(const OpenedTerrain& terrain, const Detail& detail, const GridBox& box,
                std::size_t centres) {
  const auto area = [](const GridBox& b) {
    return (static_cast<double>(b.max_x) - b.min_x + 1) *
           (static_cast<double>(b.max_y) - b.min_y + 1);
  };
  const double share = std::min(1.0, area(box) / area(terrain.store().facts().bounds));
  const double records =
      static_cast<double>(records_above(terrain.store(), detail.tolerance())) * share;
  return records > kRecordsOfCentre * static_cast<double>(centres);
}

/// Gives each centre the height of a surface triangle that holds it: all that do give the same.
void sample(LivingReader& reader, const HeightEncoding& encoding, const CentreBins& bins,
            std::span<double> heights, QueryContext& context) {
  LivingPlace place;
  place.box = bins.box();
  VisitorOf sampling(
      [&](std::size_t /*most_triangles*/) {
        context.check_stop();
        return true;
      },
      [&](const LivingTriangle& t) {
        if (t.is_void) return;
        const SpotWeights weights_at(t);
        bins.near(box_of(t), [&](const Centre& c) {
          double& height = heights[c.place];
          if (!std::isnan(height) || !contains(box_of(t), c.spot)) return;
          const auto weights = weights_at.at(c.spot);
          if (!SpotWeights::is_inside(weights)) return;
          height = encoding.height_of_code(codes_in(t, encoding, c.spot, weights).mean());
        });
      });
  reader.read(place, context, sampling);
}

RasterResult answer_of(const OpenedTerrain& terrain, std::span<const MapPoint> points,
                       const LocateRequest& request, std::span<double> heights) {
  QueryContext context(request.limits, terrain.store().path());
  // Each is held twice while cells are counted.
  context.hold(points.size() * 2 * sizeof(Centre));
  const StoreFacts& facts = terrain.store().facts();
  const Detail detail(request.detail, terrain.record_source(), context);
  std::fill(heights.begin(), heights.end(), std::numeric_limits<double>::quiet_NaN());
  const std::vector<Centre> centres = centres_on(facts, points);
  if (!centres.empty()) {
    const CentreBins bins(centres);
    if (are_sparse(terrain, detail, bins.box(), centres.size())) {
      std::vector<MapPoint> some;
      for (const Centre& c : centres) some.push_back(points[c.place]);
      const LocateResult located = locate(terrain, some, request);
      for (std::size_t i = 0; i < centres.size(); ++i) {
        heights[centres[i].place] = located.points[i].height;
      }
      context.cost.add_counts(located.cost);
    } else {
      LivingReader reader(terrain, detail);
      sample(reader, facts.heights, bins, heights, context);
    }
  }
  terrain.store().pages().check_unchanged();
  RasterResult result;
  result.detail = request.detail;
  result.certified_error = detail.certificate().error;
  result.certified_deviation = detail.certificate().deviation;
  result.exact = detail.is_exact(facts);
  result.surface_pixels = static_cast<std::uint64_t>(std::count_if(
      heights.begin(), heights.end(), [](double height) { return !std::isnan(height); }));
  result.cost = context.cost;
  return result;
}

}  // namespace

RasterResult heights_at(const OpenedTerrain& terrain, std::span<const MapPoint> centres,
                        const LocateRequest& request, std::span<double> heights) {
  return timed([&] { return answer_of(terrain, centres, request, heights); });
}

}  // namespace ptin
