// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_source.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/frame_file.h"
#include "engine/construct/grid/grid_precision.h"
#include "engine/construct/grid/height_fit.h"
#include "engine/construct/raster/raster_mosaic.h"
#include "engine/construct/raster/raster_scan.h"
#include "engine/crs/height_unit.h"
#include "engine/error.h"
#include "engine/geometry/point.h"

namespace ptin {

namespace {

constexpr const char* kLostVoids =
    "each number of a VRT, or what stood in each of the samples without a height";
constexpr const char* kLostNumbers = "each of the numbers that were rounded to heights";

SourceNumber number_of(const StoredType& stored) {
  switch (stored.type) {
    case GDT_Byte:
      return stored.signed_bytes ? SourceNumber::kInt8 : SourceNumber::kUInt8;
    case GDT_UInt16:
      return SourceNumber::kUInt16;
    case GDT_Int16:
      return SourceNumber::kInt16;
    case GDT_UInt32:
      return SourceNumber::kUInt32;
    case GDT_Int32:
      return SourceNumber::kInt32;
    case GDT_Float32:
      return SourceNumber::kFloat32;
    case GDT_Float64:
      return SourceNumber::kFloat64;
    default:
      return SourceNumber::kUnknown;
  }
}

/// Whether the heights are the numbers from which they were made, bit for bit.
bool are_given_back(const HeightEncoding& encoding, std::span<const HeightBits> heights,
                    std::span<const double> numbers, std::span<const std::uint8_t> valid) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (valid[i] != 0 && std::bit_cast<std::uint64_t>(encoding.height(heights[i])) !=
                             std::bit_cast<std::uint64_t>(numbers[i])) {
      return false;
    }
  }
  return true;
}

}  // namespace

// ---------------------------------------------------------------------------------------------------
// Opening.

/// Takes the unit that the bands declare where the CRS has none; warns where the two differ, and of one
/// that is not known unless the caller names a vertical CRS.
void RasterSource::take_unit(const std::string& declared, const std::string& path,
                             const SourceOptions& options) {
  const std::string unit = height_unit_named(declared);
  if (unit != "unknown" && !metres_in(unit) &&
      (frame_.vertical_unit == "unknown" || options.vertical_crs.empty())) {
    warnings_.add(
        {"unknown_height_unit",
         "the unit of the heights, '" + declared +
             "', is none that is known, so nothing is converted; name a vertical CRS with "
             "--vertical-crs, or a unit such as 'metre' with 'gdal_edit.py -units'",
         path});
  }
  if (frame_.vertical_unit == "unknown") {
    frame_.vertical_unit = unit;
    return;
  }
  const std::optional<double> said = metres_in(unit);
  const std::optional<double> meant = metres_in(height_unit_named(frame_.vertical_unit));
  if (said && meant && *said != *meant) {
    warnings_.add({"height_unit",
                   "the band says that heights are in '" + declared +
                       "', and the vertical CRS that they are in '" + frame_.vertical_unit +
                       "', which is believed; if the band is right, name another one with "
                       "--vertical-crs",
                   path});
  }
}

/// Takes the unit of x and y that the first file states beside a CRS. Degrees without a CRS have no
/// length over ground, so there is a warning.
void RasterSource::take_plane_unit(const std::string& path) {
  const std::string& unit = mosaic_.first().plane_unit;
  if (!frame_.crs_wkt.empty() || unit.empty()) {
    return;
  }
  frame_.horizontal_unit = unit;
  if (unit != "degree") {
    return;
  }
  warnings_.add({"degrees_without_crs",
                 "x and y are in degrees, of no CRS that it tells, so lengths over ground are not "
                 "known; name it with --a-srs, as EPSG:4326",
                 path});
}

/// Takes over what the files say: types, CRS, units and the map, bounds applied.
/// @param path  The first file, for errors.
void RasterSource::frame_mosaic(const std::string& path, const SourceOptions& options) {
  const RasterShape& first = mosaic_.first();
  set_crs(frame_, resolve_source_crs({first.crs, ""}, options, path, warnings_));
  take_plane_unit(path);
  take_unit(mosaic_.unit(), path, options);
  frame_.map = mosaic_.map();
  require_resolvable(frame_.map, mosaic_.width() - 1, mosaic_.height() - 1,
                     "is its geotransform what was meant?", path);
  require_latitudes(frame_, mosaic_.height() - 1, path);
  if (options.bbox) {
    mosaic_.crop(*options.bbox);
    frame_.map = mosaic_.map();
  }
}

void RasterSource::check_size() const {
  if (width() < 2 || height() < 2) {
    refuse("a terrain of " + std::to_string(width()) + " x " + std::to_string(height()) +
               " samples has no area: all of them are collinear; at least 2 x 2 are needed",
           mosaic_.context());
  }
  if (width() - 1 > kGridMax || height() - 1 > kGridMax) {
    refuse("the terrain has more than 2^30 columns or rows, which is the limit of the grid",
           mosaic_.context());
  }
}

/// Values that may stand for no height, each with its first place in map units.
void RasterSource::warn_of(const std::vector<RasterSuspects::Suspect>& suspects) {
  for (const RasterSuspects::Suspect& s : suspects) {
    const auto columns = static_cast<std::uint64_t>(width());
    const auto x = static_cast<std::int64_t>(s.first % columns);
    const std::int64_t y = height() - 1 - static_cast<std::int64_t>(s.first / columns);
    const MapPoint p = frame_.map.to_map(static_cast<double>(x), static_cast<double>(y));
    char value[32], text[256];
    std::snprintf(value, sizeof value, "%.9g", s.value);
    std::snprintf(text, sizeof text,
                  "the stored value %s lies apart from all others and is taken for a height, as at "
                  "x %.12g, y %.12g; if it means none, build with --nodata %s",
                  value, p.x, p.y, value);
    warnings_.add({"undeclared_nodata", text, mosaic_.path_at(x, y), value, 0, s.count});
  }
}

/// The files opened and looked over, no sample read.
RasterSource RasterSource::opened(const std::vector<std::string>& paths,
                                  const SourceOptions& options) {
  RasterSource source{RasterMosaic(paths, options)};
  source.frame_mosaic(paths.front(), options);
  source.check_size();
  return source;
}

RasterSource RasterSource::open(const std::vector<std::string>& paths, const SourceOptions& options,
                                const RunTasks& run) {
  RasterSource source = opened(paths, options);
  RasterScan scan(source.mosaic_.duplicate());
  TaskList tasks = scan.tasks();
  run(tasks, scan);
  const RasterScan::Joined found = scan.join(tasks.results());
  set_heights(source.frame_, found.fit);
  source.valid_samples_ = found.fit.count;
  source.warnings_.join(warnings_that_count(source.mosaic_.warnings(), options));
  source.warn_of(found.suspects);
  warn_of_no_crs(source.frame_, paths.front(), source.warnings_);
  return source;
}

std::unique_ptr<TaskWorker> RasterSource::open_to_scan(const std::vector<std::string>& paths,
                                                       const SourceOptions& options) {
  return std::make_unique<RasterScan>(std::move(opened(paths, options).mosaic_));
}

ArrayFileFacts RasterSource::save(FileLayer& files, const std::string& index) const {
  ArrayFileWriter file(files, index);
  file.values(frame_, valid_samples_);
  file.sync();
  return file.finish();
}

RasterSource RasterSource::take_up(const std::vector<std::string>& paths,
                                   const SourceOptions& options, const std::string& index,
                                   const ArrayFileFacts& facts) {
  RasterSource source = opened(paths, options);
  ArrayFileReader file(index, facts);
  file.values(source.frame_, source.valid_samples_);
  return source;
}

RasterSource RasterSource::duplicate() const {
  const std::lock_guard lock(*mutex_);
  RasterSource copy(mosaic_.duplicate());
  copy.frame_ = frame_;
  copy.valid_samples_ = valid_samples_;
  return copy;
}

// ---------------------------------------------------------------------------------------------------
// What is kept of a raster.

KeptRaster RasterSource::kept() const {
  const RasterShape& shape = mosaic_.first();
  const bool is_scaled = shape.scale != 1.0 || shape.offset != 0.0;
  KeptRaster kept{number_of(shape.stored), shape.nodata, shape.geotransform, shape.is_point, ""};
  if (!mosaic_.is_one_file()) {
    kept.lost = "which sample was of which of its rasters";
  } else if (mosaic_.is_cropped()) {
    kept.lost = "what lies outside of the --bbox of its build";
  } else if (shape.is_overridden) {
    kept.lost = "the nodata value in whose place its build was given --nodata";
  } else if (shape.is_masked) {
    kept.lost = "the mask that told which samples count";
  } else if (kept.number == SourceNumber::kUnknown) {
    kept.lost = "the type " + shape.type_name + " of its numbers";
  } else if (is_scaled && shape.raw != RawType::kInt32) {
    kept.lost = "each of the numbers that a scale and an offset made heights";
  }
  return kept;
}

// ---------------------------------------------------------------------------------------------------
// Reading windows.

void RasterSource::read(const SampleRange& window, std::span<HeightBits> heights,
                        std::span<std::uint8_t> valid) const {
  read_samples(window, heights, valid, nullptr);
}

void RasterSource::read(const SampleRange& window, std::span<HeightBits> heights,
                        std::span<std::uint8_t> valid, KeptRaster& kept) const {
  read_samples(window, heights, valid, kept.lost.empty() ? &kept : nullptr);
}

/// @param kept  Null: nobody wants to know.
void RasterSource::read_samples(const SampleRange& window, std::span<HeightBits> heights,
                                std::span<std::uint8_t> valid, KeptRaster* kept) const {
  const bool inside = window.x0 >= 0 && window.y0 >= 0 && window.width > 0 && window.height > 0 &&
                      window.x0 <= width() - window.width && window.y0 <= height() - window.height;
  if (!inside || heights.size() != window.samples() || valid.size() != heights.size()) {
    throw Error(ErrorCode::invalid_argument,
                "a window of samples must lie inside the terrain, and its arrays be of its size");
  }
  const std::lock_guard lock(*mutex_);
  const auto read_as = [&]<class T>(std::span<T> raw, auto to_bits) {
    mosaic_.read<T>(window, raw, valid);
    if (kept != nullptr && !mosaic_.gives_back<T>(window, raw, valid)) kept->lost = kLostVoids;
    for (std::size_t i = 0; i < heights.size(); ++i) {
      heights[i] = valid[i] ? to_bits(raw[i]) : 0;
    }
  };
  switch (mosaic_.first().raw) {
    case RawType::kInt32:  // in place: signed and unsigned may share memory
      read_as(std::span(reinterpret_cast<std::int32_t*>(heights.data()), heights.size()),
              [](std::int32_t v) { return std::bit_cast<HeightBits>(v); });
      break;
    case RawType::kFloat32: {
      std::vector<float> values(heights.size());
      read_as(std::span(values), [](float v) { return std::bit_cast<HeightBits>(v); });
      break;
    }
    case RawType::kFloat64: {
      std::vector<double> values(heights.size());
      read_as(std::span(values), [&](double v) {
        return encode_height(frame_.heights, mosaic_.first().offset + mosaic_.first().scale * v);
      });
      if (kept != nullptr && !are_given_back(frame_.heights, heights, values, valid)) {
        kept->lost = kLostNumbers;
      }
    }
  }
}

}  // namespace ptin
