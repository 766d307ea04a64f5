// SPDX-License-Identifier: GPL-3.0-or-later
//
// Opens a file of points of any format as a stream.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/read/point_stream.h"

namespace ptin {

/// Opens a file of points by its format (input_kind.h): LAS (las_reader.h), a TIN for its vertices
/// (tin_vertices.h), text (xyz_reader.h), anything else as a layer of OGR's (ogr_points.h).
/// @param nodata  This height means none: such points are handed out all the same, but that
///                vertices of a TIN stay only where a triangle has three heights, as when it is
///                built.
/// @throws Error  not_found, io_error, invalid_argument, unsupported_version  as those; a choice
///                that means nothing for the format
[[nodiscard]] std::unique_ptr<PointStream> open_point_stream(const std::string& path,
                                                             const PointChoice& choice,
                                                             std::optional<double> nodata = {},
                                                             const StreamResources& resources = {});

}  // namespace ptin
