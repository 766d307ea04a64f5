// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far the border between surface and void may have moved in an answer.
#pragma once

#include <array>

#include <nlohmann/json_fwd.hpp>

#include "storage/store_file.h"

namespace ptin {

/// The farthest, in ground units (metres where the CRS is in degrees, else units of the plane), that
/// the border between surface and void may be from that of the source, either way, in an answer that
/// certifies this error: the error divided by the store's slope of voids (engine/DESIGN.md, section
/// 3.2). 0 where the store has no voids. +infinity where nothing bounds it: the slope is 0, or the
/// metadata do not state it.
/// @throws Error corruption  the metadata are no JSON
[[nodiscard]] double border_moved_at_most(const StoreFile& store, double certified_error);

/// The same of metadata that hold the options of the build; those of a stream do.
/// @param free_of_voids  As in StoreFacts.
[[nodiscard]] double border_move_told_by(const nlohmann::json& metadata, bool free_of_voids,
                                         double certified_error);

/// The same along x and along y, in map units: no part of the border is farther from that of the
/// source than this in both. Over degrees it is what the distance is where a degree is shortest.
/// @throws Error as border_moved_at_most()
[[nodiscard]] std::array<double, 2> border_reach(const StoreFile& store, double certified_error);

/// The greatest error of heights that are looked at in pixels: the border stays within a quarter of a
/// pixel. Small voids grow by as much on all sides, and with a whole pixel would meet. Infinite where
/// nothing moves the border, and where nothing bounds how far it moves.
/// @param reach_of_one   border_reach() of an error of 1.
/// @param width, height  Of a pixel, map units.
[[nodiscard]] double most_error_for_pixels(const std::array<double, 2>& reach_of_one, double width,
                                           double height) noexcept;

}  // namespace ptin
