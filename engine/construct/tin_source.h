// SPDX-License-Identifier: GPL-3.0-or-later
//
// A TIN of somebody else's as a terrain: read, snapped to the grid, checked, made convex.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>

#include "engine/construct/point_stream.h"
#include "engine/construct/terrain_source.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// The full TIN of a file of triangles.
struct TinTerrain {
  TerrainFrame frame;
  Tin tin;  ///< Valid, convex; the file's triangles are surface, what fills up the hull is void.
  std::uint64_t surface_triangles = 0;
  std::uint64_t left_out_triangles = 0;  ///< Hidden ones, and those with a corner of no height.
  std::uint64_t unused_vertices = 0;     ///< In no triangle: left out.
  std::uint64_t merged_vertices = 0;     ///< Shared a position and a height with another.
  std::uint64_t mended_triangles = 0;    ///< Slivers that snapping spoiled: edges flipped.
  double largest_shift_plan = 0.0;       ///< How far snapping moved a vertex, CRS units.
};

/// Reads one TIN (tin_soup.h says from what) and makes it a terrain.
///
/// The grid is that of points (point_source.h), but that digits beyond it are dropped: programs
/// write TINs with all digits of a double. Without a resolution the unit is the smallest power of
/// ten that keeps every digit or, where that spans more than 2^30 units, the smallest that does
/// not; largest_shift_plan says what that moved. Vertices that share a position and a height are
/// one; slivers that snapping flattens or turns over are flipped away (sliver_flips.h). Concave
/// borders and holes are filled with void triangles up to the convex hull.
///
/// @param memory_bytes  For the triangles while they are read; the work after takes as much again.
/// @throws Error  as read_tin_soup()
///                invalid_argument  this is no terrain: triangles without area (after snapping),
///                                  turned over or over one another, positions with several
///                                  heights, T-junctions; the message counts each kind and names
///                                  its first place. A bbox is asked for. The CRS is not understood
///                cancelled
/// Cost: O(n log n), about 1 us and 250 bytes a triangle.
[[nodiscard]] TinTerrain read_tin(
    const std::string& path, const SourceOptions& options, std::uint64_t memory_bytes,
    const std::stop_token& stop = {},
    const std::function<void(std::uint64_t done, std::uint64_t total)>& progress = {});

/// The vertices of a TIN's triangles as points: to triangulate them anew, or to verify against.
class TinVertices final : public PointStream {
 public:
  /// @throws Error as read_tin_soup()
  TinVertices(const std::string& path, const PointChoice& choice);

  [[nodiscard]] const PointStreamFacts& facts() const noexcept override { return facts_; }
  [[nodiscard]] bool next(std::vector<SourcePoint>& batch) override;
  [[nodiscard]] std::uint64_t left_out() const noexcept override { return left_out_; }
  [[nodiscard]] std::uint64_t done() const noexcept override { return next_; }
  [[nodiscard]] std::uint64_t total() const noexcept override { return points_.size(); }

 private:
  PointStreamFacts facts_;
  std::vector<SourcePoint> points_;
  std::uint64_t next_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace ptin
