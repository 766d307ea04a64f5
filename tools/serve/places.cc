// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <ogr_spatialref.h>

#include "engine/error.h"
#include "tools/http/problem.h"
#include "tools/region/on_terrain.h"
#include "tools/serve/transformations.h"
#include "tools/tiles/curve_range.h"

namespace ptin::serve {

namespace {

constexpr std::string_view kEpsg = "http://www.opengis.net/def/crs/EPSG/0/";
constexpr std::string_view kEpsgUrn = "urn:ogc:def:crs:EPSG::";
/// Steps along a side of a window: a straight side may be bent in the other CRS.
constexpr int kStepsOfSide = 32;
constexpr double kQuarterTurn = 90, kHalfTurn = 180, kTurn = 360;  // degrees

/// One of them, and the one against it.
struct Way {
  OGRCoordinateTransformation *there, *back;
};
Way forth(const BothWays& ways) { return {ways.there.get(), ways.back.get()}; }
Way back(const BothWays& ways) { return {ways.back.get(), ways.there.get()}; }

/// What the client's CRS is called for GDAL; nothing where it is the terrain's own.
std::optional<std::string> name_of(const std::string& asked) {
  if (asked == "native") return std::nullopt;
  if (asked == "CRS84" || asked == "OGC:CRS84" || asked == kCrs84) return "OGC:CRS84";
  std::string_view code;
  for (const std::string_view before : {std::string_view("EPSG:"), kEpsg, kEpsgUrn}) {
    if (asked.starts_with(before)) code = std::string_view(asked).substr(before.size());
  }
  const bool is_number = !code.empty() && code.size() < 8 &&
                         code.find_first_not_of("0123456789") == std::string_view::npos;
  if (is_number) return "EPSG:" + std::string(code);
  throw http::Problem(400,
                      "no CRS that is known here; expected CRS84, native, EPSG:CODE, or the "
                      "URI of one of them at http://www.opengis.net/def/crs/")
      .at("crs");
}

/// Whether x of a CRS is a longitude, and whether that is in degrees.
struct Longitudes {
  bool are_there = false, are_degrees = false;
};

Longitudes longitudes_of(const std::string& name) {
  constexpr double kDegree = 3.14159265358979323846 / 180, kSame = 1e-12;
  OGRSpatialReference crs;
  if (crs.SetFromUserInput(name.c_str()) != OGRERR_NONE || crs.IsGeographic() == 0) return {};
  return {true, std::abs(crs.GetAngularUnits() - kDegree) < kSame};
}

bool transform(OGRCoordinateTransformation& way, MapPoint& place) {
  double x = place.x, y = place.y;
  int succeeded = 0;
  way.Transform(1, &x, &y, nullptr, &succeeded);
  if (succeeded == 0 || !std::isfinite(x) || !std::isfinite(y)) return false;
  place = {x, y};
  return true;
}

/// Positions along a side of a window, from corner to corner; the four go once around it.
std::vector<MapPoint> along_side(const Window& w, std::size_t side) {
  const MapPoint corners[] = {
      {w.min_x, w.min_y}, {w.max_x, w.min_y}, {w.max_x, w.max_y}, {w.min_x, w.max_y}};
  const MapPoint &a = corners[side], &b = corners[(side + 1) % 4];
  std::vector<MapPoint> path;
  for (int i = 0; i <= kStepsOfSide; ++i) {
    const double t = static_cast<double>(i) / kStepsOfSide;
    path.push_back({std::lerp(a.x, b.x, t), std::lerp(a.y, b.y, t)});
  }
  return path;
}

/// The multiple of a turn that brings an x nearest to another one.
double turns_towards(double x, double other, double turn = kTurn) {
  return turn * std::round((other - x) / turn);
}

/// The turn of x in the plane of a cylinder around the Earth, such as Mercator's: x grows in
/// proportion to longitude alone. 0 of any other plane.
/// @param way  To longitude and latitude, and back.
double turn_of_cylinder(const Way& way, const Window& bounds) {
  constexpr double kStep = 0.5, kSame = 1e-11;
  MapPoint middle{(bounds.min_x + bounds.max_x) / 2, (bounds.min_y + bounds.max_y) / 2};
  if (!transform(*way.there, middle)) return 0;
  const double north = middle.y > 0 ? -kStep : kStep;
  const auto step_east = [&](double lon, double lat) {
    MapPoint a{lon, lat}, b{lon + kStep, lat};
    if (!transform(*way.back, a) || !transform(*way.back, b) || a.y != b.y) return 0.0;
    return b.x - a.x;
  };
  for (const double lon : {middle.x, middle.x - kStep}) {  // One of them is not across the seam.
    const double step = step_east(lon, middle.y), other = step_east(lon, middle.y + north);
    if (step > 0 && std::abs(step - other) < kSame * step) return step / kStep * kTurn;
  }
  return 0;
}

/// Whether a pole is one position of a CRS, and lies in a window of it or on its border.
/// @param way  From longitude and latitude.
bool holds_pole(OGRCoordinateTransformation& way, const Window& w, double lat) {
  MapPoint pole{0, lat}, turned{120, lat};
  if (!transform(way, pole) || !transform(way, turned)) return false;
  const double near = 1e-9 * (w.max_x - w.min_x + w.max_y - w.min_y);
  const bool is_one = std::hypot(pole.x - turned.x, pole.y - turned.y) <= near;
  return is_one && pole.x >= w.min_x - near && pole.x <= w.max_x + near &&
         pole.y >= w.min_y - near && pole.y <= w.max_y + near;
}

/// The box that holds a window's sides in the other CRS; none where one of their positions has none
/// there.
/// @param turn  Of x there, 360 of a longitude in degrees; 0: none. x jumps by it at the
///              antimeridian, which is taken out along the sides: the box may reach beyond 180.
std::optional<Window> box_of_sides(OGRCoordinateTransformation& way, const Window& window,
                                   double turn) {
  tools::CurveRange x, y;
  std::optional<double> last;
  for (std::size_t side = 0; side < 4; ++side) {
    std::vector<double> xs, ys;
    for (MapPoint p : along_side(window, side)) {
      if (!transform(way, p)) return std::nullopt;
      if (turn > 0 && last) p.x += turns_towards(p.x, *last, turn);
      last = p.x;
      xs.push_back(p.x);
      ys.push_back(p.y);
    }
    x.hold_curve(xs);
    y.hold_curve(ys);
  }
  return Window{x.low, y.low, x.high, y.high};
}

/// The box that holds a window in the other CRS, as above. A pole within the window makes it all
/// longitudes, up to the pole.
std::optional<Window> box_around(const Way& way, const Window& window, double turn) {
  std::optional<Window> box = box_of_sides(*way.there, window, turn);
  if (!box || turn != kTurn) return box;
  const bool north = holds_pole(*way.back, window, kQuarterTurn);
  const bool south = holds_pole(*way.back, window, -kQuarterTurn);
  box->min_y = south ? -kQuarterTurn : std::max(box->min_y, -kQuarterTurn);
  box->max_y = north ? kQuarterTurn : std::min(box->max_y, kQuarterTurn);
  if (north || south) {
    box->min_x = -kHalfTurn;
    box->max_x = kHalfTurn;
  }
  return box;
}

/// A window of longitudes as clients read it: from -180 to 180, west larger than east across the
/// antimeridian.
Window wrapped(Window window) {
  if (window.max_x - window.min_x >= kTurn) {
    window.min_x = -kHalfTurn;
    window.max_x = kHalfTurn;
    return window;
  }
  const double off = turns_towards((window.min_x + window.max_x) / 2, 0);
  window.min_x += off;
  window.max_x += off;
  if (window.min_x < -kHalfTurn) window.min_x += kTurn;
  if (window.max_x > kHalfTurn) window.max_x -= kTurn;
  return window;
}

bool is_in_degrees(const CrsFacts& crs) {
  return crs.geographic && crs.horizontal_unit == "degree";
}

}  // namespace

struct Places::Inside {
  std::shared_ptr<const BothWays> ways;  ///< Null: nothing is transformed.
};

Places::Places(const CrsFacts& terrain, const std::string& asked,
               const std::optional<Window>& bounds, const std::string& who)
    : inside_(std::make_unique<Inside>()),
      turn_(is_in_degrees(terrain) ? kTurn : 0),
      bounds_(bounds) {
  const bool is_known = !terrain.wkt.empty();
  const std::optional<std::string> name =
      asked.empty() && !is_known ? std::nullopt : name_of(asked.empty() ? "CRS84" : asked);
  if (!name) {
    uri_ = uri_of(terrain);
    geographic_ = terrain.geographic;
    client_turns_ = turn_ > 0;
    return;
  }
  if (!is_known) {
    throw http::Problem(400, "the CRS of this collection is not known; ask with crs=native")
        .at("crs");
  }
  inside_->ways = both_ways(*name, terrain.wkt, who);
  if (bounds && !terrain.geographic) {
    turn_ = turn_of_cylinder(back(*both_ways("OGC:CRS84", terrain.wkt)), *bounds);
  }
  uri_ = *name == "OGC:CRS84" ? std::string(kCrs84) : std::string(kEpsg) + name->substr(5);
  const Longitudes longitudes =
      *name == "OGC:CRS84" ? Longitudes{true, true} : longitudes_of(*name);
  geographic_ = longitudes.are_there;
  client_turns_ = longitudes.are_degrees;
}

Places::~Places() = default;

bool Places::is_native() const noexcept { return inside_->ways == nullptr; }

bool Places::is_north_first() const {
  if (!uri_.starts_with(kEpsg)) return false;
  OGRSpatialReference crs;
  const std::string code = "EPSG:" + uri_.substr(kEpsg.size());
  if (crs.SetFromUserInput(code.c_str()) != OGRERR_NONE) return false;
  return crs.EPSGTreatsAsLatLong() != 0 || crs.EPSGTreatsAsNorthingEasting() != 0;
}

double Places::turned(double x) const noexcept {
  if (turn_ == 0 || !bounds_ || (x >= bounds_->min_x && x <= bounds_->max_x)) return x;
  return x + turns_towards(x, (bounds_->min_x + bounds_->max_x) / 2, turn_);
}

std::vector<double> Places::shifts_onto_terrain(double low, double high) const {
  if (turn_ == 0 || !bounds_) return {0.0};
  std::vector<double> shifts;
  const double first = std::ceil((bounds_->min_x - high) / turn_);
  const double last = std::floor((bounds_->max_x - low) / turn_);
  for (double k = first; k <= last; ++k) {
    const double shift = k * turn_, from = low + shift, to = high + shift;
    if (from >= bounds_->min_x && to <= bounds_->max_x) return {shift};
    const bool only_touches = from == bounds_->max_x || to == bounds_->min_x;
    if (!only_touches) shifts.push_back(shift);
  }
  if (shifts.empty()) shifts.push_back(turned(low) - low);
  return shifts;
}

void Places::to_terrain(std::span<MapPoint> places, std::string_view parameter) const {
  if (is_native()) return;
  transform_to_terrain(places, parameter);
  for (MapPoint& place : places) place.x = turned(place.x);
}

void Places::transform_to_terrain(std::span<MapPoint> places, std::string_view parameter) const {
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (transform(*inside_->ways->there, places[i])) continue;
    throw http::Problem(400,
                        "position " + std::to_string(i + 1) +
                            " is nowhere in the CRS of this collection; expected x (longitude) "
                            "before y (latitude)")
        .at(std::string(parameter));
  }
}

MapPoint Places::to_terrain(MapPoint place, std::string_view parameter) const {
  to_terrain({&place, 1}, parameter);
  return place;
}

std::vector<std::vector<MapPoint>> Places::line_to_terrain(std::vector<MapPoint> line,
                                                           tools::SideTarget sides,
                                                           std::string_view parameter) const {
  if (is_native() || line.empty()) return {std::move(line)};
  sides.turn = turn_;
  sides.source_turns = client_turns_;
  try {
    line = tools::transformed_sides(line, tools::places_by(*inside_->ways->there), sides);
  } catch (const Error& e) {
    http::Problem problem(e.code() == ErrorCode::resource_exhausted ? 413 : 400, e.message());
    throw std::move(problem).at(std::string(parameter));
  }
  if (turn_ == 0) return {std::move(line)};
  const auto [low, high] = std::minmax_element(
      line.begin(), line.end(), [](const MapPoint& a, const MapPoint& b) { return a.x < b.x; });
  std::vector<std::vector<MapPoint>> lines;
  for (const double shift : shifts_onto_terrain(low->x, high->x)) {
    lines.push_back(line);
    for (MapPoint& p : lines.back()) p.x += shift;
  }
  return lines;
}

bool Places::is_in_turn_of_terrain(double x) const noexcept {
  if (turn_ == 0 || !bounds_) return true;
  const double from_middle = x - (bounds_->min_x + bounds_->max_x) / 2;
  return from_middle >= -turn_ / 2 && from_middle < turn_ / 2;
}

void Places::go_on(std::span<MapPoint> line, double from) const {
  if (!client_turns_ || is_native()) return;
  for (MapPoint& p : line) {
    p.x += turns_towards(p.x, from);
    from = p.x;
  }
}

void Places::wrap(std::span<MapPoint> places) const {
  if (!client_turns_ || is_native()) return;
  for (MapPoint& p : places) {
    if (std::abs(p.x) > kHalfTurn) p.x += turns_towards(p.x, 0);
  }
}

void Places::from_terrain(std::span<MapPoint> places) const {
  if (is_native()) return;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double last = 0.0;  // Nearest to it is from -180 to 180.
  for (MapPoint& place : places) {
    if (!transform(*inside_->ways->back, place)) {
      place = {kNone, kNone};
    } else if (client_turns_) {
      place.x += turns_towards(place.x, last);
      last = place.x;
    }
  }
}

Window Places::to_terrain(const Window& given) const {
  if (is_native() && given.min_x <= given.max_x) return given;
  Window window = given;
  if (window.min_x > window.max_x) {
    if (!client_turns_) {
      throw http::Problem(400, tools::kInverted).at("bbox");
    }
    window.max_x += kTurn;
  }
  if (!is_native()) {
    const std::optional<Window> box = box_around(forth(*inside_->ways), window, turn_);
    if (!box) {
      throw http::Problem(400,
                          "the window reaches where the CRS of this collection has no positions; "
                          "ask for a smaller one")
          .at("bbox");
    }
    window = *box;
  }
  if (turn_ == 0 || !bounds_) return window;
  if (window.max_x - window.min_x >= turn_) {  // Every longitude, in whatever turn.
    return {bounds_->min_x, window.min_y, bounds_->max_x, window.max_y};
  }
  const std::vector<double> shifts = shifts_onto_terrain(window.min_x, window.max_x);
  if (shifts.size() > 1) {
    throw http::Problem(400,
                        "the window lies on both sides of the longitude at which this terrain "
                        "begins and ends; ask for each side by itself")
        .at("bbox");
  }
  return {window.min_x + shifts[0], window.min_y, window.max_x + shifts[0], window.max_y};
}

std::optional<Window> Places::from_terrain(const Window& window) const {
  if (is_native()) return window;
  const std::optional<Window> box =
      box_around(back(*inside_->ways), window, client_turns_ ? kTurn : 0);
  return box && client_turns_ ? wrapped(*box) : box;
}

std::optional<Window> lon_lat_of(const Window& window, const CrsFacts& terrain) {
  if (terrain.wkt.empty()) return std::nullopt;
  try {
    const std::optional<Window> box =
        box_around(back(*both_ways("OGC:CRS84", terrain.wkt)), window, kTurn);
    return box ? std::optional(wrapped(*box)) : std::nullopt;
  } catch (const http::Problem&) {  // There is no transformation.
    return std::nullopt;
  }
}

std::string uri_of(const CrsFacts& terrain) {
  if (!terrain.code.starts_with("EPSG:")) return {};
  return std::string(kEpsg) + terrain.code.substr(5);
}

}  // namespace ptin::serve
