// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/facts/answers.h"

#include <cmath>

#include <nlohmann/json.hpp>

namespace ptin::tools {

nlohmann::json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

nlohmann::json border_move_json(const StoreFile& store, double certified_error) {
  return number_or_null(border_moved_at_most(store, certified_error));
}

nlohmann::json units_json(const CrsFacts& crs) {
  return {{"horizontal", crs.horizontal_unit}, {"height", crs.vertical_unit}};
}

}  // namespace ptin::tools
