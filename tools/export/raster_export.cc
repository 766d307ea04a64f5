// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/export/raster_export.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "engine/construct/memory_plan.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/stop.h"
#include "tools/export/tin_samples.h"
#include "tools/formats/geotiff_crs.h"
#include "tools/output/gdal_output.h"
#include "tools/output/pending_file.h"

namespace ptin::tools {

namespace {

constexpr const char* kBlockSide = "512";

/// The type of the pixels: of heights Float64 where Float32 does not hold every height of a vertex.
/// Float32 holds whole multiples of a power of two that take at most 24 bits; it does not hold
/// tenths.
GDALDataType type_for(const StoreFacts& facts, PixelValue value) {
  if (value == PixelValue::kHillshade) return GDT_Byte;
  if (value != PixelValue::kHeight) return GDT_Float32;
  const HeightEncoding& heights = facts.heights;
  if (heights.type != HeightType::int32) return GDT_Float32;
  int exponent = 0;
  const bool is_power = std::frexp(heights.step, &exponent) == 0.5;
  const double steps_to_offset = heights.offset / heights.step;
  const double largest = std::max(std::abs(facts.min_height), std::abs(facts.max_height));
  const bool fits = is_power && steps_to_offset == std::trunc(steps_to_offset) &&
                    largest / heights.step <= 0x1p24;
  return fits ? GDT_Float32 : GDT_Float64;
}

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
void check_table(const PixelGrid& grid, const RasterTarget& target) {
  const std::int64_t side = std::stoi(kBlockSide);
  const auto across = [&](std::int64_t pixels) {
    return static_cast<std::uint64_t>((pixels + side - 1) / side);
  };
  constexpr std::uint64_t kBytes = 2 * sizeof(std::uint64_t);
  const std::uint64_t copies = target.is_cog ? 3 : 1;
  const std::uint64_t table = copies * kBytes * across(grid.columns()) * across(grid.rows());
  if (table <= target.table_bytes) return;
  throw Error(ErrorCode::resource_exhausted,
              "a raster of " + std::to_string(grid.columns()) + " x " +
                  std::to_string(grid.rows()) + " pixels takes " + std::to_string(table >> 20) +
                  " MiB of memory for the table of its blocks, and " +
                  std::to_string(target.table_bytes >> 20) +
                  " MiB are there for it; give a larger --pixel-size, a --window or more --memory",
              target.path);
}

/// Fills a dataset, region by region.
class RasterWriter {
 public:
  RasterWriter(TinParts& parts, const PixelGrid& grid, const RasterTarget& target,
               GDALDataset& dataset, const std::function<void(double)>& progress)
      : parts_(parts),
        grid_(grid),
        target_(target),
        band_(*dataset.GetRasterBand(1)),
        per_map_unit_(ground_of(target.crs).per_map_unit),
        progress_(progress) {
    int width = 0;
    int height = 0;
    band_.GetBlockSize(&width, &height);
    block_width_ = width;
    block_height_ = height;
  }

  void run() { write({0, 0, blocks(grid_.columns(), block_width_), rows_of_blocks()}); }

  [[nodiscard]] const WrittenRaster& written() const noexcept { return written_; }

 private:
  static std::int64_t blocks(std::int64_t pixels, std::int64_t side) {
    return (pixels + side - 1) / side;
  }
  [[nodiscard]] std::int64_t rows_of_blocks() const { return blocks(grid_.rows(), block_height_); }
  /// Pixels of a rectangle of blocks, those beyond the raster left out.
  [[nodiscard]] PixelRect pixels_of(const PixelRect& b) const {
    const std::int64_t column = b.column * block_width_;
    const std::int64_t row = b.row * block_height_;
    return {column, row, std::min(b.width * block_width_, grid_.columns() - column),
            std::min(b.height * block_height_, grid_.rows() - row)};
  }
  static std::array<PixelRect, 2> halves(const PixelRect& r) {
    PixelRect first = r;
    PixelRect second = r;
    if (r.width >= r.height) {
      first.width = r.width / 2;
      second.column += first.width;
      second.width -= first.width;
    } else {
      first.height = r.height / 2;
      second.row += first.height;
      second.height -= first.height;
    }
    return {first, second};
  }
  /// Samples and writes a rectangle of blocks: together when the buffers hold it, else half by half.
  void write(const PixelRect& b) {
    const PixelRect rect = pixels_of(b);
    const std::uint64_t pixel_bytes = sizeof(double) + (of_heights() ? 0 : sizeof(GridNormal));
    const bool buffer_fits =
        static_cast<std::uint64_t>(rect.pixels()) * pixel_bytes <= target_.buffer_bytes;
    if (b.pixels() > 1 && !buffer_fits) {
      for (const PixelRect& half : halves(b)) write(half);
      return;
    }
    const auto pixels = static_cast<std::size_t>(rect.pixels());
    if (of_heights()) {
      values_.assign(pixels, std::numeric_limits<double>::quiet_NaN());
      sample_heights(rect);
      const auto is_none = [](double v) { return std::isnan(v); };
      written_.surface_pixels += static_cast<std::uint64_t>(
          std::count_if(values_.begin(), values_.end(), std::not_fn(is_none)));
      std::replace_if(values_.begin(), values_.end(), is_none, target_.nodata);
    } else {
      values_.assign(pixels, target_.nodata);
      normals_.assign(pixels, {});
      sample_normals_of(rect, rect);
      turn_normals_into_values(rect);
    }
    emit(b, rect);
  }

  [[nodiscard]] bool of_heights() const { return target_.content.value == PixelValue::kHeight; }

  void turn_normals_into_values(const PixelRect& rect) {
    const StoreFacts& facts = parts_.terrain().store().facts();
    for (std::size_t i = 0; i < normals_.size(); ++i) {
      if (!(normals_[i].z > 0)) continue;
      ++written_.surface_pixels;
      const auto place = static_cast<std::int64_t>(i);
      const MapPoint centre =
          grid_.centre(rect.column + place % rect.width, rect.row + place / rect.width);
      values_[i] = value_of(slope_of(normals_[i], facts, per_map_unit_(centre)));
    }
  }

  [[nodiscard]] double value_of(const Slope& slope) const {
    const PixelContent& content = target_.content;
    if (content.value == PixelValue::kAspect) return aspect_of(slope).value_or(target_.nodata);
    if (content.value == PixelValue::kHillshade) return grey_of(content.light.on(slope));
    return content.in_percent ? percent_of(slope) : degrees_of(slope);
  }

  void sample_heights(const PixelRect& rect) {
    const GridBox box = grid_.box(rect);
    const StoreFacts& facts = parts_.terrain().store().facts();
    if (!meets(box, facts.bounds)) return;
    HeightSamples samples(facts, grid_, rect, values_);
    parts_.visit(box, [&](const LivingTriangle& t) { samples.add(t); });
  }

  void sample_normals_of(const PixelRect& part, const PixelRect& rect) {
    const GridBox box = grid_.box(part);
    if (!meets(box, parts_.terrain().store().facts().bounds)) return;
    const Tin* tin = parts_.part(box);
    if (tin == nullptr) {
      if (part.pixels() == 1) refuse_pixel();
      for (const PixelRect& half : halves(part)) sample_normals_of(half, rect);
      return;
    }
    const StoreFacts& facts = parts_.terrain().store().facts();
    sample_normals(*tin, facts, grid_, part, rect, normals_);
  }

  [[noreturn]] void refuse_pixel() const {
    throw Error(ErrorCode::resource_exhausted,
                "what meets a single pixel takes more memory than a part may; give more --memory",
                target_.path);
  }

  /// Writes the blocks of `b` in the order in which halving reaches them.
  void emit(const PixelRect& b, const PixelRect& rect) {
    if (b.pixels() > 1) {
      for (const PixelRect& half : halves(b)) emit(half, rect);
      return;
    }
    if (band_.GetRasterDataType() == GDT_Float64) {
      write_block<double>(b, rect);
    } else if (band_.GetRasterDataType() == GDT_Byte) {
      write_block<std::uint8_t>(b, rect);
    } else {
      write_block<float>(b, rect);
    }
    ++blocks_done_;
    if (progress_) {
      const auto all = static_cast<double>(blocks(grid_.columns(), block_width_)) *
                       static_cast<double>(rows_of_blocks());
      progress_(static_cast<double>(blocks_done_) / all);
    }
  }

  template <typename T>
  void write_block(const PixelRect& b, const PixelRect& rect) {
    const PixelRect pixels = pixels_of(b);
    std::vector<T> block(static_cast<std::size_t>(block_width_ * block_height_),
                         static_cast<T>(target_.nodata));
    for (std::int64_t y = 0; y < pixels.height; ++y) {
      const std::int64_t from =
          (pixels.row + y - rect.row) * rect.width + pixels.column - rect.column;
      std::transform(values_.begin() + from, values_.begin() + from + pixels.width,
                     block.begin() + y * block_width_, [&](double value) {
                       const T written = static_cast<T>(value);
                       note_rounding(value, static_cast<double>(written));
                       return written;
                     });
    }
    CPLErrorReset();
    if (band_.WriteBlock(static_cast<int>(b.column), static_cast<int>(b.row), block.data()) !=
        CE_None) {
      throw gdal_failure("cannot write the raster", target_.path);
    }
  }

  void note_rounding(double height, double written) noexcept {
    if (of_heights() && height != target_.nodata) {
      // Exact: the two numbers are nearly the same.
      written_.rounding = std::max(written_.rounding, std::abs(written - height));
    }
  }

  TinParts& parts_;
  const PixelGrid& grid_;
  const RasterTarget& target_;
  GDALRasterBand& band_;
  std::function<MapPoint(MapPoint)> per_map_unit_;
  const std::function<void(double)>& progress_;
  std::int64_t block_width_ = 0;
  std::int64_t block_height_ = 0;
  std::int64_t blocks_done_ = 0;
  WrittenRaster written_;
  std::vector<double> values_;
  std::vector<GridNormal> normals_;  ///< Beside `values_`; empty when these are heights.
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

/// The unit of the pixels; empty when it is unknown, or there is none.
std::string unit_of(const RasterTarget& target) {
  switch (target.content.value) {
    case PixelValue::kHeight:
      return target.crs.vertical_unit == "unknown" ? "" : target.crs.vertical_unit;
    case PixelValue::kSlope:
      return target.content.in_percent ? "percent" : "degree";
    case PixelValue::kAspect:
      return "degree";
    case PixelValue::kHillshade:
      break;
  }
  return {};
}

GDALDatasetUniquePtr create(const PendingFile& file, const PixelGrid& grid,
                            const RasterTarget& target, const StoreFacts& facts) {
  GDALDriver& driver = driver_named("GTiff");
  const CPLStringList options = options_of(target, false);
  check_creation_options(&driver, options, target.path);
  CPLErrorReset();
  GDALDatasetUniquePtr dataset(driver.Create(
      file.temporary().c_str(), static_cast<int>(grid.columns()), static_cast<int>(grid.rows()), 1,
      type_for(facts, target.content.value), const_cast<char**>(options.List())));
  if (!dataset) throw gdal_failure("cannot create the raster", target.path);
  auto transform = grid.geotransform();
  require_done(dataset->SetGeoTransform(transform.data()), "cannot place the raster", target.path);
  set_geotiff_crs(*dataset, target.crs.wkt, target.content.value == PixelValue::kHeight,
                  target.path);
  GDALRasterBand* band = dataset->GetRasterBand(1);
  require_done(band->SetNoDataValue(target.nodata), "cannot set the nodata value", target.path);
  const std::string unit = unit_of(target);
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

double default_nodata(const StoreFacts& facts, PixelValue value) noexcept {
  constexpr double kUsual = -9999.0;
  if (value == PixelValue::kHillshade) return 0.0;
  if (value != PixelValue::kHeight || !(facts.min_height <= kUsual && kUsual <= facts.max_height))
    return kUsual;
  return static_cast<double>(std::numeric_limits<float>::lowest());
}

WrittenRaster export_raster(TinParts& parts, const PixelGrid& grid, const RasterTarget& target,
                            const std::function<void(double)>& progress) {
  check_table(grid, target);
  const GdalCacheLimit cache(target.buffer_bytes);
  PendingFile file(target.path, target.overwrite);
  const StoreFacts& facts = parts.terrain().store().facts();
  WrittenRaster written;
  if (!target.is_cog) {
    GDALDatasetUniquePtr dataset = create(file, grid, target, facts);
    RasterWriter writer(parts, grid, target, *dataset, progress);
    writer.run();
    written = writer.written();
    close_checked(dataset, target.path);
  } else {
    const PendingFile raw(target.path + ".raw.tif", true);
    const std::function<void(double)> first_half = [&](double done) {
      if (progress) progress(done / 2);
    };
    GDALDatasetUniquePtr dataset = create(raw, grid, target, facts);
    RasterWriter writer(parts, grid, target, *dataset, first_half);
    writer.run();
    written = writer.written();
    close_checked(dataset, target.path);
    CopyProgress copying{progress, parts.request().limits.stop};
    copy_as_cog(raw, file, target, copying);
  }
  file.publish();
  return written;
}

}  // namespace ptin::tools
