// SPDX-License-Identifier: GPL-3.0-or-later
//
// The places of a terrain that benchmarks ask for: the same in every run, so that what an answer counts
// does not depend on the machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/query/select/region.h"
#include "storage/store_facts.h"

namespace ptin::bench {

/// Uniform over the bounding box.
[[nodiscard]] std::vector<MapPoint> random_points(const StoreFacts& facts, std::size_t count);

/// Windows of `area_ppm` millionths of the area, uniform within the bounding box.
[[nodiscard]] std::vector<Window> random_windows(const StoreFacts& facts, std::size_t count,
                                                 double area_ppm, std::uint64_t seed);

/// The window of `area_ppm` millionths of the area that has a third of the free room in the west and in
/// the south; `shift` of its own width farther to the east.
[[nodiscard]] Window window_at(const StoreFacts& facts, double area_ppm, double shift = 0.0);

}  // namespace ptin::bench
