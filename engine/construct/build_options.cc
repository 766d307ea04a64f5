// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build_options.h"

#include <cmath>
#include <tuple>

#include "engine/construct/read/column_names.h"
#include "engine/error.h"

namespace ptin {

LineChoice line_choice_of(const BuildOptions& options) {
  return {options.breaklines, options.breakline_layer, options.boundary, options.boundary_layer};
}

PointChoice point_choice_of(const BuildOptions& options) {
  return {options.classes, options.returns, options.layer,
          options.z_field, options.columns, options.skip_invalid};
}

SourceOptions source_options_of(const BuildOptions& options) {
  SourceOptions source;
  source.nodata = options.nodata;
  source.resolution = options.resolution;
  if (options.bbox) {
    source.bbox = {(*options.bbox)[0], (*options.bbox)[1], (*options.bbox)[2], (*options.bbox)[3]};
  }
  source.a_srs = options.a_srs;
  source.merge = options.duplicates.value_or(PointMerge::kMean);
  source.points = point_choice_of(options);
  source.vertical_crs = options.vertical_crs;
  return source;
}

void check_options(const BuildOptions& o) {
  const auto require = [](bool holds, const char* message) {
    if (!holds) {
      throw Error(ErrorCode::invalid_argument, message);
    }
  };
  const auto is_length = [](double v) { return std::isfinite(v) && v >= 0.0; };
  require(is_length(o.max_error), "the largest error to leave out must be a finite number >= 0");
  require(is_length(o.void_slope), "the void slope must be a finite number >= 0");
  require(!o.resolution || (is_length(*o.resolution) && *o.resolution > 0.0),
          "the resolution must be a finite number > 0");
  require(!o.max_edge || (is_length(*o.max_edge) && *o.max_edge > 0.0),
          "the longest edge must be a finite number > 0");
  require(!o.bbox || ((*o.bbox)[0] < (*o.bbox)[2] && (*o.bbox)[1] < (*o.bbox)[3]),
          "the bbox is inverted or empty; its order is xmin ymin xmax ymax");
  require(o.breakline_layer.empty() || !o.breaklines.empty(),
          "--breakline-layer is for files that --breaklines names; name them, or leave it out");
  require(o.boundary_layer.empty() || !o.boundary.empty(),
          "--boundary-layer is for the file that --boundary names; name it, or leave it out");
  if (!o.columns.empty()) {
    std::ignore = columns_of(o.columns, point_roles());
  }
  require(!o.tile || (*o.tile >= 2 && *o.tile <= (std::int64_t{1} << 20)),
          "a tile must be 2 to 1,048,576 grid units along a side");
}

}  // namespace ptin
