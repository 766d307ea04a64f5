// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stars and lifetimes held against engine/DESIGN.md, section 2.10: the splits are done again on a set of
// triangles, which shares no code with the mesh, and maker and successor of each are noted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/mesh/tin.h"
#include "storage/star.h"

namespace ptin::oracle {

/// What a build gives: T0 with the deaths of its triangles, and records with their stars.
struct BuiltStars {
  Tin t0;  ///< May hold further vertices, in no triangle.
  std::vector<float> t0_deaths;
  StarredRecords records;
};

/// Replays the records in falling rank, and returns the first fault in words, or an empty string: a
/// fan that is not there; a ring whose order, positions, heights or classes are not those of the
/// star after its split; a death that is not the error of the record that replaces the triangle, or
/// is above that of its maker; a triangle of T0 with another death.
[[nodiscard]] std::string check_stars(const BuiltStars& built);

/// Holds the triangles whose lifetimes hold an error against those of the TIN of the records with
/// larger errors, for errors that occur, others, and none at all. Returns the first fault in words.
[[nodiscard]] std::string check_intervals(const BuiltStars& built, std::uint64_t seed);

}  // namespace ptin::oracle
