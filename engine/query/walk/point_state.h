// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a point of the plane can be to a terrain.
#pragma once

#include <cstdint>

namespace ptin {

/// What a point can be: over ground, over a void (the terrain has no height there), or outside of
/// the domain. None is an error.
enum class PointState : std::uint8_t { kSurface, kVoid, kOutside };

}  // namespace ptin
