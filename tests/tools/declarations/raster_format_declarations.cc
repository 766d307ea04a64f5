// SPDX-License-Identifier: GPL-3.0-or-later
//
// What rasters of single formats declare, most of which GDAL passes over.
#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

namespace {

using Arguments = std::vector<std::string>;

/// Two tiles with a gap between them, or without one.
Arguments vrt_of_tiles(const TestFolder& folder, bool has_gap) {
  RasterRecipe tile;
  tile.width = 8;
  tile.value = &hills;
  make_raster(folder.file("tile.tif"), tile);
  const auto source = [](int at) {
    return R"(<SimpleSource><SourceFilename relativeToVRT="1">tile.tif</SourceFilename>)"
           R"(<SourceBand>1</SourceBand><SrcRect xOff="0" yOff="0" xSize="8" ySize="33"/>)"
           R"(<DstRect yOff="0" xSize="8" ySize="33" xOff=")" +
           std::to_string(at) + R"("/></SimpleSource>)";
  };
  write_file(folder.file("source.vrt"),
             R"(<VRTDataset rasterXSize="24" rasterYSize="33"><SRS>EPSG:32611</SRS>)"
             "<GeoTransform>500000, 30, 0, 4000000, 0, -30</GeoTransform>"
             R"(<VRTRasterBand dataType="Float32" band="1">)" +
                 source(0) + (has_gap ? "" : source(8)) + source(16) +
                 "</VRTRasterBand></VRTDataset>");
  return {folder.file("source.vrt")};
}

}  // namespace

std::vector<Declaration> raster_format_declarations() {
  return {
      {"raster.vrt_gaps", &vrt_of_tiles},
  };
}

}  // namespace ptin::tools::testing
