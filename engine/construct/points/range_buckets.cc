// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/range_buckets.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "engine/construct/grid/point_merge.h"
#include "engine/construct/grid/point_sorter.h"
#include "engine/construct/points/packed_bucket.h"
#include "engine/construct/points/point_shares.h"
#include "engine/error.h"
#include "engine/stop.h"
#include "storage/file/checksum.h"
#include "storage/file/external_memory.h"
#include "storage/file/external_sorter.h"

namespace ptin {

namespace {

/// Merges points that come in the order of the curve, and writes them in buckets.
class BucketWriter {
 public:
  BucketWriter(const SortPlan& plan, const PointFiles& files, const std::string& path)
      : plan_(plan),
        order_(plan.order()),
        syncs_(files.syncs_buckets),
        file_(files.files, without_old(files.files, path), ScratchFile::Kept::kNew),
        index_{0, 0.0, HeightFinder(plan.grid.whole, plan.grid.heights.unit()), {}, {}, {}, {}} {}

  void add(std::uint64_t key, double height) {
    if (merged_ && key == key_) {
      merged_->add(height);
      return;
    }
    put();
    key_ = key;
    merged_.emplace(height);
  }

  [[nodiscard]] RangeIndex finish() {
    put();
    write();
    if (syncs_) {
      file_.sync();
    }
    file_.close();
    index_.hull = hull_.hull().corners();
    return std::move(index_);
  }

 private:
  void put() {
    if (!merged_) {
      return;
    }
    const double height = merged_->height(plan_.rule, plan_.grid.whole);
    index_.largest_shift_height = std::max(index_.largest_shift_height, merged_->shift(height));
    index_.heights.add(height);
    const GridPoint position = order_.point(key_);
    hull_.add(position);
    bucket_.push_back({position, height});
    ++index_.points;
    if (bucket_.size() == plan_.bucket_points) {
      write();
    }
  }

  void write() {
    if (bucket_.empty()) {
      return;
    }
    GridBox box;
    for (const GridVertex& p : bucket_) {
      box = united(box, p.position);
    }
    pack_bucket(bucket_, box, packed_);
    const std::uint64_t begin = index_.ends.empty() ? 0 : index_.ends.back();
    file_.write_at(packed_, begin);
    index_.checksums.push_back(checksum_of(packed_));
    index_.ends.push_back(begin + packed_.size());
    index_.boxes.push_back(box);
    bucket_.clear();
  }

  const SortPlan& plan_;
  PointOrder order_;
  bool syncs_;
  ScratchFile file_;
  RangeIndex index_;
  HullCollector hull_;
  std::vector<GridVertex> bucket_;
  std::vector<std::byte> packed_;
  std::uint64_t key_ = 0;
  std::optional<MergedHeight> merged_;
};

template <class Record>
RangeIndex sort_as(const SortPlan& plan, const RangeOfShares& records, const PointFiles& files,
                   const Task& task) {
  const ExternalMemory memory{files.files, files.folder, std::max(task.bytes, plan.least_memory)};
  ExternalSorter<Record> sorter(memory, "points", task.stop);
  sorter.expect(records.records());
  const auto report = [&](std::uint64_t done) {
    stop_if_asked(task.stop, "sorting the points");
    task.tell(done / 2);
  };
  records.read<Record>([&](std::span<const Record> some) {
    for (const Record& r : some) {
      sorter.add(r);
    }
    report(sorter.size());
  });
  BucketWriter writer(plan, files, plan.buckets_of(number_of(task.name)));
  std::uint64_t done = sorter.size();
  sorter.merge(
      [&](const auto& points) {
        for (const auto& p : points) {
          writer.add(p.key, p.height);
        }
        report(done += points.size());
      },
      task.stop);
  return writer.finish();
}

}  // namespace

ArrayFileFacts sort_range(const SortPlan& plan, const std::vector<ArrayFileFacts>& shares,
                          const PointFiles& files, const Task& task) {
  const RangeOfShares records(files, shares, number_of(task.name));
  const RangeIndex index = plan.is_numbered() ? sort_as<NumberedHeight>(plan, records, files, task)
                                              : sort_as<KeyedHeight>(plan, records, files, task);
  ArrayFileWriter file(files.files, files.path("range", number_of(task.name)));
  file.values(index);
  return file.finish();
}

RangeIndex index_of_range(const PointFiles& files, std::size_t range, const ArrayFileFacts& facts) {
  ArrayFileReader file = files.open(files.path("range", range), facts);
  RangeIndex index{0, 0.0, HeightFinder(false, 0.0), {}, {}, {}, {}};
  file.values(index);
  return index;
}

}  // namespace ptin
