// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/point_source.h"

#include <algorithm>
#include <cmath>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/height_fit.h"
#include "engine/construct/grid/point_merge.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/points/point_portions.h"
#include "engine/construct/points/point_reading.h"
#include "engine/construct/points/point_spool.h"
#include "engine/construct/points/point_tasks.h"
#include "engine/error.h"
#include "engine/geometry/orient.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/read_buckets.h"

namespace ptin {
namespace {

using Progress = std::function<void(std::uint64_t, std::uint64_t)>;

/// A snapped point. Heights are codes of the decimal step where those fit int32, else heights.
struct Entry {
  VertexKey key;
  double height;
};

/// Fills positions, merged heights (returned) and counts. Sorting by height too makes the sums, and
/// so the means, independent of the order of the source, which the rule kFirst keeps.
std::vector<double> merge(std::vector<Entry>& entries, PointMerge rule, bool whole, PointSet& set) {
  std::stable_sort(entries.begin(), entries.end(), [rule](const Entry& a, const Entry& b) {
    return a.key != b.key ? a.key < b.key : rule != PointMerge::kFirst && a.height < b.height;
  });
  std::vector<double> heights;
  const Entry* const end = entries.data() + entries.size();
  for (const Entry* first = entries.data(); first != end;) {
    MergedHeight merged(first->height);
    const Entry* next = first + 1;
    for (; next != end && next->key == first->key; ++next) {
      merged.add(next->height);
    }
    const double height = merged.height(rule, whole);
    set.largest_shift_height = std::max(set.largest_shift_height, merged.shift(height));
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

void add_points(const std::vector<SourcePoint>& points, const PointGrid& grid, PointMerge rule,
                PointSet& set) {
  std::vector<Entry> entries;
  entries.reserve(points.size());
  for (const SourcePoint& p : points) {
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
    refuse("there are " + std::to_string(set.positions.size()) +
               " distinct points; a terrain needs at least 3",
           context);
  }
  const GridPoint first = set.positions.front(), last = set.positions.back();
  if (std::all_of(set.positions.begin(), set.positions.end(),
                  [&](GridPoint p) { return orient(first, last, p) == 0; })) {
    refuse("all points lie on one line; a terrain needs an area", context);
  }
}

/// All points that were read.
std::vector<SourcePoint> spooled(const PointFiles& files, const PointReading& reading) {
  std::vector<SourcePoint> points, block;
  for (const PointReading::Spool& spool : reading.spools) {
    ArrayFileReader file = files.open(files.path("spool", spool.number), spool.facts);
    while (!file.at_end()) {
      read_block(file, block);
      points.insert(points.end(), block.begin(), block.end());
    }
  }
  return points;
}

}  // namespace

PointSet read_points(const std::vector<std::string>& paths, const SourceOptions& options,
                     const std::stop_token& stop, const Progress& progress) {
  const std::string context = paths.empty() ? "" : paths[0];
  PointSet set;
  const oracle::ScratchFolder folder(oracle::ScratchFolder::Size::kSmall);
  const PointFiles files{FileLayer::system(), folder.path()};
  PointTasks tasks(paths, options, files);
  const ReadingPlan plan{0, cut_into_portions(paths, options)};
  TaskList reading = tasks.reading(plan);
  run_told(1 << 20, stop, [&](const StageProgress& told) {
    if (progress) {
      progress(told.done, told.total);
    }
  })(reading, tasks);
  std::vector<SpooledPortion> portions;
  for (const auto& [name, result] : reading.results()) {
    const std::size_t i = number_of(name);
    portions.push_back({plan.portions[i], i, result.facts(TileFile::kIndex)});
  }
  const PointReading raw = join_portions(paths, options, files, portions);
  const PointGrid grid = grid_with_lines(raw, options);
  SourceWarnings ignored;
  set_crs(set.frame, resolve_source_crs({raw.crs, ""}, options, "", ignored));
  set.frame.map = grid.map();
  set.left_out_points = raw.left_out.total();
  add_points(spooled(files, raw), grid, options.merge, set);
  check_area(set, context);
  return set;
}

}  // namespace ptin
