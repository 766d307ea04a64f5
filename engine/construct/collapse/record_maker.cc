// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse/record_maker.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "engine/check.h"
#include "engine/construct/measure/fan_deviation.h"
#include "engine/construct/measure/saturation.h"
#include "engine/geometry/rounding.h"
#include "engine/prefetch.h"

namespace ptin {

namespace {

std::uint16_t flags_of(const Tin& tin, const CollapseSite& site) {
  const auto is_void = [&](TriangleId t) {
    return t != kNone && tin.classes[t] == TriangleClass::kVoid;
  };
  unsigned flags = 0;
  const auto set_when = [&](bool condition, VertexSplit::Flag flag) {
    flags |= condition ? unsigned{flag} : 0U;
  };
  set_when(is_void(site.left), VertexSplit::kLeftVoid);
  set_when(is_void(site.right), VertexSplit::kRightVoid);
  set_when(site.left == kNone, VertexSplit::kNoLeft);
  set_when(site.right == kNone, VertexSplit::kNoRight);
  set_when(tin.has_height[site.u] == 0, VertexSplit::kVertexVoid);
  return static_cast<std::uint16_t>(flags);
}

}  // namespace

VertexSplit RecordMaker::make_record(const StarSamples& s, const FanError& own,
                                     const CollapseSite& site) {
  const Tin& tin = tile_.tin;
  VertexSplit r;
  const double fixed = full_ != nullptr ? fan_fixed_gap(tile_, s, fan_, {*full_}) : 0.0;
  r.error = height_bound(std::max(own.error, fixed), tile_.units.heights);
  std::uint32_t rank = 0;
  if (full_ != nullptr) {
    r.deviation =
        height_bound(std::max(own.deviation, fan_deviation(tile_, s, fan_, *full_, kEverywhere)),
                     tile_.units.heights);
  }
  for (const TriangleId t : s.star.triangles) {
    if (const std::uint32_t below = tile_.carried[t].record; below != kNone) {
      const VertexSplit& b = tile_.records[below];
      if (full_ != nullptr) {
        r.error = std::max(r.error, b.error);
        r.deviation = std::max(r.deviation, b.deviation);
      }
      rank = std::max<std::uint32_t>(rank, b.rank + 1U);
    }
  }
  if (rank > UINT16_MAX) {
    throw Error(ErrorCode::resource_exhausted,
                "a chain of more than 65 535 collapses depends on each other; build with the cost "
                "'error' or 'roi', or smaller tiles");
  }
  r.rank = static_cast<std::uint16_t>(rank);
  r.u = tin.position(site.u);
  r.w = tin.position(site.w);
  r.vl = tin.position(site.vl);
  r.vr = tin.position(site.vr);
  r.roi = saturated_box(tile_, s.star);
  std::tie(r.height_lo, r.height_hi) =
      height_bits(saturated_heights(tile_, s.star), tile_.units.heights);
  r.flags = flags_of(tin, site);
  if (tin.has_height[site.u] != 0) {
    r.height = tin.vertices[site.u].height;
  }
  return r;
}

/// Appends the star to the stars of the tile, while its mesh and what it carries are there: w first
/// where it is closed, else as it is walked.
void RecordMaker::append_star(const Star& star, std::size_t j) {
  const Tin& tin = tile_.tin;
  RecordStars& stars = tile_.stars;
  std::size_t i = star.closed ? j : 0;
  for (std::size_t k = 0; k < star.degree(); ++k) {
    const VertexId v = star.link[i];
    RingCorner corner;
    corner.position = tin.position(v);
    if (tin.has_height[v] != 0) {
      corner.height = tin.vertices[v].height;
    } else {
      corner.flags = RingCorner::kNoHeight;
    }
    std::uint32_t successor = kNone;
    if (i < star.triangles.size()) {
      const TriangleId t = star.triangles[i];
      successor = tile_.carried[t].record;
      if (tin.classes[t] == TriangleClass::kVoid) {
        corner.flags |= RingCorner::kVoid;
      }
    }
    stars.corners.push_back(corner);
    stars.successors.push_back(successor);
    i = i + 1 == star.degree() ? 0 : i + 1;
  }
  stars.ring_end.push_back(static_cast<std::uint32_t>(stars.corners.size()));
}

void RecordMaker::prefetch_records(const Star& star) const {
  for (const TriangleId t : star.triangles) {
    if (const std::uint32_t r = tile_.carried[t].record; r != kNone) {
      const auto* bytes = reinterpret_cast<const char*>(&tile_.records[r]);
      prefetch(bytes);
      prefetch(bytes + sizeof(VertexSplit) - 1);
    }
  }
}

void RecordMaker::collapse_and_record(StarSamples& s, std::size_t j) {
  PTIN_CHECK(make_fan(s, j, fan_));
  if (s.count == 0) {
    gather_samples(tile_, s);
  }
  prefetch_records(s.star);  // read after the measuring
  gather_sources(tile_, s);
  const FanError own = measure_fan(tile_, s, fan_, full_, assignment_);
  const CollapseSite site = collapse_site(s.star, j);
  const VertexSplit record = make_record(s, own, site);
  append_star(s.star, j);
  fan_ids_.clear();
  for (const std::uint32_t i : fan_.star_triangle) {
    fan_ids_.push_back(s.star.triangles[i]);
  }
  hand_over_.run(tile_, s, fan_, assignment_, fan_ids_, false);
  (void)collapse(tile_.tin, s.star, j);
  const auto id = static_cast<std::uint32_t>(tile_.records.size());
  tile_.records.push_back(record);
  for (const TriangleId t : fan_ids_) {
    carry_record(tile_.carried[t], record, id);
  }
}

}  // namespace ptin
