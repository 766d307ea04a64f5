// SPDX-License-Identifier: GPL-3.0-or-later
//
// What shows when the border between surface and void moves, and how far (engine/DESIGN.md, section
// 3).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "engine/construct/grid/crs.h"
#include "engine/construct/tile/direction.h"
#include "engine/geometry/point.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// A part of the full TIN. All of it is borrowed.
struct PartOfTerrain {
  const Tin& tin;
  /// True when more of the terrain lies beyond the edge from a to b, which has no triangle beyond
  /// it in the part.
  const std::function<bool(GridPoint a, GridPoint b)>& goes_on;
  /// Triangles of the leaf itself: 1, others, of a margin around it: 0. Empty: all are of the leaf.
  std::span<const std::uint8_t> inner;
  GroundStep step;  ///< Lengths on the ground; at least those of each of its rows.
  /// Around each vertex of the leaf borders are known up to this distance, in ground units.
  double known = 0.0;
  /// Depths beyond this count as infinite, in ground units: so do reaches.
  double farthest = std::numeric_limits<double>::infinity();
};

/// A witness infinitely near a corner of its triangle, within it: for a triangle whose corners are
/// all on the border, or may be.
struct CornerWitness {
  TriangleId triangle;
  WayIn way;
  float reach;
};

/// The **witnesses** of a leaf. Every triangle of the full TIN has one: its deepest corner that has
/// one class all around, or else a point at one of its corners (CornerWitness). A witness that
/// changes its class is charged its **reach**, a length on the ground that is at least
/// - the depth, that is the distance to the border, of any point of the triangles that it stands
///   for;
/// - the distance between two regions of the other class that these triangles lie between, so that
///   the regions stay apart while nothing of that reach changes its class; and
/// - the distance from any point of the border that it stands for to where the border may be when
///   this witness has changed its class and the next has not. Each witness of finite depth, but one
///   of a class and connected region of the leaf, has a next one beside it, on the way to greater
///   depth; the others have an infinite reach.
/// So a collapse that leaves all witnesses of at least a reach in their class, and whose new border
/// edges cut no more off the triangles that they cross (border_crossing), moves no point of the border
/// by more than that reach, neither way, and changes the class of no point that is deeper.
struct BorderWitnesses {
  /// What a vertex is.
  enum class Kind : std::uint8_t {
    kInner,    ///< One class all around.
    kBorder,   ///< Surface and void meet here.
    kUnknown,  ///< One class in the part, but not all of its triangles are in it.
  };
  std::vector<Kind> kind;  ///< One for each of tin.vertices, as the next two.
  /// The nearest vertex of the border that is known, or one that is not much farther; itself for
  /// one on the border. kNoBorder where the part has none.
  std::vector<GridPoint> nearest;
  std::vector<float> reach;  ///< Ground units; 0 for a vertex that is no witness.
  /// The connected regions of surface and of voids that the nearest border vertex of each vertex
  /// belongs to; kNone where the part has no border.
  std::vector<std::array<std::uint32_t, 2>> region;
  /// How far the regions of the other class may be apart that a vertex on a seam lies between, as far
  /// as this leaf can tell: twice its depth where another leaf may know of a nearer border, else 0.
  std::vector<float> doubt;
  std::vector<CornerWitness> corners;

  static constexpr GridPoint kNoBorder{-1, -1};
};

/// Cost: n log n.
[[nodiscard]] BorderWitnesses find_border_witnesses(const PartOfTerrain& part);

}  // namespace ptin
