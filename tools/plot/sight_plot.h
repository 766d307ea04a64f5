// SPDX-License-Identifier: GPL-3.0-or-later
//
// The plot of lines of sight: a panel a pair, with the ground, the line and its Fresnel zone.
#pragma once

#include <limits>
#include <span>
#include <string>

#include "engine/query/questions.h"
#include "tools/plot/panel.h"

namespace ptin::tools {

/// A pair and what is known of it.
struct PlottedSight {
  std::string title;
  SightResult result;
  ProfileResult profile;  ///< The ground below the line; without points where its ends are one.
  struct End {
    /// Absolute; NaN where the end stands on no ground: no line is drawn then.
    double height = std::numeric_limits<double>::quiet_NaN();
    std::string label;  ///< How high it was asked to be, as "20 m above ground".
  };
  End a, b;
};

/// How the lines were asked for.
struct SightPlotStyle {
  Curvature curvature;
  double wavelength = 0.0;  ///< Height's unit; 0: no Fresnel zone.
};

/// The height of a line of sight at a share of its way: straight, and sunk by the Earth's curvature,
/// as SightPoint::height.
[[nodiscard]] double sight_height(const PlottedSight& sight, const Curvature& curvature,
                                  double share);

/// Writes the plot. Every panel has scales of its own. The ground has its heights, and the line
/// sinks by the curvature. The first Fresnel zone is filled, and six tenths of it, which a radio link
/// keeps free, are dashed.
/// @param path   A name of is_picture_name().
/// @param units  Distances are in the height's unit.
/// @throws Error as Canvas, as require_panels
void plot_sights(const std::string& path, bool overwrite, std::span<const PlottedSight> sights,
                 const SightPlotStyle& style, const PlotUnits& units);

}  // namespace ptin::tools
