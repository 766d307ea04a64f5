// SPDX-License-Identifier: GPL-3.0-or-later
//
// The question of heights at positions: `ptin locate`, and over HTTP `position`, `area`, `trajectory`
// and `/v1`.
#pragma once

#include <array>
#include <string>

#include "tools/ask/field.h"
#include "tools/ask/groups.h"

namespace ptin::ask {

void add_locate(Parameters& rows, LocateRequest& request);

/// A located point as it is told.
struct LocatedRow {
  LocatedRow(const MapPoint& at, const LocatedPoint& point, const AffineMap& map);

  MapPoint at;  ///< In the CRS of whoever asked, as are the corners of its triangle.
  const LocatedPoint& point;
  std::array<MapPoint, 3> corners{};
  const std::string* id = nullptr;  ///< Null: the input has none.
};
/// What is told of a located point, wherever one is told.
[[nodiscard]] Fields<LocatedRow> located_fields();

}  // namespace ptin::ask
