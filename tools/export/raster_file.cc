// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/export/raster_file.h"

#include <algorithm>
#include <array>
#include <utility>

#include <cpl_string.h>
#include <ogr_spatialref.h>

#include "engine/error.h"
#include "engine/stop.h"
#include "tools/formats/geotiff_crs.h"
#include "tools/output/gdal_output.h"

namespace ptin::tools {

namespace {

CPLStringList options_of(const RasterTarget& target, const RasterForm& form, bool for_copy) {
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
    set("PREDICTOR", GDALDataTypeIsFloating(form.type) != 0 ? "3" : "2");
  if (form.has_signed_bytes) set("PIXELTYPE", "SIGNEDBYTE");
  return options;
}

/// Checks that the table of blocks fits its memory: GDAL keeps the place and the size of every
/// block in memory. For a COG it keeps those of the raster that is copied and of the overviews
/// besides.
void check_table(const RasterForm& form, const RasterTarget& target) {
  const std::int64_t side = std::stoi(kBlockSide);
  const auto across = [&](std::int64_t pixels) {
    return static_cast<std::uint64_t>((pixels + side - 1) / side);
  };
  constexpr std::uint64_t kBytes = 2 * sizeof(std::uint64_t);
  const std::uint64_t copies = target.is_cog ? 3 : 1;
  const std::uint64_t table = copies * kBytes * across(form.width) * across(form.height);
  if (table <= target.table_bytes) return;
  throw Error(ErrorCode::resource_exhausted,
              "a raster of " + std::to_string(form.width) + " x " + std::to_string(form.height) +
                  " pixels takes " + std::to_string(table >> 20) +
                  " MiB of memory for the table of its blocks, and " +
                  std::to_string(target.table_bytes >> 20) +
                  " MiB are there for it; give a larger --pixel-size, a --window or more --memory",
              target.path);
}

/// Refuses options that the driver does not know; GDAL itself only warns of them.
void check_creation_options(GDALDriver* driver, const CPLStringList& options,
                            const std::string& path) {
  CPLErrorReset();
  if (GDALValidateCreationOptions(driver, const_cast<char**>(options.List())) == FALSE) {
    throw Error(ErrorCode::invalid_argument,
                std::string("a --co is refused: ").append(CPLGetLastErrorMsg()), path);
  }
}

GDALDatasetUniquePtr create(const std::string& path, const RasterForm& form,
                            const RasterTarget& target) {
  GDALDriver& driver = driver_named("GTiff");
  const CPLStringList options = options_of(target, form, false);
  check_creation_options(&driver, options, target.path);
  CPLErrorReset();
  GDALDatasetUniquePtr dataset(driver.Create(path.c_str(), static_cast<int>(form.width),
                                             static_cast<int>(form.height), 1, form.type,
                                             const_cast<char**>(options.List())));
  if (!dataset) throw gdal_failure("cannot create the raster", target.path);
  // Before the geotransform, which GDAL writes half a pixel off of points.
  if (form.is_point) dataset->SetMetadataItem(GDALMD_AREA_OR_POINT, GDALMD_AOP_POINT);
  if (form.geotransform) {
    auto transform = *form.geotransform;
    require_done(dataset->SetGeoTransform(transform.data()), "cannot place the raster",
                 target.path);
  }
  set_geotiff_crs(*dataset, target.crs.wkt, target.content.value == PixelValue::kHeight,
                  target.path);
  GDALRasterBand* band = dataset->GetRasterBand(1);
  if (form.nodata) {
    require_done(band->SetNoDataValue(*form.nodata), "cannot set the nodata value", target.path);
  }
  if (form.scale != 1.0) band->SetScale(form.scale);
  if (form.offset != 0.0) band->SetOffset(form.offset);
  if (!form.unit.empty()) band->SetUnitType(form.unit.c_str());
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

void copy_as_cog(const std::string& raw, const std::string& copied_to, const RasterForm& form,
                 const RasterTarget& target, CopyProgress& progress) {
  GDALDriver& driver = driver_named("COG");
  CPLErrorReset();
  const GDALDatasetUniquePtr source(GDALDataset::Open(raw.c_str(), GDAL_OF_RASTER));
  if (!source) throw gdal_failure("cannot read the raster back", target.path);
  const CPLStringList options = options_of(target, form, true);
  check_creation_options(&driver, options, target.path);
  GDALDatasetUniquePtr copy(driver.CreateCopy(copied_to.c_str(), source.get(), FALSE,
                                              const_cast<char**>(options.List()),
                                              &CopyProgress::tell, &progress));
  stop_if_asked(progress.stop, "the export", target.path);
  if (!copy || CPLGetLastErrorType() >= CE_Failure)
    throw gdal_failure("cannot write the COG", target.path);
  close_checked(copy, target.path);
}

}  // namespace

RasterFile::RasterFile(const RasterTarget& target, const RasterForm& form)
    : target_(target), form_((check_table(form, target), form)) {
  if (target.path.starts_with("/vsimem/")) {
    written_ = target.path;
    if (target.is_cog) copied_ = target.path + ".raw.tif";
  } else {
    cache_.emplace(target.cache_bytes);
    file_.emplace(target.path, target.overwrite);
    written_ = file_->temporary();
    if (target.is_cog) copied_ = raw_.emplace(target.path + ".raw.tif", true).temporary();
  }
  dataset_ = create(target.is_cog ? copied_ : written_, form, target);
  for (const auto& [name, value] : target.metadata) describe(name, value);
}

RasterFile::~RasterFile() {
  dataset_.reset();
  if (file_) return;
  for (const std::string& path : {written_, copied_}) {
    if (!path.empty()) VSIUnlink(path.c_str());
  }
}

void RasterFile::describe(const std::string& name, const std::string& value) {
  require_done(dataset_->SetMetadataItem(name.c_str(), value.c_str()), "cannot describe the raster",
               target_.path);
}

void RasterFile::write_block(int column, int row, void* values) {
  CPLErrorReset();
  if (band().WriteBlock(column, row, values) != CE_None) {
    throw gdal_failure("cannot write the raster", target_.path);
  }
}

void RasterFile::publish(const std::function<void(double)>& progress, const std::stop_token& stop) {
  close_checked(dataset_, target_.path);
  if (!copied_.empty()) {
    CopyProgress copying{progress, stop};
    copy_as_cog(copied_, written_, form_, target_, copying);
  }
  if (file_) return file_->publish();
  if (!copied_.empty()) VSIUnlink(copied_.c_str());
  written_.clear();  // It is the caller's now.
  copied_.clear();
}

}  // namespace ptin::tools
