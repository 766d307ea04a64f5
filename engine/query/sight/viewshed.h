// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one observer sees of a terrain: its vertices, and a raster.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/query_limits.h"
#include "engine/query/sight/curvature.h"

namespace ptin {

/// What a viewshed is asked with. Lengths on the ground are in the height's unit; the ground
/// factors turn map units into it.
struct ViewshedRequest {
  MapPoint eye;           ///< Map units; taken to the nearest spot (shape/spot.h).
  double eye_height = 0;  ///< Above the surface; absolute when `absolute` is set.
  bool absolute = false;
  double target_height = 0;     ///< Height of targets above the surface; >= 0.
  double radius = 0;            ///< Targets within it are looked at; ground units, > 0.
  double ground_per_map_x = 1;  ///< Ground units in a map unit: 1 for a projected CRS in the
  double ground_per_map_y = 1;  ///< height's unit; metres a degree, at the eye, for degrees.
  /// Lowers vertices and targets by drop_at() of their distance. Edges stay straight between their
  /// lowered ends: the middle of an edge of length L is drop_at(L) / 4 too low, about a tenth of a
  /// metre at 2.5 km.
  Curvature curvature;
  /// Width and height of a pixel, map units, with pixels centred on the eye. None: the steps of the
  /// grid, with pixels centred on the grid points.
  std::optional<std::array<double, 2>> pixel_size;
  bool pixels = true;         ///< Fill the raster.
  bool list_vertices = true;  ///< List the vertices.
  /// At a level of detail the TIN that is swept is finer towards the eye: it also has the records
  /// of a deviation above Viewshed::certified_deviation * distance / radius. A number of vertices
  /// stands for the error of the last of them: it has all records of that error.
  DetailRequest detail;
  QueryLimits limits;
};

/// What is known of a target. kHidden and kVisible are what the source's full TIN answers.
/// kPerhapsHidden and kPerhapsVisible are what the TIN that was swept answers, where the full TIN
/// may answer otherwise. kNothing is no target. A value above kNothing means visible.
enum class Sight : std::uint8_t {
  kHidden = 0,
  kPerhapsHidden = 64,
  kNothing = 128,
  kPerhapsVisible = 192,
  kVisible = 255
};

[[nodiscard]] constexpr bool is_visible(Sight s) noexcept { return s > Sight::kNothing; }
[[nodiscard]] constexpr bool is_certain(Sight s) noexcept {
  return s == Sight::kHidden || s == Sight::kVisible;
}

/// What one observer sees. Targets are vertices with a height, and pixel centres on the surface,
/// within the radius.
struct Viewshed {
  struct Target {
    MapPoint position;
    double height = 0;
    bool visible = false;
    bool certain = true;  ///< The source's full TIN gives the same answer.
  };
  std::vector<Target> vertices;
  /// Visible and hidden ones are certain. Where nothing was left out, none is undecided.
  std::uint64_t visible_vertices = 0, hidden_vertices = 0, undecided_vertices = 0;
  std::uint32_t width = 0, height = 0;
  MapPoint first;  ///< Centre of pixel 0: the north-western one. Rows go south.
  double step_x = 0, step_y = 0;
  std::vector<Sight> pixels;  ///< kNothing beyond the radius, on voids and outside.
  std::uint64_t visible_pixels = 0, hidden_pixels = 0, undecided_pixels = 0;
  double eye_height = 0;  ///< Absolute, height's unit.
  /// How far the surface that was swept is at most from the source, at samples and at any point,
  /// height's unit. At a level of detail the deviation is that at the radius, and no larger than
  /// the error asked for; nearer to the eye it is smaller in proportion. 0 when exact.
  double certified_error = 0, certified_deviation = 0;
  bool exact = false;  ///< Nothing was left out, and the file's base error is 0.
  /// Targets that were decided by a walk along a line of their own, which is slower: those in
  /// triangles that hide one another in a ring and so have no order, and those behind such
  /// triangles.
  std::uint64_t walked_targets = 0;
  QueryCost cost;
};

/// Computes what one observer sees.
///
/// A target is hidden when some inner point of the segment from the eye to the target lies strictly
/// below the surface. Touching is visible, and voids hide nothing. Triangles are taken front to
/// back, and each target is held against the horizon of the edges before it (sight/horizon.h). So
/// the answer is that of a sight line to each target, up to the rounding of doubles; sight()
/// decides exactly. With an eye on a grid point, whole heights and no curvature, and while products
/// of three offsets fit 53 bits, nothing rounds but the direction in which two edges cross. The
/// memory, that of the raster included, is known before the sweep begins.
///
/// At a level of detail the full TIN lies within d = certified_deviation * distance / radius of the
/// TIN that is swept. Two more sweeps find what is certain:
/// - A target is certainly hidden when it is hidden even with all before it lowered by d and the
///   target raised by d.
/// - A target is certainly visible when it is visible even with all before it raised by d and the
///   target lowered by d, and when its height above ground is at least 2 d: a bump that the level
///   leaves out may always hide the ground itself.
///
/// In a terrain with voids nothing is certainly hidden, since the level may cover a void with
/// surface, and a void of the level may hold ground of any height that the terrain has. With
/// curvature both are certain up to the straightness of edges (ViewshedRequest::curvature). A file
/// that left records out (leaves_records_out(), select/certificate.h) is treated as a
/// level of detail too: d grows by base_deviation at any distance, and by as much again for the
/// ground below an eye that stands on it.
/// @throws Error invalid_argument    as Detail; the eye is outside of the terrain, on a void
///                                   without an absolute height, or below the surface; a length
///                                   means nothing
///               resource_exhausted, corruption, io_error, cancelled
/// Cost: linear in the triangles within the radius, and in practice a few pieces of horizon for
/// each; at a level of detail three times that.
[[nodiscard]] Viewshed viewshed(const OpenedTerrain& terrain, const ViewshedRequest& request);

}  // namespace ptin
