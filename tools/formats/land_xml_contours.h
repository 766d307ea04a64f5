// SPDX-License-Identifier: GPL-3.0-or-later
//
// Contours as the source data of a LandXML surface.
#pragma once

#include <span>
#include <string>

#include "engine/crs/crs_facts.h"
#include "engine/geometry/affine.h"
#include "tools/output/output_file.h"

namespace ptin::tools {

/// LandXML 1.2: Surface/SourceData/Contours, a Contour with one PntList2D (northing easting ...) a
/// line, with every digit that a double needs. Written as it comes.
class LandXmlContours {
 public:
  /// @throws Error as land_xml_head() and OutputFile
  LandXmlContours(const std::string& path, bool overwrite, const CrsFacts& crs);
  /// @throws Error resource_exhausted (disk full), io_error
  void add(std::span<const MapPoint> points, double elevation);
  /// @throws Error as OutputFile::publish
  void publish();

 private:
  OutputFile out_;
  std::string text_;
};

}  // namespace ptin::tools
