// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights over a domain, each with what it stands on and the interval that is certain: CoverageJSON,
// and for positions GeoJSON and CSV.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/query/questions.h"
#include "tools/serve/answer_parts.h"

namespace ptin::serve {

/// What a coverage knows of a position.
enum class CoverageState : std::uint8_t { kSurface, kVoid, kOutside, kLeftOut };
struct CoverageValue {
  double height = 0.0, height_min = 0.0, height_max = 0.0;
  CoverageState state = CoverageState::kOutside;
};
[[nodiscard]] CoverageValue value_of(const LocatedPoint& point) noexcept;

/// Heights over a domain, in the CRS of the client.
struct Coverage {
  std::span<const MapPoint> positions;  ///< One: a Point; several: a MultiPoint. None: a Grid.
  Json grid_axes;                       ///< Axes of a Grid: x and y.
  std::vector<std::size_t> shape;       ///< Lengths of the arrays' axes; one number: none.
  std::vector<std::string> axes;        ///< Their names.
  std::size_t size = 0;                 ///< How many values there are.
  std::function<CoverageValue(std::size_t)> value;
};

/// The names that `parameter-name` holds; empty: all that there are.
using CoverageNames = std::vector<std::string_view>;
/// The same rows, and `parameter-name` with what OGC's clients ask with that has no effect.
[[nodiscard]] ask::Parameters with_coverage(ask::Parameters rows);
/// The names of `parameter-name`.  @throws http::Problem 400  there is no such name
[[nodiscard]] CoverageNames coverage_names(const Asked& asked);

/// Point or MultiPoint.
[[nodiscard]] Coverage coverage_at(std::span<const MapPoint> positions,
                                   std::function<CoverageValue(std::size_t)> value);

/// The parameters of a coverage, for the description of a collection.
[[nodiscard]] Json coverage_parameters(const std::string& unit);

/// The coverage with those of its parameters that `parameter-name` asks for: height, height_min,
/// height_max as numbers, `state` as 0 surface, 1 void, 2 outside of the terrain, 3 outside of the
/// polygon that was asked for. A height is null where the state is not 0, and nowhere else.
[[nodiscard]] std::string coverage_text(const Asked& asked, const Places& places,
                                        const CoverageNames& names, const Coverage& coverage,
                                        const Json& certainty);

/// Heights at positions in a format: CoverageJSON, GeoJSON or CSV.
[[nodiscard]] std::string points_in(const ask::Format& format, const Asked& asked,
                                    const Places& places, const CoverageNames& names,
                                    std::span<const MapPoint> client, const LocateResult& result,
                                    const Coverage& coverage);

}  // namespace ptin::serve
