// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/border_move.h"

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/geometry/infinity.h"

namespace ptin {

double border_moved_at_most(const StoreFile& store, double certified_error) {
  const bool free_of_voids = store.facts().free_of_voids;
  return free_of_voids ? 0.0 : border_moved_at_most(metadata_of(store), false, certified_error);
}

double border_moved_at_most(const nlohmann::json& metadata, bool free_of_voids,
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

}  // namespace ptin
