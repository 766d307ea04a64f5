// SPDX-License-Identifier: GPL-3.0-or-later
//
// A TIN as a file holds it: vertices and triangles, unchecked. Readers for PLY, OBJ, 2DM, LandXML.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "engine/construct/byte_reader.h"
#include "engine/construct/point_stream.h"

namespace ptin {

/// Triangles over indexed vertices, in the order of the file. Indices are in range; nothing else is
/// known of them.
struct TinSoup {
  std::vector<SourcePoint> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint64_t hidden_triangles = 0;  ///< Marked invisible (LandXML): left out.
  std::string crs;                     ///< Anything GDAL understands; "" when the file is silent.
  std::string vertical_crs;            ///< Likewise.
};

/// What a reader is told, and asked now and then.
struct TinReading {
  std::string surface;  ///< LandXML: the surface's name; "" where there is only one.
  std::uint64_t memory_bytes = UINT64_MAX;  ///< For the soup.
  std::stop_token stop;
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;  ///< Bytes; may be empty.
};

/// True when a name is that of a TIN: .ply, .obj, .2dm, .xml or .landxml, in any case.
[[nodiscard]] bool is_tin_file(std::string_view path);

/// Reads a TIN by its name's extension.
/// @throws Error  not_found, io_error
///                invalid_argument    not what the format says, or cut short: the context names the
///                                    place; a face that is no triangle; an index beyond the
///                                    vertices; coordinates that are no finite numbers
///                resource_exhausted  the soup takes more than `memory_bytes`
///                cancelled
/// Cost: 48 bytes a vertex, 12 a triangle; memory grows with what is read, never with what a
/// header claims.
[[nodiscard]] TinSoup read_tin_soup(const std::string& path, const TinReading& reading);

// The readers. Each documents its own conventions.
[[nodiscard]] TinSoup read_ply(ByteReader& in, const TinReading& reading);
[[nodiscard]] TinSoup read_obj(ByteReader& in, const TinReading& reading);
[[nodiscard]] TinSoup read_two_dm(ByteReader& in, const TinReading& reading);
[[nodiscard]] TinSoup read_land_xml(ByteReader& in, const TinReading& reading);

}  // namespace ptin
