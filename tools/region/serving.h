// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a stream is asked for: as text that a receiver hands back, as a predicate, and as what the
// stream says of itself.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/query/questions.h"
#include "storage/store_file.h"

namespace ptin::tools {

/// A part of a terrain: the splits that meet the window, have more than the error, and straddle one
/// of the levels.
struct Serving {
  std::vector<double> window;  ///< xmin ymin xmax ymax; empty: everywhere.
  std::optional<double> error;
  std::vector<double> levels;           ///< Empty: all heights.
  std::optional<std::uint64_t> splits;  ///< At most this many, the first ones.

  [[nodiscard]] bool given() const noexcept {
    return !window.empty() || error || !levels.empty() || splits;
  }
};

/// True when `served` covers the window and the levels of `asked`. Each level of `asked`, or all
/// heights where it names none, must be in a serving whose window contains that of `asked`. Errors
/// and splits are not looked at.
/// @param asked  Names a window; that of the whole terrain where everything is asked for.
[[nodiscard]] bool covers(const std::vector<Serving>& served, const Serving& asked);

/// The predicate of the window, error and levels of a serving; `splits` is no part of it.
/// @param option  Gave the window; named in errors.
/// @throws Error invalid_argument  a window that is inverted or misses the terrain, a negative
///                                 error, a number that is not finite
[[nodiscard]] PredicatePtr predicate_of(const Serving& serving, const StoreFacts& facts,
                                        const std::string& option);

/// {"window": [4 numbers], "error": E, "levels": [H...], "splits": N}; what is not given is left
/// out.
[[nodiscard]] nlohmann::json to_json(const Serving& serving);

/// The servings in a JSON text, which is a list of servings or one: what `ptin unstream --json`
/// prints as `have`.
/// @throws Error invalid_argument  not JSON, unknown names or other types
[[nodiscard]] std::vector<Serving> servings_of(const std::string& text);

/// The metadata of the stream: CRS and units for the receiver, what keeps the border of voids in
/// place, and what was asked for, so that the receiver can say what it has.
[[nodiscard]] std::string metadata_of_stream(const StoreFile& store, const Serving& wanted);

}  // namespace ptin::tools
