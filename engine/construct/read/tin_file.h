// SPDX-License-Identifier: GPL-3.0-or-later
//
// A TIN as a file holds it: vertices, triangles and quads, unchecked. Readers for PLY, OBJ, 2DM, LandXML,
// which hand it out piece by piece.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/source_warning.h"
#include "engine/construct/read/byte_reader.h"
#include "engine/construct/read/point_stream.h"

namespace ptin {

/// Takes what a reader finds, in the order of the file.
class TinFileSink {
 public:
  TinFileSink() = default;
  TinFileSink(const TinFileSink&) = delete;
  TinFileSink& operator=(const TinFileSink&) = delete;
  virtual ~TinFileSink() = default;

  /// The number of vertices that the header of the file announces. Not called for formats that have
  /// no such header.
  virtual void expect_vertices(std::uint64_t /*count*/) {}
  /// `id` is the file's own, or the vertex's number from 0 where the format has no ids. A file at
  /// fault may give an id twice.
  virtual void add_vertex(std::int64_t id, const SourcePoint& p) = 0;
  /// A triangle or a quad. `ids` are those of its three or four corners, one after the other around
  /// it. The vertices that have them may come later, or not at all.
  virtual void add_face(std::span<const std::int64_t> ids) = 0;
};

/// What a file declares, and how much was read from it.
struct TinFileFacts {
  std::string crs;           ///< Anything GDAL understands; "" when the file is silent.
  std::string vertical_crs;  ///< Likewise.
  DeclaredUnits units;
  std::uint64_t vertices = 0, faces = 0;
  std::uint64_t hidden_triangles = 0;  ///< Marked invisible (LandXML): left out.
  SourceWarnings warnings;
};

/// What a reader is given: which surface to read, when to stop, and to whom to report.
struct TinReading {
  std::string surface;  ///< LandXML: the surface's name; "" where there is only one.
  std::stop_token stop;
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;  ///< Bytes; may be empty.
};

/// True when a name is that of a TIN: .ply, .obj, .2dm, .xml or .landxml, in any case.
[[nodiscard]] bool is_tin_file(std::string_view path);
/// True when a name is that of a format whose files may hold several surfaces with names: LandXML.
[[nodiscard]] bool may_have_surfaces(std::string_view path);

/// Reads a TIN in the format that the extension of its name shows. At least one vertex and one
/// face are handed out, else it is an error.
/// @throws Error  not_found, io_error
///                invalid_argument    not what the format says, or cut short: the context names the
///                                    place; a face of less than three or more than four corners;
///                                    coordinates that are no finite numbers; no vertex, or no face
///                cancelled           `reading.stop` fired
///                and what the sink throws
/// Memory: some hundred KiB, whatever the file's size.
TinFileFacts read_tin_file(const std::string& path, const TinReading& reading, TinFileSink& sink);

// The readers. The source of each says what it reads of its format.
using TinReader = TinFileFacts(ByteReader& in, const TinReading& reading, TinFileSink& sink);
TinReader read_ply, read_obj, read_two_dm, read_land_xml;
/// The reader for a name's extension.  @throws Error invalid_argument  there is none
[[nodiscard]] TinReader& tin_reader_of(const std::string& path);

}  // namespace ptin
