// SPDX-License-Identifier: GPL-3.0-or-later
//
// A GeoTIFF or a COG while it is written, block by block.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <gdal_priv.h>

#include "engine/construct/memory_plan.h"
#include "engine/crs/crs_facts.h"
#include "tools/export/pixel_value.h"
#include "tools/output/pending_file.h"

namespace ptin::tools {

/// Pixels along the sides of a block, unless a creation option says otherwise.
inline constexpr const char* kBlockSide = "512";

struct RasterTarget {
  /// Or "/vsimem/NAME": a file of GDAL's in memory, which the caller removes once it is published. Then GDAL's
  /// cache stays as it is.
  std::string path;
  bool overwrite = false;
  bool is_cog = false;
  PixelContent content;
  double nodata = -9999.0;
  std::vector<std::string> creation_options;  ///< KEY=VALUE for the driver; they override ours.
  CrsFacts crs;
  /// For GDAL's cache.
  std::uint64_t cache_bytes = std::uint64_t{64} << 20;
  std::uint64_t table_bytes = std::uint64_t{64} << 20;  ///< For GDAL's table of blocks.
  /// Of heights: the type of pixels; none: type_of_pixels().
  std::optional<GDALDataType> type = std::nullopt;
  /// Metadata of the file: names that GDAL writes as tags (TIFFTAG_COPYRIGHT), and others. Of what is known only
  /// when it was sampled, export_raster() adds PTIN_CERTIFIED_ERROR, PTIN_CERTIFIED_DEVIATION and PTIN_EXACT.
  bool is_described = false;
  std::vector<std::pair<std::string, std::string>> metadata{};
};

/// What a raster is, beside the values of its pixels.
struct RasterForm {
  std::int64_t width = 0, height = 0;
  GDALDataType type = GDT_Float32;
  bool has_signed_bytes = false;  ///< Of Byte: values are -128 to 127.
  /// GDAL's six numbers; none: it lies nowhere.
  std::optional<std::array<double, 6>> geotransform;
  bool is_point = false;  ///< It calls its pixels points, and not areas.
  std::optional<double> nodata;
  double scale = 1.0, offset = 0.0;
  std::string unit;  ///< Empty: none.
};

/// Takes the place of what was there when it is published; destroyed before, it leaves nothing behind. A
/// COG is copied by GDAL, with its overviews, from a GeoTIFF beside it.
class RasterFile {
 public:
  /// @param target  Borrowed.
  /// @throws Error  invalid_argument    GDAL refuses an option, or the output exists
  ///                resource_exhausted  the table of blocks does not fit `table_bytes`
  ///                io_error
  RasterFile(const RasterTarget& target, const RasterForm& form);
  ~RasterFile();
  RasterFile(const RasterFile&) = delete;
  RasterFile& operator=(const RasterFile&) = delete;

  /// Adds an item of metadata.  @throws Error io_error
  void describe(const std::string& name, const std::string& value);
  [[nodiscard]] GDALRasterBand& band() { return *dataset_->GetRasterBand(1); }
  /// @param values  A whole block, of the type of the form.
  /// @throws Error  io_error; resource_exhausted  the disk is full
  void write_block(int column, int row, void* values);
  /// @param progress  Called with the share done of a COG, one half to 1; may be empty.
  /// @throws Error  io_error; resource_exhausted  the disk is full; cancelled
  void publish(const std::function<void(double)>& progress, const std::stop_token& stop);

 private:
  const RasterTarget& target_;
  RasterForm form_;
  std::optional<GdalCacheLimit> cache_;
  std::optional<PendingFile> file_;  ///< None: in memory.
  std::optional<PendingFile> raw_;   ///< What a COG is copied from.
  std::string written_, copied_;     ///< Their names; empty: there is none.
  GDALDatasetUniquePtr dataset_;     ///< Closed before the files are removed.
};

}  // namespace ptin::tools
