// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh of which is known, triangle by triangle, what the full surface below it can be.
#pragma once

#include "engine/geometry/interval.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// Bounds of the full surface below one triangle of a refinement.
struct SurfaceBounds {
  /// Most vertical distance to the full surface where both are surface, height's unit.
  double deviation = 0.0;
  Interval heights;  ///< Codes of the full surface; empty: nothing but void.
};

/// A valid and whole mesh with bounds of its triangles.
class BoundedSurface {
 public:
  BoundedSurface() = default;
  BoundedSurface(const BoundedSurface&) = default;
  BoundedSurface(BoundedSurface&&) = default;
  BoundedSurface& operator=(const BoundedSurface&) = default;
  BoundedSurface& operator=(BoundedSurface&&) = default;
  virtual ~BoundedSurface() = default;

  [[nodiscard]] virtual const Tin& tin() const noexcept = 0;
  [[nodiscard]] virtual SurfaceBounds bounds(TriangleId t) const noexcept = 0;
};

}  // namespace ptin
