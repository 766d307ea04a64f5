// SPDX-License-Identifier: GPL-3.0-or-later
//
// What export says when it is done.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "engine/query/questions.h"
#include "tools/ask/field.h"
#include "tools/formats/mesh.h"
#include "tools/region/straight_sides.h"

namespace ptin::tools {

/// What was made.
struct Exported {
  std::string output, format;
  bool is_raster = false;
  bool is_source = false;       ///< The source raster itself.
  std::string what = "height";  ///< What a raster's pixels say.
  std::string slope_unit;       ///< "degree" or "percent"; of slopes alone.
  std::uint64_t vertices = 0, triangles = 0, cells = 0;
  std::int64_t columns = 0, rows = 0;
  std::array<double, 2> pixel_size{};      ///< Map units.
  std::optional<LocalFrame> frame;         ///< The frame of formats that have one.
  Certificate certificate;                 ///< Bounds of heights, rounding of pixels included.
  double rounding = 0.0;                   ///< Rounding of heights to pixels; rasters only.
  std::optional<Transformed> transformed;  ///< The region.
  std::uint64_t lone_samples = 0;          ///< Heights of the source without a triangle, void here.
  std::optional<ClassChanges> changes;     ///< Changes in the region; none: not counted.
  std::uint64_t surface_pixels = 0;        ///< Whose centre lies on surface; rasters only.
  std::uint64_t bytes = 0;
  double seconds = 0.0;
};

[[nodiscard]] ask::Fields<Exported> exported_fields();

/// Prints it for `--json`. The certificate speaks of heights, so other pixels have none.
void print_json_of(const Exported& made, const StoreFile& store);
/// Prints it for people.
void print_exported(const Exported& made, const StoreFacts& facts);

}  // namespace ptin::tools
