// SPDX-License-Identifier: GPL-3.0-or-later
//
// Meshes that go out piece by piece, so that they may be larger than memory.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "engine/crs/crs_facts.h"
#include "tools/formats/mesh.h"

namespace ptin::tools {

/// What every one of them is made from.
struct MeshStreamTarget {
  std::string path;
  bool overwrite = false;
  CrsFacts crs;
  LocalFrame frame;
};

/// Takes vertices, and triangles behind the vertices that they use. Destroyed before publish(), it
/// leaves nothing behind.
class MeshStream {
 public:
  using Point = std::array<double, 3>;  ///< x, y in map units, height.
  struct Corner {
    std::uint64_t number;  ///< The vertex's number, from 0 in the order of adding.
    Point point;
  };

  MeshStream() = default;
  MeshStream(const MeshStream&) = delete;
  MeshStream& operator=(const MeshStream&) = delete;
  virtual ~MeshStream() = default;

  /// @throws Error resource_exhausted (disk full), io_error
  virtual void add_vertex(const Point& point) = 0;
  /// @param corners  Counter-clockwise seen from above.
  /// @throws Error as add_vertex(); invalid_argument  more than the format counts
  virtual void add_triangle(const std::array<Corner, 3>& corners) = 0;
  /// Makes the file appear under its name.  @throws Error as OutputFile::publish
  virtual void publish() = 0;
};

/// STL, binary: a normal and three corners in float32 a triangle, z up, in the local frame of the
/// target; the header of 80 bytes names it as "ptin origin X Y Z scale X Y Z". At most 2^32 - 1
/// triangles.
[[nodiscard]] std::unique_ptr<MeshStream> make_stl(const MeshStreamTarget& target);

/// LandXML 1.2: a surface of type TIN, points as northing, easting, height with every digit that a
/// double needs, then faces, which wait in a nameless file beside the target.
/// @throws Error invalid_argument  the CRS is geographic: LandXML has a plane
[[nodiscard]] std::unique_ptr<MeshStream> make_land_xml(const MeshStreamTarget& target);

/// Wavefront OBJ: map coordinates with every digit that a double needs; faces wait in a nameless file
/// beside the target.
[[nodiscard]] std::unique_ptr<MeshStream> make_obj(const MeshStreamTarget& target);

/// SMS 2DM: elements, then nodes, which wait in a nameless file beside the target.
[[nodiscard]] std::unique_ptr<MeshStream> make_two_dm(const MeshStreamTarget& target);

/// DXF of release 12, which every CAD program reads: a 3DFACE a triangle on the layer TIN, in map
/// coordinates with every digit that a double needs; an ASCII file. The CRS is a comment.
[[nodiscard]] std::unique_ptr<MeshStream> make_dxf(const MeshStreamTarget& target);

}  // namespace ptin::tools
