// SPDX-License-Identifier: GPL-3.0-or-later
//
// The plot of a profile: a panel a line, all on the same scales.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/query/questions.h"
#include "tools/plot/panel.h"

namespace ptin::tools {

/// The points of a profile, line by line.
[[nodiscard]] std::vector<std::span<const ProfilePoint>> lines_of(const ProfileResult& profile);

/// Writes the plot. Distances of all lines begin at 0 and have one scale, and so have heights.
/// @param path  A name of is_picture_name().
/// @param ids   Title of each line of the request; empty: lines are titled by their numbers.
/// @throws Error as Canvas, as require_panels
void plot_profile(const std::string& path, bool overwrite, const ProfileResult& profile,
                  const std::vector<std::string>& ids, const PlotUnits& units);

}  // namespace ptin::tools
