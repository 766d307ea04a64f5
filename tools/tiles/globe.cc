// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/globe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <utility>

#include <cpl_conv.h>
#include <ogr_spatialref.h>
#include <proj.h>

#include "engine/crs/ground.h"
#include "engine/error.h"
#include "tools/tiles/curve_range.h"

namespace ptin::tools {

namespace {

/// No undulation of the geoid is larger, metres.
constexpr double kMostUndulation = 120.0;

struct DestroyContext {
  void operator()(PJ_CONTEXT* c) const noexcept { proj_context_destroy(c); }
};
struct DestroyPj {
  void operator()(PJ* p) const noexcept { proj_destroy(p); }
};
using ContextPtr = std::unique_ptr<PJ_CONTEXT, DestroyContext>;
using PjPtr = std::unique_ptr<PJ, DestroyPj>;

/// The horizontal part of a CRS, as WKT; empty when there is none.
std::string plane_of(const std::string& wkt) {
  OGRSpatialReference srs;
  if (srs.importFromWkt(wkt.c_str()) != OGRERR_NONE) return {};
  if (srs.IsCompound() != 0) srs.StripVertical();
  if (srs.GetAxesCount() > 2) srs.DemoteTo2D(nullptr);
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  char* text = nullptr;
  std::string plane;
  if (srs.exportToWkt(&text, options) == OGRERR_NONE && text != nullptr) plane = text;
  CPLFree(text);
  return plane;
}

/// From a CRS to another, x and longitude first; null when PROJ knows no way.
PjPtr way(PJ_CONTEXT* context, const std::string& from, const char* to, bool is_exact) {
  const PjPtr source(proj_create(context, from.c_str()));
  const PjPtr target(proj_create(context, to));
  if (source == nullptr || target == nullptr) return nullptr;
  const char* const exact[] = {"ALLOW_BALLPARK=NO", nullptr};
  const PjPtr raw(proj_create_crs_to_crs_from_pj(context, source.get(), target.get(), nullptr,
                                                 is_exact ? exact : nullptr));
  return raw == nullptr ? nullptr : PjPtr(proj_normalize_for_visualization(context, raw.get()));
}

/// `lon` turned by full circles until it is next to another longitude.
double next_to(double lon, double other) noexcept {
  return lon + 360.0 * std::round((other - lon) / 360.0);
}

Window window_of(const GridBox& b) {
  return {static_cast<double>(b.min_x), static_cast<double>(b.min_y), static_cast<double>(b.max_x),
          static_cast<double>(b.max_y)};
}

/// Calls visit(xs, ys) for each side of a box: `steps` + 1 points from corner to corner, of which
/// place(x, y) gives two numbers each.
template <class Place, class Visit>
void walk_sides(const Window& w, std::size_t steps, const Place& place, const Visit& visit) {
  const std::array<MapPoint, 5> corners{{{w.min_x, w.min_y},
                                         {w.max_x, w.min_y},
                                         {w.max_x, w.max_y},
                                         {w.min_x, w.max_y},
                                         {w.min_x, w.min_y}}};
  std::vector<double> xs(steps + 1), ys(steps + 1);
  for (std::size_t side = 0; side < 4; ++side) {
    const MapPoint& a = corners[side];
    const MapPoint& b = corners[side + 1];
    for (std::size_t i = 0; i <= steps; ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(steps);
      const MapPoint p = place(std::lerp(a.x, b.x, t), std::lerp(a.y, b.y, t));
      xs[i] = p.x;
      ys[i] = p.y;
    }
    visit(xs, ys);
  }
}

/// Whether a pole is one place of the map that lies in a box of the grid, or on its border.
bool holds_pole(const GlobePath& path, const AffineMap& map, const GridBox& b, double lat) {
  const MapPoint pole = map.to_grid(path.to_map(0.0, lat));
  const MapPoint turned = map.to_grid(path.to_map(120.0, lat));
  constexpr double kSame = 1.0;  // grid unit
  const bool is_one =
      std::hypot(pole.x - turned.x, pole.y - turned.y) < kSame;  // false of no place
  return is_one && pole.x > b.min_x - kSame && pole.x < b.max_x + kSame &&
         pole.y > b.min_y - kSame && pole.y < b.max_y + kSame;
}

}  // namespace

VerticalDatum vertical_datum(const CrsFacts& crs) {
  OGRSpatialReference srs;
  if (crs.wkt.empty() || srs.importFromWkt(crs.wkt.c_str()) != OGRERR_NONE)
    return VerticalDatum::kUnknown;
  if (srs.IsCompound() == 0) {
    const bool is_solid = srs.GetAxesCount() >= 3 && srs.IsLocal() == 0;
    return is_solid ? VerticalDatum::kEllipsoidal : VerticalDatum::kUnknown;
  }
  // 2002 is the type of a datum that is an ellipsoid, in WKT 1, which alone says so.
  const char* const type = srs.GetAttrValue("VERT_DATUM", 1);
  return type != nullptr && std::string(type) == "2002" ? VerticalDatum::kEllipsoidal
                                                        : VerticalDatum::kOrthometric;
}

struct GlobePath::Impl {
  ContextPtr context;
  PjPtr plane;  ///< Map to longitude and latitude.
  PjPtr solid;  ///< The same with heights, where these are transformed.
  AffineMap map;
  double metres_per_height = 1.0;
  double degrees_per_map_unit = 0.0;
  double middle_lon = 0.0;
};

GlobePath::~GlobePath() = default;

GlobePoint GlobePath::to_globe(double x, double y, double height) const {
  const MapPoint at = impl_->map.to_map(x, y);
  const bool has_solid = impl_->solid != nullptr;
  const PJ_COORD to = proj_trans(has_solid ? impl_->solid.get() : impl_->plane.get(), PJ_FWD,
                                 proj_coord(at.x, at.y, has_solid ? height : 0.0, HUGE_VAL));
  if (!std::isfinite(to.xyz.x) || !std::isfinite(to.xyz.y) || !std::isfinite(to.xyz.z)) {
    refuse("PROJ cannot transform it to EPSG:4326",
           "the position " + std::to_string(at.x) + " " + std::to_string(at.y));
  }
  const double degrees = impl_->degrees_per_map_unit;
  return {next_to(to.xyz.x, degrees > 0 ? at.x * degrees : impl_->middle_lon), to.xyz.y,
          has_solid ? to.xyz.z : height * impl_->metres_per_height};
}

MapPoint GlobePath::to_map(double lon, double lat) const {
  const PJ_COORD to = proj_trans(impl_->plane.get(), PJ_INV, proj_coord(lon, lat, 0.0, HUGE_VAL));
  const double degrees = impl_->degrees_per_map_unit;
  return {degrees > 0 ? next_to(to.xy.x * degrees, lon) / degrees : to.xy.x, to.xy.y};
}

std::unique_ptr<GlobePath> Globe::make_path() const {
  auto impl = std::make_unique<GlobePath::Impl>();
  impl->context.reset(proj_context_create());
  PJ_CONTEXT* const context = impl->context.get();
  proj_log_level(context, PJ_LOG_NONE);
  if (options_.to_ellipsoid) impl->solid = way(context, crs_.wkt, "EPSG:4979", true);
  impl->plane = way(context, plane_of(crs_.wkt), "EPSG:4326", false);
  if (impl->plane == nullptr)
    refuse("the terrain's CRS is no place on Earth that PROJ knows: give one to build", crs_.name);
  if (options_.to_ellipsoid && impl->solid == nullptr) {
    refuse("PROJ knows no way from these heights to the ellipsoid; leave them as they are",
           crs_.vertical_text());
  }
  impl->map = facts_.map;
  impl->metres_per_height = metres_per_height_;
  impl->degrees_per_map_unit = degrees_per_map_unit_;
  impl->middle_lon = middle_lon_;
  std::unique_ptr<GlobePath> path(new GlobePath());
  path->impl_ = std::move(impl);
  return path;
}

Globe::Globe(const StoreFacts& facts, const CrsFacts& crs, const GlobeOptions& options)
    : facts_(facts), crs_(crs), options_(options) {
  OGRSpatialReference srs;
  if (crs.wkt.empty() || srs.importFromWkt(crs.wkt.c_str()) != OGRERR_NONE)
    refuse("tiles need the terrain's CRS, which the file does not tell: give --a-srs to build");
  if (options.to_ellipsoid && vertical_datum(crs) == VerticalDatum::kUnknown) {
    refuse(
        "heights cannot be made ellipsoidal: the file does not tell from where they are "
        "measured; give --vertical-crs to build");
  }
  metres_per_height_ = ground_of(crs).metres_per_height;
  if (srs.IsGeographic() != 0) degrees_per_map_unit_ = srs.GetAngularUnits() * (180.0 / M_PI);
  std::unique_ptr<GlobePath> path = make_path();
  const GridBox& b = facts.bounds;
  try {
    middle_lon_ =
        path->to_globe(0.5 * b.min_x + 0.5 * b.max_x, 0.5 * b.min_y + 0.5 * b.max_y, 0).lon;
  } catch (const Error& e) {
    if (!options.to_ellipsoid) throw;
    refuse(
        "PROJ lacks what it needs to make these heights ellipsoidal, a grid perhaps; leave "
        "them as they are",
        crs.vertical_text());
  }
  path->impl_->middle_lon = middle_lon_;
  find_box(*path);
  if (facts.min_height <= facts.max_height) {
    const double slack = options.to_ellipsoid ? kMostUndulation : 0.0;
    min_height_ = facts.min_height * metres_per_height_ - slack;
    max_height_ = facts.max_height * metres_per_height_ + slack;
  }
  idle_.push_back(std::move(path));
}

void Globe::find_box(const GlobePath& path) {
  const GridBox& b = facts_.bounds;
  const bool is_plane = degrees_per_map_unit_ == 0;
  CurveRange lon, lat;
  bool turns =
      is_plane && (holds_pole(path, facts_.map, b, 90.0) || holds_pole(path, facts_.map, b, -90.0));
  // Where heights are transformed, positions depend on them.
  std::vector<double> heights = {0.0};
  if (options_.to_ellipsoid && facts_.min_height <= facts_.max_height)
    heights = {facts_.min_height, facts_.max_height};
  for (const double height : heights) {
    const auto place = [&](double x, double y) {
      const GlobePoint p = path.to_globe(x, y, height);
      return MapPoint{p.lon, p.lat};
    };
    walk_sides(window_of(b), 64, place,
               [&](const std::vector<double>& lons, const std::vector<double>& lats) {
                 for (std::size_t i = 1; i < lons.size(); ++i)
                   turns = turns || (is_plane && std::abs(lons[i] - lons[i - 1]) > 180.0);
                 lon.hold_curve(lons);
                 lat.hold_curve(lats);
               });
  }
  if (turns)
    refuse("a pole lies within the terrain, which tiles of longitude and latitude cannot show");
  if (is_plane) {  // As GlobePath::to_globe() turns longitudes.
    lon.low = std::max(lon.low, middle_lon_ - 180.0);
    lon.high = std::min(lon.high, middle_lon_ + 180.0);
  }
  const double rounding = 1e-12 * (lon.high - lon.low);
  box_ = {lon.low - rounding, std::max(-90.0, lat.low - rounding), lon.high + rounding,
          std::min(90.0, lat.high + rounding)};
}

Globe::Lease Globe::path() const {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!idle_.empty()) {
      std::unique_ptr<GlobePath> path = std::move(idle_.back());
      idle_.pop_back();
      return {*this, std::move(path)};
    }
  }
  return {*this, make_path()};
}

Globe::Lease::~Lease() {
  const std::lock_guard<std::mutex> lock(globe_->mutex_);
  try {
    globe_->idle_.push_back(std::move(path_));
  } catch (const std::bad_alloc&) {
    // It is kept to save time alone: the next one makes its own.
  }
}

GridBox Globe::grid_box(const GlobeBox& asked) const {
  const GlobeBox box{std::max(asked.west, box_.west), std::max(asked.south, box_.south),
                     std::min(asked.east, box_.east), std::min(asked.north, box_.north)};
  if (box.west > box.east || box.south > box.north) return {};
  const GridBox& all = facts_.bounds;
  CurveRange x, y;
  bool is_finite = true;
  const Lease way = path();
  walk_sides(
      {box.west, box.south, box.east, box.north}, 16,
      [&](double lon, double lat) { return facts_.map.to_grid(way->to_map(lon, lat)); },
      [&](const std::vector<double>& xs, const std::vector<double>& ys) {
        for (std::size_t i = 0; i < xs.size(); ++i)
          is_finite = is_finite && std::isfinite(xs[i]) && std::isfinite(ys[i]);
        x.hold_curve(xs);
        y.hold_curve(ys);
      });
  if (!is_finite) return all;
  constexpr double kRounding = 1.0;  // grid unit
  const double min_x = x.low - kRounding, max_x = x.high + kRounding;
  const double min_y = y.low - kRounding, max_y = y.high + kRounding;
  const auto clamped = [](double v, std::int32_t low, std::int32_t high) {
    return static_cast<std::int32_t>(std::clamp(v, double(low), double(high)));
  };
  if (max_x < all.min_x || min_x > all.max_x || max_y < all.min_y || min_y > all.max_y) return {};
  return {clamped(std::floor(min_x), all.min_x, all.max_x),
          clamped(std::floor(min_y), all.min_y, all.max_y),
          clamped(std::ceil(max_x), all.min_x, all.max_x),
          clamped(std::ceil(max_y), all.min_y, all.max_y)};
}

GlobeBox unwrapped(const GlobeBox& box) noexcept {
  return box.west > box.east ? GlobeBox{-180.0, box.south, 180.0, box.north} : box;
}

MapPoint middle_of(const GlobeBox& box) noexcept {
  const double east = box.east < box.west ? box.east + 360.0 : box.east;
  const double middle = 0.5 * (box.west + east);
  return {middle > 180.0 ? middle - 360.0 : middle, 0.5 * (box.south + box.north)};
}

}  // namespace ptin::tools
