// SPDX-License-Identifier: GPL-3.0-or-later
//
// The question of lines of sight: `ptin sight`, and `sight` over HTTP.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "engine/crs/ground.h"
#include "tools/ask/field.h"
#include "tools/ask/groups.h"

namespace ptin::ask {

struct SightQuestion {
  SightRequest request;
  std::optional<double> hertz;  ///< Of the link whose first Fresnel zone is measured.
};
void add_sight(Parameters& rows, SightQuestion& question);
/// Fills in what the ground tells: distances, the Earth, and the wavelength in the height's unit.
void set_ground(SightQuestion& question, const Ground& ground);
/// The records of the coarse level that so many pairs share; 0: they are too few for one.
[[nodiscard]] std::uint64_t coarse_records_for(std::size_t pairs);

/// A line of sight as it is told.
struct SightRow {
  /// @param to_client  Takes places to the CRS of whoever asked; none: they stay.
  explicit SightRow(const SightResult& line,
                    const std::function<void(std::span<MapPoint>)>& to_client = {});

  const SightResult& result;
  std::optional<SightPoint> obstruction, clearance, fresnel;
  const std::string* id = nullptr;  ///< Null: the input has none.
};
[[nodiscard]] Fields<SightRow> sight_fields();

}  // namespace ptin::ask
