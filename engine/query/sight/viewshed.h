// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one observer sees of a terrain: its vertices, and a raster.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/query_limits.h"
#include "engine/query/sight/curvature.h"

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
  bool pixels = true;         ///< Fill the raster.
  bool list_vertices = true;  ///< List the vertices.
  /// At a level of detail the TIN that is swept is finer towards the eye: records of a deviation
  /// above certified_deviation * distance / radius are kept too.
  DetailRequest detail;
  QueryLimits limits;
};

/// The two in the middle: at a level of detail, what is seen of its TIN, where the full TIN may
/// answer otherwise. The other two are its answers. Above kNothing is visible.
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

/// Targets are vertices with a height, and pixel centres on the surface, within the radius.
struct Viewshed {
  struct Target {
    MapPoint position;
    double height = 0;
    bool visible = false;
    bool certain = true;  ///< The source's full TIN answers so.
  };
  std::vector<Target> vertices;
  /// For certain; always, of the full TIN.
  std::uint64_t visible_vertices = 0, hidden_vertices = 0, undecided_vertices = 0;
  std::uint32_t width = 0, height = 0;
  MapPoint first;  ///< Centre of pixel 0: the north-western one. Rows go south.
  double step_x = 0, step_y = 0;
  std::vector<Sight> pixels;  ///< kNothing beyond the radius, on voids and outside.
  std::uint64_t visible_pixels = 0, hidden_pixels = 0, undecided_pixels = 0;
  double eye_height = 0;  ///< Of itself.
  /// Of the surface that was swept from the source. At a level of detail the deviation is that at
  /// the radius, no larger than the error asked for. 0 when exact.
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
/// (horizon.h), so the answer is that of a sight line to each, up to the rounding of doubles:
/// sight() decides exactly. With an eye on the grid, whole heights and no curvature, while products
/// of three offsets fit 53 bits, nothing rounds but the direction in which two edges cross. Memory,
/// the raster included, is known before the sweep begins.
///
/// At a level of detail the full TIN lies within certified_deviation * distance / radius of the TIN
/// that is swept. A target is hidden for certain when it is although all before it is lowered by
/// that and itself raised; visible for certain when it is although all before it is raised and
/// itself lowered, and its height is twice that: a bump that the level leaves out may always hide
/// the ground itself. A void may be filled there: in a terrain with voids nothing is hidden for
/// certain, and voids of the level may hold ground of any of the terrain's heights. With curvature
/// both are for certain up to the straightness of edges above. A file that left records out (its
/// base_deviation is more than rounding) is a level of detail throughout: its full TIN deviates by
/// that at any distance, the ground below an eye that stands on it included.
/// @throws Error invalid_argument    as Detail; the eye is outside of the terrain, on a void
///                                   without an absolute height, or below the surface; a length
///                                   means nothing
///               resource_exhausted, corruption, io_error, cancelled
/// Cost: linear in the triangles within the radius, and in practice a few pieces of horizon each;
/// at a level of detail three times that.
[[nodiscard]] Viewshed viewshed(const OpenedTerrain& terrain, const ViewshedRequest& request);

}  // namespace ptin
