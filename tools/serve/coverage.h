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

constexpr auto kPlaceFormats = std::to_array<OfferedFormat>(
    {{"covjson", kCoverageJson}, {"geojson", kGeoJson}, {"csv", kCsv}, {"json", kJson}});

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
  Json grid_axes;                       ///< Of a Grid: x and y.
  std::vector<std::size_t> shape;  ///< Of the arrays, and the names of its axes; one number: none.
  std::vector<std::string> axes;
  std::size_t size = 0;  ///< Of values.
  std::function<CoverageValue(std::size_t)> value;
};

/// Point or MultiPoint.
[[nodiscard]] Coverage coverage_at(std::span<const MapPoint> positions,
                                   std::function<CoverageValue(std::size_t)> value);

/// The parameters of a coverage, for the description of a collection.
[[nodiscard]] Json coverage_parameters(const std::string& unit);

/// The coverage with those of its parameters that `parameter-name` asks for: height, height_min,
/// height_max as numbers, `state` as 0 surface, 1 void, 2 outside of the terrain, 3 outside of the
/// polygon that was asked for. A height is null where the state is not 0, and nowhere else.
[[nodiscard]] std::string coverage_text(const Asked& asked, const Places& places,
                                        const Coverage& coverage, const Json& certainty);

/// The names that `parameter-name` holds, all that there are without it.
/// @throws http::Problem 400  another name
[[nodiscard]] std::vector<std::string_view> asked_names(const Question& question);

/// Heights at positions as GeoJSON and as CSV.
[[nodiscard]] std::string points_geojson(const Asked& asked, std::span<const MapPoint> client,
                                         const LocateResult& result);
[[nodiscard]] std::string points_csv(const Asked& asked, std::span<const MapPoint> client,
                                     const LocateResult& result);
/// The object of GeoJSON that stands for a position: {"type":"Point","coordinates":[x,y]}.
void add_point(LongText& text, const MapPoint& p);
/// The members state, height, height_min, height_max of an object.
void add_members(LongText& text, const LocatedPoint& p);
[[nodiscard]] Json certainty_of(const Asked& asked, const LocateResult& result);

}  // namespace ptin::serve
