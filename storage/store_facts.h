// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a file says of its terrain as a whole. A stream says it, too.
#pragma once

#include <cstdint>

#include "engine/geometry/affine.h"
#include "engine/geometry/box.h"
#include "engine/geometry/height.h"

namespace ptin {

/// Facts of fixed size that a query needs; kept in the header, in binary.
struct StoreFacts {
  AffineMap map;
  HeightEncoding heights;
  GridBox bounds;           ///< Box of the whole domain, grid units.
  double min_height = 0.0;  ///< Least of all samples, height's unit; min > max when all is void.
  double max_height = 0.0;
  /// Error of the file's finest TIN against its source, in the height's unit: what --max-error left
  /// out, and the rounding of heights.
  double base_error = 0.0;
  double base_deviation = 0.0;
  std::uint64_t source_samples = 0;  ///< Samples with a height in the source.
  /// No triangle of the source's TIN, or of any coarser one, is void, and every vertex has a
  /// height. False where that is not known.
  bool free_of_voids = false;
  std::uint32_t page_bytes = 4096;
  friend bool operator==(const StoreFacts&, const StoreFacts&) = default;
};

}  // namespace ptin
