// SPDX-License-Identifier: GPL-3.0-or-later
//
// What both doors of the question of volumes must know of the ground, and of two terrains.
#pragma once

#include <optional>
#include <string>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"

namespace ptin::ask {

/// Sets the lengths over ground of a volume's request, and how far borders of voids may have moved.
void set_ground(VolumeRequest& request, const CrsFacts& crs);

/// Why positions or heights of another terrain cannot be compared with those of a terrain, as the end of a
/// sentence about the other one; empty: they can.
/// @param name  Of the terrain.
[[nodiscard]] std::string mismatch_of(const CrsFacts& terrain, const CrsFacts& other,
                                      const std::string& name);

/// Heights' units of a terrain in one of another; none where one of both, or neither, is known.
[[nodiscard]] std::optional<double> height_scale(const CrsFacts& terrain, const CrsFacts& other);

}  // namespace ptin::ask
