// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/shape/bins_along_y.h"

#include <cmath>

namespace ptin {

namespace {

/// Bins of which a thing of the average height spans so many: with more the lists grow, with fewer
/// each of them holds many things that are not near.
constexpr double kBinsOfAThing = 4.0;

}  // namespace

BinsAlongY::BinsAlongY(std::span<const Interval> reaches) : first_bin_(reaches.size()) {
  if (reaches.empty()) return;
  Interval all;
  double heights = 0.0;
  for (const Interval& r : reaches) {
    all = united(all, r);
    heights += r.hi - r.lo;
  }
  const auto count = static_cast<double>(reaches.size());
  const double whole = all.hi - all.lo;
  const double most = heights > 0 ? kBinsOfAThing * count * (whole / heights) : 1.0;
  const double bins = std::floor(std::clamp(most, 1.0, count));
  low_ = all.lo;
  // Where all lie at one y, or so close to it that this is no number, one bin holds everything.
  const double per_unit = whole > 0 ? bins / whole : 0.0;
  bins_per_unit_ = std::isfinite(per_unit) ? per_unit : 0.0;
  begin_.assign(static_cast<std::size_t>(bins) + 1, 0);
  const auto visit_bins = [&](const auto& visit) {
    for (std::uint32_t i = 0; i < reaches.size(); ++i) {
      for (std::size_t b = bin_of(reaches[i].lo); b <= bin_of(reaches[i].hi); ++b) visit(b, i);
    }
  };
  visit_bins([&](std::size_t bin, std::uint32_t) { ++begin_[bin + 1]; });
  for (std::size_t b = 1; b < begin_.size(); ++b) begin_[b] += begin_[b - 1];
  numbers_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  visit_bins([&](std::size_t bin, std::uint32_t i) { numbers_[next[bin]++] = i; });
  for (std::uint32_t i = 0; i < reaches.size(); ++i) {
    first_bin_[i] = static_cast<std::uint32_t>(bin_of(reaches[i].lo));
  }
}

}  // namespace ptin
