// SPDX-License-Identifier: GPL-3.0-or-later
//
// The half-edge collapse u -> w: u is removed, its star becomes the fan from w.
#pragma once

#include <cstddef>

#include "engine/mesh/star.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// The most neighbours that a vertex should have after a collapse while there is another choice
/// (engine/DESIGN.md, section 2.1).
inline constexpr std::size_t kComfortableDegree = 64;

/// True when collapsing the centre of `star` into link vertex `j` leaves a valid mesh. Every fan
/// triangle has to be strictly counter-clockwise. A border vertex goes along the border alone,
/// between two neighbours on one line with it, so that the domain stays. Cost: the degree.
[[nodiscard]] bool can_collapse(const Tin& tin, const Star& star, std::size_t j) noexcept;

/// The split that undoes a collapse, in ids. vl and vr are the neighbours of u beside w; at a
/// border, where one of the two triangles does not exist, they are the ends of the fan.
struct CollapseSite {
  VertexId u, w, vl, vr;
  TriangleId left = kNone;   ///< The triangle (u, w, vl) that vanishes; kNone at a border.
  TriangleId right = kNone;  ///< The triangle (u, vr, w) that vanishes; kNone at a border.
};

/// What collapse(tin, star, j) would remove. REQUIRES: can_collapse(tin, star, j).
[[nodiscard]] CollapseSite collapse_site(const Star& star, std::size_t j) noexcept;

/// Collapses the centre u of `star` into w = star.link[j].
/// REQUIRES: can_collapse(tin, star, j), and `star` is the present star of u.
/// Post-conditions: u is removed (its triangle is kNone; position and height stay readable). The
/// triangles `left` and `right` of the site are removed. Every other triangle of the star has w in
/// u's place and keeps its id and class. Nothing else changes. Vertex::triangle of w and of the
/// link vertices obeys invariant I6 (mesh/validate.h).
CollapseSite collapse(Tin& tin, const Star& star, std::size_t j);

}  // namespace ptin
