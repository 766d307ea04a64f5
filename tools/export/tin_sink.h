// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the patches of an export go: one sink a format, each written as it comes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "engine/crs/crs_facts.h"
#include "tools/export/tin_patch.h"
#include "tools/formats/mesh.h"

namespace ptin::tools {

/// What every sink is made from.
struct SinkTarget {
  std::string path;
  bool overwrite = false;
  CrsFacts crs;
  LocalFrame frame;                                      ///< The frame of STL.
  std::optional<double> solid_base;                      ///< An STL's, if solid (make_solid).
  bool slope_in_percent = false;                         ///< The field `slope`; else degrees.
  std::uint64_t border_bytes = std::uint64_t{64} << 20;  ///< The most for PatchMaker::make().
  std::uint64_t index_bytes = std::uint64_t{256} << 20;  ///< Bytes for an index of features.
  std::uint64_t most_triangles = 0;                      ///< At most; sets the size of that index.
};

/// Takes patches in order. Destroyed before publish(), it leaves nothing behind.
class TinSink {
 public:
  TinSink() = default;
  TinSink(const TinSink&) = delete;
  TinSink& operator=(const TinSink&) = delete;
  virtual ~TinSink() = default;

  /// @throws Error resource_exhausted (disk full; more than the format counts), io_error
  virtual void add(const TinPatch& patch) = 0;
  /// Makes the file appear under its name.  @throws Error as OutputFile::publish
  virtual void publish() = 0;
};

/// PLY, binary, with the conventions of tools/formats/ply.cc. Vertices go to the file as they come,
/// triangles first to a nameless file beside it. Indices are `int`, or `uint` where there are more
/// than 2^31 - 1 vertices; at most 2^32 vertices.
[[nodiscard]] std::unique_ptr<TinSink> make_ply_sink(const SinkTarget& target);

/// Triangles as polygons with heights, one feature each, written by GDAL as POLYGON Z, which QGIS
/// reads in any version. The fields `slope` and `aspect` say how a triangle lies over ground
/// (tools/slope.h), at its middle; `aspect` is null where it is flat. A GeoPackage gets its spatial index when it is finished. A FlatGeobuf gets
/// one where the index fits `index_bytes` (128 bytes a triangle).
[[nodiscard]] std::unique_ptr<TinSink> make_geopackage_sink(const SinkTarget& target);
[[nodiscard]] std::unique_ptr<TinSink> make_flatgeobuf_sink(const SinkTarget& target);
/// True when a FlatGeobuf gets its index.
[[nodiscard]] bool flatgeobuf_index_fits(const SinkTarget& target);

/// As tools/formats/mesh_stream.h has them.
[[nodiscard]] std::unique_ptr<TinSink> make_land_xml_sink(const SinkTarget& target);
[[nodiscard]] std::unique_ptr<TinSink> make_obj_sink(const SinkTarget& target);
[[nodiscard]] std::unique_ptr<TinSink> make_two_dm_sink(const SinkTarget& target);
[[nodiscard]] std::unique_ptr<TinSink> make_dxf_sink(const SinkTarget& target);
[[nodiscard]] std::unique_ptr<TinSink> make_stl_sink(const SinkTarget& target);

}  // namespace ptin::tools
