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

/// Opens a file of points by its format (read/input_kind.h): LAS (read/las_reader.h), a TIN for its
/// vertices (tin/tin_vertices.h), text (read/xyz_reader.h), anything else as a layer of OGR's
/// (read/ogr_points.h).
/// @param nodata     The height that means none. A TIN hands out only vertices that belong to a
///                   triangle with three heights, as when the TIN itself is built. For text it
///                   takes the place of a value that a comment declares. Points with this height are
///                   handed out all the same.
/// @param resources  For a TIN, while it is opened.
/// @param part       What is read of the file. A TIN, a layer and text that is_packed() are read as a
///                   whole.
/// @throws Error  as those readers; invalid_argument also for a choice that means nothing for the
///                format
[[nodiscard]] std::unique_ptr<PointStream> open_point_stream(const std::string& path,
                                                             const PointChoice& choice,
                                                             std::optional<double> nodata = {},
                                                             const StreamResources& resources = {},
                                                             const PointPart& part = {});

}  // namespace ptin
