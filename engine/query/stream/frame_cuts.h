// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the total order of the splits of a stream is cut into frames.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/query/select/total_order.h"
#include "engine/query/stream/stream_format.h"

namespace ptin {

/// Takes the places of all splits in their order, and keeps those at which frames begin: of any
/// other record the frame is found by its place alone. A frame holds an eighth as many splits as
/// the mesh has vertices by then, but 256 to 2^20 of them.
class FrameCuts {
 public:
  /// @param base_vertices  Of the mesh to which the first split is applied.
  /// @param most_splits    Splits that are taken; those behind are left out.
  FrameCuts(std::uint64_t base_vertices, std::uint64_t most_splits)
      : base_vertices_(base_vertices), most_splits_(most_splits) {}

  /// REQUIRES: no place comes before one that was added earlier.
  void add(const RecordPlace& place) {
    if (splits_ == most_splits_) {
      if (!end_) leave_out(place.error);
      if (!end_) end_ = place;
      return;
    }
    if (splits_ == next_) {
      firsts_.push_back(place);
      begins_.push_back(splits_);
      next_ += std::clamp((base_vertices_ + splits_) / kShare, kLeastSplits, kMostSplits);
    }
    ++splits_;
  }
  /// Notes that a record of this error is left out.
  void leave_out(double error) noexcept { left_out_ = std::max(left_out_, error); }

  [[nodiscard]] std::uint64_t splits() const noexcept { return splits_; }
  [[nodiscard]] std::size_t frames() const noexcept { return firsts_.size(); }
  /// Splits before frame `i`, which may be frames().
  [[nodiscard]] std::uint64_t begin(std::size_t i) const noexcept {
    return i < begins_.size() ? begins_[i] : splits_;
  }
  [[nodiscard]] std::uint64_t count(std::size_t i) const noexcept {
    return begin(i + 1) - begin(i);
  }
  /// Most splits of a frame among so many.
  [[nodiscard]] static std::uint64_t most_of_frame(std::uint64_t base_vertices,
                                                   std::uint64_t splits) noexcept {
    return std::min(splits,
                    std::clamp((base_vertices + splits) / kShare, kLeastSplits, kMostSplits));
  }
  [[nodiscard]] std::uint64_t largest() const noexcept {
    std::uint64_t most = 0;
    for (std::size_t i = 0; i < frames(); ++i) most = std::max(most, count(i));
    return most;
  }
  /// The first record that is left out; none: all are taken.
  [[nodiscard]] const std::optional<RecordPlace>& end() const noexcept { return end_; }
  /// The frame of a split. REQUIRES: it was among those taken.
  [[nodiscard]] std::size_t frame_of(const RecordPlace& place) const noexcept {
    const auto next = std::upper_bound(firsts_.begin(), firsts_.end(), place);
    return static_cast<std::size_t>(next - firsts_.begin()) - (next == firsts_.begin() ? 0 : 1);
  }
  /// The largest error of what is missing before frame `i`, which may be frames(); -1: nothing is.
  [[nodiscard]] double error_before(std::size_t i) const noexcept {
    return i < firsts_.size() ? firsts_[i].error : left_out_;
  }

 private:
  static constexpr std::uint64_t kLeastSplits = 256;
  static constexpr std::uint64_t kMostSplits = std::uint64_t{1} << 20;
  static constexpr std::uint64_t kShare = 8;
  static_assert(kShare <= stream::kLeastShare && kMostSplits >= stream::kMostLeastSplits);

  std::uint64_t base_vertices_, most_splits_;
  std::uint64_t splits_ = 0, next_ = 0;
  std::vector<RecordPlace> firsts_;
  std::vector<std::uint64_t> begins_;
  std::optional<RecordPlace> end_;
  double left_out_ = -1.0;
};

}  // namespace ptin
