// SPDX-License-Identifier: GPL-3.0-or-later
//
// Distances over the ground that the metadata of a stream tell. Both modules have them: the decoder for the size of the
// terrain and the scale of its picture, the questions for profiles and lines of sight.
#pragma once

#include "engine/crs/ground_facts.h"

namespace ptin::viewer {

/// The ground that the host described last (export `describeGround`). On the ellipsoid a length over more than 170 degrees of
/// longitude is not a number.
[[nodiscard]] Ground ground();

inline constexpr double kSpeedOfLight = 299792458.0;  ///< Metres a second.

}  // namespace ptin::viewer
