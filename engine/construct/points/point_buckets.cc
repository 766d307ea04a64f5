// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_buckets.h"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/grid_precision.h"
#include "engine/construct/grid/height_finder.h"
#include "engine/construct/grid/point_grid.h"
#include "engine/construct/grid/point_merge.h"
#include "engine/construct/grid/point_order.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/lines/lines_on_grid.h"
#include "engine/construct/points/packed_bucket.h"
#include "engine/construct/points/point_reading.h"
#include "engine/construct/points/point_spool.h"
#include "engine/error.h"
#include "engine/stop.h"
#include "storage/file/checksum.h"

namespace ptin {

namespace {

constexpr std::uint64_t kMostBuckets = std::uint64_t{1} << 20;

void check_area(const ConvexHull& hull, std::uint64_t points, const std::string& context) {
  if (points < 3) {
    refuse("there are " + std::to_string(points) + " distinct points; a terrain needs at least 3",
           context);
  }
  if (hull.corners().size() < 3) {
    refuse("all points lie on one line; a terrain needs an area", context);
  }
}

template <class Sorter>
void add_to(Sorter& sorter, std::uint64_t key, double height) {
  if constexpr (std::is_same_v<Sorter, NumberedPointSorter>) {
    sorter.add({key, height, sorter.size()});
  } else {
    sorter.add({key, height});
  }
}

}  // namespace

/// Merges points that come in the order of the curve, and writes them in buckets.
class PointBuckets::Writer {
 public:
  Writer(PointBuckets& to, const PointGrid& grid, const PointOrder& order, PointMerge rule)
      : to_(to),
        grid_(grid),
        order_(order),
        rule_(rule),
        heights_(grid.whole, grid.heights.unit()) {}

  void add(std::uint64_t key, double height) {
    if (merged_ && key == key_) {
      merged_->add(height);
      return;
    }
    put();
    key_ = key;
    merged_.emplace(height);
  }

  void finish() {
    put();
    write();
    to_.boxes_ = PackedBoxes(std::move(boxes_));
    const HeightFit fit = heights_.fit();
    set_heights(to_.frame_, fit);
    to_.codes_are_whole_ = grid_.whole;
    to_.counts_.largest_shift_height *= grid_.whole ? fit.encoding.step : 1.0;
    to_.counts_.merged_points = to_.counts_.source_points - to_.size_;
    to_.hull_ = hull_.hull();
  }

 private:
  void put() {
    if (!merged_) {
      return;
    }
    const double height = merged_->height(rule_, grid_.whole);
    double& largest = to_.counts_.largest_shift_height;
    largest = std::max(largest, merged_->shift(height));
    heights_.add(height);
    const GridPoint position = order_.point(key_);
    hull_.add(position);
    bucket_.push_back({position, height});
    ++to_.size_;
    if (bucket_.size() == to_.bucket_points_) {
      write();
    }
  }

  void write() {
    if (bucket_.empty()) {
      return;
    }
    GridBox box;
    for (const PlacedHeight& p : bucket_) {
      box = united(box, p.position);
    }
    pack_bucket(bucket_, box, packed_);
    to_.checksums_.push_back(checksum_of(packed_));
    const std::uint64_t begin = to_.begin_of(boxes_.size());
    to_.file_->write_at(packed_, begin);
    to_.ends_.push_back(begin + packed_.size());
    boxes_.push_back(box);
    bucket_.clear();
  }

  PointBuckets& to_;
  const PointGrid& grid_;
  const PointOrder& order_;
  PointMerge rule_;
  HeightFinder heights_;
  HullCollector hull_;
  std::vector<GridBox> boxes_;
  std::vector<PlacedHeight> bucket_;
  std::vector<std::byte> packed_;
  std::uint64_t key_ = 0;
  std::optional<MergedHeight> merged_;
};

/// Adds a point that the boundary holds, unless it falls on a vertex of a line.
template <class Sorter>
void PointBuckets::add_unless_fixed(const SourcePoint& p, const PointGrid& grid,
                                    const PointOrder& order, Sorter& sorter) {
  const GridPoint position = grid.position(p);
  if (fixed_.vertex_at(position) != KeyTable::kAbsent) {
    return;
  }
  if (fixed_.holds(position)) {
    add_to(sorter, order.key(position), grid.height(p.z));
  } else {
    --counts_.source_points;
    ++counts_.left_out_points;
  }
}

template <class Sorter>
void PointBuckets::add_fixed_vertices(const PointOrder& order, Sorter& sorter) {
  for (const LineVertex& v : fixed_.vertices()) {
    add_to(sorter, order.key(v.position), v.height);
  }
  counts_.source_points += fixed_.vertices().size();
}

template <class Sorter>
void PointBuckets::sort_by(PointSpool& spool, const PointGrid& grid, PointMerge rule,
                           const ExternalMemory& memory, const std::stop_token& stop,
                           const Progress& progress, const std::string& keep_as) {
  const std::uint64_t total = spool.size();
  std::uint64_t done = 0;
  const auto report = [&](std::size_t points) {
    stop_if_asked(stop, "sorting the points");
    done += points;
    if (progress) {
      progress("sorting", done, 2 * total);
    }
  };
  const PointOrder order(grid.largest());
  Sorter sorter(memory, "points", stop);
  std::vector<SourcePoint> batch;
  while (spool.take(batch)) {
    for (const SourcePoint& p : batch) {
      if (fixed_.is_empty()) {
        add_to(sorter, order.key(grid.position(p)), grid.height(p.z));
      } else {
        add_unless_fixed(p, grid, order, sorter);
      }
      counts_.largest_shift_plan = std::max(counts_.largest_shift_plan, grid.shift(p));
    }
    report(batch.size());
  }
  add_fixed_vertices(order, sorter);
  while ((total + bucket_points_ - 1) / bucket_points_ > kMostBuckets) {
    bucket_points_ *= 2;
  }
  file_ = keep_as.empty()
              ? std::make_unique<ScratchFile>(memory.files, memory.folder, "buckets", true)
              : std::make_unique<ScratchFile>(memory.files, keep_as, ScratchFile::Kept::kNew);
  Writer writer(*this, grid, order, rule);
  sorter.merge(
      [&](const auto& points) {
        for (const auto& p : points) {
          writer.add(p.key, p.height);
        }
        report(points.size());
      },
      stop);
  writer.finish();
}

void PointBuckets::sort(PointSpool& spool, const PointGrid& grid, PointMerge rule,
                        const ExternalMemory& memory, const std::stop_token& stop,
                        const Progress& progress, const std::string& keep_as) {
  if (rule == PointMerge::kFirst) {
    sort_by<NumberedPointSorter>(spool, grid, rule, memory, stop, progress, keep_as);
  } else {
    sort_by<PointSorter>(spool, grid, rule, memory, stop, progress, keep_as);
  }
}

PointBuckets PointBuckets::read(const std::vector<std::string>& paths, const SourceOptions& options,
                                const ExternalMemory& memory, const std::stop_token& stop,
                                const Progress& progress, const std::string& keep_as) {
  const std::string context = paths.empty() ? "" : paths[0];
  PointBuckets buckets;
  PointSpool spool(memory);
  const PointReading reading = read_sources(
      paths, options, [&](const SourcePoint& p) { spool.add(p); }, stop,
      [&](std::uint64_t done, std::uint64_t total) {
        if (progress) {
          progress("reading", done, total);
        }
      },
      &memory);
  set_crs(buckets.frame_,
          resolve_crs(reading.crs, options.a_srs,
                      options.vertical_crs.empty() ? reading.vertical_crs : options.vertical_crs));
  set_units(buckets.frame_, reading.units, options.a_srs.empty(), context);
  buckets.frame_.map = reading.grid.map();
  require_resolvable(buckets.frame_.map, reading.grid.east - reading.grid.west,
                     reading.grid.north - reading.grid.south, "give a coarser --resolution",
                     context);
  require_latitudes(buckets.frame_, reading.grid.north - reading.grid.south, context);
  buckets.counts_.source_points = reading.points;
  buckets.counts_.left_out_points = reading.left_out;
  if (options.lines != nullptr && !options.lines->is_empty()) {
    LinesOnGrid lines = put_on_grid(*options.lines, reading.grid, stop);
    buckets.fixed_ = std::move(lines.edges);
    buckets.counts_.largest_shift_plan = lines.largest_shift_plan;
  }
  buckets.sort(spool, reading.grid, options.merge, memory, stop, progress, keep_as);
  buckets.counts_.largest_shift_plan += reading.largest_shift;
  check_area(buckets.hull_, buckets.size_, context);
  return buckets;
}

HeightBits PointBuckets::stored(double height) const {
  return codes_are_whole_ ? frame_.heights.bits(height) : encode_height(frame_.heights, height);
}

void PointBuckets::require_undamaged(std::uint64_t bucket, std::span<const std::byte> bytes) const {
  if (checksum_of(bytes) != checksums_[bucket]) {
    throw Error(ErrorCode::corruption,
                "the sorted points of the build are not what was written; the disk or another "
                "program damaged them: start again after --discard",
                path_);
  }
}

void PointBuckets::take(std::uint64_t first, std::uint64_t count,
                        std::vector<BucketPoint>& points) const {
  points.clear();
  points.reserve(count);
  std::vector<std::byte> packed;
  std::vector<PlacedHeight> bucket;
  for (std::uint64_t at = first; at < first + count;) {
    const std::uint64_t number = at / bucket_points_;
    const std::uint64_t begin = number * bucket_points_;
    const std::uint64_t end = std::min(begin + bucket_points_, first + count);
    const std::uint64_t bytes = ends_[number] - begin_of(number);
    packed.resize(bytes + kUnpackSlack);
    file_->read_at(std::span(packed).first(bytes), begin_of(number));
    require_undamaged(number, std::span(packed).first(bytes));
    bucket.resize(end - begin);
    unpack_bucket(std::span(packed).first(bytes), box(number), bucket);
    for (; at < end; ++at) {
      const PlacedHeight& p = bucket[at - begin];
      points.push_back({p.position, stored(p.height)});
    }
  }
}

}  // namespace ptin
