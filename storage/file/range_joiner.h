// SPDX-License-Identifier: GPL-3.0-or-later
//
// Ranges of slots (record pages, nodes of the index) that are announced together.
#pragma once

#include <cstdint>
#include <new>
#include <span>
#include <vector>

#include "storage/file/readable_file.h"

namespace ptin {

/// Ranges that are announced: of a far file together, when this goes; of another one each at once,
/// without memory. A hint: what there is no memory for is left out.
class RangesToCome {
 public:
  RangesToCome(const ReadableFile& file, IoCounters& counters, Coming coming = Coming::kInOrder)
      : file_(file), counters_(counters), coming_(coming) {}
  RangesToCome(const RangesToCome&) = delete;
  RangesToCome& operator=(const RangesToCome&) = delete;
  ~RangesToCome() {
    if (file_.is_far()) {
      coming_ == Coming::kInOrder ? file_.will_need(ranges_) : file_.will_also_need(ranges_);
    }
  }

  [[nodiscard]] bool is_far() const noexcept { return file_.is_far(); }
  void add(const ByteRange& range) noexcept {
    ++counters_.ranges_announced;
    if (!file_.is_far()) {
      file_.will_need(std::span(&range, 1));
      return;
    }
    try {
      ranges_.push_back(range);
    } catch (const std::bad_alloc&) {
      ranges_.clear();  // What comes one by one comes all the same.
    }
  }

 private:
  const ReadableFile& file_;
  IoCounters& counters_;
  const Coming coming_;
  std::vector<ByteRange> ranges_;
};

/// Makes ranges from the slots that are wanted, which ascend. Slots that lie near each other are
/// joined, with what lies between them: one more request to the disk costs as much as reading a
/// gap of 32 KiB. Yet at most a third of what a run of requests reads is unwanted. The requests of a
/// round to a far file go out together, so that one more costs little: a gap of 8 KiB.
class RangeJoiner {
 public:
  /// @param offset  Place of slot 0 in the file.
  /// @param ranges  Borrowed; gets each range when it is complete, the last one when this goes.
  RangeJoiner(std::uint64_t offset, std::uint64_t slot_bytes, RangesToCome& ranges)
      : offset_(offset),
        slot_bytes_(slot_bytes),
        gap_((ranges.is_far() ? kFarGapBytes : kGapBytes) / slot_bytes),
        ranges_(ranges) {}
  RangeJoiner(const RangeJoiner&) = delete;
  RangeJoiner& operator=(const RangeJoiner&) = delete;
  ~RangeJoiner() { send(); }

  void add(std::uint64_t slot) noexcept {
    ++wanted_;
    if (begin_ == end_ || slot < end_ || slot - end_ > gap_ ||
        (wasted_ + (slot - end_)) * kWantedPerWaste > wanted_) {
      send();
      begin_ = slot;
    } else {
      wasted_ += slot - end_;
    }
    end_ = slot + 1;
  }

 private:
  static constexpr std::uint64_t kGapBytes = std::uint64_t{32} << 10;
  static constexpr std::uint64_t kFarGapBytes = std::uint64_t{8} << 10;
  static constexpr std::uint64_t kWantedPerWaste = 2;

  void send() noexcept {
    if (begin_ != end_) {
      ranges_.add({offset_ + begin_ * slot_bytes_, (end_ - begin_) * slot_bytes_});
    }
  }

  std::uint64_t offset_, slot_bytes_, gap_;
  RangesToCome& ranges_;
  std::uint64_t begin_ = 0, end_ = 0;
  std::uint64_t wanted_ = 0, wasted_ = 0;
};

}  // namespace ptin
