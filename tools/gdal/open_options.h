// SPDX-License-Identifier: GPL-3.0-or-later
//
// The options with which GDAL opens a terrain: `-oo NAME=VALUE` of its programs.
#pragma once

#include <cstdint>
#include <optional>

#include <cpl_string.h>

#include "engine/memory_units.h"
#include "tools/export/pixel_value.h"

namespace ptin::tools {

struct OpenOptions {
  std::optional<double> error;       ///< ERROR: certified error, height's unit. None: AUTO.
  PixelContent content;              ///< BAND: what the raster says.
  std::optional<double> pixel_size;  ///< PIXEL_SIZE: both sides of a pixel, map units.
  std::optional<double> interval;    ///< INTERVAL: between isolines. None: there is no such layer.
  std::uint64_t memory_bytes = kMemoryOfParts;  ///< MEMORY_MB, of one question.
};

/// The options of a list NAME=VALUE; names that are none of ours are passed over.
/// @throws Error invalid_argument  a value that means nothing
[[nodiscard]] OpenOptions open_options_of(CSLConstList options);

/// The same for GDAL: their names, types and meanings as XML (GDAL_DMD_OPENOPTIONLIST).
extern const char* const kOpenOptionList;

}  // namespace ptin::tools
