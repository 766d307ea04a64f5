// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_tiles.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include "engine/error.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/refine/tile_queue.h"
#include "engine/query/select/predicate.h"
#include "engine/query/select/retrieval.h"

namespace ptin {

namespace {

constexpr std::int64_t kSmallestTile = 8;  // grid units a side

std::string size_text(std::uint64_t bytes) {
  return bytes < (16 << 20) ? std::to_string((bytes + 1023) >> 10) + " KiB"
                            : std::to_string((bytes + 0xFFFFF) >> 20) + " MiB";
}

/// Where all workers put what they traced.
class Collected {
 public:
  Collected(PointStore& points, std::uint64_t piece_bytes, std::string file)
      : points_(points), most_pieces_(piece_bytes / kBytesAPiece), file_(std::move(file)) {}

  void add(TracedPieces traced, const TraceCounts& counts) {
    std::vector<IsolinePiece>& pieces = traced.pieces;
    const std::lock_guard lock(mutex_);
    if (all_.pieces.size() + pieces.size() > most_pieces_) {
      throw Error(ErrorCode::resource_exhausted,
                  "there are more than " + std::to_string(most_pieces_) +
                      " pieces of isolines to join, which is all that the memory holds: give more "
                      "memory, or ask for fewer levels, a window or a larger error",
                  file_);
    }
    for (IsolinePiece& piece : pieces) {
      piece.first += points_.size();
    }
    points_.add(traced.points);
    all_.pieces.insert(all_.pieces.end(), pieces.begin(), pieces.end());
    all_.counts.triangles += counts.triangles;
    all_.counts.vertices += counts.vertices;
    all_.counts.segments += counts.segments;
    ++all_.tiles;
  }
  [[nodiscard]] TileTraces release() { return std::move(all_); }

 private:
  std::mutex mutex_;
  PointStore& points_;
  std::uint64_t most_pieces_;
  std::string file_;
  TileTraces all_;
};

/// Refines and traces tiles, one after the other, in the same memory.
class Worker {
 public:
  Worker(const OpenedTerrain& terrain, const TileTraceRequest& request, std::uint64_t limit,
         TileQueue& queue, Collected& collected)
      : terrain_(terrain),
        request_(request),
        limit_(limit),
        queue_(queue),
        collected_(collected),
        context_({limit, request.stop}, terrain.store().path()),
        refinement_(terrain.t0()) {}

  void run() noexcept {
    queue_.run([this](const GridBox& tile) { trace(tile); });
  }
  [[nodiscard]] const QueryCost& cost() const noexcept { return context_.cost; }

 private:
  /// Traces the triangles of a tile, or has its halves traced when it does not fit.
  void trace(const GridBox& tile) {
    context_.check_stop();
    const StoreFile& store = terrain_.store();
    const PredicatePtr predicate =
        tile == store.facts().bounds
            ? request_.predicate
            : all_of({std::make_shared<MeetsBox>(tile), request_.predicate});
    pages_.clear();
    terrain_.index().search(*predicate, pages_, context_.cost.io);
    const std::uint64_t records = most_records(store, pages_);
    const std::uint64_t t0_bytes = refinement_bytes(terrain_.t0().vertices.size());
    const std::uint64_t bytes = t0_bytes + refinement_bytes(records);
    if (bytes > limit_ || refinement_bytes(records) > std::max(request_.tile_bytes, 4 * t0_bytes)) {
      if (may_halve(tile, bytes)) {
        queue_.put_halves(tile);
        return;
      }
    }
    refine(*predicate, records);
    trace_mesh(tile, bytes);
  }

  /// False for the smallest tiles when they fit as they are.
  [[nodiscard]] bool may_halve(const GridBox& tile, std::uint64_t bytes) const {
    if (half_perimeter(tile) > 2 * kSmallestTile) {
      return true;
    }
    if (bytes <= limit_) {
      return false;
    }
    throw Error(ErrorCode::resource_exhausted,
                "the isolines of " + std::to_string(kSmallestTile) + " x " +
                    std::to_string(kSmallestTile) + " grid units alone take " + size_text(bytes) +
                    ", more than the " + size_text(limit_) +
                    " that a tile may take: give more memory, or ask for fewer levels or a larger "
                    "error",
                terrain_.store().path());
  }

  void refine(const AttributePredicate& predicate, std::uint64_t records) {
    splits_.clear();
    splits_.reserve(records);
    read_pages(terrain_.store(), pages_, predicate, context_, splits_);
    request_.detail.keep(splits_);
    refinement_.restart(terrain_.t0());
    refinement_.apply(splits_, context_);
  }

  void trace_mesh(const GridBox& tile, std::uint64_t mesh_bytes) {
    const StoreFacts& facts = terrain_.store().facts();
    const TraceScope scope{tile, request_.region};
    TracedPieces traced;
    const TraceResult result =
        trace_isolines({refinement_.tin(), request_.levels, facts.heights, facts.map}, scope,
                       limit_ - std::min(limit_, mesh_bytes), context_, traced);
    if (!result.traced && may_halve(tile, mesh_bytes + result.bytes)) {
      queue_.put_halves(tile);
      return;
    }
    collected_.add(std::move(traced), result.counts);
  }

  const OpenedTerrain& terrain_;
  const TileTraceRequest& request_;
  std::uint64_t limit_;
  TileQueue& queue_;
  Collected& collected_;
  QueryContext context_;
  Refinement refinement_;
  std::vector<PageId> pages_;
  std::vector<PendingSplit> splits_;
};

/// As many threads as asked for, as long as each has room for a tile of a useful size.
int threads_within(const TileTraceRequest& request, std::size_t t0_vertices) {
  const std::uint64_t useful = 2 * refinement_bytes(t0_vertices) + request.tile_bytes / 4;
  const std::uint64_t most = std::max<std::uint64_t>(request.memory_bytes / useful, 1);
  return static_cast<int>(std::min<std::uint64_t>(std::max(request.threads, 1), most));
}

}  // namespace

TileTraces trace_tiles(const OpenedTerrain& terrain, const TileTraceRequest& request,
                       PointStore& points, QueryCost& cost) {
  TileQueue queue(terrain.store().facts().bounds);
  Collected collected(points, request.piece_bytes, terrain.store().path());
  const int count = threads_within(request, terrain.t0().vertices.size());
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
