// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/record_maker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "engine/check.h"
#include "engine/construct/rounding.h"
#include "engine/construct/sample_blocks.h"
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

bool is_mostly_alike(const std::vector<Sample>& list) {
  std::size_t alike = 0;
  for (std::size_t k = 1; k < list.size(); ++k) {
    alike += list[k].height == list[k - 1].height ? 1 : 0;
  }
  return alike > list.size() / 2;
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
  assign_samples(s, fan_, triangle_, residual_);
  if (s.void_only || s.flat) {
    return {};
  }
  const double bound = residual_bound(s, tile_.units);
  if (!s.surface_only) {
    for (std::size_t k = 0; k < s.source.size(); ++k) {
      triangle_[k] = static_cast<double>(
          triangle_of_sample(tile_, s, fan_, s.x[k], s.y[k], s.source[k].depth >= 0.0F));
    }
    const VoidMeasure voids = measure_with_voids(tile_, s, fan_);
    return {scaled_up(voids.error) + bound, scaled_up(voids.deviation) + bound};
  }
  double worst = *std::max_element(residual_.begin(), residual_.end());
  if (!s.blocks.empty()) {
    worst = std::max(worst, straddling_residual(s, fan_));
  }
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

/// Hands every element to the fan triangle that it lies in; blocks across a spoke are taken apart.
void RecordMaker::hand_over_samples(const StarSamples& s) {
  for (const TriangleId t : s.star.triangles) {
    tile_.samples.give_back(tile_.carried[t].samples);
    tile_.carried[t].samples = {};
  }
  lists_.resize(std::max(lists_.size(), fan_.triangles()));
  for (std::size_t i = 0; i < fan_.triangles(); ++i) {
    lists_[i].samples.clear();
  }
  for (std::size_t k = 0; k < s.source.size(); ++k) {
    if (s.source[k].side_log == 0) {
      lists_[static_cast<std::size_t>(triangle_[k])].add(s.source[k], residual_[k]);
    }
  }
  for (const SampleBlock& b : s.blocks) {
    hand_over_block(s, s.source[b.source]);
  }
  for (std::size_t i = 0; i < fan_.triangles(); ++i) {
    store_list(i);
  }
}

void RecordMaker::hand_over_block(const StarSamples& s, const Sample& block) {
  const GridPoint u = tile_.tin.position(s.star.center);
  const double x = static_cast<double>(block.position.x) - u.x;
  const double y = static_cast<double>(block.position.y) - u.y;
  if (block.side_log == 0) {
    lists_[triangle_of_sample(tile_, s, fan_, x, y, block.depth >= 0.0F)].add(block, 0.0);
    return;
  }
  const auto reach = static_cast<double>((std::int64_t{1} << block.side_log) - 1);
  const std::size_t i = triangle_of_box(fan_, x, y, x + reach, y + reach);
  if (i < fan_.triangles()) {
    lists_[i].add(block, 0.0);
    return;
  }
  const std::int32_t half = std::int32_t{1} << (block.side_log - 1);
  for (const GridPoint offset : {GridPoint{0, 0}, {half, 0}, {0, half}, {half, half}}) {
    Sample quarter = block;
    quarter.position = {block.position.x + offset.x, block.position.y + offset.y};
    --quarter.side_log;
    hand_over_block(s, quarter);
  }
}

/// Long lists become blocks where that pays: where they hold more samples than the triangle is
/// long, so that there is an inside, and most are like the one before.
void RecordMaker::store_list(std::size_t i) {
  std::vector<Sample>& list = lists_[i].samples;
  CarriedState& carried = tile_.carried[fan_ids_[i]];
  carried.holds_voids =
      tile_.has_voids &&
      std::any_of(list.begin(), list.end(), [](const Sample& a) { return a.depth < 0.0F; });
  carried.holds_heights =
      !tile_.has_voids ||
      std::any_of(list.begin(), list.end(), [](const Sample& a) { return !(a.depth < 0.0F); });
  const double length = std::abs(fan_.spoke_x[i]) + std::abs(fan_.spoke_y[i]) +
                        std::abs(fan_.spoke_x[i + 1]) + std::abs(fan_.spoke_y[i + 1]);
  if (tile_.samples_fill_grid && static_cast<double>(list.size()) > 2.0 * length + 64.0 &&
      is_mostly_alike(list)) {
    join_into_blocks(list);
  }
  carried.samples = tile_.samples.take(static_cast<std::uint32_t>(list.size()));
  std::copy(list.begin(), list.end(), tile_.samples.samples(carried.samples).begin());
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
