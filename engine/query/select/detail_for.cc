// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/query/select/detail.h"
#include "engine/query/select/predicate.h"

namespace ptin {

namespace {

/// A window that is asked for more vertices than the level that was counted has is counted again
/// down to a level of so many times as many records.
constexpr double kMoreRecords = 8;

/// The part of the side from `low` to `high` that lies between `from` and `to`, as a share of it.
double share_of_side(double low, double high, double from, double to) {
  return std::max(0.0, std::min(high, to) - std::max(low, from)) / (high - low);
}

/// The share of the positions of a box that lies within a window. A position is a square, so that a
/// box of a single one has an area too.
/// @param beside  The box is so much larger than what its positions take up, on each side.
double share_within(const GridBox& b, const GridWindow& w, double beside = 0.0) {
  const auto along = [beside](double min, double max, double from, double to) {
    // Of a narrow box at least a third is left.
    const double less = std::min(beside, (max - min + 1) / 3);
    return share_of_side(min - 0.5 + less, max + 0.5 - less, from - 0.5, to + 0.5);
  };
  return along(b.min_x, b.max_x, w.min_x, w.max_x) * along(b.min_y, b.max_y, w.min_y, w.max_y);
}

/// How far the box of a page's stars reaches beyond its vertices, which are what is counted: about
/// 0.7 of their spacing, in the median of the pages of several terrains (0.5 to 1.0 for most).
double reach_of_stars(const StoreFile::PageInfo& page) {
  const GridBox& b = page.stars.box;
  const double area =
      (static_cast<double>(b.max_x) - b.min_x + 1) * (static_cast<double>(b.max_y) - b.min_y + 1);
  return 0.7 * std::sqrt(area / std::max<std::uint32_t>(page.records, 1));
}

GridBox box_around(const GridWindow& w) {
  const auto coordinate = [](double v) {
    return static_cast<std::int32_t>(std::clamp(v, -1.0, static_cast<double>(kGridMax) + 1));
  };
  return {coordinate(std::floor(w.min_x)), coordinate(std::floor(w.min_y)),
          coordinate(std::ceil(w.max_x)), coordinate(std::ceil(w.max_y))};
}

/// Counts the vertices of a window by the bins of their errors.
class WindowCounts {
 public:
  WindowCounts(const StoreFile& store, const GridWindow& window)
      : store_(store), bins_(store.error_bins()), window_(window) {}

  /// Records in the window of each bin, about: those on pages that meet it and may hold records of
  /// an error above `error`. A page's records are spread over its stars' box, and over the bins
  /// between its least and its largest error as those of the whole file are.
  std::vector<double> above(double error, IoCounters& io) const {
    std::vector<double> counts(bins_.size(), 0.0);
    std::vector<PageId> pages;
    const PredicatePtr meeting = all_of(
        {std::make_shared<MeetsBox>(box_around(window_)), std::make_shared<AboveError>(error)});
    store_.index().search(*meeting, pages, io);
    for (const PageId id : pages) {
      const StoreFile::PageInfo page = store_.page_info(id);
      const std::size_t first = bin_of(page.min_error);
      const std::size_t last = bin_of(page.attributes.error);
      double records = 0.0;
      for (std::size_t i = first; i <= last; ++i) records += static_cast<double>(bins_[i].records);
      if (records == 0) continue;
      const double wanted =
          page.records * share_within(page.stars.box, window_, reach_of_stars(page)) / records;
      for (std::size_t i = first; i <= last; ++i) {
        counts[i] += wanted * static_cast<double>(bins_[i].records);
      }
    }
    return counts;
  }

 private:
  [[nodiscard]] std::size_t bin_of(double error) const {
    const auto bin = std::lower_bound(bins_.begin(), bins_.end(), error,
                                      [](const ErrorBin& b, double e) { return b.upper < e; });
    return static_cast<std::size_t>(std::min(bin, bins_.end() - 1) - bins_.begin());
  }

  const StoreFile& store_;
  std::span<const ErrorBin> bins_;
  GridWindow window_;
};

}  // namespace

std::uint64_t records_above(const StoreFile& store, double tolerance) {
  if (tolerance < 0) return store.record_count();
  std::uint64_t records = 0;
  for (const ErrorBin& bin : store.error_bins()) {
    if (bin.upper > tolerance) records += bin.records;
  }
  return records;
}

namespace {

/// The level above a bin of errors, or above the next one below it that allows no greater error than asked.
/// A level has all records of infinite error: without them it would certify nothing.
DetailRequest level_above(std::span<const ErrorBin> bins, std::size_t bin, double most_error) {
  const auto is_allowed = [&](const ErrorBin& b) {
    return std::isfinite(b.upper) && b.upper <= most_error;
  };
  while (bin > 0 && !is_allowed(bins[bin])) --bin;
  if (!is_allowed(bins[bin])) return {};
  return {static_cast<double>(bins[bin].upper), std::nullopt};
}

}  // namespace

DetailRequest detail_for(const StoreFile& store, std::uint64_t vertices, const Window& window,
                         IoCounters& io, double most_error) {
  const GridWindow on = on_grid(window, store.facts().map);
  const std::span<const ErrorBin> bins = store.error_bins();
  const auto of_t0 = std::count_if(store.t0().vertices.begin(), store.t0().vertices.end(),
                                   [&](const CoarsestTin::V& v) {
                                     return on.min_x <= v.position.x && v.position.x <= on.max_x &&
                                            on.min_y <= v.position.y && v.position.y <= on.max_y;
                                   });
  const double most = static_cast<double>(vertices) - static_cast<double>(of_t0);
  const double share = share_within(store.facts().bounds, on);
  const WindowCounts in_window(store, on);
  // The level at which evenly spread records would be as many. Where there are fewer of them in the
  // window than wanted, finer levels are counted, too.
  for (double wanted = std::max(most, 1.0) * kMoreRecords;; wanted *= kMoreRecords) {
    std::size_t lowest = bins.size();
    for (double evenly = 0.0; lowest > 0 && evenly <= wanted; --lowest) {
      evenly += static_cast<double>(bins[lowest - 1].records) * share;
    }
    const double error = lowest == 0 ? -1.0 : static_cast<double>(bins[lowest - 1].upper);
    std::vector<double> counts;
    if (share < 1.0) {
      counts = in_window.above(error, io);
    } else {
      for (const ErrorBin& bin : bins) counts.push_back(static_cast<double>(bin.records));
    }
    double kept = 0.0;
    for (std::size_t i = bins.size(); i-- > lowest;) {
      kept += counts[i];
      if (kept > most) return level_above(bins, i, most_error);
    }
    if (lowest == 0) return {};
  }
}

}  // namespace ptin
