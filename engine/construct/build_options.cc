// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build_options.h"

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

}  // namespace ptin
