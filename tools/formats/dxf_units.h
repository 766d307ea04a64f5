// SPDX-License-Identifier: GPL-3.0-or-later
//
// The unit of a drawing, as the header of a DXF file states it.
#pragma once

#include <string>

#include "engine/crs/crs_facts.h"

namespace ptin::tools {

struct DxfUnits {
  int insunits = 0;     ///< $INSUNITS: 6 metres, 2 feet, 21 US survey feet ...; 0: none is stated.
  int measurement = 0;  ///< $MEASUREMENT: 1 metric, 0 English.
};

/// The units of a CRS's plane; none where they are unknown or degrees, which no drawing has.
[[nodiscard]] DxfUnits dxf_units(const CrsFacts& crs);

/// The header that GDAL's DXF driver begins a drawing with, with the units of a CRS in it, as a file in
/// GDAL's memory that is gone with the object. GDAL reads it until the drawing is closed.
class DxfHeader {
 public:
  /// @throws Error io_error  GDAL's own header is not where its data lie
  explicit DxfHeader(const CrsFacts& crs);
  ~DxfHeader();
  DxfHeader(const DxfHeader&) = delete;
  DxfHeader& operator=(const DxfHeader&) = delete;
  /// The creation option that names it.
  [[nodiscard]] std::string option() const { return "HEADER=" + path_; }

 private:
  std::string path_;
  std::string text_;  ///< The text that the file is made of.
};

}  // namespace ptin::tools
