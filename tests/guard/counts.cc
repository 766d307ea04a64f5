// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/guard/counts.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <random>
#include <span>
#include <sstream>
#include <stdexcept>

#include "engine/construct/build.h"
#include "engine/query/questions.h"
#include "storage/spatialindex_rtree.h"
#include "tests/support/test_folder.h"

namespace ptin::guard {

namespace {

/// Draws numbers that are the same with every standard library.
class Places {
 public:
  explicit Places(const StoreFacts& facts) : facts_(facts) {}
  double share() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  MapPoint point() {
    const GridBox& b = facts_.bounds;
    const double x = b.min_x + share() * (b.max_x - b.min_x);
    return facts_.map.to_map(x, b.min_y + share() * (b.max_y - b.min_y));
  }
  /// @param side  Of the window, as a share of that of the bounds.
  Window window(double side) {
    const GridBox& b = facts_.bounds;
    const double width = side * (b.max_x - b.min_x), height = side * (b.max_y - b.min_y);
    const double x = b.min_x + share() * (b.max_x - b.min_x - width);
    const double y = b.min_y + share() * (b.max_y - b.min_y - height);
    const MapPoint low = facts_.map.to_map(x, y), high = facts_.map.to_map(x + width, y + height);
    return {low.x, low.y, high.x, high.y};
  }

 private:
  const StoreFacts& facts_;
  std::mt19937_64 random_{1};
};

class Counter {
 public:
  /// @param second  Of the terrain's store.
  Counter(std::string name, const Terrain& terrain, const RecordIndex& second)
      : name_(std::move(name)), terrain_(terrain), stars_(terrain), second_(second) {
    stars_.use_floor(false);
  }

  Counts run() {
    const StoreFile& store = terrain_.store();
    const auto vertices = static_cast<double>(store.t0().vertices.size() + store.record_count());
    add("bytes a vertex", static_cast<double>(store.file_bytes()) / vertices);
    count_points("point, exact: ", {});
    count_points("point, error 5: ", 5.0);
    if (terrain_.floor() != nullptr) count_heights();
    count_windows("window 1/25: ", 0.2);
    count_windows("window 1/4: ", 0.5);
    for (const double tolerance : {1.0, 2.0, 5.0, 10.0, 20.0}) {
      RefineRequest request;
      request.detail.tolerance = tolerance;
      add("vertices at " + std::to_string(static_cast<int>(tolerance)),
          static_cast<double>(terrain_.refine(request).vertices));
    }
    StreamRequest everything;
    const StreamSummary sent = terrain_.stream(everything, [](std::span<const std::byte>) {});
    add("stream, bytes a vertex", static_cast<double>(sent.bytes) / vertices);
    return std::move(counts_);
  }

 private:
  void add(const std::string& what, double value) { counts_.push_back({name_, what, value}); }

  void count_points(const std::string& what, std::optional<double> tolerance) {
    constexpr int kPoints = 500;
    Places places(terrain_.store().facts());
    LocateRequest request;
    request.detail.tolerance = tolerance;
    QueryCost sum;
    for (int i = 0; i < kPoints; ++i) {
      const MapPoint at = places.point();
      sum.add_counts(stars_.locate(std::span(&at, 1), request).cost);
    }
    const auto mean = [](std::uint64_t n) { return static_cast<double>(n) / kPoints; };
    add(what + "pages", mean(sum.io.pages));
    add(what + "nodes", mean(sum.io.index_nodes));
    add(what + "stars", mean(sum.stars_read));
  }

  /// The full TIN of a raster by its heights.
  void count_heights() {
    constexpr int kPlaces = 500;
    Places places(terrain_.store().facts());
    QueryCost points, windows;
    std::uint64_t triangles = 0;
    for (int i = 0; i < kPlaces; ++i) {
      const MapPoint at = places.point();
      points.add_counts(terrain_.locate(std::span(&at, 1), {}, AnswerBy::kHeights).cost);
      RefineRequest request;
      request.region = places.window(0.2);
      request.form = ResultForm::kMeetingRegion;
      const RefinedTin tin = terrain_.refine(request);
      windows.add_counts(tin.cost);
      triangles += tin.triangles;
    }
    const auto mean = [](std::uint64_t n) { return static_cast<double>(n) / kPlaces; };
    add("point by heights: pages", mean(points.io.pages));
    add("point by heights: nodes", mean(points.io.index_nodes));
    add("point by heights: samples", mean(points.samples_read));
    add("window 1/25 by heights: pages", mean(windows.io.pages));
    add("window 1/25 by heights: samples a triangle",
        static_cast<double>(windows.samples_read) / static_cast<double>(triangles));
  }

  void count_windows(const std::string& what, double side) {
    constexpr int kWindows = 20;
    Places places(terrain_.store().facts());
    QueryCost by_splits, by_stars;
    IoCounters packed, second;
    std::uint64_t vertices = 0, triangles = 0;
    for (int i = 0; i < kWindows; ++i) {
      RefineRequest request;
      const Window window = places.window(side);
      request.region = window;
      by_splits.add_counts(terrain_.refine(request).cost);
      request.form = ResultForm::kMeetingRegion;
      const RefinedTin tin = stars_.refine(request);
      by_stars.add_counts(tin.cost);
      vertices += tin.vertices;
      triangles += tin.triangles;
      const PredicatePtr asked = meets_region(window, terrain_.store().facts().map);
      std::vector<PageId> pages, same;
      terrain_.index().search(*asked, pages, packed);
      second_.search(*asked, same, second);
      if (pages != same) throw std::runtime_error("the two indexes find different pages");
    }
    add(what + "records a vertex",
        static_cast<double>(by_splits.records_retrieved) / static_cast<double>(vertices));
    add(what + "pages by splits", static_cast<double>(by_splits.io.pages) / kWindows);
    add(what + "stars a triangle",
        static_cast<double>(by_stars.stars_read) / static_cast<double>(triangles));
    add(what + "pages by stars", static_cast<double>(by_stars.io.pages) / kWindows);
    add(what + "nodes, packed", static_cast<double>(packed.index_nodes) / kWindows);
    add(what + "nodes, libspatialindex", static_cast<double>(second.index_nodes) / kWindows);
  }

  std::string name_;
  const Terrain& terrain_;
  Terrain stars_;  ///< The same, answered from stars.
  const RecordIndex& second_;
  Counts counts_;
};

std::string text_of(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4f", value);
  return text.data();
}

const Count* find(const Counts& counts, const Count& wanted) {
  const auto at = std::find_if(counts.begin(), counts.end(), [&](const Count& c) {
    return c.terrain == wanted.terrain && c.what == wanted.what;
  });
  return at == counts.end() ? nullptr : &*at;
}

}  // namespace

Counts counts_of(const std::string& terrain) {
  const test::TestFolder folder(test::TestFolder::Size::kSmall);
  const std::string store = folder.file("a.ptin");
  build({PTIN_TEST_DATA "/" + terrain}, store, {}, {});
  const auto opened = StoreFile::open(store);
  return Counter(terrain, Terrain(opened), *SpatialIndexRTree::open(opened)).run();
}

Counts read_table(const std::string& path) {
  std::ifstream in(path);
  std::string line;
  if (!std::getline(in, line)) throw std::runtime_error(path + " is not there, or empty");
  Counts counts;
  while (std::getline(in, line)) {
    // The name of a count may hold commas; it stands in quotes.
    const std::size_t open = line.find(",\""), close = line.rfind("\",");
    if (open == std::string::npos || close == std::string::npos || close < open + 2)
      throw std::runtime_error(path + ": no count: " + line);
    counts.push_back({line.substr(0, open), line.substr(open + 2, close - open - 2),
                      std::stod(line.substr(close + 2))});
  }
  return counts;
}

void write_table(const std::string& path, const Counts& counts) {
  std::ofstream out(path);
  out << "terrain,count,value\n";
  for (const Count& c : counts) {
    out << c.terrain << ",\"" << c.what << "\"," << text_of(c.value) << "\n";
  }
  if (!out.flush()) throw std::runtime_error("cannot write " + path);
}

std::vector<std::string> what_is_worse(const Counts& table, const Counts& now, double tolerance) {
  std::vector<std::string> faults;
  for (const Count& c : now) {
    const Count* const before = find(table, c);
    const std::string name = c.terrain + ", " + c.what;
    if (before == nullptr) {
      faults.push_back(name + " is not in the table");
    } else if (c.value > before->value * (1 + tolerance)) {
      faults.push_back(name + " is " + text_of(c.value) + ", and was " + text_of(before->value));
    }
  }
  for (const Count& c : table) {
    if (find(now, c) == nullptr) faults.push_back(c.terrain + ", " + c.what + " is not counted");
  }
  return faults;
}

}  // namespace ptin::guard
