// SPDX-License-Identifier: GPL-3.0-or-later
//
// The words of answers, the same in text and JSON.
#pragma once

#include <cmath>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/query/terrain.h"

namespace ptin::tools {

[[nodiscard]] inline nlohmann::json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

/// The object `units` of every answer.
[[nodiscard]] inline nlohmann::json units_json(const CrsFacts& crs) {
  return {{"horizontal", crs.horizontal_unit}, {"height", crs.vertical_unit}};
}

[[nodiscard]] constexpr const char* name_of(PointState s) noexcept {
  return s == PointState::kSurface ? "surface" : (s == PointState::kVoid ? "void" : "outside");
}

[[nodiscard]] constexpr const char* name_of(SightVerdict v) noexcept {
  switch (v) {
    case SightVerdict::kVisible:
      return "visible";
    case SightVerdict::kHidden:
      return "hidden";
    case SightVerdict::kUndecided:
      return "undecided";
    case SightVerdict::kUndefined:
      break;
  }
  return "undefined";
}

}  // namespace ptin::tools
