// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/export/raster_export.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "engine/construct/memory_plan.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/memory_units.h"
#include "engine/stop.h"
#include "tools/export/pixel_grid.h"
#include "tools/formats/geotiff_crs.h"
#include "tools/output/gdal_output.h"
#include "tools/output/pending_file.h"

namespace ptin::tools {

namespace {

constexpr const char* kBlockSide = "512";

CPLStringList options_of(const RasterTarget& target, bool for_copy) {
  CPLStringList options;
  if (target.is_cog == for_copy) {
    for (const std::string& option : target.creation_options) options.AddString(option.c_str());
  }
  const auto set = [&](const char* key, const char* value) {
    if (options.FetchNameValue(key) == nullptr) options.SetNameValue(key, value);
  };
  set("COMPRESS", "DEFLATE");
  set("BIGTIFF", "IF_SAFER");
  if (for_copy) {
    set("PREDICTOR", "YES");
    // The mean of 359 and 1 degrees is no direction between them.
    const bool is_aspect = target.content.value == PixelValue::kAspect;
    set("OVERVIEW_RESAMPLING", is_aspect ? "NEAREST" : "AVERAGE");
    return options;
  }
  set("TILED", "YES");
  if (options.FetchBool("TILED", true)) {
    set("BLOCKXSIZE", kBlockSide);
    set("BLOCKYSIZE", kBlockSide);
  }
  const std::string compression = options.FetchNameValueDef("COMPRESS", "");
  if (compression == "DEFLATE" || compression == "LZW" || compression == "ZSTD")
    set("PREDICTOR", target.content.value == PixelValue::kHillshade ? "2" : "3");
  return options;
}

/// Checks that the table of blocks fits its memory: GDAL keeps the place and the size of every
/// block in memory. For a COG it keeps those of the raster that is copied and of the overviews
/// besides.
void check_table(const PixelRect& raster, const RasterTarget& target) {
  const std::int64_t side = std::stoi(kBlockSide);
  const auto across = [&](std::int64_t pixels) {
    return static_cast<std::uint64_t>((pixels + side - 1) / side);
  };
  constexpr std::uint64_t kBytes = 2 * sizeof(std::uint64_t);
  const std::uint64_t copies = target.is_cog ? 3 : 1;
  const std::uint64_t table = copies * kBytes * across(raster.width) * across(raster.height);
  if (table <= target.table_bytes) return;
  throw Error(ErrorCode::resource_exhausted,
              "a raster of " + std::to_string(raster.width) + " x " +
                  std::to_string(raster.height) + " pixels takes " + std::to_string(table >> 20) +
                  " MiB of memory for the table of its blocks, and " +
                  std::to_string(target.table_bytes >> 20) +
                  " MiB are there for it; give a larger --pixel-size, a --window or more --memory",
              target.path);
}

/// Checks that a block fits the memory of the question, which samples whole blocks.
void check_block(const RasterRequest& request, const RasterTarget& target) {
  const std::int64_t width = std::min(request.block_width, request.pixels.width);
  const std::int64_t height = std::min(request.block_height, request.pixels.height);
  const std::uint64_t bytes = static_cast<std::uint64_t>(width * height) *
                              (request.heights ? sizeof(double) : sizeof(GridNormal));
  if (bytes <= request.limits.memory_bytes) return;
  throw Error(ErrorCode::resource_exhausted,
              "a block of " + std::to_string(width) + " x " + std::to_string(height) +
                  " pixels takes " + std::to_string((bytes - 1) / kMiB + 1) +
                  " MiB of memory, and " + std::to_string(request.limits.memory_bytes / kMiB) +
                  " MiB are there for it; give smaller blocks (--co BLOCKXSIZE=" + kBlockSide +
                  " --co BLOCKYSIZE=" + kBlockSide + ") or more --memory",
              target.path);
}

/// Fills a dataset block by block.
class RasterWriter {
 public:
  /// @param request  What is not asked for yet is set.
  /// @throws Error resource_exhausted  a block does not fit the memory
  RasterWriter(const Terrain& terrain, RasterRequest request, const RasterTarget& target,
               GDALDataset& dataset)
      : terrain_(terrain),
        request_(std::move(request)),
        target_(target),
        band_(*dataset.GetRasterBand(1)),
        per_map_unit_(ground_of(target.crs).per_map_unit) {
    int width = 0;
    int height = 0;
    band_.GetBlockSize(&width, &height);
    request_.block_width = width;
    request_.block_height = height;
    request_.heights = of_heights();
    request_.normals = !of_heights();
    check_block(request_, target);
  }

  WrittenRaster run() {
    const RasterResult result =
        terrain_.raster(request_, [this](const RasterBlock& block) { write(block); });
    return {rounding_, result.surface_pixels};
  }

 private:
  [[nodiscard]] bool of_heights() const { return target_.content.value == PixelValue::kHeight; }

  void write(const RasterBlock& block) {
    if (band_.GetRasterDataType() == GDT_Float64) {
      write_as<double>(block);
    } else if (band_.GetRasterDataType() == GDT_Byte) {
      write_as<std::uint8_t>(block);
    } else {
      write_as<float>(block);
    }
  }

  template <typename T>
  void write_as(const RasterBlock& block) {
    const PixelRect& pixels = block.pixels;
    std::vector<T> values(static_cast<std::size_t>(request_.block_width * request_.block_height),
                          static_cast<T>(target_.nodata));
    for (std::int64_t y = 0; y < pixels.height; ++y) {
      for (std::int64_t x = 0; x < pixels.width; ++x) {
        const std::size_t from =
            static_cast<std::size_t>(y) * block.stride + static_cast<std::size_t>(x);
        const std::optional<double> value =
            of_heights() ? height_of(block.heights[from])
                         : value_of(block.normals[from], pixels.column + x, pixels.row + y);
        if (!value) continue;
        T& written = values[static_cast<std::size_t>(y * request_.block_width + x)];
        written = static_cast<T>(*value);
        // Exact: the two numbers are nearly the same.
        rounding_ = std::max(rounding_,
                             of_heights() ? std::abs(static_cast<double>(written) - *value) : 0.0);
      }
    }
    CPLErrorReset();
    if (band_.WriteBlock(
            static_cast<int>((pixels.column - request_.pixels.column) / request_.block_width),
            static_cast<int>((pixels.row - request_.pixels.row) / request_.block_height),
            values.data()) != CE_None) {
      throw gdal_failure("cannot write the raster", target_.path);
    }
  }

  static std::optional<double> height_of(double height) {
    return std::isnan(height) ? std::nullopt : std::optional(height);
  }

  [[nodiscard]] std::optional<double> value_of(const GridNormal& normal, std::int64_t column,
                                               std::int64_t row) const {
    return value_at(normal, target_.content, terrain_.store().facts(),
                    per_map_unit_(request_.lattice.centre(column, row)));
  }

  const Terrain& terrain_;
  RasterRequest request_;
  const RasterTarget& target_;
  GDALRasterBand& band_;
  std::function<MapPoint(MapPoint)> per_map_unit_;
  double rounding_ = 0.0;
};

/// Refuses options that the driver does not know; GDAL itself only warns of them.
void check_creation_options(GDALDriver* driver, const CPLStringList& options,
                            const std::string& path) {
  CPLErrorReset();
  if (GDALValidateCreationOptions(driver, const_cast<char**>(options.List())) == FALSE) {
    throw Error(ErrorCode::invalid_argument,
                std::string("a --co is refused: ").append(CPLGetLastErrorMsg()), path);
  }
}

GDALDatasetUniquePtr create(const PendingFile& file, const RasterRequest& request,
                            const RasterTarget& target, const StoreFacts& facts) {
  GDALDriver& driver = driver_named("GTiff");
  const CPLStringList options = options_of(target, false);
  check_creation_options(&driver, options, target.path);
  CPLErrorReset();
  GDALDatasetUniquePtr dataset(driver.Create(
      file.temporary().c_str(), static_cast<int>(request.pixels.width),
      static_cast<int>(request.pixels.height), 1, type_of_pixels(facts, target.content.value),
      const_cast<char**>(options.List())));
  if (!dataset) throw gdal_failure("cannot create the raster", target.path);
  auto transform = geotransform_of(request);
  require_done(dataset->SetGeoTransform(transform.data()), "cannot place the raster", target.path);
  set_geotiff_crs(*dataset, target.crs.wkt, target.content.value == PixelValue::kHeight,
                  target.path);
  GDALRasterBand* band = dataset->GetRasterBand(1);
  require_done(band->SetNoDataValue(target.nodata), "cannot set the nodata value", target.path);
  const std::string unit = unit_of_pixels(target.content, target.crs);
  if (!unit.empty()) band->SetUnitType(unit.c_str());
  return dataset;
}

/// Closes a dataset, and throws when its last writes failed: GDALClose() has no result in this
/// GDAL.
void close_checked(GDALDatasetUniquePtr& dataset, const std::string& path) {
  CPLErrorReset();
  GDALClose(dataset.release());
  if (CPLGetLastErrorType() >= CE_Failure) throw gdal_failure("cannot finish the raster", path);
}

struct CopyProgress {
  const std::function<void(double)>& report;
  const std::stop_token& stop;
  static int tell(double done, const char* /*message*/, void* self) {
    const auto& me = *static_cast<const CopyProgress*>(self);
    if (me.report) me.report(0.5 + done / 2);
    return me.stop.stop_requested() ? FALSE : TRUE;
  }
};

void copy_as_cog(const PendingFile& raw, const PendingFile& file, const RasterTarget& target,
                 CopyProgress& progress) {
  GDALDriver& driver = driver_named("COG");
  CPLErrorReset();
  const GDALDatasetUniquePtr source(GDALDataset::Open(raw.temporary().c_str(), GDAL_OF_RASTER));
  if (!source) throw gdal_failure("cannot read the raster back", target.path);
  const CPLStringList options = options_of(target, true);
  check_creation_options(&driver, options, target.path);
  GDALDatasetUniquePtr copy(driver.CreateCopy(file.temporary().c_str(), source.get(), FALSE,
                                              const_cast<char**>(options.List()),
                                              &CopyProgress::tell, &progress));
  stop_if_asked(progress.stop, "the export", target.path);
  if (!copy || CPLGetLastErrorType() >= CE_Failure)
    throw gdal_failure("cannot write the COG", target.path);
  close_checked(copy, target.path);
}

}  // namespace

WrittenRaster export_raster(const Terrain& terrain, RasterRequest request,
                            const RasterTarget& target,
                            const std::function<void(double)>& progress) {
  check_table(request.pixels, target);
  const GdalCacheLimit cache(target.cache_bytes);
  PendingFile file(target.path, target.overwrite);
  std::optional<PendingFile> raw;  // what a COG is copied from
  if (target.is_cog) raw.emplace(target.path + ".raw.tif", true);
  const double share = target.is_cog ? 0.5 : 1.0;
  request.progress = [&](double done) {
    if (progress) progress(done * share);
  };
  GDALDatasetUniquePtr dataset =
      create(raw ? *raw : file, request, target, terrain.store().facts());
  const WrittenRaster written = RasterWriter(terrain, request, target, *dataset).run();
  close_checked(dataset, target.path);
  if (raw) {
    CopyProgress copying{progress, request.limits.stop};
    copy_as_cog(*raw, file, target, copying);
  }
  file.publish();
  return written;
}

}  // namespace ptin::tools
