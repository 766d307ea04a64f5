// SPDX-License-Identifier: GPL-3.0-or-later
//
// The variable length records of a LAS file, before and behind its points: those that state its
// CRS.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/construct/grid/geotiff_keys.h"
#include "engine/construct/read/las_file.h"

namespace ptin {

/// The records of a LAS file that state its CRS.
struct LasRecords {
  /// The texts that are not empty, in the order of the file; those that the library libLAS wrote under
  /// its own name where there are no others.
  std::vector<std::string> wkt;
  GeoTiffKeys keys;  ///< The last of each kind of record.
  bool has_math_transform = false;
  std::vector<SourceWarning> warnings;  ///< About records that are not there; they name no file.
};

/// Looks at the header of each record, and reads those that are about the CRS. Records end where the
/// points begin, those behind the points with the file, whatever the header counts.
/// @throws Error io_error  the file cannot be read
/// Memory: up to 64 MiB of records that declare a CRS.
[[nodiscard]] LasRecords read_las_records(const LasFile& file, const LasHeader& header);

}  // namespace ptin
