// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights on a grid within a polygon: OGC EDR's `area`.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "engine/stop.h"
#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/coverage.h"
#include "tools/serve/questions.h"
#include "tools/serve/wkt_places.h"

namespace ptin::serve {

namespace {

constexpr auto kAreaParameters = std::to_array<ParameterFact>(
    {{"coords", "string", "the area as WKT, POLYGON or MULTIPOLYGON",
      "POLYGON((-118.31 34.34, -118.3 34.34, -118.3 34.35, -118.31 34.34))", true},
     {"resolution-x", "integer", "steps of the grid along x; without it 64 along the longer side",
      "50"},
     {"resolution-y", "integer", "steps of the grid along y", "50"},
     kErrorParameter,
     kVerticesParameter,
     kCrsParameter,
     kNamesParameter,
     kDatetimeParameter,
     kZParameter,
     {"f", "string", "covjson (the grid), geojson or csv (its positions within the area)",
      "covjson"}});
constexpr auto kAreaFormats = std::to_array<OfferedFormat>(
    {{"covjson", kCoverageJson}, {"geojson", kGeoJson}, {"csv", kCsv}});
constexpr double kStepsOfGrid = 64;

/// Positions at equal steps over a box, row by row from the south, in the CRS of the client.
struct Grid {
  Window box{};
  std::size_t columns = 1, rows = 1;

  [[nodiscard]] double x(std::size_t column) const {
    return box.min_x + (box.max_x - box.min_x) * share(column, columns);
  }
  [[nodiscard]] double y(std::size_t row) const {
    return box.min_y + (box.max_y - box.min_y) * share(row, rows);
  }

 private:
  static double share(std::size_t i, std::size_t n) {
    return n == 1 ? 0.0 : static_cast<double>(i) / static_cast<double>(n - 1);
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

Grid grid_of(const Asked& asked, const Polygon& polygon) {
  Grid grid{box_of(polygon), 1, 1};
  const double width = grid.box.max_x - grid.box.min_x, height = grid.box.max_y - grid.box.min_y;
  const double step = std::max(width, height) / kStepsOfGrid;
  const auto steps_along = [&](const char* name, double length) {
    const auto otherwise =
        static_cast<std::uint64_t>(step > 0 ? std::max(1.0, std::ceil(length / step)) : 1.0);
    const std::uint64_t steps = asked.question.count(name).value_or(otherwise);
    if (steps >= 1 && steps <= asked.options.question.points) return steps + 1;
    throw http::Problem(
        steps == 0 ? 400 : 413,
        "a grid has 1 to " + std::to_string(asked.options.question.points) + " steps along a side")
        .at(name)
        .beyond("points");
  };
  grid.columns = steps_along("resolution-x", width);
  grid.rows = steps_along("resolution-y", height);
  check_count(grid.columns * grid.rows, asked.options.question.points, "positions", "points",
              "resolution-x");
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

Json axis_json(double start, double stop, std::size_t count) {
  if (count == 1) return {{"values", {start}}};
  return {{"start", start}, {"stop", stop}, {"num", count}};
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
  inner.number.assign(grid.columns * grid.rows, Inner::kNone);
  for (std::size_t row = 0; row < grid.rows; ++row) {
    stop_if_asked(asked.limits.stop, "the area");
    for (std::size_t column = 0; column < grid.columns; ++column) {
      const MapPoint p{grid.x(column), grid.y(row)};
      if (!is_within(polygon, p)) continue;
      inner.number[row * grid.columns + column] = inner.at.size();
      inner.at.push_back(p);
    }
  }
  return inner;
}

Coverage coverage_of(const Grid& grid, const Inner& inner, const LocateResult& result) {
  Coverage coverage;
  coverage.grid_axes = {{"x", axis_json(grid.box.min_x, grid.box.max_x, grid.columns)},
                        {"y", axis_json(grid.box.min_y, grid.box.max_y, grid.rows)}};
  coverage.shape = {grid.rows, grid.columns};
  coverage.axes = {"y", "x"};
  coverage.size = inner.number.size();
  coverage.value = [&inner, &result](std::size_t i) {
    const std::size_t number = inner.number[i];
    if (number == Inner::kNone) return CoverageValue{0.0, 0.0, 0.0, CoverageState::kLeftOut};
    return value_of(result.points[number]);
  };
  return coverage;
}

std::size_t corners_of(const Polygon& polygon) {
  std::size_t corners = 0;
  for (const auto& ring : polygon.rings) corners += ring.size();
  return corners;
}

}  // namespace

std::span<const ParameterFact> area_parameters() noexcept { return kAreaParameters; }

http::Response answer_area(const Asked& asked) {
  static_cast<void>(asked_names(asked.question));
  const OfferedFormat& format = format_of(asked, kAreaFormats);
  const Places places(asked.collection->crs, asked.question.text("crs"), asked.collection->bounds);
  const Polygon polygon = polygon_of_wkt(asked.question.needed("coords"), "coords");
  check_count(corners_of(polygon), asked.options.question.points, "positions", "points", "coords");
  const Grid grid = grid_of(asked, polygon);
  const Inner inner = inner_of(asked, grid, polygon);
  std::vector<MapPoint> at = inner.at;
  places.to_terrain(at);
  LocateRequest request;
  request.detail = detail_of(asked);
  request.limits = engine_limits(asked, inner.number.size() * kAnswerBytesOfPlace);
  const LocateResult result = asked.terrain().locate(at, request);

  std::string text;
  if (format.name == "csv") {
    text = points_csv(asked, inner.at, result);
  } else if (format.name == "geojson") {
    text = points_geojson(asked, inner.at, result);
  } else {
    text =
        coverage_text(asked, places, coverage_of(grid, inner, result), certainty_of(asked, result));
  }
  http::Response response = text_response(std::move(text), format.media);
  add_choice(response, asked);
  add_cost(response, result.cost);
  add_certainty(response, result.certified_error, result.exact);
  return response;
}

}  // namespace ptin::serve
