// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/volume_terms.h"

#include "engine/crs/border_move.h"
#include "engine/crs/ground.h"

namespace ptin::ask {

void set_ground(VolumeRequest& request, const CrsFacts& crs) {
  const Ground ground = ground_of(crs);
  request.ground = {ground.per_map_unit, !ground.geographic};
  // Borders move by metres where map units are degrees, and by map units elsewhere.
  const double ground_per_move =
      ground.geographic ? 1 / ground.metres_per_height : ground.per_map_unit({0, 0}).x;
  request.border_move = [ground_per_move](const StoreFile& store, double certified_error) {
    return ground_per_move * border_moved_at_most(store, certified_error);
  };
}

std::string mismatch_of(const CrsFacts& terrain, const CrsFacts& other, const std::string& name) {
  if (!is_same_plane(terrain, other)) {
    return "its CRS (" + (other.name.empty() ? other.horizontal_unit : other.name) +
           ") is not that of " + name + " (" +
           (terrain.name.empty() ? terrain.horizontal_unit : terrain.name) +
           "); transform the source of one and build it again";
  }
  if (!terrain.vertical_name.empty() && !other.vertical_name.empty() &&
      terrain.vertical_text() != other.vertical_text()) {
    return "its heights (" + other.vertical_name + ") do not count from where those of " + name +
           " (" + terrain.vertical_name + ") do; transform the source of one and build it again";
  }
  return {};
}

std::optional<double> height_scale(const CrsFacts& terrain, const CrsFacts& other) {
  const auto is_known = [](const CrsFacts& crs) { return crs.vertical_unit != "unknown"; };
  if (!is_known(terrain) || !is_known(other)) return std::nullopt;
  return ground_of(other).metres_per_height / ground_of(terrain).metres_per_height;
}

}  // namespace ptin::ask
