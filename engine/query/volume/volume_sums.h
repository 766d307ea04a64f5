// SPDX-License-Identifier: GPL-3.0-or-later
//
// What volumes add up, piece by piece.
#pragma once

#include <array>
#include <cstdint>

#include "engine/geometry/affine.h"
#include "engine/geometry/interval.h"
#include "engine/query/volume/convex_piece.h"
#include "engine/query/volume/fixed_sum.h"
#include "engine/query/volume/plane_area.h"

namespace ptin {

/// A height that is linear on a triangle.
struct LinearHeight {
  std::array<MapPoint, 3> corners;  ///< Counter-clockwise, grid units.
  std::array<double, 3> heights{};  ///< Height's unit.

  /// At a point of the triangle: between the heights of the corners. At a corner exact but for the
  /// rounding of one sum.
  [[nodiscard]] double at(MapPoint p) const;
  /// How far at() may be from the height in real numbers within the triangle, when its corners are
  /// `shift` grid units from where they should be.
  [[nodiscard]] double noise(double shift) const;
};

/// A difference of heights over a convex piece of ground: cut where it is above 0.
struct PieceDifference {
  double deviation = 0.0;  ///< The source's difference is no farther from this one.
  double noise = 0.0;      ///< Most that rounding changed the difference.
  double shift = 0.0;      ///< Most that rounding moved the piece's border, grid units.
};

/// The sums of a volume, independent of the order of what is added. Areas and volumes are over
/// ground. Threads: one owner.
class VolumeSums {
 public:
  /// @param most_area    The area of everything that is added is no larger.
  /// @param most_height  No difference, nor a deviation, is larger.
  VolumeSums(double most_area, double most_height);

  void add(const VolumeSums& other);
  /// A piece where the difference is known. @param f  The difference at the corners.
  void add_surface(const PlaneArea& plane, const ConvexPiece& piece, std::span<const double> f,
                   const PieceDifference& how);
  /// A piece where it is not, and where the source's can be in `possible`; empty: nor is the
  /// source's.
  void add_void(const PlaneArea& plane, const ConvexPiece& piece, const Interval& possible);

  FixedSum cut, fill;  ///< Sums of the TIN that is asked.
  FixedSum cut_area, fill_area, surface_area, void_area;
  FixedSum least_cut, most_cut, least_fill, most_fill;  ///< The source's, with classes as here.
  FixedSum slack;                ///< Deviation times area: how far the net can be off.
  FixedSum void_cut, void_fill;  ///< What the source can have at most where it is void here.
  FixedSum rounding;             ///< Most that rounding changed any of the volumes.
  FixedSum area_rounding;        ///< The same of areas.

 private:
  void add_facet(const PlaneArea& plane, const Facet& t, double deviation);
};

}  // namespace ptin
