// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_tiles.h"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "engine/error.h"
#include "engine/query/living/living_place.h"
#include "engine/query/living/stars_in_region.h"
#include "engine/query/shape/tiler.h"

namespace ptin {

namespace {

std::string size_text(std::uint64_t bytes) {
  return bytes < (16 << 20) ? std::to_string((bytes + 1023) >> 10) + " KiB"
                            : std::to_string((bytes + 0xFFFFF) >> 20) + " MiB";
}

/// Gathers and traces tiles, one after the other, in the same memory.
class Worker final : private LivingVisitor {
 public:
  Worker(const OpenedTerrain& terrain, const TileTraceRequest& request, std::uint64_t limit,
         TraceCollector& collected)
      : store_(terrain.store()),
        request_(request),
        collected_(collected),
        context_({limit, request.stop}, store_.path()),
        stars_in_region_(request.region),
        reader_(terrain, request.detail),
        tracer_(request.levels, store_.facts().heights, store_.facts().map, context_) {
    place_.steps = request.levels.least_above();
    place_.stars = request.region == nullptr ? nullptr : &stars_in_region_;
  }

  /// Traces the triangles of a tile, unless it does not fit.
  [[nodiscard]] bool work(const GridTile& tile) {
    context_.check_stop();
    place_.box = tile.box;
    is_smallest_ = tile.is_smallest;
    most_bytes_ = tile.most_bytes;
    is_full_ = false;
    tracer_.begin({tile.box, request_.region, request_.counts_vertices}, most_bytes_);
    const std::uint64_t before = context_.cost.examined();
    const bool fits = reader_.read(place_, context_, *this) && !is_full_;
    if (const std::uint64_t records = context_.cost.examined() - before; records > 0) {
      bytes_of_record_ = static_cast<double>(tracer_.bytes_wanted()) / static_cast<double>(records);
    }
    if (fits) {
      collected_.add(tracer_.join(), tracer_.counts());
    } else if (is_smallest_) {
      refuse(tile.box);
    }
    return fits;
  }
  [[nodiscard]] const QueryCost& cost() const noexcept { return context_.cost; }

 private:
  /// A tile that is expected not to fit is not read: halves of a tile that would have fitted cost less
  /// than a tile read in vain. The expectation is trusted less each time, since nothing is learnt then.
  bool expect(std::uint64_t records) override {
    if (is_smallest_ ||
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
  bool take_cells(const RasterSquare& square) override {
    if (!tracer_.takes(square)) {
      return false;
    }
    is_full_ = is_full_ || !tracer_.add(square);
    return true;
  }
  void take(const LivingTriangle& t) override { is_full_ = is_full_ || !tracer_.add(t); }

  [[noreturn]] void refuse(const GridBox& tile) const {
    const auto side = [](std::int32_t low, std::int32_t high) {
      return std::to_string(std::int64_t{high} - low);
    };
    throw Error(ErrorCode::resource_exhausted,
                "the isolines of " + side(tile.min_x, tile.max_x) + " x " +
                    side(tile.min_y, tile.max_y) + " grid units alone take " +
                    size_text(tracer_.bytes_wanted()) + " or more, and a tile may take " +
                    size_text(most_bytes_) +
                    ": give more memory, or ask for fewer levels or a larger error",
                store_.path());
  }

  const StoreFile& store_;
  const TileTraceRequest& request_;
  TraceCollector& collected_;
  QueryContext context_;
  StarsInRegion stars_in_region_;
  LivingPlace place_;
  LivingReader reader_;
  LineTracer tracer_;
  std::uint64_t most_bytes_ = 0;
  bool is_smallest_ = false;    ///< The tile is not halved.
  bool is_full_ = false;        ///< What was read of the tile does not fit.
  double bytes_of_record_ = 8;  ///< About, by what was gathered last.
};

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
  TraceCollector collected(request, points, terrain.store().path());
  const auto make = [&](std::uint64_t bytes) {
    return std::make_unique<Worker>(terrain, request, bytes, collected);
  };
  for (const auto& worker : workers_on_tiles(terrain.store().facts().bounds, request.tiles, make)) {
    cost.add_counts(worker->cost());
  }
  return collected.release();
}

}  // namespace ptin
