// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/record_maker.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "engine/check.h"
#include "engine/construct/rounding.h"
#include "engine/construct/saturation.h"
#include "engine/construct/void_measure.h"

namespace ptin {

namespace {

/// Bits of an interval of codes; an empty one as the format has it (lo > hi).
std::pair<HeightBits, HeightBits> bits_of(const Interval& codes, const HeightEncoding& heights) {
  if (!is_empty(codes)) {
    return {heights.bits(codes.lo), heights.bits(codes.hi)};
  }
  if (heights.type == HeightType::int32) {
    return {heights.bits(INT32_MAX), heights.bits(INT32_MIN)};
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {heights.bits(kInfinity), heights.bits(-kInfinity)};
}

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

/// Fills triangle_ and residual_; returns the collapse's own error and the deviation at samples, in
/// codes.
RecordMaker::OwnPart RecordMaker::measure(const StarSamples& s) {
  if (s.void_only) {
    (void)measure_with_voids(tile_, s, fan_, &triangle_);
    residual_.assign(triangle_.size(), 0.0);
    return {};
  }
  const double bound = residual_bound(s, tile_.units);
  if (!s.surface_only) {
    const VoidMeasure voids = measure_with_voids(tile_, s, fan_, &triangle_);
    residual_.assign(triangle_.size(), 0.0);
    return {scaled_up(voids.error) + bound, scaled_up(voids.deviation) + bound};
  }
  assign_samples(s, fan_, triangle_, residual_);
  const double worst = *std::max_element(residual_.begin(), residual_.end());
  double error = scaled_up(worst) + bound;
  if (bound > 0.0 && worst <= bound && all_residuals_zero(tile_, s, fan_)) {
    error = 0.0;
  }
  return {error, error};
}

/// Largest gap along the new inner edges that have surface on one side at least; link edges are
/// covered by what the star carries.
double RecordMaker::spoke_deviation(const StarSamples& s) const {
  double worst = 0.0;
  const Star& star = s.star;
  const auto end_of = [&](std::size_t link) {
    const VertexId v = star.link[link];
    return EdgeEnd{v, tile_.tin.position(v),
                   tile_.units.heights.code(tile_.tin.vertices[v].height)};
  };
  const auto is_surface = [&](std::size_t i) {
    return tile_.tin.classes[star.triangles[fan_.star_triangle[i]]] == TriangleClass::kSurface;
  };
  const EdgeEnd w = end_of(fan_.j);
  for (std::size_t i = 1; i < fan_.triangles(); ++i) {
    if (is_surface(i - 1) || is_surface(i)) {
      worst = std::max(worst, full_.largest_gap(w, end_of((fan_.j + 1 + i) % star.degree())));
    }
  }
  return worst;
}

VertexSplit RecordMaker::make_record(const StarSamples& s, const OwnPart& own,
                                     const CollapseSite& site) const {
  const Tin& tin = tile_.tin;
  const double step = tile_.units.heights.step;
  double error = own.error * step;
  double deviation = std::max(own.deviation, spoke_deviation(s)) * step;
  if (step != 1.0) {  // one more rounding
    error = scaled_up(error);
    deviation = scaled_up(deviation);
  }
  VertexSplit r;
  r.error = rounded_up(error);
  r.deviation = rounded_up(deviation);
  std::uint32_t rank = 0;
  for (const TriangleId t : s.star.triangles) {
    if (const std::uint32_t below = tile_.carried[t].record; below != kNone) {
      const VertexSplit& b = tile_.records[below];
      r.error = std::max(r.error, b.error);
      r.deviation = std::max(r.deviation, b.deviation);
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
      bits_of(saturated_heights(tile_, s.star), tile_.units.heights);
  r.flags = flags_of(tin, site);
  if (tin.has_height[site.u] != 0) {
    r.height = tin.vertices[site.u].height;
  }
  return r;
}

/// The worst sample of each fan triangle comes first in its list: the next choice of w screens by
/// it.
void RecordMaker::hand_over_samples(const StarSamples& s) {
  for (const TriangleId t : s.star.triangles) {
    tile_.samples.give_back(tile_.carried[t].samples);
    tile_.carried[t].samples = {};
  }
  const std::size_t n = s.source.size();
  counts_.assign(fan_.triangles(), 0);
  worst_.assign(fan_.triangles(), 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    ++counts_[static_cast<std::size_t>(triangle_[k])];
  }
  for (std::size_t i = 0; i < fan_.triangles(); ++i) {
    CarriedState& carried = tile_.carried[fan_ids_[i]];
    carried.samples = tile_.samples.take(counts_[i]);
    carried.holds_heights = carried.holds_voids = false;
    counts_[i] = 0;
  }
  for (std::size_t k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(triangle_[k]);
    const std::span<Sample> list = tile_.samples.samples(tile_.carried[fan_ids_[i]].samples);
    const std::uint32_t place = counts_[i]++;
    list[place] = s.source[k];
    CarriedState& carried = tile_.carried[fan_ids_[i]];
    (s.source[k].depth < 0.0F ? carried.holds_voids : carried.holds_heights) = true;
    if (place == 0) {
      worst_[i] = residual_[k];
    } else if (residual_[k] > worst_[i]) {
      worst_[i] = residual_[k];
      std::swap(list[0], list[place]);
    }
  }
}

void RecordMaker::collapse_and_record(StarSamples& s, std::size_t j) {
  PTIN_CHECK(make_fan(s, j, fan_));
  if (s.count == 0) {
    gather_samples(tile_, s);
  }
  gather_sources(tile_, s);
  const OwnPart own = measure(s);
  const CollapseSite site = collapse_site(s.star, j);
  const VertexSplit record = make_record(s, own, site);
  fan_ids_.clear();
  for (const std::uint32_t i : fan_.star_triangle) {
    fan_ids_.push_back(s.star.triangles[i]);
  }
  hand_over_samples(s);
  (void)collapse(tile_.tin, s.star, j);
  const auto id = static_cast<std::uint32_t>(tile_.records.size());
  tile_.records.push_back(record);
  for (const TriangleId t : fan_ids_) {
    tile_.carried[t].roi = record.roi;
    tile_.carried[t].record = id;
  }
}

}  // namespace ptin
