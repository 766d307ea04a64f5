// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/border_move.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/geometry/infinity.h"

namespace ptin {

double border_moved_at_most(const StoreFile& store, double certified_error) {
  const bool free_of_voids = store.facts().free_of_voids;
  return free_of_voids ? 0.0 : border_move_told_by(metadata_of(store), false, certified_error);
}

double border_move_told_by(const nlohmann::json& metadata, bool free_of_voids,
                           double certified_error) {
  if (free_of_voids) {
    return 0.0;
  }
  const auto options = metadata.find("options");
  if (options == metadata.end() || !options->is_object()) {
    return kInfinity;
  }
  const auto slope = options->find("void_slope");
  if (slope == options->end() || !slope->is_number() || !(slope->get<double>() > 0.0)) {
    return kInfinity;
  }
  return certified_error / slope->get<double>();
}

std::array<double, 2> border_reach(const StoreFile& store, double certified_error) {
  const double moved = border_moved_at_most(store, certified_error);
  const CrsFacts crs = crs_facts(store);
  if (!crs.geographic || moved == 0.0) {
    return {moved, moved};
  }
  // A degree of longitude is shortest where the latitude is greatest, one of latitude where it is
  // least; doubles and the curve of the Earth are far below the hundredth that is added.
  const StoreFacts& facts = store.facts();
  const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint high = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  std::array<double, 2> reach{0.0, 0.0};
  for (const double latitude : {low.y, high.y, std::clamp(0.0, low.y, high.y)}) {
    const std::optional<MapPoint> metres = metres_per_map_unit(crs, {low.x, latitude});
    if (!metres || !(metres->x > 0.0) || !(metres->y > 0.0)) {
      return {kInfinity, kInfinity};
    }
    reach = {std::max(reach[0], 1.01 * moved / metres->x),
             std::max(reach[1], 1.01 * moved / metres->y)};
  }
  return reach;
}

double most_error_for_pixels(const std::array<double, 2>& reach_of_one, double width,
                             double height) noexcept {
  constexpr double kShareOfPixel = 0.25;
  const auto error = [](double of_one, double side) {
    return of_one > 0.0 && of_one < kInfinity ? kShareOfPixel * side / of_one : kInfinity;
  };
  return std::min(error(reach_of_one[0], width), error(reach_of_one[1], height));
}

}  // namespace ptin
