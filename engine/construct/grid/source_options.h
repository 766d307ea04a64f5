// SPDX-License-Identifier: GPL-3.0-or-later
//
// The choices by which sources are read: which samples, on which grid, in which CRS.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ptin {

/// Which points of a source are wanted.
struct PointChoice {
  std::vector<int> classes;  ///< LAS: keep these classes (0 .. 255); empty keeps all.
  std::string layer;         ///< OGR: the layer; "" where there is only one.
  std::string z_field;       ///< OGR: the attribute that holds the height; "" for the geometry's z.
};

/// The height of points that fall together on one grid position.
enum class PointMerge : std::uint8_t { kMean, kLowest, kHighest };

/// Choices that decide what is read from a source.
struct SourceOptions {
  /// Overrides the source's own. Points of this height are left out.
  std::optional<double> nodata;
  std::optional<double> resolution;  ///< Points: grid unit in CRS units.
  struct Bounds {
    double min_x, min_y, max_x, max_y;
  };
  std::optional<Bounds> bbox;            ///< CRS units; samples outside are left out.
  std::string a_srs;                     ///< Overrides the CRS; anything GDAL understands.
  std::string vertical_crs;              ///< Added as the vertical part, e.g. "EPSG:5773".
  PointMerge merge = PointMerge::kMean;  ///< Points.
  PointChoice points;                    ///< Points: which of them.
};

}  // namespace ptin
