// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/highest_gather.h"

#include <algorithm>

#include "engine/query/refine/refinement.h"

namespace ptin {

namespace {

constexpr std::size_t kFewSplits = 4096;  // fewer are not worth looking through

}  // namespace

void HighGatherer::start(std::size_t wanted) {
  wanted_ = wanted;
  most_ = -kInfinity;
  heap_.clear();
  splits_.clear();
  looked_through_ = 0;
  for (const CoarsestTin::V& v : store_.t0().vertices) {
    if (v.has_height != 0) {
      offer(v.position, v.height);
    }
  }
}

void HighGatherer::reserve_told(std::size_t more) {
  if (told_.size() + more > told_capacity_) {
    told_capacity_ = std::max(told_.size() + more, 2 * told_capacity_);
    told_.reserve(told_capacity_);
  }
}

std::uint64_t HighGatherer::held_bytes() const noexcept {
  return splits_.capacity() * sizeof(Reaching) + KeyTable::bytes_for(told_capacity_);
}

Merit HighGatherer::bound(const Attributes& a) const {
  if (!predicate_.holds(a) || is_empty(a.heights)) {
    return kNoMerit;
  }
  return {lowest_ ? -a.heights.lo : a.heights.hi, key_of({a.roi.min_x, a.roi.min_y})};
}

Merit HighGatherer::visit(PageId page) {
  context_.check_stop();
  records_.clear();
  context_.cost.records_examined +=
      store_.read_matching(page, predicate_, records_, context_.cost.io);
  for (const VertexSplit& r : records_) {
    const PendingSplit split = pending_of(r, page);
    if (!detail_.keeps(split)) {
      continue;
    }
    if ((r.flags & VertexSplit::kVertexVoid) == 0) {
      offer(r.u, r.height);
    }
    const double reach = bound(attributes_of(r, store_.facts().heights)).value;
    if (reach > most_) {
      splits_.push_back({split, reach});
    }
  }
  if (splits_.size() > std::max(kFewSplits, 2 * looked_through_)) {
    drop_what_ends_below();
  }
  context_.admit(refinement_bytes(splits_.size()) + heap_.capacity() * sizeof(HighCandidate) +
                 KeyTable::bytes_for(told_capacity_));
  return cut_off();
}

void HighGatherer::offer(GridPoint p, HeightBits height) {
  const double code = store_.facts().heights.code(height);
  const HighCandidate c{lowest_ ? -code : code, key_of(p)};
  if (!cut_off().is_below(merit_of(c)) || (window_ != nullptr && !window_->meets(box_of(p))) ||
      is_rejected(c.key)) {
    return;
  }
  most_ = std::max(most_, c.value);
  if (heap_.size() == wanted_) {
    std::pop_heap(heap_.begin(), heap_.end(), is_better);
    heap_.pop_back();
  }
  heap_.push_back(c);
  std::push_heap(heap_.begin(), heap_.end(), is_better);
}

void HighGatherer::drop_what_ends_below() {
  std::erase_if(splits_, [this](const Reaching& r) { return !(r.bound > most_); });
  looked_through_ = splits_.size();
}

std::vector<HighCandidate> HighGatherer::take_best() {
  std::sort(heap_.begin(), heap_.end(), is_better);
  return std::move(heap_);
}

std::vector<PendingSplit> HighGatherer::take_splits() {
  drop_what_ends_below();
  std::vector<PendingSplit> wanted;
  wanted.reserve(splits_.size());
  for (const Reaching& r : splits_) {
    wanted.push_back(r.split);
  }
  context_.cost.records_retrieved += wanted.size();
  return wanted;
}

}  // namespace ptin
