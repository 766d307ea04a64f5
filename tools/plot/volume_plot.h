// SPDX-License-Identifier: GPL-3.0-or-later
//
// The plot of volumes at several levels: a stage-storage curve.
#pragma once

#include <span>
#include <string>

#include "engine/query/questions.h"
#include "tools/plot/panel.h"

namespace ptin::tools {

/// Writes three panels over the same heights: the volume below each level, the area below it, and the
/// volume above it; with the band in which the source's volumes certainly lie.
/// @param path     A name of is_picture_name().
/// @param results  One for each of `levels`, which are in any order.
/// @param units    Their `length` is the unit whose squares and cubes areas and volumes are.
/// @throws Error as Canvas
void plot_volumes(const std::string& path, bool overwrite, std::span<const VolumeResult> results,
                  std::span<const double> levels, const PlotUnits& units);

}  // namespace ptin::tools
