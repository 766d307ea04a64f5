// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_source.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "engine/construct/grid/area_of_use.h"
#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/grid_precision.h"
#include "engine/construct/grid/height_finder.h"
#include "engine/construct/lines/lines_on_grid.h"
#include "engine/construct/lines/source_lines.h"
#include "engine/construct/points/point_shares.h"
#include "engine/construct/points/range_buckets.h"
#include "engine/error.h"
#include "engine/stop.h"

namespace ptin {

namespace {

void check_area(const ConvexHull& hull, std::uint64_t points, const std::string& context) {
  if (points < 3) {
    refuse("there are " + std::to_string(points) + " distinct points; a terrain needs at least 3",
           context);
  }
  if (hull.corners().size() < 3) {
    refuse("all points lie on one line; a terrain needs an area", context);
  }
}

}  // namespace

/// Does work that reads temporary files. Where one is not what was written, or gone, all points are
/// read once more and the work is done again; the second time is the last.
template <class Work>
auto PointSource::undamaged(const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    const bool is_lost =
        error.code() == ErrorCode::corruption || error.code() == ErrorCode::not_found;
    if (!is_lost || !work_.files.is_one(error.context()) || was_damaged_ || is_read_once()) {
      throw;
    }
  }
  was_damaged_ = true;
  reading_.reset();
  return work();
}

PointSource::PointSource(const std::vector<std::string>& inputs, const SourceOptions& options,
                         PointWork work)
    : inputs_(inputs),
      options_(options),
      work_(std::move(work)),
      tasks_(inputs_, options_, work_.files) {
  static_cast<void>(PointGridScan(options_.resolution, inputs_.empty() ? "" : inputs_[0]));
  try {
    undamaged([&] { read(); });
  } catch (...) {
    remove_files();
    throw;
  }
}

/// Reads all points, if that was not done.
void PointSource::read() {
  if (!reading_) {
    work_.files.remove_all();
    reading_ = join_portions(inputs_, options_, work_.files, read_all());
  }
}

bool PointSource::is_read_once() const {
  return std::any_of(inputs_.begin(), inputs_.end(), can_be_read_once_only);
}

PointSource::~PointSource() { remove_files(); }

void PointSource::remove_files() noexcept {
  try {
    work_.files.remove_all();
  } catch (...) {  // the folder goes in the end, or the next build of this output removes them
  }
}

/// Has tasks done by whomever, or by this thread alone. Returns what came of each, by number.
std::vector<ArrayFileFacts> PointSource::run(TaskList tasks, bool alone) {
  if (alone) {
    tasks.set_bytes(work_.memory);
    tasks.tell(work_.progress);
    TaskDriver().run(tasks, tasks_, {}, work_.stop);
  } else {
    work_.run(tasks, tasks_);
  }
  std::vector<ArrayFileFacts> found;
  for (const auto& [name, result] : tasks.results()) {
    found.push_back(result.facts(TileFile::kIndex));
  }
  return found;
}

/// Reads the portions of a plan; of those that have quotes there is none.
std::vector<std::optional<SpooledPortion>> PointSource::read_some(const ReadingPlan& plan) {
  const std::vector<ArrayFileFacts> found = run(tasks_.reading(plan), is_read_once());
  std::vector<std::optional<SpooledPortion>> portions;
  for (std::size_t i = 0; i < found.size(); ++i) {
    portions.push_back(found[i].bytes > 0 ? std::optional<SpooledPortion>(
                                                {plan.portions[i], plan.first_number + i, found[i]})
                                          : std::nullopt);
  }
  return portions;
}

/// Reads all inputs. Texts of which a part has quotes are read once more, as a whole.
std::vector<SpooledPortion> PointSource::read_all() {
  const ReadingPlan plan{0, cut_into_portions(inputs_, options_, work_.portions)};
  const auto parts = read_some(plan);
  std::vector<bool> has_quotes(inputs_.size(), false);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    has_quotes[plan.portions[i].input] = has_quotes[plan.portions[i].input] || !parts[i];
  }
  ReadingPlan again{plan.portions.size(), {}};
  std::vector<SpooledPortion> all;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::uint64_t input = plan.portions[i].input;
    if (!has_quotes[input]) {
      all.push_back(*parts[i]);
      continue;
    }
    without_old(work_.files.files, work_.files.path("spool", i));
    if (again.portions.empty() || again.portions.back().input != input) {
      again.portions.push_back(whole_portion(inputs_, input));
    }
  }
  if (!again.portions.empty()) {
    for (const auto& whole : read_some(again)) {
      all.push_back(*whole);
    }
    std::stable_sort(all.begin(), all.end(), [](const SpooledPortion& a, const SpooledPortion& b) {
      return a.portion.input < b.portion.input;
    });
  }
  return all;
}

/// What the reading and the grid say of the buckets.
PointBuckets::Index PointSource::begin_index(const PointGrid& grid) const {
  const std::string context = inputs_.empty() ? "" : inputs_[0];
  PointBuckets::Index index;
  index.warnings = reading_->warnings;
  set_crs(index.frame, resolve_source_crs({reading_->crs, reading_->vertical_crs}, options_,
                                          reading_->crs_path, index.warnings));
  warn_of_no_crs(index.frame, context, index.warnings);
  set_units(index.frame, reading_->units, options_.a_srs.empty(), context);
  index.frame.map = grid.map();
  require_resolvable(index.frame.map, grid.east - grid.west, grid.north - grid.south,
                     "give a coarser --resolution", context);
  require_latitudes(index.frame, grid.north - grid.south, context);
  require_longitudes(index.frame, grid.east - grid.west, grid.is_split, context);
  index.warnings.join(reading_->scan.warnings(inputs_, false));
  index.counts.source_points = reading_->scan.points();
  index.counts.left_out = reading_->left_out;
  index.counts.classes = reading_->classes;
  index.empty_inputs = reading_->empty_inputs;
  if (are_axes_exchanged(index.frame, grid.east - grid.west, grid.north - grid.south)) {
    index.warnings.add(
        {.kind = "exchanged_axes",
         .message = "the points lie outside of the area in which their CRS is used, and inside of "
                    "it with x and y exchanged; where northings stand before eastings, name the "
                    "columns of a text with --columns, as in --columns y x z",
         .file = context});
  }
  return index;
}

void PointSource::join_ranges(const std::vector<ArrayFileFacts>& found, const SortPlan& plan,
                              PointBuckets::Index& index) const {
  HeightFinder heights(plan.grid.whole, plan.grid.heights.unit());
  HullCollector hull;
  for (std::size_t range = 0; range < found.size(); ++range) {
    const RangeIndex of = index_of_range(work_.files, range, found[range]);
    if (of.points == 0) {
      without_old(work_.files.files, plan.buckets_of(range));
      continue;
    }
    index.ranges.push_back({range, index.size, index.boxes.size()});
    index.size += of.points;
    index.counts.largest_shift_height =
        std::max(index.counts.largest_shift_height, of.largest_shift_height);
    heights.join(of.heights);
    for (const GridPoint corner : of.hull) {
      hull.add(corner);
    }
    index.boxes.insert(index.boxes.end(), of.boxes.begin(), of.boxes.end());
    index.ends.insert(index.ends.end(), of.ends.begin(), of.ends.end());
    index.checksums.insert(index.checksums.end(), of.checksums.begin(), of.checksums.end());
  }
  const HeightFit fit = heights.fit();
  set_heights(index.frame, fit);
  index.hull = hull.hull();
  index.codes_are_whole = plan.grid.whole;
  index.counts.largest_shift_height *= plan.grid.whole ? fit.encoding.step : 1.0;
  index.counts.merged_points = index.counts.source_points - index.size;
}

PointBuckets PointSource::sort(const std::string& buckets, bool is_last) {
  return undamaged([&] {
    read();
    return sort_once(buckets, is_last);
  });
}

PointBuckets PointSource::sort_once(const std::string& buckets, bool is_last) {
  const PointGrid grid = grid_with_lines(*reading_, options_);
  PointBuckets::Index index = begin_index(grid);
  LinesOnGrid lines;
  if (options_.lines != nullptr && !options_.lines->is_empty()) {
    lines = put_on_grid(*options_.lines, grid, work_.stop);
  }
  auto plan = std::make_shared<SortPlan>(plan_sorting(*reading_, grid, std::move(lines.edges),
                                                      options_.merge, buckets, work_.sorting));
  index.bucket_points = plan->bucket_points;
  const std::vector<ArrayFileFacts> shares = run(tasks_.sharing(plan), false);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const ShareCounts counts = counts_of_share(work_.files, i, shares[i]);
    index.counts.source_points -= counts.left_out;
    index.counts.left_out.add(LeftOutReason::kBoundary, counts.left_out);
    index.counts.largest_shift_plan =
        std::max(index.counts.largest_shift_plan, counts.largest_shift_plan);
  }
  index.counts.source_points += plan->fixed.vertices().size();
  if (!options_.resolution) {
    warn_of_shift(index.counts.largest_shift_plan, index.frame, inputs_.empty() ? "" : inputs_[0],
                  index.warnings);
  }
  index.counts.largest_shift_plan =
      std::max(index.counts.largest_shift_plan, lines.largest_shift_plan);
  if (is_last) {
    work_.files.remove_all("spool");
  }
  join_ranges(run(tasks_.sorting(shares), false), *plan, index);
  work_.files.remove_all("share");
  index.fixed = std::move(plan->fixed);
  check_area(index.hull, index.size, inputs_.empty() ? "" : inputs_[0]);
  return PointBuckets(work_.files.files, buckets, std::move(index));
}

}  // namespace ptin
