// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/hierarchy/segment.h"

#include <algorithm>

#include "engine/check.h"

namespace ptin {

namespace {

void raise_to(RecordBounds& bounds, const RecordBounds& least) {
  bounds.error = std::max(bounds.error, least.error);
  bounds.deviation = std::max(bounds.deviation, least.deviation);
}

}  // namespace

SegmentBounds::SegmentBounds(const SegmentView& segment)
    : segment_(&segment), bounds_(segment.foreign.begin(), segment.foreign.end()) {
  bounds_.reserve(segment.foreign.size() + segment.records.size());
  for (const VertexSplit& r : segment.records) {
    bounds_.push_back({r.error, r.deviation});
  }
}

void SegmentBounds::raise(std::span<const BoundsRaise> raises) {
  for (const BoundsRaise& r : raises) {
    PTIN_CHECK(r.record < segment_->records.size());
    raise_to(bounds_[segment_->foreign.size() + r.record], r.bounds);
  }
}

void SegmentBounds::set_foreign(std::size_t child, std::span<const RecordBounds> bounds) {
  PTIN_CHECK(segment_->child_begin[child] + bounds.size() <= segment_->foreign.size());
  std::copy(bounds.begin(), bounds.end(), bounds_.begin() + segment_->child_begin[child]);
}

std::vector<RecordBounds> SegmentBounds::saturate() {
  std::uint32_t begin = 0;  // of the ring of record i
  for (std::size_t i = 0; i < segment_->records.size(); ++i) {
    RecordBounds& own = bounds_[segment_->foreign.size() + i];
    for (; begin < segment_->ring_end[i]; ++begin) {
      if (const std::uint32_t successor = segment_->successors[begin]; successor != kNone) {
        raise_to(own, bounds_[successor]);
      }
    }
  }
  std::vector<RecordBounds> exported;
  exported.reserve(segment_->exported.size());
  for (const std::uint32_t number : segment_->exported) {
    exported.push_back(bounds_[number]);
  }
  return exported;
}

StarredRecords SegmentBounds::records() const {
  StarredRecords records;
  records.splits.assign(segment_->records.begin(), segment_->records.end());
  for (std::size_t i = 0; i < records.size(); ++i) {
    records.splits[i].error = bounds_[segment_->foreign.size() + i].error;
    records.splits[i].deviation = bounds_[segment_->foreign.size() + i].deviation;
  }
  records.corners.assign(segment_->corners.begin(), segment_->corners.end());
  set_deaths(records.corners, segment_->successors,
             [this](std::uint32_t successor) { return bounds_[successor].error; });
  records.ring_end.assign(segment_->ring_end.begin(), segment_->ring_end.end());
  return records;
}

}  // namespace ptin
