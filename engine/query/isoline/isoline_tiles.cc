// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_tiles.h"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "engine/error.h"
#include "engine/query/living/living_place.h"
#include "engine/query/living/stars_in_region.h"
#include "engine/query/refine/tile_queue.h"

namespace ptin {

namespace {

constexpr std::int64_t kSmallestTile = 8;  // grid units a side
/// With less memory for its tile a thread would read most pages several times.
constexpr std::uint64_t kUsefulBytes = std::uint64_t{2} << 20;

std::string size_text(std::uint64_t bytes) {
  return bytes < (16 << 20) ? std::to_string((bytes + 1023) >> 10) + " KiB"
                            : std::to_string((bytes + 0xFFFFF) >> 20) + " MiB";
}

/// Gathers and traces tiles, one after the other, in the same memory.
class Worker final : private LivingVisitor {
 public:
  Worker(const OpenedTerrain& terrain, const TileTraceRequest& request, std::uint64_t limit,
         TileQueue& queue, TraceCollector& collected)
      : store_(terrain.store()),
        request_(request),
        limit_(limit),
        queue_(queue),
        collected_(collected),
        context_({limit, request.stop}, store_.path()),
        stars_in_region_(request.region),
        reader_(terrain, request.detail),
        tracer_(request.levels, store_.facts().heights, store_.facts().map, context_) {
    place_.steps = request.levels.least_above();
    place_.stars = request.region == nullptr ? nullptr : &stars_in_region_;
  }

  void run() noexcept {
    queue_.run([this](const GridBox& tile) { trace(tile); });
  }
  [[nodiscard]] const QueryCost& cost() const noexcept { return context_.cost; }

 private:
  /// Traces the triangles of a tile, or has its halves traced when it does not fit.
  void trace(const GridBox& tile) {
    context_.check_stop();
    place_.box = tile;
    is_small_ = half_perimeter(tile) <= 2 * kSmallestTile;
    most_bytes_ = is_small_ ? limit_ : std::min(limit_, request_.tile_bytes);
    is_full_ = false;
    tracer_.begin({tile, request_.region, request_.counts_vertices}, most_bytes_);
    const std::uint64_t before = context_.cost.records_examined;
    const bool fits = reader_.read(place_, context_, *this) && !is_full_;
    if (const std::uint64_t records = context_.cost.records_examined - before; records > 0) {
      bytes_of_record_ = static_cast<double>(tracer_.bytes_wanted()) / static_cast<double>(records);
    }
    if (!fits) {
      halve(tile);
      return;
    }
    collected_.add(tracer_.join(), tracer_.counts());
  }

  /// A tile that is expected not to fit is not read: halves of a tile that would have fitted cost less
  /// than a tile read in vain. The expectation is trusted less each time, since nothing is learnt then.
  bool expect(std::uint64_t records) override {
    if (is_small_ ||
        bytes_of_record_ * static_cast<double>(records) <= static_cast<double>(most_bytes_)) {
      return true;
    }
    bytes_of_record_ *= 0.875;
    return false;
  }
  bool begin(std::size_t /*most_triangles*/) override { return !is_full_; }
  bool take_stars(const LivingStars& stars) override {
    is_full_ = is_full_ || !tracer_.add(stars);
    return true;
  }
  void take(const LivingTriangle& t) override { is_full_ = is_full_ || !tracer_.add(t); }

  /// Has the halves of a tile traced that does not fit.
  void halve(const GridBox& tile) {
    if (!is_small_) {
      queue_.put_halves(tile);
      return;
    }
    throw Error(ErrorCode::resource_exhausted,
                "the isolines of " + std::to_string(kSmallestTile) + " x " +
                    std::to_string(kSmallestTile) + " grid units alone take " +
                    size_text(tracer_.bytes_wanted()) + " or more, and a tile may take " +
                    size_text(limit_) +
                    ": give more memory, or ask for fewer levels or a larger error",
                store_.path());
  }

  const StoreFile& store_;
  const TileTraceRequest& request_;
  std::uint64_t limit_;
  TileQueue& queue_;
  TraceCollector& collected_;
  QueryContext context_;
  StarsInRegion stars_in_region_;
  LivingPlace place_;
  LivingReader reader_;
  LineTracer tracer_;
  std::uint64_t most_bytes_ = 0;
  bool is_small_ = false;       ///< The tile cannot be halved.
  bool is_full_ = false;        ///< What was read of the tile does not fit.
  double bytes_of_record_ = 8;  ///< About, by what was gathered last.
};

/// As many threads as asked for, as long as each has room for a tile of a useful size.
int threads_within(const TileTraceRequest& request) {
  const std::uint64_t most = std::max<std::uint64_t>(request.memory_bytes / kUsefulBytes, 1);
  return static_cast<int>(std::min<std::uint64_t>(std::max(request.threads, 1), most));
}

}  // namespace

void TraceCollector::add(const TracedPieces& traced, const TraceCounts& counts) {
  const std::vector<IsolinePiece>& pieces = traced.pieces;
  const std::lock_guard lock(mutex_);
  if (all_.pieces.size() + pieces.size() > most_pieces_) {
    throw Error(ErrorCode::resource_exhausted,
                "there are more than " + std::to_string(most_pieces_) +
                    " pieces of isolines to join, which is all that the memory holds: give more "
                    "memory, or ask for fewer levels, a window or a larger error",
                file_);
  }
  const std::size_t before = all_.pieces.size();
  all_.pieces.insert(all_.pieces.end(), pieces.begin(), pieces.end());
  for (IsolinePiece& piece : std::span(all_.pieces).subspan(before)) {
    piece.first += points_.size();
  }
  points_.add(traced.points);
  all_.counts.triangles += counts.triangles;
  all_.counts.vertices += counts.vertices;
  all_.counts.segments += counts.segments;
  ++all_.tiles;
}

TileTraces trace_tiles(const OpenedTerrain& terrain, const TileTraceRequest& request,
                       PointStore& points, QueryCost& cost) {
  TileQueue queue(terrain.store().facts().bounds);
  TraceCollector collected(request, points, terrain.store().path());
  const int count = threads_within(request);
  const std::uint64_t limit = request.memory_bytes / static_cast<std::uint64_t>(count);
  std::vector<std::unique_ptr<Worker>> workers;
  for (int i = 0; i < count; ++i) {
    workers.push_back(std::make_unique<Worker>(terrain, request, limit, queue, collected));
  }
  run_on_threads(count, [&](int i) { workers[static_cast<std::size_t>(i)]->run(); });
  queue.rethrow();
  for (const auto& worker : workers) {
    cost.add_counts(worker->cost());
  }
  return collected.release();
}

}  // namespace ptin
