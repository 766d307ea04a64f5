// SPDX-License-Identifier: GPL-3.0-or-later
//
// The vertex split: the exact inverse of a half-edge collapse.
#pragma once

#include "engine/mesh/tin.h"

namespace ptin {

/// Where a split takes place. At a border `has_left` or `has_right` is false and vl, vr are the
/// ends of the fan.
struct SplitSite {
  VertexId u;  ///< New vertex, already in `vertices`, in no triangle.
  VertexId w, vl, vr;
  bool has_left = true;   ///< Triangle (u, w, vl) appears.
  bool has_right = true;  ///< Triangle (u, vr, w) appears.
  TriangleClass left_class = TriangleClass::kSurface;
  TriangleClass right_class = TriangleClass::kSurface;
};

/// Triangles that a split added; kNone where there is none.
struct SplitResult {
  TriangleId left = kNone;
  TriangleId right = kNone;
  bool applied = false;
};

/// Applies split(w; u, vl, vr). Post-conditions: the triangles of w from vl counter-clockwise round
/// to vr have u in w's place and keep their ids and classes; (u, w, vl) and (u, vr, w) exist,
/// appended at the end; nothing else changes. Not applied, and the mesh unchanged, when vl and vr
/// are not neighbours of w in that order, or when a triangle would not be strictly
/// counter-clockwise: so a damaged record never makes an invalid mesh. REQUIRES: w is alive. Cost:
/// the degree of w.
SplitResult split(Tin& tin, const SplitSite& site);

/// The same, but the new triangles take the places `left` and `right`, of removed triangles: so a
/// caller that knows all splits beforehand decides which triangles lie near each other in memory.
/// The place of a side that does not exist is left alone. Returns whether it was applied: one word,
/// since a struct of three goes through memory, and the caller waits for it to get there.
[[nodiscard]] bool split_into(Tin& tin, const SplitSite& site, TriangleId left, TriangleId right);

}  // namespace ptin
