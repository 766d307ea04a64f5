// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_crossings.h"

#include <algorithm>
#include <utility>

#include "engine/geometry/affine.h"

namespace ptin {

namespace {

/// Finds the triangles that each level crosses.
class Collector {
 public:
  Collector(const Tin& tin, const LevelSet& levels, const HeightEncoding& heights,
            const TraceScope& scope, const QueryContext& context)
      : tin_(tin), levels_(levels), heights_(heights), scope_(scope), context_(context) {}

  void count();
  void collect();
  /// Bytes that collecting and tracing take. REQUIRES: count() was called. A line has one point
  /// more than segments.
  [[nodiscard]] std::uint64_t bytes() const noexcept {
    return tin_.vertices.size() * (sizeof(std::uint32_t) + 1) +
           tin_.triangles.size() * kTraceBytesATriangle +
           counts_.segments * (sizeof(TriangleId) + 6 * sizeof(MapPoint));
  }
  [[nodiscard]] const TraceCounts& counts() const noexcept { return counts_; }
  [[nodiscard]] Crossings take() noexcept { return std::move(crossings_); }

 private:
  [[nodiscard]] bool meets_region(const Triangle& t) const noexcept;
  [[nodiscard]] bool is_in_tile(const Triangle& t) const noexcept;
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> bands_of(const Triangle& t) const noexcept {
    const std::vector<std::uint32_t>& bands = crossings_.bands;
    const std::uint32_t a = bands[t.v[0]], b = bands[t.v[1]], c = bands[t.v[2]];
    return {std::min(std::min(a, b), c), std::max(std::max(a, b), c)};
  }

  const Tin& tin_;
  const LevelSet& levels_;
  const HeightEncoding& heights_;
  const TraceScope& scope_;
  const QueryContext& context_;
  TraceCounts counts_;
  Crossings crossings_;
};

bool Collector::meets_region(const Triangle& t) const noexcept {
  return scope_.region == nullptr ||
         scope_.region->meets(tin_.position(t.v[0]), tin_.position(t.v[1]), tin_.position(t.v[2]));
}

bool Collector::is_in_tile(const Triangle& t) const noexcept {
  return contains(scope_.tile,
                  point_of(std::min({key_of(tin_.position(t.v[0])), key_of(tin_.position(t.v[1])),
                                     key_of(tin_.position(t.v[2]))})));
}

void Collector::count() {
  std::vector<std::uint32_t>& bands = crossings_.bands;
  bands.resize(tin_.vertices.size());
  for (VertexId v = 0; v < tin_.vertices.size(); ++v) {
    bands[v] = levels_.band_of(heights_.code(tin_.vertices[v].height));
  }
  std::vector<std::uint8_t> seen(tin_.vertices.size());
  crossings_.traced.assign(tin_.triangles.size(), 0);
  crossings_.begin.assign(levels_.size() + 1, 0);
  for (TriangleId t = 0; t < tin_.triangles.size(); ++t) {
    if (t % kStopInterval == 0) {
      context_.check_stop();
    }
    const Triangle& triangle = tin_.triangles[t];
    if (triangle.v[0] == kNone || tin_.classes[t] != TriangleClass::kSurface) {
      continue;
    }
    const auto [low, high] = bands_of(triangle);
    if (low == high || !meets_region(triangle)) {
      continue;
    }
    for (const VertexId v : triangle.v) {
      // All crossed triangles around a corner in the tile are in this mesh, since they meet the
      // tile.
      seen[v] = 1;
    }
    if (!is_in_tile(triangle)) {
      continue;
    }
    crossings_.traced[t] = 1;
    ++counts_.triangles;
    counts_.segments += high - low;
    for (std::uint32_t level = low; level < high; ++level) {
      ++crossings_.begin[level + 1];
    }
  }
  for (VertexId v = 0; v < seen.size(); ++v) {
    counts_.vertices += seen[v] != 0 && contains(scope_.tile, tin_.position(v)) ? 1 : 0;
  }
}

void Collector::collect() {
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    crossings_.begin[level + 1] += crossings_.begin[level];
  }
  crossings_.triangles.resize(counts_.segments);
  std::vector<std::uint64_t> next(crossings_.begin.begin(), crossings_.begin.end() - 1);
  for (TriangleId t = 0; t < tin_.triangles.size(); ++t) {
    if (crossings_.traced[t] == 0) {
      continue;
    }
    const auto [low, high] = bands_of(tin_.triangles[t]);
    for (std::uint32_t level = low; level < high; ++level) {
      crossings_.triangles[next[level]++] = t;
    }
  }
}

}  // namespace

FoundCrossings find_crossings(const Tin& tin, const LevelSet& levels, const HeightEncoding& heights,
                              const TraceScope& scope, std::uint64_t most_bytes,
                              const QueryContext& context) {
  Collector collector(tin, levels, heights, scope, context);
  collector.count();
  if (collector.bytes() > most_bytes) {
    return {false, collector.bytes(), {}, {}};
  }
  collector.collect();
  return {true, collector.bytes(), collector.counts(), collector.take()};
}

}  // namespace ptin
