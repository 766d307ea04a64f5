// SPDX-License-Identifier: GPL-3.0-or-later
//
// How many vertices a file of triangles may have, before it is read.
#pragma once

#include <cstdint>
#include <string>

namespace ptin {

/// How many vertices a file of triangles has, or an estimate. A file with fewer than 65536 vertices
/// and triangles in all is read to its end and counted. For a longer one the header of a PLY is
/// believed; in other formats the number is estimated from the file's size and the bytes that the
/// first vertices and triangles take, with two triangles to a vertex.
/// @param surface  As TinReading::surface.
/// @throws Error as read_tin_file(), for what is read
/// Cost: reads up to the 65536th vertex or triangle, mostly some MB.
[[nodiscard]] std::uint64_t count_tin_vertices(const std::string& path, const std::string& surface);

}  // namespace ptin
