// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/pixel_size.h"

#include <utility>

#include "engine/crs/ground.h"
#include "engine/error.h"
#include "tools/facts/quantity.h"
#include "tools/facts/source_count.h"

namespace ptin::tools {

namespace {

constexpr const char* kPixelSize = "--pixel-size";

Length pixel_side_of(const std::string& text) {
  if (const std::optional<Length> length = length_of(text); length && length->number > 0) {
    return *length;
  }
  throw Error(ErrorCode::invalid_argument,
              "\"" + text +
                  "\" is no size of a pixel; expected a number > 0 in map units, or with a unit (" +
                  known_length_units() + ") behind it a length over ground, as 90m",
              kPixelSize);
}

}  // namespace

std::vector<Length> pixel_sides_of(const std::vector<std::string>& texts) {
  std::vector<Length> sides;
  for (const std::string& text : texts) sides.push_back(pixel_side_of(text));
  return sides;
}

std::array<double, 2> pixel_size_of(const std::vector<Length>& sides, const CrsFacts& crs,
                                    MapPoint at) {
  const Length& across = sides.front();
  const Length& up = sides.back();
  if (!across.has_unit() && !up.has_unit()) return {across.number, up.number};
  const std::optional<MapPoint> metres = metres_per_map_unit(crs, at);
  if (!metres) {
    throw Error(ErrorCode::invalid_argument,
                "the unit of the terrain's map is unknown, so a length over ground cannot be "
                "turned into it; give a number in map units",
                kPixelSize);
  }
  return {across.has_unit() ? across.in(metres->x) : across.number,
          up.has_unit() ? up.in(metres->y) : up.number};
}

MapPoint middle_of(const std::optional<Window>& window, const StoreFacts& facts) {
  const GridBox& b = facts.bounds;
  if (!window)
    return facts.map.to_map((0.0 + b.min_x + b.max_x) / 2, (0.0 + b.min_y + b.max_y) / 2);
  return {(window->min_x + window->max_x) / 2, (window->min_y + window->max_y) / 2};
}

std::array<double, 2> own_pixel_size(const StoreFile& store) {
  if (const std::optional<MapPoint> own = own_pixel_of(store)) return {own->x, own->y};
  throw Error(ErrorCode::invalid_argument,
              "this terrain was not built from a raster, so it has no pixel size of its own; "
              "give --pixel-size",
              store.path());
}

}  // namespace ptin::tools
