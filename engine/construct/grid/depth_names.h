// SPDX-License-Identifier: GPL-3.0-or-later
//
// Names by which sources say that their values are depths, which grow downwards.
#pragma once

#include <string_view>

namespace ptin {

/// True for a name of depths: one of its words is "depth" or "sounding", in any case and number
/// ("sea_floor_depth_below_geoid", "Depth (m)", "SOUNDG"), or the whole is an attribute of nautical
/// charts that holds depths (S-57: VALSOU, DRVAL1, DRVAL2, VALDCO).
[[nodiscard]] bool is_name_of_depths(std::string_view name);

}  // namespace ptin
