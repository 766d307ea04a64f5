// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rasters in GDAL's memory.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include <gdal.h>

#include "tests/support/test_folder.h"

namespace ptin::oracle {

/// A raster to be written; `value` by column and row of the file (row 0 in the north).
struct RasterFile {
  int columns = 20, rows = 20;
  std::function<double(int column, int row)> value;
  GDALDataType type = GDT_Int16;
  std::optional<double> nodata;
  double scale = 1.0, offset = 0.0;
  std::string srs = "EPSG:32611";
  double step = 10.0;
};

/// Writes it; the file is gone with the object.
class WrittenRaster {
 public:
  explicit WrittenRaster(const RasterFile& raster);
  ~WrittenRaster();
  WrittenRaster(const WrittenRaster&) = delete;
  WrittenRaster& operator=(const WrittenRaster&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

using ScratchFolder = test::TestFolder;

[[nodiscard]] std::string bytes_of(const std::string& path);
void write_text(const std::string& path, const std::string& text);

}  // namespace ptin::oracle
