// SPDX-License-Identifier: GPL-3.0-or-later
//
// How many vertices a file of triangles may have, before it is read.
#pragma once

#include <cstdint>
#include <string>

namespace ptin {

/// As a PLY's header says; of other files by the bytes of what comes first, two triangles counted
/// for a vertex. Exact for a file that is small.
/// @param surface  As TinReading.
/// @throws Error as read_tin_file(), for what is looked at
/// Cost: reads some MB at most.
[[nodiscard]] std::uint64_t count_tin_vertices(const std::string& path, const std::string& surface);

}  // namespace ptin
