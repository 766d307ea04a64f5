// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/point_source.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include <cpl_vsi.h>

#include "engine/construct/crs.h"
#include "engine/construct/gdal_session_internal.h"
#include "engine/construct/height_fit_internal.h"
#include "engine/construct/xyz_reader.h"
#include "engine/error.h"
#include "engine/geometry/orient.h"

namespace ptin {
namespace {

__extension__ using Int128 = __int128;
using Progress = std::function<void(std::uint64_t, std::uint64_t)>;

constexpr std::uint64_t kBetweenReports = 1 << 16;
constexpr double kInt32Max = 2147483647.0;

[[noreturn]] void refuse(const std::string& context, const std::string& sentence) {
  throw Error(ErrorCode::invalid_argument, sentence, context);
}

// ---------------------------------------------------------------------------------------------------
// Reading.

struct RawPoints {
  std::vector<XyzPoint> points;
  int plan_decimals = 0;    ///< Most of any x and y.
  int height_decimals = 0;  ///< Most of any z.
};

/// Size of all files, or 0 where one is packed.
std::uint64_t bytes_of(const std::vector<std::string>& paths) {
  const GdalSession session;
  std::uint64_t bytes = 0;
  for (const std::string& path : paths) {
    VSIStatBufL status;
    if (path.ends_with(".gz") || VSIStatL(path.c_str(), &status) != 0) {
      return 0;
    }
    bytes += static_cast<std::uint64_t>(status.st_size);
  }
  return bytes;
}

bool is_wanted(const XyzPoint& p, const SourceOptions& options) {
  if (options.nodata && to_double(p.z) == *options.nodata) {
    return false;
  }
  if (!options.bbox) {
    return true;
  }
  const double x = to_double(p.x), y = to_double(p.y);
  return options.bbox->min_x <= x && x <= options.bbox->max_x && options.bbox->min_y <= y &&
         y <= options.bbox->max_y;
}

RawPoints read_all(const std::vector<std::string>& paths, const SourceOptions& options,
                   const std::stop_token& stop, const Progress& progress) {
  RawPoints raw;
  const std::uint64_t total = bytes_of(paths);
  std::uint64_t done = 0, count = 0;
  for (const std::string& path : paths) {
    XyzReader reader(path);
    XyzPoint p;
    while (reader.next(p)) {
      if (++count % kBetweenReports == 0) {
        if (stop.stop_requested()) {
          throw Error(ErrorCode::cancelled, "reading was cancelled", path);
        }
        if (progress) {
          progress(done + reader.bytes_read(), total);
        }
      }
      if (is_wanted(p, options)) {
        raw.plan_decimals = std::max({raw.plan_decimals, p.x.decimals, p.y.decimals});
        raw.height_decimals = std::max(raw.height_decimals, p.z.decimals);
        raw.points.push_back(p);
      }
    }
    done += reader.bytes_read();
  }
  if (raw.points.empty()) {
    refuse(paths.empty() ? "" : paths[0],
           count == 0 ? "there is no point in this file"
                      : "every point is left out: none lies in the bounds with a height");
  }
  return raw;
}

// ---------------------------------------------------------------------------------------------------
// The plan grid.

/// 10^exponent. REQUIRES: 0 <= exponent <= 18.
std::int64_t power_of_ten(int exponent) {
  std::int64_t power = 1;
  for (; exponent > 0; --exponent) {
    power *= 10;
  }
  return power;
}

/// Whole steps of a coordinate from 0 of the CRS: exactly, in units of 10^-decimals, or rounded to
/// the nearest multiple of a resolution.
class StepCounter {
 public:
  StepCounter(int decimals, std::optional<double> resolution)
      : decimals_(decimals), resolution_(resolution) {}

  /// Beyond 2^62 in either direction is given as that: far beyond the grid.
  [[nodiscard]] std::int64_t steps(Decimal value) const {
    static constexpr std::int64_t kFar = std::int64_t{1} << 62;
    if (resolution_) {
      const double steps = std::round(to_double(value) / *resolution_);
      return std::abs(steps) < 9007199254740992.0 ? static_cast<std::int64_t>(steps)
                                                  : (steps < 0 ? -kFar : kFar);
    }
    const Int128 steps = Int128{value.mantissa} * power_of_ten(decimals_ - value.decimals);
    return static_cast<std::int64_t>(std::clamp<Int128>(steps, -kFar, kFar));
  }
  [[nodiscard]] double unit() const { return resolution_ ? *resolution_ : decimal_step(decimals_); }
  /// The coordinate at a number of steps, rounded once.
  [[nodiscard]] double coordinate(std::int64_t steps) const {
    return resolution_ ? static_cast<double>(steps) * *resolution_
                       : static_cast<double>(steps) / static_cast<double>(power_of_ten(decimals_));
  }
  /// How far from its place in the source a coordinate stands on the grid.
  [[nodiscard]] double shift(Decimal value) const {
    return resolution_ ? std::abs(to_double(value) - coordinate(steps(value))) : 0.0;
  }

 private:
  int decimals_;
  std::optional<double> resolution_;
};

struct PlanGrid {
  StepCounter counter;
  std::int64_t west = std::numeric_limits<std::int64_t>::max();
  std::int64_t south = std::numeric_limits<std::int64_t>::max();

  [[nodiscard]] GridPoint position(const XyzPoint& p) const {
    return {static_cast<std::int32_t>(counter.steps(p.x) - west),
            static_cast<std::int32_t>(counter.steps(p.y) - south)};
  }
  [[nodiscard]] AffineMap map() const {
    return {counter.coordinate(west), counter.coordinate(south), counter.unit(), counter.unit()};
  }
};

/// Refuses an extent beyond the grid, and names the power of ten that would do.
void check_extent(double extent, const PlanGrid& grid, const std::string& context) {
  if (extent / grid.counter.unit() <= kGridMax) {
    return;
  }
  const double enough = std::pow(10.0, std::ceil(std::log10(extent / kGridMax)));
  char text[160];
  std::snprintf(text, sizeof text,
                "the points span %.9g units in steps of %g: more than the 2^30 steps of the grid; "
                "give a coarser "
                "resolution, such as %g",
                extent, grid.counter.unit(), enough);
  refuse(context, text);
}

PlanGrid make_grid(const RawPoints& raw, const SourceOptions& options, const std::string& context) {
  if (options.resolution && !(std::isfinite(*options.resolution) && *options.resolution > 0)) {
    refuse(context, "the resolution must be a finite length above 0");
  }
  PlanGrid grid{StepCounter(raw.plan_decimals, options.resolution)};
  std::int64_t east = std::numeric_limits<std::int64_t>::min(), north = east;
  for (const XyzPoint& p : raw.points) {
    const std::int64_t x = grid.counter.steps(p.x), y = grid.counter.steps(p.y);
    grid.west = std::min(grid.west, x);
    grid.south = std::min(grid.south, y);
    east = std::max(east, x);
    north = std::max(north, y);
  }
  // Differences of numbers up to 2^62 fit; as doubles they are near enough for a limit of 2^30.
  const double width = static_cast<double>(east) - static_cast<double>(grid.west);
  const double height = static_cast<double>(north) - static_cast<double>(grid.south);
  check_extent(std::max(width, height) * grid.counter.unit(), grid, context);
  return grid;
}

// ---------------------------------------------------------------------------------------------------
// Merging.

/// A snapped point. Heights are codes of the decimal step where those fit int32, else heights.
struct Entry {
  VertexKey key;
  double height;
};

/// The height of points that share a position, sorted by height.
double merged_height(const Entry* first, const Entry* end, PointMerge merge, bool whole) {
  if (merge != PointMerge::kMean || first->height == (end - 1)->height) {
    return merge == PointMerge::kHighest ? (end - 1)->height : first->height;
  }
  double sum = 0.0;
  for (const Entry* e = first; e != end; ++e) {
    sum += e->height;
  }
  const double mean = sum / static_cast<double>(end - first);
  return whole ? std::nearbyint(mean) : mean;
}

/// Fills positions, merged heights (returned) and counts. Sorting by height too makes the sums, and
/// so the means, independent of the order of the source.
std::vector<double> merge(std::vector<Entry>& entries, PointMerge rule, bool whole, PointSet& set) {
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.key != b.key ? a.key < b.key : a.height < b.height;
  });
  std::vector<double> heights;
  const Entry* const end = entries.data() + entries.size();
  for (const Entry* first = entries.data(); first != end;) {
    const Entry* next = first + 1;
    while (next != end && next->key == first->key) {
      ++next;
    }
    const double height = merged_height(first, next, rule, whole);
    set.largest_shift_height =
        std::max({set.largest_shift_height, height - first->height, (next - 1)->height - height});
    set.positions.push_back(point_of(first->key));
    heights.push_back(height);
    first = next;
  }
  set.source_points = entries.size();
  set.merged_points = entries.size() - heights.size();
  return heights;
}

/// Encodes whole codes of a decimal step: exact.
void encode_codes(const std::vector<double>& codes, double step, PointSet& set) {
  HeightFit fit;
  fit.encoding = {HeightType::int32, step, 0.0};
  fit.quantum = step;
  const auto [low, high] = std::minmax_element(codes.begin(), codes.end());
  fit.min_height = fit.encoding.height_of_code(*low);
  fit.max_height = fit.encoding.height_of_code(*high);
  set_heights(set.frame, fit);
  for (const double code : codes) {
    set.heights.push_back(fit.encoding.bits(code));
  }
  set.largest_shift_height *= step;
}

void encode_heights(const std::vector<double>& heights, PointSet& set) {
  HeightScan scan(HeightScan::Given::kFloat64);
  for (const double height : heights) {
    scan.add(height);
  }
  set_heights(set.frame, scan.fit());
  for (const double height : heights) {
    set.heights.push_back(encode_height(set.frame.heights, height));
  }
}

void add_points(const RawPoints& raw, const PlanGrid& grid, PointMerge rule, PointSet& set) {
  const StepCounter codes(raw.height_decimals, std::nullopt);
  const bool whole = std::all_of(raw.points.begin(), raw.points.end(), [&](const XyzPoint& p) {
    return std::abs(static_cast<double>(codes.steps(p.z))) <= kInt32Max;
  });
  std::vector<Entry> entries;
  entries.reserve(raw.points.size());
  for (const XyzPoint& p : raw.points) {
    const double height = whole ? static_cast<double>(codes.steps(p.z)) : to_double(p.z);
    entries.push_back({key_of(grid.position(p)), height});
    set.largest_shift_plan = std::max(
        set.largest_shift_plan,
        std::sqrt(std::pow(grid.counter.shift(p.x), 2) + std::pow(grid.counter.shift(p.y), 2)));
  }
  const std::vector<double> heights = merge(entries, rule, whole, set);
  if (whole) {
    encode_codes(heights, codes.unit(), set);
  } else {
    encode_heights(heights, set);
  }
}

void check_area(const PointSet& set, const std::string& context) {
  if (set.positions.size() < 3) {
    refuse(context, "there are " + std::to_string(set.positions.size()) +
                        " distinct points; a terrain needs at least 3");
  }
  const GridPoint first = set.positions.front(), last = set.positions.back();
  if (std::all_of(set.positions.begin(), set.positions.end(),
                  [&](GridPoint p) { return orient(first, last, p) == 0; })) {
    refuse(context, "all points lie on one line; a terrain needs an area");
  }
}

}  // namespace

bool is_point_file(const std::string& path) {
  std::string name = path;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name.ends_with(".gz")) {
    name.resize(name.size() - 3);
  }
  return name.ends_with(".csv") || name.ends_with(".xyz") || name.ends_with(".txt") ||
         name.ends_with(".tsv");
}

PointSet read_points(const std::vector<std::string>& paths, const SourceOptions& options,
                     const std::stop_token& stop, const Progress& progress) {
  const std::string context = paths.empty() ? "" : paths[0];
  PointSet set;
  set_crs(set.frame, resolve_crs("", options.a_srs, options.vertical_crs));
  const RawPoints raw = read_all(paths, options, stop, progress);
  const PlanGrid grid = make_grid(raw, options, context);
  set.frame.map = grid.map();
  add_points(raw, grid, options.merge, set);
  check_area(set, context);
  return set;
}

}  // namespace ptin
