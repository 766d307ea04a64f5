// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse_queue.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace ptin {

namespace {

constexpr std::size_t kArity = 4;  // four children share a cache line: half the levels of a binary heap

std::uint64_t clamped32(std::int64_t v) noexcept {
  return static_cast<std::uint64_t>(std::clamp<std::int64_t>(v, 0, UINT32_MAX));
}

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
  constexpr double kQuarter = 0.59460355750136053336;           // 2^(-3/4)
  constexpr double kHalf = 0.70710678118654752440;              // 2^(-1/2)
  constexpr double kThreeQuarters = 0.84089641525371454303;     // 2^(-1/4)
  const std::uint32_t part = (mantissa >= kQuarter ? 1U : 0U) + (mantissa >= kHalf ? 1U : 0U) +
                             (mantissa >= kThreeQuarters ? 1U : 0U);
  return 1 + 4 * static_cast<std::uint32_t>(exponent - 1) + part;
}

std::uint64_t priority_of(CostModel cost, const CollapseMeasure& measure) noexcept {
  const std::uint64_t box = clamped32(half_perimeter(measure.roi));
  switch (cost) {
    case CostModel::kError:
      return (std::uint64_t{error_class(measure.error_quanta)} << 32) | box;
    case CostModel::kRoi:
      return box;
    case CostModel::kElevation:
      // The bits of a float that is not negative grow with it.
      return (std::uint64_t{std::bit_cast<std::uint32_t>(static_cast<float>(measure.height_quanta))} << 32) | box;
  }
  return 0;
}

void CollapseQueue::assign(std::vector<QueueEntry> entries) {
  heap_ = std::move(entries);
  if (heap_.size() < 2) {
    return;
  }
  for (std::size_t i = (heap_.size() - 2) / kArity + 1; i-- > 0;) {
    sift_down(i, QueueEntry(heap_[i]));
  }
}

void CollapseQueue::push(const QueueEntry& entry) {
  std::size_t hole = heap_.size();
  heap_.push_back(entry);
  while (hole > 0) {
    const std::size_t parent = (hole - 1) / kArity;
    if (!(entry < heap_[parent])) {
      break;
    }
    heap_[hole] = heap_[parent];
    hole = parent;
  }
  heap_[hole] = entry;
}

void CollapseQueue::pop() {
  const QueueEntry last = heap_.back();
  heap_.pop_back();
  if (!heap_.empty()) {
    sift_down(0, last);
  }
}

void CollapseQueue::replace_top(const QueueEntry& entry) { sift_down(0, entry); }

void CollapseQueue::sift_down(std::size_t hole, const QueueEntry& entry) {
  const std::size_t n = heap_.size();
  while (true) {
    const std::size_t first = hole * kArity + 1;
    if (first >= n) {
      break;
    }
    std::size_t least = first;
    const std::size_t end = std::min(first + kArity, n);
    for (std::size_t c = first + 1; c < end; ++c) {
      if (heap_[c] < heap_[least]) {
        least = c;
      }
    }
    if (!(heap_[least] < entry)) {
      break;
    }
    heap_[hole] = heap_[least];
    hole = least;
  }
  heap_[hole] = entry;
}

}  // namespace ptin
