// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_source.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <mutex>
#include <utility>

#include <sys/resource.h>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/grid_precision.h"
#include "engine/construct/grid/height_fit.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/raster/raster_part.h"
#include "engine/crs/height_unit.h"
#include "engine/error.h"
#include "engine/geometry/point.h"
#include "engine/stop.h"

namespace ptin {
namespace {

/// Most files of a mosaic that one source has open at once.
constexpr std::size_t kMostOpenFiles = 64;
/// Descriptors left for all else: GDAL keeps up to 100 files of VRTs open, and a build has files of
/// its own.
constexpr std::size_t kOtherFiles = 256;

/// How many files each of `sources` sources may have open, so that all of them together stay within
/// the descriptors of the process (often 1024).
std::size_t most_open_files(std::size_t sources) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) {
    return kMostOpenFiles;
  }
  const auto all = static_cast<std::size_t>(limit.rlim_cur);
  const std::size_t ours = std::max(all / 2, all - std::min(all, kOtherFiles));
  return std::clamp<std::size_t>(ours / sources, 1, kMostOpenFiles);
}

/// About how many samples the first reading looks at together.
constexpr std::int64_t kScanSamples = std::int64_t{1} << 20;

/// The parts of a step by which the samples of another file and the bounds of `bbox` may miss the
/// grid.
constexpr double kFileSlack = 0.01;
constexpr double kBoundsSlack = 1e-6;

struct PlacedPart {
  RasterPart part;
  std::int64_t x = 0, y = 0;    ///< Of its south-western sample, in the terrain.
  std::uint64_t last_used = 0;  ///< Impl::clock at that time.
};

/// Why `b` cannot stand beside `a` in one terrain; empty when it can.
std::string mismatch(const RasterShape& a, const RasterShape& b, bool compare_crs) {
  if (!a.georeferenced || !b.georeferenced) {
    return "several rasters make one terrain only where each has a geotransform";
  }
  if (a.type_name != b.type_name || a.scale != b.scale || a.offset != b.offset) {
    return "its type, scale or offset (" + b.type_name + ") is not that of the first raster (" +
           a.type_name + "); rewrite it with 'gdal_translate -ot " + a.type_name + "'";
  }
  if (compare_crs && !is_same_crs(a.crs, b.crs)) {
    return "its CRS is not that of the first raster; warp it with 'gdalwarp -t_srs', or name the "
           "CRS of all by --a-srs";
  }
  const auto extent = static_cast<double>(std::max({a.width, a.height, b.width, b.height}));
  if (std::abs(b.map.step_x / a.map.step_x - 1.0) * extent > kFileSlack ||
      std::abs(b.map.step_y / a.map.step_y - 1.0) * extent > kFileSlack) {
    return "its pixel size is not that of the first raster; warp it with 'gdalwarp -tr'";
  }
  return "";
}

/// Whole steps from `a` to `b`. Refuses the file `path`, whose origin is `b`, when their difference
/// is not near to a whole number of steps.
std::int64_t steps_between(double a, double b, double step, const std::string& path) {
  const double steps = (b - a) / step;
  if (!(std::abs(steps) <= 2.0 * kGridMax)) {
    refuse("it lies more than 2^30 pixels from the first raster", path);
  }
  if (std::abs(steps - std::nearbyint(steps)) > kFileSlack) {
    refuse(
        "its samples lie between those of the first raster; warp it onto that grid with "
        "'gdalwarp -tap' or '-te'",
        path);
  }
  return std::llround(steps);
}

}  // namespace

struct RasterSource::Impl {
  TerrainFrame frame;
  std::int64_t width = 0, height = 0;
  std::uint64_t valid_samples = 0;
  RawType raw = RawType::kInt32;
  double scale = 1.0, offset = 0.0;

  std::mutex mutex;  ///< Guards what follows.
  std::vector<PlacedPart> parts;
  std::uint64_t clock = 0;
  /// This source and its duplicates, which share the descriptors of the process.
  std::shared_ptr<std::atomic<std::size_t>> sharers = std::make_shared<std::atomic<std::size_t>>(1);

  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() { --*sharers; }

  [[nodiscard]] std::string context() const {
    return parts.size() == 1
               ? parts[0].part.path()
               : parts[0].part.path() + " and " + std::to_string(parts.size() - 1) + " more";
  }

  void open_parts(const std::vector<std::string>& paths, const SourceOptions& options);
  void place();
  void crop(const SourceOptions::Bounds& bounds);
  void check_size() const;
  void scan(const std::stop_token& stop, const Progress& progress);
  template <class T>
  void scan_as(const std::stop_token& stop, const Progress& progress);
  [[nodiscard]] SampleRange scan_step() const;

  void touch(PlacedPart& placed);
  template <class T>
  void read_raw(const SampleRange& w, std::span<T> values, std::span<std::uint8_t> valid);
  template <class T>
  void overlay(PlacedPart& placed, const SampleRange& w, std::span<T> values,
               std::span<std::uint8_t> valid);
};

// ---------------------------------------------------------------------------------------------------
// Opening.

void RasterSource::Impl::open_parts(const std::vector<std::string>& paths,
                                    const SourceOptions& options) {
  if (paths.empty()) {
    refuse("no raster was named", "");
  }
  parts.reserve(paths.size());
  for (const std::string& path : paths) {
    parts.push_back({RasterPart(path, options.nodata)});
    touch(parts.back());
    const std::string problem =
        parts.size() == 1
            ? ""
            : mismatch(parts[0].part.shape(), parts.back().part.shape(), options.a_srs.empty());
    if (!problem.empty()) {
      refuse(problem, path);
    }
  }
  const RasterShape& first = parts[0].part.shape();
  raw = first.raw;
  scale = first.scale;
  offset = first.offset;
  const Crs crs = resolve_crs(first.crs, options.a_srs, options.vertical_crs);
  set_crs(frame, crs);
  if (frame.vertical_unit == "unknown") {
    frame.vertical_unit = height_unit_named(first.unit);
  }
  place();
  require_resolvable(frame.map, width - 1, height - 1, "is its geotransform what was meant?",
                     paths.front());
  require_latitudes(frame, height - 1, paths.front());
}

/// Gives each part its place on the common grid, whose origin is the south-western corner of all.
void RasterSource::Impl::place() {
  const AffineMap map = parts[0].part.shape().map;
  std::int64_t west = 0, south = 0, east = 0, north = 0;
  for (PlacedPart& p : parts) {
    const RasterShape& shape = p.part.shape();
    p.x = steps_between(map.origin_x, shape.map.origin_x, map.step_x, p.part.path());
    p.y = steps_between(map.origin_y, shape.map.origin_y, map.step_y, p.part.path());
    west = std::min(west, p.x);
    south = std::min(south, p.y);
    east = std::max(east, p.x + shape.width);
    north = std::max(north, p.y + shape.height);
  }
  for (PlacedPart& p : parts) {
    p.x -= west;
    p.y -= south;
  }
  width = east - west;
  height = north - south;
  const MapPoint origin = map.to_map(static_cast<double>(west), static_cast<double>(south));
  frame.map = {origin.x, origin.y, map.step_x, map.step_y};
}

void RasterSource::Impl::crop(const SourceOptions::Bounds& b) {
  const auto range = [&](double low, double high, double origin, double step, std::int64_t count) {
    if (!(std::isfinite(low) && std::isfinite(high) && low <= high)) {
      refuse("the bounds must be finite, and each minimum at most its maximum", context());
    }
    const double last = static_cast<double>(count - 1);
    const double first_step = std::ceil((low - origin) / step - kBoundsSlack);
    const double last_step = std::floor((high - origin) / step + kBoundsSlack);
    if (first_step > last || last_step < 0 || first_step > last_step) {
      refuse("no sample lies in the bounds; samples reach from " + std::to_string(origin) + " to " +
                 std::to_string(origin + step * last),
             context());
    }
    return std::pair{static_cast<std::int64_t>(std::max(first_step, 0.0)),
                     static_cast<std::int64_t>(std::min(last_step, last))};
  };
  const auto [x0, x1] = range(b.min_x, b.max_x, frame.map.origin_x, frame.map.step_x, width);
  const auto [y0, y1] = range(b.min_y, b.max_y, frame.map.origin_y, frame.map.step_y, height);
  for (PlacedPart& p : parts) {
    p.x -= x0;
    p.y -= y0;
  }
  width = x1 - x0 + 1;
  height = y1 - y0 + 1;
  const MapPoint origin = frame.map.to_map(static_cast<double>(x0), static_cast<double>(y0));
  frame.map.origin_x = origin.x;
  frame.map.origin_y = origin.y;
}

void RasterSource::Impl::check_size() const {
  if (width < 2 || height < 2) {
    refuse("a terrain of " + std::to_string(width) + " x " + std::to_string(height) +
               " samples has no area: all of them are collinear; at least 2 x 2 are needed",
           context());
  }
  if (width - 1 > kGridMax || height - 1 > kGridMax) {
    refuse("the terrain has more than 2^30 columns or rows, which is the limit of the grid",
           context());
  }
}

RasterSource RasterSource::open(const std::vector<std::string>& paths, const SourceOptions& options,
                                const std::stop_token& stop, const Progress& progress) {
  auto impl = std::make_unique<Impl>();
  impl->open_parts(paths, options);
  if (options.bbox) {
    impl->crop(*options.bbox);
  }
  impl->check_size();
  impl->scan(stop, progress);
  return RasterSource(std::move(impl));
}

RasterSource::RasterSource(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RasterSource::RasterSource(RasterSource&&) noexcept = default;
RasterSource& RasterSource::operator=(RasterSource&&) noexcept = default;
RasterSource::~RasterSource() = default;

RasterSource RasterSource::duplicate() const {
  auto copy = std::make_unique<Impl>();
  copy->frame = impl_->frame;
  copy->width = impl_->width;
  copy->height = impl_->height;
  copy->valid_samples = impl_->valid_samples;
  copy->raw = impl_->raw;
  copy->scale = impl_->scale;
  copy->offset = impl_->offset;
  const std::lock_guard lock(impl_->mutex);
  copy->sharers = impl_->sharers;
  ++*copy->sharers;
  for (PlacedPart& p : impl_->parts) {
    copy->parts.push_back({p.part.closed_copy(), p.x, p.y});
    if (impl_->parts.size() > 1) {  // from now on the copies read, mostly
      p.part.close();
    }
  }
  return RasterSource(std::move(copy));
}

// ---------------------------------------------------------------------------------------------------
// The first reading.

/// The size of the windows of the first reading: whole rows where the blocks of the file are whole
/// rows, else a few blocks side by side.
SampleRange RasterSource::Impl::scan_step() const {
  const auto [block_width, block_height] = parts[0].part.shape().block;
  const std::int64_t columns =
      block_width >= parts[0].part.shape().width
          ? width
          : std::min<std::int64_t>(width,
                                   std::max<std::int64_t>(4096 / block_width, 1) * block_width);
  const std::int64_t rows = std::max<std::int64_t>(kScanSamples / columns, 1);
  return {0, 0, columns, rows > block_height ? rows / block_height * block_height : rows};
}

template <class T>
void RasterSource::Impl::scan_as(const std::stop_token& stop, const Progress& progress) {
  static constexpr bool kWhole = std::is_integral_v<T>;
  HeightScan heights(std::is_same_v<T, float> ? HeightScan::Given::kFloat32
                                              : HeightScan::Given::kFloat64);
  T low = std::numeric_limits<T>::max(), high = std::numeric_limits<T>::lowest();
  std::uint64_t count = 0, done = 0;
  const std::uint64_t total =
      static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  const SampleRange step = scan_step();
  std::vector<T> values(static_cast<std::size_t>(step.width * std::min(step.height, height)));
  std::vector<std::uint8_t> valid(values.size());
  for (std::int64_t y = height; y > 0; y -= step.height) {  // from the north, as most files lie
    for (std::int64_t x = 0; x < width; x += step.width) {
      stop_if_asked(stop, "reading", context());
      const std::int64_t south = std::max<std::int64_t>(y - step.height, 0);
      const SampleRange w{x, south, std::min(step.width, width - x), y - south};
      const auto n = static_cast<std::size_t>(w.width * w.height);
      read_raw<T>(w, std::span(values).first(n), std::span(valid).first(n));
      for (std::size_t i = 0; i < n; ++i) {
        if constexpr (kWhole) {
          low = std::min(low, valid[i] ? values[i] : low);
          high = std::max(high, valid[i] ? values[i] : high);
          count += valid[i];
        } else if (valid[i]) {
          heights.add(offset + scale * static_cast<double>(values[i]));
        }
      }
      done += n;
      if (progress) {
        progress(done, total);
      }
    }
  }
  HeightFit fit = heights.fit();
  if constexpr (kWhole) {
    const HeightEncoding encoding{HeightType::int32, scale, offset};
    fit = {encoding, scale, 0.0, 0.0, -1.0, count};
    if (count > 0) {
      fit.min_height = encoding.height_of_code(low);
      fit.max_height = encoding.height_of_code(high);
    }
  }
  set_heights(frame, fit);
  valid_samples = fit.count;
}

void RasterSource::Impl::scan(const std::stop_token& stop, const Progress& progress) {
  switch (raw) {
    case RawType::kInt32:
      return scan_as<std::int32_t>(stop, progress);
    case RawType::kFloat32:
      return scan_as<float>(stop, progress);
    case RawType::kFloat64:
      return scan_as<double>(stop, progress);
  }
}

// ---------------------------------------------------------------------------------------------------
// Reading windows.

/// Marks a part as used. Where too many parts are open, closes those whose last use is longest ago.
void RasterSource::Impl::touch(PlacedPart& placed) {
  placed.last_used = ++clock;
  std::vector<PlacedPart*> open;
  for (PlacedPart& p : parts) {
    if (p.part.is_open() && &p != &placed) {
      open.push_back(&p);
    }
  }
  const std::size_t most_others = most_open_files(sharers->load()) - 1;
  if (open.size() <= most_others) {
    return;
  }
  std::sort(open.begin(), open.end(),
            [](const PlacedPart* a, const PlacedPart* b) { return a->last_used < b->last_used; });
  open.resize(open.size() - most_others);
  for (PlacedPart* p : open) {
    p->part.close();
  }
}

/// Reads the part of the window that `placed` covers. Its heights overwrite what is there already;
/// its voids do not.
template <class T>
void RasterSource::Impl::overlay(PlacedPart& placed, const SampleRange& w, std::span<T> values,
                                 std::span<std::uint8_t> valid) {
  const RasterShape& shape = placed.part.shape();
  const std::int64_t x0 = std::max(w.x0, placed.x),
                     x1 = std::min(w.x0 + w.width, placed.x + shape.width);
  const std::int64_t y0 = std::max(w.y0, placed.y),
                     y1 = std::min(w.y0 + w.height, placed.y + shape.height);
  if (x0 >= x1 || y0 >= y1) {
    return;
  }
  touch(placed);
  const SampleRange own{x0 - placed.x, y0 - placed.y, x1 - x0, y1 - y0};
  std::vector<T> own_values(static_cast<std::size_t>(own.width * own.height));
  std::vector<std::uint8_t> own_valid(own_values.size());
  placed.part.read<T>(own, own_values, own_valid);
  std::size_t from = 0;
  for (std::int64_t y = y0; y < y1; ++y) {
    auto to = static_cast<std::size_t>((y - w.y0) * w.width + x0 - w.x0);
    for (std::int64_t x = x0; x < x1; ++x, ++from, ++to) {
      if (own_valid[from]) {
        values[to] = own_values[from];
        valid[to] = 1;
      }
    }
  }
}

template <class T>
void RasterSource::Impl::read_raw(const SampleRange& w, std::span<T> values,
                                  std::span<std::uint8_t> valid) {
  if (parts.size() == 1) {
    PlacedPart& only = parts[0];
    only.part.read<T>({w.x0 - only.x, w.y0 - only.y, w.width, w.height}, values, valid);
    return;
  }
  std::fill(values.begin(), values.end(), T{});
  std::fill(valid.begin(), valid.end(), std::uint8_t{0});
  for (PlacedPart& placed : parts) {
    overlay(placed, w, values, valid);
  }
}

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
    impl_->read_raw<T>(window, raw, valid);
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
std::uint64_t RasterSource::void_samples() const noexcept {
  return static_cast<std::uint64_t>(width()) * static_cast<std::uint64_t>(height()) -
         valid_samples();
}

}  // namespace ptin
