// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/point_source.h"

#include <algorithm>
#include <cmath>

#include "engine/construct/crs.h"
#include "engine/construct/height_fit_internal.h"
#include "engine/construct/point_grid.h"
#include "engine/construct/point_stream.h"
#include "engine/error.h"
#include "engine/geometry/orient.h"

namespace ptin {
namespace {

using Progress = std::function<void(std::uint64_t, std::uint64_t)>;

[[noreturn]] void refuse(const std::string& context, const std::string& sentence) {
  throw Error(ErrorCode::invalid_argument, sentence, context);
}

// ---------------------------------------------------------------------------------------------------
// Reading.

/// Everything that the files hold, and what it means for the grid.
struct RawPoints {
  std::vector<SourcePoint> points;
  std::uint64_t left_out = 0;
  PointGrid grid;
  std::string crs;  ///< As the files declare it.
};

/// The CRS that all files share.
class CommonCrs {
 public:
  void add(const std::string& crs, const std::string& path) {
    if (first_ && !is_same_crs(crs_, crs)) {
      refuse(path, "this file has another CRS than '" + path_ +
                       "', or one of them has none; transform " +
                       "it first, or say with --a-srs what all of them are in");
    }
    if (!first_) {
      first_ = true;
      crs_ = crs;
      path_ = path;
    }
  }
  [[nodiscard]] const std::string& text() const { return crs_; }

 private:
  bool first_ = false;
  std::string crs_, path_;
};

RawPoints read_all(const std::vector<std::string>& paths, const SourceOptions& options,
                   const std::stop_token& stop, const Progress& progress) {
  RawPoints raw;
  PointGridScan scan(options.resolution, paths.empty() ? "" : paths[0]);
  CommonCrs crs;
  std::vector<SourcePoint> batch;
  std::uint64_t count = 0;
  for (const std::string& path : paths) {
    const auto stream = open_point_stream(path, options.points);
    if (options.a_srs.empty()) {
      crs.add(stream->facts().crs, path);
    }
    scan.add_source(stream->facts());
    while (stream->next(batch)) {
      if (stop.stop_requested()) {
        throw Error(ErrorCode::cancelled, "reading was cancelled", path);
      }
      if (progress) {
        progress(stream->done(), stream->total());
      }
      count += batch.size();
      for (const SourcePoint& p : batch) {
        if (is_wanted(p, options)) {
          scan.add(p);
          raw.points.push_back(p);
        }
      }
    }
    raw.left_out += stream->left_out();
  }
  if (raw.points.empty()) {
    refuse(paths.empty() ? "" : paths[0],
           count + raw.left_out == 0
               ? "there is no point in this file"
               : "every point is left out: none lies in the bounds, with a height and of a chosen "
                 "class");
  }
  raw.left_out += count - raw.points.size();
  raw.grid = scan.grid();
  raw.crs = crs.text();
  return raw;
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

void add_points(const RawPoints& raw, PointMerge rule, PointSet& set) {
  const PointGrid& grid = raw.grid;
  std::vector<Entry> entries;
  entries.reserve(raw.points.size());
  for (const SourcePoint& p : raw.points) {
    entries.push_back({key_of(grid.position(p)), grid.height(p.z)});
    set.largest_shift_plan = std::max(set.largest_shift_plan, grid.shift(p));
  }
  const std::vector<double> heights = merge(entries, rule, grid.whole, set);
  if (grid.whole) {
    encode_codes(heights, grid.heights.unit(), set);
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

PointSet read_points(const std::vector<std::string>& paths, const SourceOptions& options,
                     const std::stop_token& stop, const Progress& progress) {
  const std::string context = paths.empty() ? "" : paths[0];
  PointSet set;
  const RawPoints raw = read_all(paths, options, stop, progress);
  set_crs(set.frame, resolve_crs(raw.crs, options.a_srs, options.vertical_crs));
  set.frame.map = raw.grid.map();
  set.left_out_points = raw.left_out;
  add_points(raw, options.merge, set);
  check_area(set, context);
  return set;
}

}  // namespace ptin
