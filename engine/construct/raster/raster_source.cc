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
struct RasterSource::Impl {
  explicit Impl(RasterMosaic files) : mosaic(std::move(files)) {}

  TerrainFrame frame;
  std::int64_t width = 0, height = 0;
  std::uint64_t valid_samples = 0;
  SourceWarnings warnings;
  RawType raw = RawType::kInt32;
  double scale = 1.0, offset = 0.0;

  std::mutex mutex;  ///< Guards the mosaic.
  RasterMosaic mosaic;

  void take_unit(const std::string& declared, const std::string& path,
                 const SourceOptions& options);
  void take_plane_unit(const std::string& path);
  void frame_mosaic(const std::string& path, const SourceOptions& options);
  void check_size() const;
  void warn_of(const std::vector<RasterSuspects::Suspect>& suspects);
  [[nodiscard]] static std::unique_ptr<Impl> opened(const std::vector<std::string>& paths,
                                                    const SourceOptions& options);
};

// ---------------------------------------------------------------------------------------------------
// Opening.

/// Takes the unit that the bands declare where the CRS has none; warns where the two differ, and of one
/// that is not known unless the caller names a vertical CRS.
void RasterSource::Impl::take_unit(const std::string& declared, const std::string& path,
                                   const SourceOptions& options) {
  const std::string unit = height_unit_named(declared);
  if (unit != "unknown" && !metres_in(unit) &&
      (frame.vertical_unit == "unknown" || options.vertical_crs.empty())) {
    warnings.add({"unknown_height_unit",
                  "the unit of the heights, '" + declared +
                      "', is none that is known, so nothing is converted; name a vertical CRS with "
                      "--vertical-crs, or a unit such as 'metre' with 'gdal_edit.py -units'",
                  path});
  }
  if (frame.vertical_unit == "unknown") {
    frame.vertical_unit = unit;
    return;
  }
  const std::optional<double> said = metres_in(unit);
  const std::optional<double> meant = metres_in(height_unit_named(frame.vertical_unit));
  if (said && meant && *said != *meant) {
    warnings.add({"height_unit",
                  "the band says that heights are in '" + declared +
                      "', and the vertical CRS that they are in '" + frame.vertical_unit +
                      "', which is believed; if the band is right, name another one with "
                      "--vertical-crs",
                  path});
  }
}

/// Takes the unit of x and y that the first file states beside a CRS. Degrees without a CRS have no
/// length over ground, so there is a warning.
void RasterSource::Impl::take_plane_unit(const std::string& path) {
  const std::string& unit = mosaic.first().plane_unit;
  if (!frame.crs_wkt.empty() || unit.empty()) {
    return;
  }
  frame.horizontal_unit = unit;
  if (unit != "degree") {
    return;
  }
  warnings.add({"degrees_without_crs",
                "x and y are in degrees, of no CRS that it tells, so lengths over ground are not "
                "known; name it with --a-srs, as EPSG:4326",
                path});
}

/// Takes over what the files say: types, CRS, units and the map, bounds applied.
/// @param path  The first file, for errors.
void RasterSource::Impl::frame_mosaic(const std::string& path, const SourceOptions& options) {
  const RasterShape& first = mosaic.first();
  raw = first.raw;
  scale = first.scale;
  offset = first.offset;
  set_crs(frame, resolve_source_crs({first.crs, ""}, options, path, warnings));
  take_plane_unit(path);
  take_unit(mosaic.unit(), path, options);
  frame.map = mosaic.map();
  require_resolvable(frame.map, mosaic.width() - 1, mosaic.height() - 1,
                     "is its geotransform what was meant?", path);
  require_latitudes(frame, mosaic.height() - 1, path);
  if (options.bbox) {
    mosaic.crop(*options.bbox);
    frame.map = mosaic.map();
  }
  width = mosaic.width();
  height = mosaic.height();
}

void RasterSource::Impl::check_size() const {
  if (width < 2 || height < 2) {
    refuse("a terrain of " + std::to_string(width) + " x " + std::to_string(height) +
               " samples has no area: all of them are collinear; at least 2 x 2 are needed",
           mosaic.context());
  }
  if (width - 1 > kGridMax || height - 1 > kGridMax) {
    refuse("the terrain has more than 2^30 columns or rows, which is the limit of the grid",
           mosaic.context());
  }
}

/// Values that may stand for no height, each with its first place in map units.
void RasterSource::Impl::warn_of(const std::vector<RasterSuspects::Suspect>& suspects) {
  for (const RasterSuspects::Suspect& s : suspects) {
    const auto columns = static_cast<std::uint64_t>(width);
    const auto x = static_cast<std::int64_t>(s.first % columns);
    const std::int64_t y = height - 1 - static_cast<std::int64_t>(s.first / columns);
    const MapPoint p = frame.map.to_map(static_cast<double>(x), static_cast<double>(y));
    char value[32], text[256];
    std::snprintf(value, sizeof value, "%.9g", s.value);
    std::snprintf(text, sizeof text,
                  "the stored value %s lies apart from all others and is taken for a height, as at "
                  "x %.12g, y %.12g; if it means none, build with --nodata %s",
                  value, p.x, p.y, value);
    warnings.add({"undeclared_nodata", text, mosaic.path_at(x, y), value, 0, s.count});
  }
}

/// The files opened and looked over, no sample read.
std::unique_ptr<RasterSource::Impl> RasterSource::Impl::opened(
    const std::vector<std::string>& paths, const SourceOptions& options) {
  auto impl = std::make_unique<Impl>(RasterMosaic(paths, options));
  impl->frame_mosaic(paths.front(), options);
  impl->check_size();
  return impl;
}

RasterSource RasterSource::open(const std::vector<std::string>& paths, const SourceOptions& options,
                                const RunTasks& run) {
  auto impl = Impl::opened(paths, options);
  RasterScan scan(impl->mosaic.duplicate());
  TaskList tasks = scan.tasks();
  run(tasks, scan);
  const RasterScan::Joined found = scan.join(tasks.results());
  set_heights(impl->frame, found.fit);
  impl->valid_samples = found.fit.count;
  impl->warnings.join(warnings_that_count(impl->mosaic.warnings(), options));
  impl->warn_of(found.suspects);
  return RasterSource(std::move(impl));
}

std::unique_ptr<TaskWorker> RasterSource::open_to_scan(const std::vector<std::string>& paths,
                                                       const SourceOptions& options) {
  return std::make_unique<RasterScan>(std::move(Impl::opened(paths, options)->mosaic));
}

ArrayFileFacts RasterSource::save(FileLayer& files, const std::string& index) const {
  ArrayFileWriter file(files, index);
  put_frame(file, impl_->frame);
  file.put(std::span<const std::uint64_t>(&impl_->valid_samples, 1));
  file.sync();
  return file.finish();
}

RasterSource RasterSource::take_up(const std::vector<std::string>& paths,
                                   const SourceOptions& options, const std::string& index,
                                   const ArrayFileFacts& facts) {
  auto impl = Impl::opened(paths, options);
  ArrayFileReader file(index, facts);
  impl->frame = take_frame(file);
  impl->valid_samples = file.take<std::uint64_t>()[0];
  file.require_undamaged();
  return RasterSource(std::move(impl));
}

RasterSource::RasterSource(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RasterSource::RasterSource(RasterSource&&) noexcept = default;
RasterSource& RasterSource::operator=(RasterSource&&) noexcept = default;
RasterSource::~RasterSource() = default;

RasterSource RasterSource::duplicate() const {
  const std::lock_guard lock(impl_->mutex);
  auto copy = std::make_unique<Impl>(impl_->mosaic.duplicate());
  copy->frame = impl_->frame;
  copy->width = impl_->width;
  copy->height = impl_->height;
  copy->valid_samples = impl_->valid_samples;
  copy->raw = impl_->raw;
  copy->scale = impl_->scale;
  copy->offset = impl_->offset;
  return RasterSource(std::move(copy));
}

// ---------------------------------------------------------------------------------------------------
// Reading windows.

void RasterSource::read(std::int64_t x0, std::int64_t y0, std::int64_t w, std::int64_t h,
                        std::span<HeightBits> heights, std::span<std::uint8_t> valid) const {
  const bool inside =
      x0 >= 0 && y0 >= 0 && w > 0 && h > 0 && x0 <= width() - w && y0 <= height() - h;
  if (!inside || heights.size() != static_cast<std::size_t>(w * h) ||
      valid.size() != heights.size()) {
    throw Error(ErrorCode::invalid_argument,
                "a window of samples must lie inside the terrain, and its arrays be of its size");
  }
  const SampleRange window{x0, y0, w, h};
  const std::lock_guard lock(impl_->mutex);
  const auto read_as = [&]<class T>(std::span<T> raw, auto to_bits) {
    impl_->mosaic.read<T>(window, raw, valid);
    for (std::size_t i = 0; i < heights.size(); ++i) {
      heights[i] = valid[i] ? to_bits(raw[i]) : 0;
    }
  };
  switch (impl_->raw) {
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
        return encode_height(impl_->frame.heights, impl_->offset + impl_->scale * v);
      });
    }
  }
}

const TerrainFrame& RasterSource::frame() const noexcept { return impl_->frame; }
std::int64_t RasterSource::width() const noexcept { return impl_->width; }
std::int64_t RasterSource::height() const noexcept { return impl_->height; }
std::uint64_t RasterSource::valid_samples() const noexcept { return impl_->valid_samples; }
const SourceWarnings& RasterSource::warnings() const noexcept { return impl_->warnings; }

std::uint64_t RasterSource::void_samples() const noexcept {
  return static_cast<std::uint64_t>(width()) * static_cast<std::uint64_t>(height()) -
         valid_samples();
}

}  // namespace ptin
