// SPDX-License-Identifier: GPL-3.0-or-later
//
// Declarations of single formats of rasters, most of which GDAL passes over.
#include <string>
#include <vector>

#include <cpl_string.h>
#include <gdal_priv.h>

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

/// A grid of SAGA of 4 x 3 floats, whose header has these lines.
Arguments saga(const TestFolder& folder, const std::string& header) {
  write_file(folder.file("source.sgrd"),
             "NAME\t= dem\nDATAFORMAT\t= FLOAT\nBYTEORDER_BIG\t= FALSE\nPOSITION_XMIN\t= 300\n"
             "POSITION_YMIN\t= 500\nCELLCOUNT_X\t= 4\nCELLCOUNT_Y\t= 3\nCELLSIZE\t= 10\n"
             "NODATA_VALUE\t= -99999\nTOPTOBOTTOM\t= FALSE\n" +
                 header);
  std::string bytes;
  for (int i = 0; i < 12; ++i) {
    const float height = static_cast<float>(100 + i * i);
    bytes.append(reinterpret_cast<const char*>(&height), sizeof height);
  }
  write_file(folder.file("source.sdat"), bytes);
  return {folder.file("source.sdat")};
}

Declaration of_saga(const char* key, const char* declared, const char* undeclared) {
  return {key, [=](const TestFolder& folder, bool is_declared) {
            return saga(folder, is_declared ? declared : undeclared);
          }};
}

Arguments ascii_grid(const TestFolder& folder, bool is_declared) {
  write_file(folder.file("source.asc"), std::string("ncols 4\nnrows 3\nxllcorner 500000\nyll") +
                                            (is_declared ? "center" : "corner") +
                                            " 4000000\ncellsize 30\n1 2 3 4\n2 3 4 5\n5 5 5 6\n");
  return {folder.file("source.asc")};
}

Arguments er_mapper(const TestFolder& folder, bool is_declared) {
  write_file(folder.file("source.ers"),
             std::string("DatasetHeader Begin\n\tVersion = \"5.0\"\n\tDataSetType = ERStorage\n"
                         "\tDataType = Raster\n\tByteOrder = LSBFirst\n\tCoordinateSpace Begin\n"
                         "\t\tDatum = \"RAW\"\n\t\tProjection = \"RAW\"\n"
                         "\t\tCoordinateType = EN\n\t\tRotation = ") +
                 (is_declared ? "30:0:0.0" : "0:0:0.0") +
                 "\n\tCoordinateSpace End\n\tRasterInfo Begin\n\t\tCellType = IEEE4ByteReal\n"
                 "\t\tNrOfLines = 3\n\t\tNrOfCellsPerLine = 4\n\t\tNrOfBands = 1\n"
                 "\t\tCellInfo Begin\n\t\t\tXdimension = 10\n\t\t\tYdimension = 10\n"
                 "\t\tCellInfo End\n\t\tRegistrationCoord Begin\n\t\t\tEastings = 500\n"
                 "\t\t\tNorthings = 900\n\t\tRegistrationCoord End\n\tRasterInfo End\n"
                 "DatasetHeader End\n");
  std::string bytes;
  for (int i = 0; i < 12; ++i) {
    const float height = static_cast<float>(100 + i * i);
    bytes.append(reinterpret_cast<const char*>(&height), sizeof height);
  }
  write_file(folder.file("source"), bytes);
  return {folder.file("source.ers")};
}

/// Heights of a GeoPackage that are those of cells, or of their corners.
Arguments gpkg_coverage(const TestFolder& folder, bool is_declared) {
  RasterRecipe recipe;
  recipe.width = recipe.height = 8;
  recipe.value = &hills;
  make_raster(folder.file("base.tif"), recipe);
  const GDALDatasetUniquePtr data(GDALDataset::Open(folder.file("base.tif").c_str()));
  CPLStringList options;
  options.SetNameValue("GRID_CELL_ENCODING",
                       is_declared ? "grid-value-is-corner" : "grid-value-is-center");
  const std::string path = folder.file("source.gpkg");
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  GDALClose(driver->CreateCopy(path.c_str(), data.get(), FALSE, options.List(), nullptr, nullptr));
  return {path};
}

}  // namespace

std::vector<Declaration> raster_format_declarations() {
  return {
      {"raster.vrt_gaps", &vrt_of_tiles},
      of_saga("raster.saga_offset", "DATAFILE_OFFSET\t= 4\n", "DATAFILE_OFFSET\t= 0\n"),
      {"raster.corner_and_centre", &ascii_grid},
      {"raster.ers_rotation", &er_mapper},
      {"raster.values_at_corners", &gpkg_coverage},
      of_saga("raster.gdal_warning", "Z_FACTOR\t= 0.1\n", "Z_FACTOR\t= 1\n"),
  };
}

}  // namespace ptin::tools::testing
