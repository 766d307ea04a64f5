// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/select/polygon_sides.h"

#include <limits>
#include <tuple>
#include <utility>

namespace ptin {

namespace {

/// Bins so that a side reaches few of them on average: polygons of tall sides have few bins.
constexpr double kBinsOfASide = 4.0;

}  // namespace

PolygonSides::PolygonSides(std::span<const std::vector<MapPoint>> rings) {
  double farthest = 0.0;
  for (const std::vector<MapPoint>& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      MapPoint a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
      farthest = std::max({farthest, std::abs(a.x), std::abs(a.y)});
      if (a == b) continue;
      if (std::tie(b.x, b.y) < std::tie(a.x, a.y)) std::swap(a, b);
      sides_.push_back({a, b});
    }
  }
  slack_ = 8 * std::numeric_limits<double>::epsilon() * farthest;
  sort_into_bins();
}

void PolygonSides::sort_into_bins() {
  if (sides_.empty()) return;
  double high = sides_.front().low.y, heights = 0.0;
  low_ = high;
  for (const Side& s : sides_) {
    low_ = std::min({low_, s.low.y, s.high.y});
    high = std::max({high, s.low.y, s.high.y});
    heights += std::abs(s.high.y - s.low.y);
  }
  const auto count = static_cast<double>(sides_.size());
  const double all = high - low_;
  const double most = heights > 0 ? kBinsOfASide * count * (all / heights) : 1.0;
  const double bins = std::floor(std::clamp(most, 1.0, count));
  bins_per_unit_ = all > 0 ? bins / all : 0.0;
  bin_begin_.assign(static_cast<std::size_t>(bins) + 1, 0);
  const auto visit_bins = [&](const auto& visit) {
    for (std::uint32_t i = 0; i < sides_.size(); ++i) {
      const auto [from, to] = std::minmax(sides_[i].low.y, sides_[i].high.y);
      sides_[i].first_bin = bin_of(from);
      for (std::size_t bin = sides_[i].first_bin; bin <= bin_of(to); ++bin) visit(bin, i);
    }
  };
  visit_bins([&](std::size_t bin, std::uint32_t) { ++bin_begin_[bin + 1]; });
  for (std::size_t bin = 1; bin < bin_begin_.size(); ++bin) bin_begin_[bin] += bin_begin_[bin - 1];
  in_bin_.resize(bin_begin_.back());
  std::vector<std::uint32_t> next(bin_begin_.begin(), bin_begin_.end() - 1);
  visit_bins([&](std::size_t bin, std::uint32_t i) { in_bin_[next[bin]++] = i; });
}

std::size_t PolygonSides::bin_of(double y) const noexcept {
  const auto last = static_cast<double>(bin_begin_.size() - 2);
  return static_cast<std::size_t>(std::clamp((y - low_) * bins_per_unit_, 0.0, last));
}

bool PolygonSides::surround(MapPoint p) const {
  bool is_odd = false;
  if (sides_.empty()) return is_odd;
  const std::size_t bin = bin_of(p.y);
  for (std::uint32_t i = bin_begin_[bin]; i < bin_begin_[bin + 1]; ++i) {
    const Side& s = sides_[in_bin_[i]];
    if ((s.low.y <= p.y) == (s.high.y <= p.y)) continue;
    // The side crosses the line to the right of the place where it has the place on its left, going
    // up.
    const double left =
        (s.high.x - s.low.x) * (p.y - s.low.y) - (p.x - s.low.x) * (s.high.y - s.low.y);
    if ((left > 0) == (s.high.y > s.low.y)) is_odd = !is_odd;
  }
  return is_odd;
}

}  // namespace ptin
