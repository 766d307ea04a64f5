// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/on_terrain.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <ogr_spatialref.h>

#include "engine/error.h"
#include "tools/formats/number_text.h"
#include "tools/region/straight_sides.h"

namespace ptin::tools {

namespace {

struct ChangePlaces {
  Region operator()(const Window& w) const { return Window{w.min_y, w.min_x, w.max_y, w.max_x}; }
  Region operator()(const MapPoint& p) const { return MapPoint{p.y, p.x}; }
  Region operator()(const Segment& s) const { return Segment{{s.a.y, s.a.x}, {s.b.y, s.b.x}}; }
  Region operator()(Polygon polygon) const {
    for (std::vector<MapPoint>& ring : polygon.rings) {
      for (MapPoint& p : ring) std::swap(p.x, p.y);
    }
    return polygon;
  }
};

bool meets(const Region& region, const StoreFacts& facts) {
  return GridRegion(region, facts.map).meets(facts.bounds);
}

/// "x from 0 to 5, y from 0 to 7".
std::string bounds_text(const StoreFacts& facts) {
  const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint high = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  std::string text = "x from ";
  append_number(text, low.x);
  append_number(text.append(" to "), high.x);
  append_number(text.append(", y from "), low.y);
  append_number(text.append(" to "), high.y);
  return text;
}

/// Whether one of the places lies in the box.
bool holds_any(const Window& box, std::span<const MapPoint> places) {
  return std::any_of(places.begin(), places.end(), [&](const MapPoint& p) {
    return p.x >= box.min_x && p.x <= box.max_x && p.y >= box.min_y && p.y <= box.max_y;
  });
}

std::vector<MapPoint> exchanged(std::span<const MapPoint> places) {
  std::vector<MapPoint> other;
  for (const MapPoint& p : places) other.push_back({p.y, p.x});
  return other;
}

/// Longitudes and latitudes in the terrain's CRS; empty where that is not known.
std::vector<MapPoint> from_degrees(std::vector<MapPoint> places, const CrsFacts& crs) {
  OGRSpatialReference degrees, terrain;
  if (crs.wkt.empty() || degrees.importFromEPSG(4326) != OGRERR_NONE ||
      terrain.importFromWkt(crs.wkt.c_str()) != OGRERR_NONE) {
    return {};
  }
  std::erase_if(places,
                [](const MapPoint& p) { return std::abs(p.x) > 360 || std::abs(p.y) > 90; });
  for (OGRSpatialReference* plane : {&degrees, &terrain}) {
    plane->DemoteTo2D(nullptr);
    plane->StripVertical();
    plane->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  }
  const std::unique_ptr<OGRCoordinateTransformation> way(
      OGRCreateCoordinateTransformation(&degrees, &terrain));
  if (!way) return {};
  places_by (*way)(places);
  return places;
}

}  // namespace

std::optional<std::string> why_all_miss(std::span<const MapPoint> places, const StoreFacts& facts,
                                        const CrsFacts& crs) {
  const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint high = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  // Rounding may have moved a place on the border.
  const double slack_x = 1e-9 * (high.x - low.x), slack_y = 1e-9 * (high.y - low.y);
  const Window box{low.x - slack_x, low.y - slack_y, high.x + slack_x, high.y + slack_y};
  if (places.empty() || holds_any(box, places)) return std::nullopt;
  std::string why = bounds_text(facts);
  const std::vector<MapPoint> other = exchanged(places);
  if (holds_any(box, other)) {
    why += "; with x and y exchanged some would: give x before y";
  } else if (holds_any(box, from_degrees({places.begin(), places.end()}, crs))) {
    why += "; as longitude and latitude some would: give them in " + crs.name +
           ", or as a layer with its CRS";
  } else if (holds_any(box, from_degrees(other, crs))) {
    why += "; as latitude and longitude some would: give them in " + crs.name +
           ", x before y, or as a layer with its CRS";
  }
  return why;
}

void check_on_terrain(const Region& region, const StoreFacts& facts, const std::string& option) {
  if (meets(region, facts)) return;
  const bool exchanged = meets(std::visit(ChangePlaces{}, region), facts);
  throw Error(ErrorCode::invalid_argument,
              "this misses the terrain, which has " + bounds_text(facts) +
                  (exchanged ? "; with x and y exchanged it would not: give x before y" : ""),
              option);
}

Window window_of(std::span<const double> numbers, const std::string& option, bool may_turn) {
  if (numbers.size() != 4 && !(may_turn && numbers.size() == 6)) {
    refuse("a window has four numbers: xmin, ymin, xmax, ymax (west, south, east, north)", option);
  }
  for (const double number : numbers) {
    if (!std::isfinite(number)) refuse("a region's coordinates must be finite numbers", option);
  }
  const std::size_t half = numbers.size() / 2;
  const Window window{numbers[0], numbers[1], numbers[half], numbers[half + 1]};
  constexpr double kHalfCircle = 180;
  const bool turns = may_turn && std::abs(window.min_x) <= kHalfCircle &&
                     std::abs(window.max_x) <= kHalfCircle &&
                     window.min_x - window.max_x >= kHalfCircle;
  if ((window.min_x > window.max_x && !turns) || window.min_y > window.max_y) {
    refuse(kInverted, option);
  }
  return window;
}

}  // namespace ptin::tools
