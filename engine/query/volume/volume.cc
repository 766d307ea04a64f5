// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/volume/volume.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "engine/error.h"
#include "engine/query/volume/volume_tiles.h"

namespace ptin {

namespace {

/// Far beyond any height, and far from where sums would overflow.
constexpr double kLargest = 1e100;

void check(const VolumeRequest& request, std::span<const double> levels) {
  const auto is_level = [](double level) { return std::abs(level) <= kLargest; };
  if (levels.empty() || !std::all_of(levels.begin(), levels.end(), is_level)) {
    refuse("the level of a volume must be a finite number, no larger than 1e100");
  }
  if (levels.size() > 1 && request.other != nullptr) {
    refuse("several levels are asked for beside another terrain, which stands in their place");
  }
  const double scale = request.other_height_scale;
  if (!(scale >= 1 / kLargest && scale <= kLargest)) {
    refuse("the scale of the other terrain's heights must be a number above 0");
  }
}

/// What the difference can be anywhere in the sources; empty where there is no surface.
Interval possible_differences(const VolumeSide& side, const VolumeSide* other,
                              const VolumeRequest& request, double level) {
  const Interval a = source_heights(side.facts());
  if (other == nullptr) return {a.lo - level, a.hi - level};
  const Interval b = source_heights(other->facts());
  if (is_empty(a) || is_empty(b)) return {};
  return {a.lo - request.other_height_scale * b.hi, a.hi - request.other_height_scale * b.lo};
}

/// Bounds of the source's volumes: those of the deviations, and what ground of another class can
/// add or take away.
/// @param unsure  Most area whose class may be another in the source.
void certify(const VolumeSums& sums, const Interval& possible, double unsure,
             VolumeResult& result) {
  const double cut_each = is_empty(possible) ? 0.0 : std::max(possible.hi, 0.0);
  const double fill_each = is_empty(possible) ? 0.0 : std::max(-possible.lo, 0.0);
  const double r = result.rounding;
  const auto set = [r](CertifiedVolume& v, const FixedSum& least, const FixedSum& most, double lost,
                       double gained) {
    v.low = std::min(v.value, std::max(0.0, least.value() - lost - r));
    v.high = std::max(v.value, most.value() + gained + r);
  };
  set(result.cut, sums.least_cut, sums.most_cut, unsure * cut_each,
      std::min(unsure * cut_each, sums.void_cut.value()));
  set(result.fill, sums.least_fill, sums.most_fill, unsure * fill_each,
      std::min(unsure * fill_each, sums.void_fill.value()));
  // Ground that comes adds its difference, ground that goes takes its own away.
  const double either = unsure * std::max(cut_each, fill_each);
  const double up = std::min(either, sums.void_cut.value() + sums.most_fill.value());
  const double down = std::min(either, sums.void_fill.value() + sums.most_cut.value());
  CertifiedVolume& net = result.net;
  net.low = std::min(net.value, std::max(net.value - sums.slack.value() - down - r,
                                         result.cut.low - result.fill.high));
  net.high = std::max(net.value, std::min(net.value + sums.slack.value() + up + r,
                                          result.cut.high - result.fill.low));
}

/// What is left of `area` beside `part` of it; what rounding alone can have left is nothing.
double beside(const VolumeTotals& own, const VolumeTotals& shared) {
  const double left = own.sums[0].surface_area.value() - shared.sums[0].surface_area.value();
  const double rounding = own.sums[0].area_rounding.value() + shared.sums[0].area_rounding.value();
  return left <= rounding ? 0.0 : left;
}

void fill_in(const VolumeSums& sums, VolumeResult& result) {
  result.rounding = sums.rounding.value();
  result.cut.value = sums.cut.value();
  result.fill.value = sums.fill.value();
  result.net.value = result.cut.value - result.fill.value;
  result.cut_area = sums.cut_area.value();
  result.fill_area = sums.fill_area.value();
  result.surface_area = sums.surface_area.value();
  result.void_area = sums.void_area.value();
  if (result.surface_area > 0) result.mean_difference = result.net.value / result.surface_area;
}

/// Ground of a side whose class may be another in the source, at most.
double unsure_area(const VolumeSide& side, const BorderLength& border) {
  if (side.border_move == 0) return 0.0;
  return std::isfinite(side.border_move) ? border.area_within(2 * side.border_move)
                                         : side.border_move;
}

class Measuring {
 public:
  Measuring(const OpenedTerrain& terrain, const VolumeRequest& request,
            std::span<const double> levels)
      : request_(request),
        levels_(levels),
        context_(request.limits, terrain.store().path()),
        side_(terrain, request, context_) {
    if (request.other != nullptr) other_.emplace(*request.other, request, context_);
  }

  std::vector<VolumeResult> run() {
    result_.certificate = side_.detail.certificate();
    result_.border_move = side_.border_move;
    result_.exact = side_.detail.is_exact(side_.facts());
    std::vector<VolumeResult> results;
    if (other_) {
      measure_overlay();
      results.push_back(result_);
    } else {
      results = measure_levels();
    }
    side_.terrain.store().pages().check_unchanged();
    for (VolumeResult& result : results) result.cost.add_counts(context_.cost);
    return results;
  }

 private:
  std::vector<VolumeResult> measure_levels() {
    // Each thread has sums of its own, and those from before the tile at hand.
    const auto threads = static_cast<std::uint64_t>(std::max(request_.threads, 1));
    if (levels_.size() > 1) {
      context_.admit(levels_.size() *
                     (2 * (threads + 1) * sizeof(VolumeSums) + sizeof(VolumeResult)));
    }
    const VolumeTotals totals = volume_above_levels(side_, levels_, request_);
    const double unsure = unsure_area(side_, totals.border);
    std::vector<VolumeResult> results(levels_.size(), result_);
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      answer(totals, i, levels_[i], unsure, results[i]);
    }
    return results;
  }

  void measure_overlay() {
    constexpr double kZero[] = {0.0};
    const VolumeTotals here = volume_above_levels(side_, kZero, request_);
    const VolumeTotals there = volume_above_levels(*other_, kZero, request_);
    const VolumeTotals shared = volume_of_overlay(side_, *other_, request_);
    result_.other_certificate = other_->detail.certificate();
    result_.border_move = std::max(result_.border_move, other_->border_move);
    result_.exact = result_.exact && other_->detail.is_exact(other_->facts());
    answer(shared, 0, 0.0, unsure_area(side_, here.border) + unsure_area(*other_, there.border),
           result_);
    result_.only_here_area = beside(here, shared);
    result_.only_other_area = beside(there, shared);
    for (const VolumeTotals* part : {&here, &there}) {
      result_.cost.add_counts(part->cost);
      result_.tiles += part->tiles;
    }
    other_->terrain.store().pages().check_unchanged();
  }

  void answer(const VolumeTotals& totals, std::size_t which, double level, double unsure,
              VolumeResult& result) {
    const VolumeSums& sums = totals.sums[which];
    fill_in(sums, result);
    const double all = result.surface_area + result.void_area;
    const double most = std::min(unsure, all * (1 + 1e-9) + sums.area_rounding.value());
    certify(sums, possible_differences(side_, other_ ? &*other_ : nullptr, request_, level), most,
            result);
    result.cost.add_counts(totals.cost);
    result.tiles += totals.tiles;
  }

  const VolumeRequest& request_;
  std::span<const double> levels_;
  QueryContext context_;
  VolumeSide side_;
  std::optional<VolumeSide> other_;
  VolumeResult result_;
};

}  // namespace

VolumeResult volume(const OpenedTerrain& terrain, const VolumeRequest& request) {
  return volumes(terrain, request, {&request.level, 1}).front();
}

std::vector<VolumeResult> volumes(const OpenedTerrain& terrain, const VolumeRequest& request,
                                  std::span<const double> levels) {
  const auto start = std::chrono::steady_clock::now();
  check(request, levels);
  std::vector<VolumeResult> results = Measuring(terrain, request, levels).run();
  const double seconds = seconds_since(start);
  for (VolumeResult& result : results) result.cost.seconds = seconds;
  return results;
}

}  // namespace ptin
