// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a build is asked: the options that decide the bytes of the file.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/construct/collapse/cost.h"
#include "engine/construct/grid/source_options.h"

namespace ptin {

/// Every option that decides the bytes of the file; no other does.
struct BuildOptions {
  CostModel cost = CostModel::kError;
  double max_error = 0.0;  ///< Leave out records with error <= this (height's unit); 0 keeps all.
  std::optional<double> nodata;      ///< Overrides the source's.
  std::optional<double> resolution;  ///< Points: grid unit in CRS units.
  /// Points, repaired TINs: which height stands for those that fall together; none: their mean.
  std::optional<PointMerge> duplicates;
  std::vector<int> classes;                   ///< LAS: keep these classes; empty keeps all.
  ReturnChoice returns = ReturnChoice::kAll;  ///< LAS: keep these echoes.
  std::string layer;  ///< OGR: the layer of points; "" where there is only one.
  /// Points, repaired TINs: triangles with a longer edge are void; CRS units, or metres where those
  /// are degrees.
  std::optional<double> max_edge;
  std::vector<std::string> columns;  ///< Text: as PointChoice::columns.
  bool skip_invalid = false;         ///< Text: as PointChoice::skip_invalid.
  std::string z_field;  ///< OGR: the attribute with the heights; "" for the geometry's z.
  /// Points: files of lines whose pieces are edges of the full TIN; and the layer in each of them,
  /// "" where there is only one.
  std::vector<std::string> breaklines;
  std::string breakline_layer;
  /// Points: a file of polygons outside of which all is void, "" for none; and its layer.
  std::string boundary, boundary_layer;
  bool repair = false;  ///< TINs: triangulate the vertices anew instead of taking the triangles.
  std::optional<std::array<double, 4>>
      bbox;           ///< xmin ymin xmax ymax in CRS units; samples outside are left out.
  std::string a_srs;  ///< Overrides the source's CRS (anything GDAL understands); "" keeps it.
  std::string vertical_crs;  ///< "" keeps what the source declares, if anything.
  /// What the terrain is called, and who is to be named where it is shown; "" for none. Metadata alone:
  /// of all other sections the bytes are the same.
  std::string title, attribution;
  /// As BaseMap::tiles and its attribution; "" for none. Metadata alone, too.
  std::string base_map, base_map_attribution;
  double void_slope =
      1.0;  ///< Height error charged per ground unit that the border of voids moves.
  /// Rasters: grid units along a leaf of the tile hierarchy; none means TileTree::default_side().
  std::optional<std::int64_t> tile;
  std::uint32_t page_bytes = 4096;
};

/// Which lines a build wants beside its inputs.
[[nodiscard]] LineChoice line_choice_of(const BuildOptions& options);
/// Which points of its inputs a build wants.
[[nodiscard]] PointChoice point_choice_of(const BuildOptions& options);
/// The options that say what is read from a source.
[[nodiscard]] SourceOptions source_options_of(const BuildOptions& options);

/// @throws Error invalid_argument  an option whose value means nothing
void check_options(const BuildOptions& options);

}  // namespace ptin
