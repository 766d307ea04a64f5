// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_mosaic.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include <gdal.h>
#include <sys/resource.h>

#include "engine/construct/grid/crs.h"
#include "engine/crs/height_unit.h"
#include "engine/error.h"
#include "engine/geometry/point.h"

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

/// The parts of a step by which the samples of another file and the bounds of `bbox` may miss the
/// grid.
constexpr double kFileSlack = 0.01;
constexpr double kBoundsSlack = 1e-6;

/// How to bring rasters onto one grid: all of them, since the first one's need not be such a grid.
constexpr const char* kOneGrid =
    "; bring all of them onto one grid with 'gdalwarp -t_srs CRS -tr WIDTH HEIGHT -tap'";

/// A type that holds the values of both without loss.
std::string wider_type(const RasterShape& a, const RasterShape& b) {
  return GDALGetDataTypeName(GDALDataTypeUnion(a.stored.type, b.stored.type));
}

std::string scaling_of(const RasterShape& shape) {
  char text[96];
  std::snprintf(text, sizeof text, "scale %.10g and offset %.10g", shape.scale, shape.offset);
  return text;
}

/// Why the units of heights of two rasters do not go together; empty when they do.
std::string unit_mismatch(const RasterShape& a, const RasterShape& b) {
  if (a.unit.empty() || b.unit.empty() || height_unit_named(a.unit) == height_unit_named(b.unit)) {
    return "";
  }
  return "its heights are in '" + b.unit + "', those of another raster before it in '" + a.unit +
         "'; convert them first, as with 'gdal_translate -scale 0 1 0 FACTOR -ot Float32', and "
         "state the unit with 'gdal_edit.py -units'";
}

/// Why `b` cannot stand beside `a` in one terrain; empty when it can.
std::string mismatch(const RasterShape& a, const RasterShape& b, bool compare_crs) {
  if (!a.georeferenced || !b.georeferenced) {
    return "several rasters make one terrain only where each has a geotransform";
  }
  const auto crs = compare_crs ? difference_of({a.crs, ""}, {b.crs, ""}) : std::nullopt;
  if (crs) {
    return "its CRS is not that of the first raster: it declares " + crs->second +
           ", and the first one " + crs->first + kOneGrid +
           ", or name the CRS of all by --a-srs where they merely say it otherwise";
  }
  if (a.scale != b.scale || a.offset != b.offset) {
    return "its " + scaling_of(b) + " are not those of the first raster, " + scaling_of(a) +
           "; rewrite all of them with 'gdal_translate -unscale -ot Float64'";
  }
  if (a.type_name != b.type_name || a.stored.signed_bytes != b.stored.signed_bytes) {
    const std::string wide = wider_type(a, b);
    return "its type " + b.type_name + " is not that of the first raster, " + a.type_name +
           "; rewrite " +
           (b.type_name == wide   ? "those of " + a.type_name
            : a.type_name == wide ? "it"
                                  : "all of them") +
           " with 'gdal_translate -ot " + wide + "', which keeps every value";
  }
  const auto extent = static_cast<double>(std::max({a.width, a.height, b.width, b.height}));
  if (std::abs(b.map.step_x / a.map.step_x - 1.0) * extent > kFileSlack ||
      std::abs(b.map.step_y / a.map.step_y - 1.0) * extent > kFileSlack) {
    return std::string("its pixel size is not that of the first raster") + kOneGrid;
  }
  return unit_mismatch(a, b);
}

/// Whole steps from `a` to `b`. Refuses the file `path`, whose origin is `b`, when their difference
/// is not near to a whole number of steps.
std::int64_t steps_between(double a, double b, double step, const std::string& path) {
  const double steps = (b - a) / step;
  if (!(std::abs(steps) <= 2.0 * kGridMax)) {
    refuse("it lies more than 2^30 pixels from the first raster", path);
  }
  if (std::abs(steps - std::nearbyint(steps)) > kFileSlack) {
    refuse(std::string("its samples lie between those of the first raster") + kOneGrid, path);
  }
  return std::llround(steps);
}

}  // namespace

RasterMosaic::RasterMosaic(const std::vector<std::string>& paths, const SourceOptions& options) {
  if (paths.empty()) {
    refuse("no raster was named", "");
  }
  parts_.reserve(paths.size());
  RasterShape like;  // what all are to be like: the first, with the first unit that is declared
  for (const std::string& path : paths) {
    parts_.push_back({RasterPart(path, options.nodata)});
    touch(parts_.back());
    const RasterShape& shape = parts_.back().part.shape();
    const std::string problem =
        parts_.size() == 1 ? "" : mismatch(like, shape, options.a_srs.empty());
    if (!problem.empty()) {
      refuse(problem, path);
    }
    like = parts_.size() == 1 ? shape : like;
    like.unit = like.unit.empty() ? shape.unit : like.unit;
  }
  place();
}

RasterMosaic::~RasterMosaic() {
  if (sharers_) {
    --*sharers_;
  }
}

RasterMosaic RasterMosaic::duplicate() {
  RasterMosaic copy;
  copy.map_ = map_;
  copy.width_ = width_;
  copy.height_ = height_;
  copy.is_cropped_ = is_cropped_;
  copy.sharers_ = sharers_;
  ++*copy.sharers_;
  for (PlacedPart& p : parts_) {
    copy.parts_.push_back({p.part.closed_copy(), p.x, p.y});
    if (parts_.size() > 1) {  // from now on the copies read, mostly
      p.part.close();
    }
  }
  return copy;
}

std::string RasterMosaic::context() const {
  return parts_.size() == 1
             ? parts_[0].part.path()
             : parts_[0].part.path() + " and " + std::to_string(parts_.size() - 1) + " more";
}

std::string RasterMosaic::unit() const {
  const auto declares = [](const PlacedPart& p) { return !p.part.shape().unit.empty(); };
  const auto first = std::find_if(parts_.begin(), parts_.end(), declares);
  return first == parts_.end() ? "" : first->part.shape().unit;
}

const std::string& RasterMosaic::path_at(std::int64_t x, std::int64_t y) const {
  const auto covers = [&](const PlacedPart& p) {
    return x >= p.x && x < p.x + p.part.shape().width && y >= p.y &&
           y < p.y + p.part.shape().height;
  };
  const auto last = std::find_if(parts_.rbegin(), parts_.rend(), covers);
  return (last == parts_.rend() ? parts_.front() : *last).part.path();
}

SourceWarnings RasterMosaic::warnings() const {
  SourceWarnings all;
  for (const PlacedPart& p : parts_) {
    all.join(p.part.warnings());
  }
  return all;
}

/// Gives each part its place on the common grid, whose origin is the south-western corner of all.
void RasterMosaic::place() {
  const AffineMap map = parts_[0].part.shape().map;
  std::int64_t west = 0, south = 0, east = 0, north = 0;
  for (PlacedPart& p : parts_) {
    const RasterShape& shape = p.part.shape();
    p.x = steps_between(map.origin_x, shape.map.origin_x, map.step_x, p.part.path());
    p.y = steps_between(map.origin_y, shape.map.origin_y, map.step_y, p.part.path());
    west = std::min(west, p.x);
    south = std::min(south, p.y);
    east = std::max(east, p.x + shape.width);
    north = std::max(north, p.y + shape.height);
  }
  for (PlacedPart& p : parts_) {
    p.x -= west;
    p.y -= south;
  }
  width_ = east - west;
  height_ = north - south;
  const MapPoint origin = map.to_map(static_cast<double>(west), static_cast<double>(south));
  map_ = {origin.x, origin.y, map.step_x, map.step_y};
}

/// Says where the samples are, and whether the bounds would hold some with x and y exchanged.
void RasterMosaic::refuse_bounds(const SourceOptions::Bounds& b) const {
  const MapPoint low{map_.origin_x, map_.origin_y};
  const MapPoint high =
      map_.to_map(static_cast<double>(width_ - 1), static_cast<double>(height_ - 1));
  const bool exchanged =
      b.min_y <= high.x && b.max_y >= low.x && b.min_x <= high.y && b.max_x >= low.y;
  refuse("no sample lies in the bounds; samples have x from " + std::to_string(low.x) + " to " +
             std::to_string(high.x) + ", y from " + std::to_string(low.y) + " to " +
             std::to_string(high.y) +
             (exchanged ? "; with x and y exchanged the bounds hold some: give x before y" : ""),
         context());
}

void RasterMosaic::crop(const SourceOptions::Bounds& b) {
  const auto range = [&](double low, double high, double origin, double step, std::int64_t count) {
    if (!(std::isfinite(low) && std::isfinite(high) && low <= high)) {
      refuse("the bounds must be finite, and each minimum at most its maximum", context());
    }
    const double last = static_cast<double>(count - 1);
    const double first_step = std::ceil((low - origin) / step - kBoundsSlack);
    const double last_step = std::floor((high - origin) / step + kBoundsSlack);
    if (first_step > last || last_step < 0 || first_step > last_step) refuse_bounds(b);
    return std::pair{static_cast<std::int64_t>(std::max(first_step, 0.0)),
                     static_cast<std::int64_t>(std::min(last_step, last))};
  };
  const auto [x0, x1] = range(b.min_x, b.max_x, map_.origin_x, map_.step_x, width_);
  const auto [y0, y1] = range(b.min_y, b.max_y, map_.origin_y, map_.step_y, height_);
  for (PlacedPart& p : parts_) {
    p.x -= x0;
    p.y -= y0;
  }
  is_cropped_ = x1 - x0 + 1 != width_ || y1 - y0 + 1 != height_;
  width_ = x1 - x0 + 1;
  height_ = y1 - y0 + 1;
  const MapPoint origin = map_.to_map(static_cast<double>(x0), static_cast<double>(y0));
  map_.origin_x = origin.x;
  map_.origin_y = origin.y;
}

/// Marks a part as used. Where too many parts are open, closes those whose last use is longest ago.
void RasterMosaic::touch(PlacedPart& placed) {
  placed.last_used = ++clock_;
  std::vector<PlacedPart*> open;
  for (PlacedPart& p : parts_) {
    if (p.part.is_open() && &p != &placed) {
      open.push_back(&p);
    }
  }
  const std::size_t most_others = most_open_files(sharers_->load()) - 1;
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
void RasterMosaic::overlay(PlacedPart& placed, const SampleRange& w, std::span<T> values,
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
void RasterMosaic::read(const SampleRange& w, std::span<T> values, std::span<std::uint8_t> valid) {
  if (parts_.size() == 1) {
    PlacedPart& only = parts_[0];
    only.part.read<T>({w.x0 - only.x, w.y0 - only.y, w.width, w.height}, values, valid);
    return;
  }
  std::fill(values.begin(), values.end(), T{});
  std::fill(valid.begin(), valid.end(), std::uint8_t{0});
  for (PlacedPart& placed : parts_) {
    overlay(placed, w, values, valid);
  }
}

template void RasterMosaic::read<std::int32_t>(const SampleRange&, std::span<std::int32_t>,
                                               std::span<std::uint8_t>);
template void RasterMosaic::read<float>(const SampleRange&, std::span<float>,
                                        std::span<std::uint8_t>);
template void RasterMosaic::read<double>(const SampleRange&, std::span<double>,
                                         std::span<std::uint8_t>);

}  // namespace ptin
