// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/on_terrain.h"

#include <cmath>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "tools/formats/number_text.h"

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

}  // namespace

void check_on_terrain(const Region& region, const StoreFacts& facts, const std::string& option) {
  if (meets(region, facts)) return;
  const bool exchanged = meets(std::visit(ChangePlaces{}, region), facts);
  throw Error(ErrorCode::invalid_argument,
              "this misses the terrain, which has " + bounds_text(facts) +
                  (exchanged ? "; with x and y exchanged it would not: give x before y" : ""),
              option);
}

Window window_of(const std::vector<double>& numbers, const std::string& option) {
  for (const double number : numbers) {
    if (!std::isfinite(number)) refuse("a region's coordinates must be finite numbers", option);
  }
  if (numbers[0] > numbers[2] || numbers[1] > numbers[3]) {
    throw Error(ErrorCode::invalid_argument,
                "the window is inverted; its order is XMIN YMIN XMAX YMAX with XMIN <= XMAX and "
                "YMIN <= YMAX",
                option);
  }
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

}  // namespace ptin::tools
