// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one observer sees of a terrain: its vertices, and a raster.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "engine/query/accounting.h"
#include "engine/query/curvature.h"
#include "engine/query/progressive_tin.h"

namespace ptin {

/// Lengths on the ground are in the height's unit; the ground factors turn map units into it.
struct ViewshedRequest {
  MapPoint eye;           ///< Map units; taken to the nearest spot (spot.h).
  double eye_height = 0;  ///< Above the surface, or of itself when `absolute`.
  bool absolute = false;
  double target_height = 0;     ///< Of what is looked at, above the surface; >= 0.
  double radius = 0;            ///< Ground; > 0.
  double ground_per_map_x = 1;  ///< Ground units in a map unit: 1 for a projected CRS in the
  double ground_per_map_y = 1;  ///< height's unit; metres a degree, at the eye, for degrees.
  /// Lowers vertices and targets. Edges stay straight: in the middle of one of length L by
  /// drop_at(L) / 4 too low, less than a tenth of a metre at 2.5 km.
  Curvature curvature;
  /// Side of a pixel, map units; none: the grid's steps. Pixels are centred on the grid then, else
  /// on the eye.
  std::optional<double> pixel_size;
  bool pixels = true;               ///< Fill the raster.
  bool vertices = true;             ///< List the vertices.
  std::optional<double> tolerance;  ///< Certified error; none: the full TIN.
  std::uint64_t memory_limit_bytes = std::uint64_t{4} << 30;
  std::stop_token stop;
};

enum class Sight : std::uint8_t { kHidden = 0, kNothing = 128, kVisible = 255 };

/// Targets are vertices with a height, and pixel centres on the surface, within the radius.
struct Viewshed {
  struct Target {
    MapPoint position;
    double height = 0;
    bool visible = false;
  };
  std::vector<Target> vertices;
  std::uint64_t visible_vertices = 0, hidden_vertices = 0;
  std::uint32_t width = 0, height = 0;
  MapPoint first;  ///< Centre of pixel 0: the north-western one. Rows go south.
  double step_x = 0, step_y = 0;
  std::vector<Sight> pixels;  ///< kNothing beyond the radius, on voids and outside.
  std::uint64_t visible_pixels = 0, hidden_pixels = 0;
  double eye_height = 0;  ///< Of itself.
  /// Of the surface that it was computed on, from the source: targets that clear it by more are
  /// seen for certain, none is told apart. 0 when exact.
  double certified_error = 0, certified_deviation = 0;
  bool exact = false;  ///< On the full TIN, of a file that left nothing out.
  /// Targets in triangles that hide one another in a ring, which have no order: by lines of their
  /// own, which is slower.
  std::uint64_t walked_targets = 0;
  QueryCost cost;
};

/// Computes it. A target is hidden when some point of the segment from the eye to it, its ends left
/// out, lies strictly below the surface; touching is visible, and voids hide nothing. Triangles are
/// taken front to back, and each target is held against the horizon of the edges before it
/// (horizon.h), so the answer is that of a sight line to each: exact for an eye on the grid, while
/// products of offsets fit 53 bits; else up to rounding. Memory, the raster included, is known
/// before the sweep begins.
/// @throws Error invalid_argument    the eye is outside of the terrain or on a void without an
///               absolute height; a length means nothing
///               resource_exhausted, corruption, io_error, cancelled
/// Cost: linear in the triangles within the radius, and in practice a few pieces of horizon each.
[[nodiscard]] Viewshed viewshed(const ProgressiveTin& terrain, const ViewshedRequest& request);

}  // namespace ptin
