// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/sorted_samples.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "engine/query/shape/tiler.h"

namespace ptin::tools {

namespace {

/// Records that are read at once to find one of them.
constexpr std::uint64_t kBlock = 1024;
constexpr int kKeyBits = 64;

bool is_single(const GridBox& box) { return box.min_x == box.max_x && box.min_y == box.max_y; }

}  // namespace

SortedSamples::SortedSamples(const StoreFacts& facts, const ExternalMemory& memory, PointMerge rule)
    : facts_(facts), memory_(memory), rule_(rule) {
  memory_.bytes /= 2;
  sorter_ = std::make_unique<Sorter>(memory_, "samples");
}

std::uint64_t SortedSamples::key_of(GridPoint p) const {
  GridBox box = facts_.bounds;
  std::uint64_t key = 0;
  for (int bit = kKeyBits - 1; !is_single(box); --bit) {
    const auto halves = divided(box);
    const bool high = contains(halves[1], p);
    key |= static_cast<std::uint64_t>(high) << bit;
    box = halves[high ? 1 : 0];
  }
  return key;
}

GridPoint SortedSamples::point_of(std::uint64_t key) const {
  GridBox box = facts_.bounds;
  for (int bit = kKeyBits - 1; !is_single(box); --bit) box = divided(box)[(key >> bit) & 1];
  return {box.min_x, box.min_y};
}

void SortedSamples::add(GridPoint p, double height) {
  sorter_->add({key_of(p), height, rule_ == PointMerge::kFirst ? sorter_->size() : 0});
}

/// A height as it is summed up: as a whole code, so that sums are exact; as it is where the store
/// keeps floats.
double SortedSamples::code_of(double height) const {
  const HeightEncoding& heights = facts_.heights;
  return heights.type == HeightType::int32
             ? std::nearbyint((height - heights.offset) / heights.step)
             : height;
}

double SortedSamples::mean_of(double sum, std::uint64_t count) const {
  const double mean = sum / static_cast<double>(count);
  return facts_.heights.type == HeightType::int32
             ? facts_.heights.height_of_code(std::nearbyint(mean))
             : mean;
}

double SortedSamples::merged(const Together& samples) const {
  switch (rule_) {
    case PointMerge::kLowest:
      return samples.lowest;
    case PointMerge::kHighest:
      return samples.highest;
    case PointMerge::kFirst:
      return samples.first.height;
    case PointMerge::kMean:
      break;
  }
  return samples.lowest == samples.highest ? samples.lowest : mean_of(samples.sum, samples.count);
}

void SortedSamples::sort(const std::stop_token& stop) {
  const bool fits = sorter_->size() <= memory_.bytes / sizeof(Record);
  if (!fits) file_ = std::make_unique<ScratchFile>(memory_.files, memory_.folder, "samples", true);
  records_.reserve(static_cast<std::size_t>(fits ? sorter_->size() : kBlock));
  Together together;
  const auto keep_merged = [&] {
    if (together.count > 0) keep({together.first.key, merged(together)});
  };
  sorter_->merge(
      [&](std::span<const NumberedRecord> batch) {
        for (const NumberedRecord& record : batch) {
          if (together.count == 0 || record.key != together.first.key) {
            keep_merged();
            together = {record, record.height, record.height, 0.0, 0};
          }
          together.lowest = std::min(together.lowest, record.height);
          together.highest = std::max(together.highest, record.height);
          together.sum += code_of(record.height);
          ++together.count;
        }
      },
      stop);
  keep_merged();
  sorter_.reset();
  if (file_) flush();
}

void SortedSamples::keep(const Record& record) {
  records_.push_back(record);
  ++size_;
  if (file_ && records_.size() == kBlock) flush();
}

/// Writes the records that are held: a block, or at the end the rest.
void SortedSamples::flush() {
  if (records_.empty()) return;
  landmarks_.push_back(records_.front().key);
  file_->write_at(std::as_bytes(std::span(records_)), (size_ - records_.size()) * sizeof(Record));
  records_.clear();
}

std::vector<SortedSamples::Record> SortedSamples::load(std::uint64_t begin,
                                                       std::uint64_t end) const {
  if (!file_) {
    return {records_.begin() + static_cast<std::ptrdiff_t>(begin),
            records_.begin() + static_cast<std::ptrdiff_t>(end)};
  }
  std::vector<Record> loaded(static_cast<std::size_t>(end - begin));
  file_->read_at(std::as_writable_bytes(std::span(loaded)), begin * sizeof(Record));
  return loaded;
}

std::uint64_t SortedSamples::find(std::uint64_t key) const {
  const auto before = [](const Record& record, std::uint64_t k) { return record.key < k; };
  if (!file_) {
    const auto found = std::lower_bound(records_.begin(), records_.end(), key, before);
    return static_cast<std::uint64_t>(found - records_.begin());
  }
  // The record is in the block before the first block that begins with `key` or more, or begins
  // that one: keys are unique.
  const auto block = std::lower_bound(landmarks_.begin(), landmarks_.end(), key);
  if (block == landmarks_.begin()) return 0;
  const std::uint64_t begin = static_cast<std::uint64_t>(block - landmarks_.begin() - 1) * kBlock;
  const std::vector<Record> records = load(begin, std::min(begin + kBlock, size_));
  const auto found = std::lower_bound(records.begin(), records.end(), key, before);
  return begin + static_cast<std::uint64_t>(found - records.begin());
}

template <typename Visit>
void SortedSamples::visit_runs(const GridBox& box, const Visit& visit) const {
  std::vector<Run> open{{facts_.bounds, 0, 0, 0, size_}};
  while (!open.empty()) {
    const Run run = open.back();
    open.pop_back();
    if (run.begin == run.end || !meets(run.box, box)) continue;
    const bool is_inside = contains(box, run.box);
    if (is_inside || run.end - run.begin <= kBlock) {
      visit(run, is_inside);
      continue;
    }
    const auto halves = divided(run.box);
    const std::uint64_t key = run.key | std::uint64_t{1} << (kKeyBits - 1 - run.depth);
    const std::uint64_t middle = find(key);
    open.push_back({halves[0], run.key, run.depth + 1, run.begin, middle});
    open.push_back({halves[1], key, run.depth + 1, middle, run.end});
  }
}

std::uint64_t SortedSamples::count(const GridBox& box) const {
  std::uint64_t count = 0;
  visit_runs(box, [&](const Run& run, bool is_inside) {
    if (is_inside) {
      count += run.end - run.begin;
      return;
    }
    for (const Record& record : load(run.begin, run.end))
      count += contains(box, point_of(record.key)) ? 1 : 0;
  });
  return count;
}

std::vector<SourceSample> SortedSamples::read(const GridBox& box) const {
  std::vector<SourceSample> samples;
  visit_runs(box, [&](const Run& run, bool) {
    for (std::uint64_t i = run.begin; i < run.end; i += kBlock) {
      for (const Record& record : load(i, std::min(i + kBlock, run.end))) {
        const GridPoint p = point_of(record.key);
        if (contains(box, p)) samples.push_back({p.x, p.y, record.height, false});
      }
    }
  });
  return samples;
}

}  // namespace ptin::tools
