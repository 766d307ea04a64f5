// SPDX-License-Identifier: GPL-3.0-or-later
//
// Saturation: what a collapse takes over from the triangles of its star (engine/DESIGN.md, section
// 2.2).
#pragma once

#include <utility>

#include "engine/construct/tile/tile.h"
#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/geometry/interval.h"
#include "engine/mesh/star.h"

namespace ptin {

/// Box of P(u), the polygon of the star, and of everything that the collapse of u would depend on.
/// Cost: the degree.
[[nodiscard]] GridBox saturated_box(const Tile& tile, const Star& star) noexcept;

/// Length of the longest chain of collapses that this one would extend: the rank of its record.
/// Cost: the degree.
[[nodiscard]] std::uint32_t saturated_chain(const Tile& tile, const Star& star) noexcept;

/// Interval of the height codes of u, of the vertices of P(u), and of everything that the collapse
/// of u would depend on; empty when none has a height. It covers the full surface inside of P(u),
/// and any fan. Cost: the degree, and one record read for each triangle.
[[nodiscard]] Interval saturated_heights(const Tile& tile, const Star& star) noexcept;

/// The two ends of an interval of codes as bits. An empty interval is one with lo > hi, as the
/// format has it.
[[nodiscard]] std::pair<HeightBits, HeightBits> height_bits(const Interval& codes,
                                                            const HeightEncoding& heights);

}  // namespace ptin
