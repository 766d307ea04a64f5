// SPDX-License-Identifier: GPL-3.0-or-later
//
// The words of answers, the same in text and JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "engine/crs/border_move.h"
#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"

namespace ptin::tools {

/// Null where the value is not finite.
[[nodiscard]] nlohmann::json number_or_null(double value);

/// How far the border of voids may have moved in an answer; null where nothing bounds it.
[[nodiscard]] nlohmann::json border_move_json(const StoreFile& store, double certified_error);

/// The object `units` of every answer.
[[nodiscard]] nlohmann::json units_json(const CrsFacts& crs);

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
