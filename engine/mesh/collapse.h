// SPDX-License-Identifier: GPL-3.0-or-later
//
// The half-edge collapse u -> w: u goes, its star becomes the fan from w.
#pragma once

#include <cstddef>

#include "engine/mesh/star.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// The most neighbours that a vertex should have after a collapse while there is another choice
/// (engine/DESIGN.md, section 2.1).
inline constexpr std::size_t kComfortableDegree = 64;

/// True when collapsing the centre of `star` into link vertex `j` leaves a valid mesh: every fan
/// triangle strictly counter-clockwise; a border vertex only along the border, between collinear
/// neighbours, so that the domain stays. Cost: the degree.
[[nodiscard]] bool can_collapse(const Tin& tin, const Star& star, std::size_t j) noexcept;

/// The split that undoes a collapse, in ids: vl and vr are the neighbours of u beside w, or at a
/// border the ends of the fan.
struct CollapseSite {
  VertexId u, w, vl, vr;
  TriangleId left = kNone;   ///< The triangle (u, w, vl) that vanishes; kNone at a border.
  TriangleId right = kNone;  ///< The triangle (u, vr, w) that vanishes; kNone at a border.
};

/// What collapse(tin, star, j) would remove. REQUIRES: can_collapse(tin, star, j).
[[nodiscard]] CollapseSite collapse_site(const Star& star, std::size_t j) noexcept;

/// Collapses the centre u of `star` into w = star.link[j].
/// REQUIRES: can_collapse(tin, star, j), and `star` is the star of u now.
/// Post-conditions: u is removed (its triangle is kNone; position and height stay readable); the
/// triangles `left` and `right` of the site are removed; every other triangle of the star has w in
/// u's place, with its id and class kept; nothing else changes. Vertex::triangle of w and of the
/// link is kept as I6 asks.
CollapseSite collapse(Tin& tin, const Star& star, std::size_t j);

}  // namespace ptin
