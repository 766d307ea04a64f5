// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights on a grid within a polygon: OGC EDR's `area`.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "engine/stop.h"
#include "tools/ask/questions.h"
#include "tools/facts/source_count.h"
#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/coverage.h"
#include "tools/serve/questions.h"
#include "tools/serve/wkt_places.h"

namespace ptin::serve {

namespace {

constexpr const char *kColumns = "resolution-x", *kRows = "resolution-y";

struct AreaQuestion {
  LocateRequest request;
  std::optional<std::uint64_t> columns, rows;
};

void add_question(ask::Parameters& rows, AreaQuestion& question) {
  ask::add_question(rows, question.request);
  rows.front().help = "The area as WKT, POLYGON or MULTIPOLYGON";
  rows.front().example = "POLYGON((-118.31 34.34, -118.3 34.34, -118.3 34.35, -118.31 34.34))";
  rows.add(kColumns, &question.columns, "",
           "Positions along x, both ends included; 0: those of the terrain's samples; without it "
           "as many as make squares with those along y, or 65 along the longer side")
      .at(ask::Door::kService)
      .like("50");
  rows.add(kRows, &question.rows, "", "The same along y").at(ask::Door::kService).like("50");
}

constexpr double kStepsOfGrid = 64;

/// Positions at equal steps along a side of a grid: `count` of them from `first` to `last`.
struct Side {
  double first = 0.0, last = 0.0;
  std::size_t count = 1;

  [[nodiscard]] double at(std::size_t i) const {
    if (count == 1) return first;
    return first + (last - first) * (static_cast<double>(i) / static_cast<double>(count - 1));
  }
};

/// Positions at equal steps along both sides, row by row from the south, in the CRS of the client.
struct Grid {
  Side x, y;

  [[nodiscard]] std::size_t size() const { return x.count * y.count; }
  [[nodiscard]] MapPoint at(std::size_t column, std::size_t row) const {
    return {x.at(column), y.at(row)};
  }
};

Window box_of(const Polygon& polygon) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Window box{kFar, kFar, -kFar, -kFar};
  for (const auto& ring : polygon.rings) {
    for (const MapPoint& p : ring) {
      box = {std::min(box.min_x, p.x), std::min(box.min_y, p.y), std::max(box.max_x, p.x),
             std::max(box.max_y, p.y)};
    }
  }
  return box;
}

std::size_t corners_of(const Polygon& polygon) {
  std::size_t corners = 0;
  for (const auto& ring : polygon.rings) corners += ring.size();
  return corners;
}

/// The polygon that `coords` holds. Across the antimeridian its longitudes go on beyond 180.
Polygon polygon_of(const Asked& asked, const Places& places) {
  Polygon polygon = polygon_of_wkt(asked.question.text("coords"), "coords");
  check_count(corners_of(polygon), asked.options.question.points, "positions", "points", "coords");
  for (auto& ring : polygon.rings) places.go_on(ring, polygon.rings[0][0].x);
  return polygon;
}

/// The number of equal steps along a side that are nearest to `step`; 0 where it has no length.
double steps_of(double length, double step) {
  return length > 0 && step > 0 ? std::max(1.0, std::round(length / step)) : 0.0;
}

/// A number of positions, both ends included, within the limit.
std::size_t checked_count(const Asked& asked, const char* name, double count) {
  const std::size_t most = asked.options.question.points;
  if (count <= static_cast<double>(most)) return static_cast<std::size_t>(count);
  throw http::Problem(
      413, "a grid has at most " + std::to_string(most) + " positions along a side; ask in parts")
      .at(name)
      .beyond("points");
}

/// The positions of the terrain's samples along a side, at equal steps.
/// @param anchor  Such a position, of which the next one is `step` away.
Side stored_side(const Asked& asked, const char* name, Side side, double anchor, double step) {
  constexpr double kSame = 1e-6;  // Share of a step that a transformation rounds.
  const double first = std::ceil((side.first - anchor) / step - kSame);
  const double last = std::floor((side.last - anchor) / step + kSame);
  if (!(first <= last)) {
    throw http::Problem(400,
                        "no sample of the terrain lies along this side of the area; ask for a "
                        "number of positions")
        .at(name);
  }
  return {anchor + first * step, anchor + last * step,
          checked_count(asked, name, last - first + 1)};
}

/// A sample next to the middle of a box in the client's CRS, and how far the next ones are from it
/// along x and along y. In another CRS than the terrain's they are so in the middle alone.
struct StoredSample {
  MapPoint at, step;
};

/// @param parameter  Asks for it.
StoredSample stored_sample(const Asked& asked, const Places& places, const Window& box,
                           const char* parameter) {
  const std::optional<MapPoint> pixel = tools::own_pixel_of(asked.terrain().store());
  if (!pixel) {
    throw http::Problem(
        400,
        "this terrain was not built from a raster and has no resolution of its own; "
        "ask for a number of positions")
        .at(parameter);
  }
  const AffineMap& map = asked.facts().map;
  const MapPoint middle{(box.min_x + box.max_x) / 2, (box.min_y + box.max_y) / 2};
  const MapPoint at = map.to_grid(places.to_terrain(middle));
  const double x = std::round(at.x), y = std::round(at.y);
  std::array<MapPoint, 3> samples{map.to_map(x, y), map.to_map(x + 1, y), map.to_map(x, y + 1)};
  places.from_terrain(samples);
  places.go_on(samples, middle.x);
  const auto& [here, east, north] = samples;
  return {here,
          {std::max(std::abs(east.x - here.x), std::abs(north.x - here.x)),
           std::max(std::abs(east.y - here.y), std::abs(north.y - here.y))}};
}

Grid grid_of(const Asked& asked, const AreaQuestion& question, const Places& places,
             const Polygon& polygon) {
  const Window box = box_of(polygon);
  const double width = box.max_x - box.min_x, height = box.max_y - box.min_y;
  std::optional<std::uint64_t> columns = question.columns, rows = question.rows;
  if (!columns && rows == 0U) columns = 0;
  if (!rows && columns == 0U) rows = 0;
  Grid grid{{box.min_x, box.max_x}, {box.min_y, box.max_y}};
  if (columns == 0U || rows == 0U) {
    const StoredSample sample = stored_sample(asked, places, box, columns == 0U ? kColumns : kRows);
    if (columns == 0U) grid.x = stored_side(asked, kColumns, grid.x, sample.at.x, sample.step.x);
    if (rows == 0U) grid.y = stored_side(asked, kRows, grid.y, sample.at.y, sample.step.y);
  }
  // Squares, of the side that is told, or else of a step along the longer one.
  double step = std::max(width, height) / kStepsOfGrid;
  if (columns > 1U) step = width / static_cast<double>(*columns - 1);
  if (rows > 1U) step = height / static_cast<double>(*rows - 1);
  if (columns != 0U) {
    const double otherwise = steps_of(width, step) + 1;
    grid.x.count =
        checked_count(asked, kColumns, columns ? static_cast<double>(*columns) : otherwise);
  }
  if (rows != 0U) {
    const double otherwise = steps_of(height, step) + 1;
    grid.y.count = checked_count(asked, kRows, rows ? static_cast<double>(*rows) : otherwise);
  }
  check_count(grid.x.count * grid.y.count, asked.options.question.points, "positions", "points",
              kColumns);
  return grid;
}

/// Whether a position lies within an odd number of rings; on a border it may be either.
bool is_within(const Polygon& polygon, MapPoint p) {
  bool is_inside = false;
  for (const auto& ring : polygon.rings) {
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const MapPoint &a = ring[i], &b = ring[j];
      if ((a.y > p.y) == (b.y > p.y)) continue;
      if (p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) is_inside = !is_inside;
    }
  }
  return is_inside;
}

Json axis_json(const Side& side) {
  if (side.count == 1) return {{"values", {side.first}}};
  return {{"start", side.first}, {"stop", side.last}, {"num", side.count}};
}

/// The positions of a grid that lie within a polygon.
struct Inner {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<MapPoint> at;         ///< In the CRS of the client.
  std::vector<std::size_t> number;  ///< For each position of the grid, its place in `at`.
};

/// Cost: positions of the grid times corners, both within the limit `points`.
Inner inner_of(const Asked& asked, const Grid& grid, const Polygon& polygon) {
  Inner inner;
  inner.number.assign(grid.size(), Inner::kNone);
  for (std::size_t row = 0; row < grid.y.count; ++row) {
    stop_if_asked(asked.limits.stop, "the area");
    for (std::size_t column = 0; column < grid.x.count; ++column) {
      const MapPoint p = grid.at(column, row);
      if (!is_within(polygon, p)) continue;
      inner.number[row * grid.x.count + column] = inner.at.size();
      inner.at.push_back(p);
    }
  }
  return inner;
}

Coverage coverage_of(const Grid& grid, const Inner& inner, const LocateResult& result) {
  Coverage coverage;
  coverage.grid_axes = {{"x", axis_json(grid.x)}, {"y", axis_json(grid.y)}};
  coverage.shape = {grid.y.count, grid.x.count};
  coverage.axes = {"y", "x"};
  coverage.size = inner.number.size();
  coverage.value = [&inner, &result](std::size_t i) {
    const std::size_t number = inner.number[i];
    if (number == Inner::kNone) return CoverageValue{0.0, 0.0, 0.0, CoverageState::kLeftOut};
    return value_of(result.points[number]);
  };
  return coverage;
}

}  // namespace

ask::Parameters area_parameters() { return with_coverage(described<AreaQuestion>()); }

http::Response answer_area(const Asked& asked) {
  const ask::Format& format = format_of(asked);
  auto question = read<AreaQuestion>(asked);
  const CoverageNames names = coverage_names(asked);
  const Places places = places_of(asked);
  const Polygon polygon = polygon_of(asked, places);
  const Grid grid = grid_of(asked, question, places, polygon);
  Inner inner = inner_of(asked, grid, polygon);
  std::vector<MapPoint> at = inner.at;
  places.to_terrain(at);
  places.wrap(inner.at);
  LocateRequest& request = question.request;
  check_detail(asked, request.detail);
  request.limits = engine_limits(asked, inner.number.size() * kAnswerBytesOfPlace);
  const LocateResult result = asked.terrain().locate(at, request);

  std::string text =
      points_in(format, asked, places, names, inner.at, result, coverage_of(grid, inner, result));
  return answered(asked, std::move(text), format.media, result);
}

}  // namespace ptin::serve
