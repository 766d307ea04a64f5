// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/front.h"

#include <string>
#include <string_view>

#include "engine/remote/remote_file.h"
#include "tools/formats/vector_file.h"
#include "tools/output/file_name.h"

namespace ptin::tools {

namespace {

/// Whether GDAL writes an output: a layer, a drawing of isolines, a raster.
bool is_written_by_gdal(std::string_view command, const std::string& path) {
  const std::string extension = lower_extension(path);
  const VectorFormat* const layer = find_vector_format(path);
  return (layer != nullptr && layer->is_by_gdal) || extension.starts_with(".tif") ||
         (command == "isoline" && extension == ".dxf");
}

}  // namespace

bool is_for_front(const Command& command, const ask::Reading& reading) {
  if (!command.is_for_front || reading.is_by_gdal()) return false;
  for (const auto& [name, values] : reading.given()) {
    for (const std::string& value : values) {
      const bool is_ours =
          name == "output" ? !is_written_by_gdal(command.name, value) : value != "-";
      if (!is_ours || is_remote(value)) return false;
    }
  }
  return true;
}

}  // namespace ptin::tools
