// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights on a grid within a shape: OGC EDR's `area`, `cube`, `radius` and `corridor`.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "engine/crs/ground.h"
#include "engine/stop.h"
#include "tools/ask/questions.h"
#include "tools/facts/human.h"
#include "tools/facts/quantity.h"
#include "tools/facts/source_count.h"
#include "tools/http/problem.h"
#include "tools/output/file_name.h"
#include "tools/region/straight_sides.h"
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

void add_resolution(ask::Parameters& rows, AreaQuestion& question) {
  rows.add(kColumns, &question.columns, "",
           "Positions along x, both ends included; 0: those of the terrain's samples; without it "
           "as many as make squares with those along y, or 65 along the longer side")
      .at(ask::Door::kService)
      .like("50");
  rows.add(kRows, &question.rows, "", "The same along y").at(ask::Door::kService).like("50");
}

void add_question(ask::Parameters& rows, AreaQuestion& question) {
  ask::add_question(rows, question.request);
  rows.front().help = "The area as WKT, POLYGON or MULTIPOLYGON";
  rows.front().example = "POLYGON((-118.31 34.34, -118.3 34.34, -118.3 34.35, -118.31 34.34))";
  add_resolution(rows, question);
}

struct CubeQuestion : AreaQuestion {
  ask::RegionText region;
};

void add_question(ask::Parameters& rows, CubeQuestion& question) {
  ask::add_window(rows, question.region, ask::Door::kService);
  rows.back().required_at(ask::Door::kService);
  ask::add_detail(rows, question.request.detail, "; heights come with intervals",
                  "The TIN of the terrain's N most important vertices, instead of an error",
                  ask::Door::kService);
  ask::add_crs(rows);
  add_resolution(rows, question);
}

/// A length over ground, as a number and a unit in a parameter of its own.
struct Around : AreaQuestion {
  double length = 0.0;
  std::string unit;
};

void add_length(ask::Parameters& rows, Around& question, const char* name, const char* unit_name,
                const char* help) {
  rows.add(name, &question.length, "", help)
      .within(NumberRange::kPositive)
      .at(ask::Door::kService)
      .required_at(ask::Door::kService)
      .like("1");
  rows.add(unit_name, &question.unit, "",
           "The unit of that length over ground: " + tools::known_length_units())
      .at(ask::Door::kService)
      .required_at(ask::Door::kService)
      .like("km");
}

struct RadiusQuestion : Around {};

void add_question(ask::Parameters& rows, RadiusQuestion& question) {
  ask::add_question(rows, question.request);
  rows.front().help = "The middles as WKT, POINT or MULTIPOINT";
  add_length(rows, question, "within", "within-units", "How far around them, over ground");
  add_resolution(rows, question);
}

struct CorridorQuestion : Around {};

void add_question(ask::Parameters& rows, CorridorQuestion& question) {
  ask::add_question(rows, question.request);
  rows.front().help = "The middle as WKT, LINESTRING or MULTILINESTRING";
  rows.front().example = "LINESTRING(-118.3 34.34, -118.29 34.35)";
  add_length(rows, question, "corridor-width", "width-units",
             "The whole width of the corridor, over ground");
  for (const char* name : {"corridor-height", "height-units", "resolution-z"}) {
    ask::add_text(rows, name,
                  "Accepted and without effect: a surface has one height at a position");
  }
  add_resolution(rows, question);
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
             const Window& box) {
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

/// A shape in the CRS of the client.
struct Shape {
  Window box{};
  std::function<bool(MapPoint)> holds;
};

/// The positions of a grid that lie within a shape.
struct Inner {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<MapPoint> at;         ///< In the CRS of the client.
  std::vector<std::size_t> number;  ///< For each position of the grid, its place in `at`.
};

/// Cost: positions of the grid times corners, both within the limit `points`.
Inner inner_of(const Asked& asked, const Grid& grid, const Shape& shape) {
  Inner inner;
  inner.number.assign(grid.size(), Inner::kNone);
  for (std::size_t row = 0; row < grid.y.count; ++row) {
    stop_if_asked(asked.limits.stop, "the area");
    for (std::size_t column = 0; column < grid.x.count; ++column) {
      const MapPoint p = grid.at(column, row);
      if (!shape.holds(p)) continue;
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

/// Metres of a length that a question names.
double metres_of(const Around& question, const char* unit_name) {
  const auto one = tools::length_of("1" + tools::lower_case(question.unit));
  if (one && one->has_unit()) return question.length * one->metres;
  throw http::Problem(400, "\"" + tools::shown(question.unit) +
                               "\" is no unit of lengths here; there are " +
                               tools::known_length_units())
      .at(unit_name);
}

/// Metres over ground of one map unit at a position of the terrain's CRS.
MapPoint metres_at(const Asked& asked, MapPoint at) {
  if (const auto metres = metres_per_map_unit(asked.collection->crs, at)) return *metres;
  throw http::Problem(400,
                      "nothing tells the unit of this terrain's map, so lengths over ground "
                      "mean nothing on it; ask for an area")
      .at("coords");
}

/// Makes a window larger by metres on every side, in the terrain's CRS.
Window widened(const Asked& asked, Window w, double metres) {
  const double up = metres / metres_at(asked, {w.min_x, w.min_y}).y;
  w.min_y -= up;
  w.max_y += up;
  // In degrees the most at the side nearer to a pole.
  const double across =
      std::min(metres_at(asked, {w.min_x, w.min_y}).x, metres_at(asked, {w.min_x, w.max_y}).x);
  w.min_x -= metres / across;
  w.max_x += metres / across;
  if (!asked.collection->crs.geographic) return w;
  // Around a pole lie all longitudes.
  const bool holds_pole = w.min_y <= -90 || w.max_y >= 90;
  if (holds_pole || !(w.max_x - w.min_x < 360)) {
    const double middle = (w.min_x + w.max_x) / 2;
    w.min_x = middle - 180;
    w.max_x = middle + 180;
  }
  w.min_y = std::max(w.min_y, -90.0);
  w.max_y = std::min(w.max_y, 90.0);
  return w;
}

/// A box of the terrain's CRS in the client's; across the antimeridian it goes on beyond 180.
Window box_for_client(const Places& places, const Window& there) {
  if (places.is_native()) return there;
  auto box = places.from_terrain(there);
  if (!box) {
    throw http::Problem(400, "the shape reaches where the CRS of the question has no positions")
        .at("coords");
  }
  if (box->min_x > box->max_x) box->max_x += 360;
  return *box;
}

/// The place of a side nearest to a position, in the plane that has the lengths of that position.
MapPoint nearest_of(const MapPoint& a, const MapPoint& b, const MapPoint& p, const MapPoint& unit) {
  const double bx = (b.x - a.x) * unit.x, by = (b.y - a.y) * unit.y;
  const double px = (p.x - a.x) * unit.x, py = (p.y - a.y) * unit.y;
  const double length = bx * bx + by * by;
  const double share = length > 0 ? std::clamp((px * bx + py * by) / length, 0.0, 1.0) : 0.0;
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

/// The positions within metres of lines in the terrain's CRS, over ground, which in degrees is along the
/// ellipsoid; a position is a line of one corner.
Shape around(const Asked& asked, const Places& places, std::vector<std::vector<MapPoint>> lines,
             double metres) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Window box{kFar, kFar, -kFar, -kFar};
  for (const auto& line : lines) {
    for (const MapPoint& p : line) {
      box = {std::min(box.min_x, p.x), std::min(box.min_y, p.y), std::max(box.max_x, p.x),
             std::max(box.max_y, p.y)};
    }
  }
  Shape shape{box_for_client(places, widened(asked, box, metres)), {}};
  shape.holds = [&asked, &places, metres, ground = ground_of(asked.collection->crs),
                 lines = std::move(lines)](MapPoint client) {
    const MapPoint p = places.to_terrain(client);
    const MapPoint unit = metres_at(asked, p);
    MapPoint nearest{};
    double least = kFar;
    for (const auto& line : lines) {
      for (std::size_t i = 0; i < line.size(); ++i) {
        const MapPoint c = nearest_of(line[i], line[i + 1 < line.size() ? i + 1 : i], p, unit);
        const double away = std::hypot((p.x - c.x) * unit.x, (p.y - c.y) * unit.y);
        if (away < least) nearest = c;
        least = std::min(least, away);
      }
    }
    if (!ground.geographic) return least <= metres;
    return ground.distance(p, nearest) * ground.metres_per_height <= metres;
  };
  return shape;
}

/// The answer of all: the heights of the grid in a shape.
http::Response answer_in(const Asked& asked, AreaQuestion question, const Places& places,
                         const Shape& shape) {
  const ask::Format& format = format_of(asked);
  const CoverageNames names = coverage_names(asked);
  const Grid grid = grid_of(asked, question, places, shape.box);
  Inner inner = inner_of(asked, grid, shape);
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

}  // namespace

ask::Parameters area_parameters() { return with_coverage(described<AreaQuestion>()); }
ask::Parameters cube_parameters() { return with_coverage(described<CubeQuestion>()); }
ask::Parameters radius_parameters() { return with_coverage(described<RadiusQuestion>()); }
ask::Parameters corridor_parameters() { return with_coverage(described<CorridorQuestion>()); }

http::Response answer_area(const Asked& asked) {
  const auto question = read<AreaQuestion>(asked);
  const Places places = places_of(asked);
  const Polygon polygon = polygon_of(asked, places);
  const Shape shape{box_of(polygon), [&polygon](MapPoint p) { return is_within(polygon, p); }};
  return answer_in(asked, question, places, shape);
}

http::Response answer_cube(const Asked& asked) {
  const auto question = read<CubeQuestion>(asked);
  const Places places = places_of(asked);
  static_cast<void>(window_on_terrain(asked, places, question.region.window));
  Shape shape{*question.region.window, [](MapPoint) { return true; }};
  if (places.is_geographic() && shape.box.min_x > shape.box.max_x) shape.box.max_x += 360;
  return answer_in(asked, question, places, shape);
}

http::Response answer_radius(const Asked& asked) {
  const auto question = read<RadiusQuestion>(asked);
  const Places places = places_of(asked);
  std::vector<std::vector<MapPoint>> lines;
  for (const MapPoint& p : points_of_wkt(asked.question.text("coords"), "coords")) {
    lines.push_back({places.to_terrain(p)});
  }
  check_count(lines.size(), asked.options.question.points, "positions", "points", "coords");
  const double metres = metres_of(question, "within-units");
  return answer_in(asked, question, places, around(asked, places, std::move(lines), metres));
}

http::Response answer_corridor(const Asked& asked) {
  const auto question = read<CorridorQuestion>(asked);
  const Places places = places_of(asked);
  tools::SideTarget sides = tools::side_target(asked.facts(), 0.0);
  sides.most_points = asked.options.question.points;
  std::vector<std::vector<MapPoint>> lines;
  std::size_t corners = 0;
  for (auto& line : lines_of_wkt(asked.question.text("coords"), "coords")) {
    for (auto& there : places.line_to_terrain(std::move(line), sides)) {
      corners += there.size();
      lines.push_back(std::move(there));
    }
    check_count(corners, asked.options.question.points, "positions", "points", "coords");
  }
  const double metres = metres_of(question, "width-units") / 2;
  return answer_in(asked, question, places, around(asked, places, std::move(lines), metres));
}

}  // namespace ptin::serve
