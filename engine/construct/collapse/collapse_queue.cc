// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse/collapse_queue.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace ptin {

namespace {

constexpr std::uint64_t kLastClass = (std::uint64_t{1} << kClassBits) - 1;
constexpr int kClassShift = 64 - kClassBits;
// Bits of a priority of CostModel::kError, the highest first: class 10, octave 5, neighbourhood
// 2 x 9, sixteenth of the octave 4, chain 12, half-perimeter 15.
constexpr int kBoxBits = 15;
constexpr int kChainBits = 12;
constexpr int kPartBits = 4;
constexpr int kSideBits = 9;
constexpr int kPartShift = kBoxBits + kChainBits;
constexpr int kNeighbourhoodShift = kPartShift + kPartBits;
constexpr int kOctaveShift = kNeighbourhoodShift + 2 * kSideBits;
constexpr std::uint64_t kVerticesANeighbourhood = 16384;

std::uint64_t clamped(std::int64_t v) noexcept {
  return static_cast<std::uint64_t>(std::clamp<std::int64_t>(v, 0, INT32_MAX));
}

/// The bits of `box` below its highest one, as a fraction of kPartBits + kBoxBits bits.
std::uint64_t within_octave(std::uint64_t box, int octave) noexcept {
  constexpr int kBits = kPartBits + kBoxBits;
  const std::uint64_t below = box & ~(std::uint64_t{1} << octave);
  return octave <= kBits ? below << (kBits - octave) : below >> (octave - kBits);
}

/// The order of heaps whose front is the least entry.
constexpr auto kLater = [](const QueueEntry& a, const QueueEntry& b) { return b < a; };

}  // namespace

std::uint32_t error_class(double error_quanta) noexcept {
  if (!(error_quanta >= 1.0)) {
    return 0;
  }
  if (std::isinf(error_quanta)) {
    return UINT32_MAX;
  }
  int exponent = 0;
  const double mantissa = std::frexp(error_quanta, &exponent);  // in [0.5, 1)
  constexpr double kThird = 0.62996052494743658238;             // 2^(-2/3)
  constexpr double kTwoThirds = 0.79370052598409973738;         // 2^(-1/3)
  const std::uint32_t part = (mantissa > 0.5 ? 1U : 0U) + (mantissa > kThird ? 1U : 0U) +
                             (mantissa > kTwoThirds ? 1U : 0U);
  return 1 + 3 * static_cast<std::uint32_t>(exponent - 1) + part;
}

PriorityScale::PriorityScale(CostModel cost, const GridBox& bounds, std::uint64_t vertices) noexcept
    : cost_(cost), origin_{bounds.min_x, bounds.min_y} {
  const double area = (static_cast<double>(bounds.max_x) - bounds.min_x + 1.0) *
                      (static_cast<double>(bounds.max_y) - bounds.min_y + 1.0);
  const double side_squared = area / static_cast<double>(std::max<std::uint64_t>(vertices, 1)) *
                              static_cast<double>(kVerticesANeighbourhood);
  while (shift_ < 30 && std::ldexp(1.0, 2 * shift_ + 2) <= side_squared) {
    ++shift_;
  }
}

std::uint64_t PriorityScale::neighbourhood(GridPoint p, int octave) const noexcept {
  const int shift = std::min(std::max(shift_, octave + 3), 31);
  constexpr std::uint64_t kMax = (std::uint64_t{1} << kSideBits) - 1;
  const auto x = std::min(static_cast<std::uint64_t>(std::int64_t{p.x} - origin_.x) >> shift, kMax);
  const auto y = std::min(static_cast<std::uint64_t>(std::int64_t{p.y} - origin_.y) >> shift, kMax);
  return (y << kSideBits) | x;
}

std::uint64_t PriorityScale::operator()(const CollapseMeasure& measure) const noexcept {
  const std::uint64_t box = clamped(half_perimeter(measure.roi));
  const int octave = static_cast<int>(std::bit_width(box)) - (box == 0 ? 0 : 1);
  switch (cost_) {
    case CostModel::kError: {
      const std::uint64_t c =
          std::min<std::uint64_t>(error_class(measure.error_quanta), kLastClass);
      const std::uint64_t fraction = within_octave(box, octave);
      const std::uint64_t chain =
          std::min<std::uint64_t>(measure.chain, (std::uint64_t{1} << kChainBits) - 1);
      return (c << kClassShift) | (static_cast<std::uint64_t>(octave) << kOctaveShift) |
             (neighbourhood(measure.vertex, octave) << kNeighbourhoodShift) |
             (fraction >> kBoxBits << kPartShift) | (chain << kBoxBits) |
             (fraction & ((std::uint64_t{1} << kBoxBits) - 1));
    }
    case CostModel::kRoi:
      return (static_cast<std::uint64_t>(octave) << kClassShift) | box;
    case CostModel::kElevation:
      // The bits of a float that is not negative grow with it.
      return (std::uint64_t{std::bit_cast<std::uint32_t>(static_cast<float>(measure.height_quanta))}
              << 32) |
             box;
  }
  return 0;
}

void CollapseQueue::push(const QueueEntry& entry) {
  if (first_ != ahead_.size() && entry < ahead_.back()) {
    const auto from = ahead_.begin() + static_cast<std::ptrdiff_t>(first_);
    ahead_.insert(std::upper_bound(from, ahead_.end(), entry), entry);
    return;
  }
  const std::size_t bucket = entry.priority >> (64 - kBucketBits);
  if (bucket > present_) {
    waiting_[bucket].push_back(entry);
    return;
  }
  late_.push_back(entry);
  std::push_heap(late_.begin(), late_.end(), kLater);
}

/// Draws until twice kLookahead entries are ahead, or none is left elsewhere.
void CollapseQueue::draw_ahead() {
  ahead_.erase(ahead_.begin(), ahead_.begin() + static_cast<std::ptrdiff_t>(first_));
  first_ = 0;
  while (ahead_.size() < 2 * kLookahead) {
    if (next_ == run_.size() && late_.empty()) {
      if (present_ + 1 == waiting_.size()) {
        return;
      }
      ++present_;
      run_ = std::move(waiting_[present_]);
      waiting_[present_] = {};
      next_ = 0;
      std::sort(run_.begin(), run_.end());
    } else if (late_.empty() || (next_ < run_.size() && run_[next_] < late_.front())) {
      ahead_.push_back(run_[next_++]);
    } else {
      std::pop_heap(late_.begin(), late_.end(), kLater);
      ahead_.push_back(late_.back());
      late_.pop_back();
    }
  }
}

bool CollapseQueue::empty() {
  if (ahead_.size() - first_ < kLookahead) {
    draw_ahead();
  }
  return first_ == ahead_.size();
}

void CollapseQueue::rename(const std::vector<VertexId>& new_name) noexcept {
  const auto rename_all = [&](std::vector<QueueEntry>& entries, std::size_t first) {
    for (std::size_t i = first; i < entries.size(); ++i) {
      entries[i].vertex = new_name[entries[i].vertex];
    }
  };
  rename_all(ahead_, first_);
  rename_all(run_, next_);
  rename_all(late_, 0);
  for (std::vector<QueueEntry>& entries : waiting_) {
    rename_all(entries, 0);
  }
}

}  // namespace ptin
