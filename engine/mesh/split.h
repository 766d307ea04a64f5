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
/// appended at the end; nothing else changes. A split is not applied, and the mesh stays unchanged,
/// when vl and vr are not neighbours of w in that order, or when a triangle would not be strictly
/// counter-clockwise: so a damaged record never makes an invalid mesh. REQUIRES: w is alive. Cost:
/// the degree of w.
SplitResult split(Tin& tin, const SplitSite& site);

/// The ends of a fan by their keys.
struct SplitEnds {
  VertexKey vl, vr;
};

/// As split(), but the triangles (u, w, vl) and (u, vr, w) get the ids `left` and `right`, so that a
/// caller that knows all splits beforehand decides which triangles lie near each other in memory; and
/// vl and vr are known by their keys, so that nobody has to look them up: they are around w.
/// Returns whether the split was applied, in one word, since the caller waits for it and a
/// SplitResult would go through memory (engine/DECISIONS.md, section 7.3).
/// REQUIRES: both ids are of removed triangles. The id of a side that does not exist is not used.
/// @param site  Its vl and vr are not looked at. They become what was found.
[[nodiscard]] bool split_into(Tin& tin, SplitSite& site, const SplitEnds& ends, TriangleId left,
                              TriangleId right);

}  // namespace ptin
