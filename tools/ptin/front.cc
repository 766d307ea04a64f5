// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/front.h"

#include <algorithm>
#include <array>
#include <string>

#include "engine/remote/remote_file.h"
#include "tools/formats/vector_file.h"
#include "tools/output/file_name.h"

namespace ptin::tools {

namespace {

constexpr auto kFrontCommands =
    std::to_array<std::string_view>({"completion", "export", "highest", "info", "isoline", "locate",
                                     "refine", "render", "sight", "stream", "viewer", "volume"});
/// Parameters whose values GDAL reads.
constexpr auto kReadByGdal =
    std::to_array<std::string_view>({"line", "pairs", "points", "polygon"});

template <std::size_t kCount>
bool is_among(const std::array<std::string_view, kCount>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Whether GDAL writes an output: a layer, a drawing of isolines, a raster.
bool is_written_by_gdal(std::string_view command, const std::string& path) {
  const std::string extension = lower_extension(path);
  const VectorFormat* const layer = find_vector_format(path);
  return (layer != nullptr && layer->is_by_gdal) || extension.starts_with(".tif") ||
         (command == "isoline" && extension == ".dxf");
}

}  // namespace

bool is_for_front(std::string_view command, const ask::Reading& reading) {
  if (!is_among(kFrontCommands, command)) return false;
  for (const auto& [name, values] : reading.given()) {
    if (is_among(kReadByGdal, name)) return false;
    for (const std::string& value : values) {
      const bool is_ours = name == "output" ? !is_written_by_gdal(command, value) : value != "-";
      if (!is_ours || is_remote(value)) return false;
    }
  }
  return true;
}

}  // namespace ptin::tools
