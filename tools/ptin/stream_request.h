// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `ptin stream` is asked for, as options, as text that a receiver hands back, and as a
// predicate.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/query/terrain.h"
#include "storage/store_file.h"

namespace ptin::tools {

/// A part of a terrain: what is inside of the window, above the error and meets one of the levels.
struct Serving {
  std::vector<double> window;  ///< xmin ymin xmax ymax; empty: everywhere.
  std::optional<double> error;
  std::vector<double> levels;           ///< Empty: all heights.
  std::optional<std::uint64_t> splits;  ///< Only the first so many.

  [[nodiscard]] bool given() const noexcept {
    return !window.empty() || error || !levels.empty() || splits;
  }
};

/// True when all of `asked` is in what was served: each of its levels, or all heights, by one that
/// has its window. Errors and splits do not matter.
/// @param asked  Its window is that of the terrain where everything is asked for.
[[nodiscard]] bool covers(const std::vector<Serving>& served, const Serving& asked);

/// @throws Error invalid_argument  an inverted window, a negative error, a number that is not
/// finite
[[nodiscard]] PredicatePtr predicate_of(const Serving& serving, const StoreFacts& facts);

/// {"window": [4 numbers], "error": E, "levels": [H...], "splits": N}; what is not given is left
/// out.
[[nodiscard]] nlohmann::json to_json(const Serving& serving);

/// A list of servings, or one: what `ptin unstream --json` prints as `have`.
/// @throws Error invalid_argument  not JSON, unknown names or other types
[[nodiscard]] std::vector<Serving> servings_of(const std::string& text);

}  // namespace ptin::tools
