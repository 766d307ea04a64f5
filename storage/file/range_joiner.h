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

/// Makes ranges from the slots that are wanted, which ascend. Slots that lie near each other are
/// joined, with what lies between them: one more request to the disk costs as much as reading a
/// gap of 32 KiB. Yet at most a third of what a run of requests reads is unwanted. The requests of a
/// round to a far file go out together, so that one more costs little: a gap of 8 KiB.
class RangeJoiner {
 public:
  RangeJoiner(std::uint64_t slot_bytes, bool is_far)
      : gap_((is_far ? kFarGapBytes : kGapBytes) / slot_bytes) {}

  /// True when `slot` was joined to the current range; otherwise the range is complete, and
  /// restart() begins the next.
  bool join(std::uint64_t slot) {
    ++wanted_;
    if (begin_ == end_ || slot < end_ || slot - end_ > gap_ ||
        (wasted_ + (slot - end_)) * kWantedPerWaste > wanted_) {
      return false;
    }
    wasted_ += slot - end_;
    end_ = slot + 1;
    return true;
  }
  void restart(std::uint64_t slot) {
    begin_ = slot;
    end_ = slot + 1;
  }
  [[nodiscard]] std::uint64_t begin() const { return begin_; }
  [[nodiscard]] std::uint64_t size() const { return end_ - begin_; }  ///< 0: there is none.

 private:
  static constexpr std::uint64_t kGapBytes = std::uint64_t{32} << 10;
  static constexpr std::uint64_t kFarGapBytes = std::uint64_t{8} << 10;
  static constexpr std::uint64_t kWantedPerWaste = 2;

  std::uint64_t gap_;
  std::uint64_t begin_ = 0, end_ = 0;
  std::uint64_t wanted_ = 0, wasted_ = 0;
};

/// Ranges that are announced: of a far file together, when this goes; of another one each at once,
/// without memory. A hint: what there is no memory for is left out.
class RangesToCome {
 public:
  RangesToCome(const ReadableFile& file, IoCounters& counters) : file_(file), counters_(counters) {}
  RangesToCome(const RangesToCome&) = delete;
  RangesToCome& operator=(const RangesToCome&) = delete;
  ~RangesToCome() {
    if (file_.is_far()) {
      file_.will_need(ranges_);
    }
  }

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
  std::vector<ByteRange> ranges_;
};

}  // namespace ptin
