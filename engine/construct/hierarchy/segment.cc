// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/hierarchy/segment.h"

#include <algorithm>
#include <numeric>

#include "engine/check.h"

namespace ptin {

namespace {

void raise_to(RecordBounds& bounds, const RecordBounds& least) {
  bounds.error = std::max(bounds.error, least.error);
  bounds.deviation = std::max(bounds.deviation, least.deviation);
}

}  // namespace

void combine(std::vector<BoundsRaise>& raises) {
  std::sort(raises.begin(), raises.end(), [](const BoundsRaise& a, const BoundsRaise& b) {
    return key_of(a.vertex) < key_of(b.vertex);
  });
  std::size_t kept = 0;
  for (const BoundsRaise& r : raises) {
    if (kept > 0 && raises[kept - 1].vertex == r.vertex) {
      raise_to(raises[kept - 1].bounds, r.bounds);
    } else {
      raises[kept++] = r;
    }
  }
  raises.resize(kept);
}

SegmentBounds::SegmentBounds(const SegmentView& segment)
    : segment_(&segment), bounds_(segment.foreign.begin(), segment.foreign.end()) {
  bounds_.reserve(segment.foreign.size() + segment.records.size());
  for (const VertexSplit& r : segment.records) {
    bounds_.push_back({r.error, r.deviation});
  }
  by_vertex_.resize(segment.records.size());
  std::iota(by_vertex_.begin(), by_vertex_.end(), 0U);
  std::sort(by_vertex_.begin(), by_vertex_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return key_of(segment.records[a].u) < key_of(segment.records[b].u);
  });
}

void SegmentBounds::raise(std::span<const BoundsRaise> raises) {
  auto at = by_vertex_.begin();  // both ascend
  for (const BoundsRaise& r : raises) {
    at = std::lower_bound(at, by_vertex_.end(), key_of(r.vertex),
                          [this](std::uint32_t record, VertexKey key) {
                            return key_of(segment_->records[record].u) < key;
                          });
    PTIN_CHECK(at != by_vertex_.end() && segment_->records[*at].u == r.vertex);
    raise_to(bounds_[segment_->foreign.size() + *at], r.bounds);
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
