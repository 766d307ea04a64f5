// SPDX-License-Identifier: GPL-3.0-or-later
//
// Saturation: what a collapse takes over from the triangles of its star (engine/DESIGN.md, section 2.2).
#pragma once

#include <utility>

#include "engine/construct/tile/tile.h"
#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/geometry/interval.h"
#include "engine/mesh/star.h"

namespace ptin {

/// Box of P(u) and of everything that depends on this collapse. Cost: the degree.
[[nodiscard]] GridBox saturated_box(const Tile& tile, const Star& star) noexcept;

/// Longest chain of collapses that this one would extend: the rank of its record. Cost: the degree.
[[nodiscard]] std::uint32_t saturated_chain(const Tile& tile, const Star& star) noexcept;

/// Height codes of u, P(u) and of everything below: covers the full surface inside of P(u), and any
/// fan. Cost: the degree, and a record a triangle.
[[nodiscard]] Interval saturated_heights(const Tile& tile, const Star& star) noexcept;

/// Bits of an interval of codes; an empty one as the format has it (lo > hi).
[[nodiscard]] std::pair<HeightBits, HeightBits> height_bits(const Interval& codes,
                                                            const HeightEncoding& heights);

}  // namespace ptin
