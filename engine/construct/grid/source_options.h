// SPDX-License-Identifier: GPL-3.0-or-later
//
// The choices by which sources are read: which samples, on which grid, in which CRS.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ptin {

struct SourceLines;

/// Which echoes of a laser pulse are wanted. The last one reaches the ground, or comes nearest to
/// it. An echo without a number counts as the only one of its pulse.
enum class ReturnChoice : std::uint8_t { kAll, kFirst, kLast };

/// Which points of a source are wanted.
struct PointChoice {
  std::vector<int> classes;  ///< LAS: keep these classes (0 .. 255); empty keeps all.
  ReturnChoice returns = ReturnChoice::kAll;  ///< LAS.
  std::string layer;                          ///< OGR: the layer; "" where there is only one.
  std::string z_field;  ///< OGR: the attribute that holds the height; "" for the geometry's z.
  /// Text: the names of its columns from the left (read/column_names.h); empty: those of a header,
  /// else x, y and z come first.
  std::vector<std::string> columns;
  bool skip_invalid = false;  ///< Text: rows that are no points are left out, and warned of.
};

/// Which lines are wanted beside points.
struct LineChoice {
  std::vector<std::string> breaklines;  ///< Files.
  std::string breakline_layer;          ///< In each of them; "" where there is only one that fits.
  std::string boundary;                 ///< A file; "" for none.
  std::string boundary_layer;

  [[nodiscard]] bool is_empty() const noexcept { return breaklines.empty() && boundary.empty(); }
};

/// Which height stands for points that fall together on one grid position.
enum class PointMerge : std::uint8_t {
  kMean,
  kLowest,
  kHighest,
  kFirst,  ///< That of the point which comes first in the first of the sources.
};

/// Choices that decide what is read from a source.
struct SourceOptions {
  /// The height that means none; replaces the nodata value that a raster declares. Points with this
  /// height are left out, and triangles of a TIN with such a corner.
  std::optional<double> nodata;
  std::optional<double> resolution;  ///< Points and TINs: the grid unit, in CRS units.
  struct Bounds {
    double min_x, min_y, max_x, max_y;
  };
  std::optional<Bounds> bbox;  ///< CRS units; samples outside are left out. Refused for TINs.
  std::string a_srs;           ///< Replaces the CRS; "" keeps it. As resolve_crs().
  std::string vertical_crs;    ///< Replaces or adds the vertical part, e.g. "EPSG:5773".
  PointMerge merge = PointMerge::kMean;  ///< Points: how those that fall together are merged.
  PointChoice points;                    ///< Points: which of them are wanted.
  /// Points: breaklines and a boundary (lines/source_lines.h); null: none. Borrowed.
  const SourceLines* lines = nullptr;
};

}  // namespace ptin
