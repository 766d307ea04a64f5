// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "engine/error.h"
#include "engine/query/certificate.h"
#include "engine/query/isoline_clip.h"
#include "engine/query/meets_box.h"
#include "engine/query/refinement.h"
#include "engine/query/retrieval.h"

namespace ptin {

namespace {

constexpr std::int64_t kSmallestTile = 32;  // grid units a side
constexpr std::uint64_t kTraceBytes = 16;   // a record: bands, marks of two triangles
constexpr std::uint64_t kSmallestLimit = 1 << 20;

std::pair<GridBox, GridBox> halves(const GridBox& box) {
  std::pair<GridBox, GridBox> two{box, box};
  if (std::int64_t{box.max_x} - box.min_x >= std::int64_t{box.max_y} - box.min_y) {
    two.first.max_x = box.min_x + (box.max_x - box.min_x) / 2;
    two.second.min_x = two.first.max_x + 1;
  } else {
    two.first.max_y = box.min_y + (box.max_y - box.min_y) / 2;
    two.second.min_y = two.first.max_y + 1;
  }
  return two;
}

}  // namespace

/// One extraction: tiles, then joining, then cutting at the window.
class IsolineExtraction {
 public:
  IsolineExtraction(const ProgressiveTin& terrain, const IsolineRequest& request)
      : terrain_(terrain),
        store_(terrain.store()),
        request_(request),
        levels_(request.levels, store_.facts().heights),
        context_(request.stop, request.memory_limit_bytes, store_.path()),
        result_(PointStore(request.memory_limit_bytes / 4, request.temporary_folder)) {
    std::vector<PredicatePtr> parts{levels_.crossing()};
    if (request.window) {
      region_.emplace(*request.window, store_.facts().map);
      parts.push_back(meets_region(*request.window, store_.facts().map));
    }
    if (request.tolerance) {
      parts.push_back(error_above(*request.tolerance));
    }
    predicate_ = all_of(std::move(parts));
  }

  Isolines run() {
    context_.admit(kSmallestLimit);
    trace(store_.facts().bounds);
    result_.lines_ = join_pieces(result_.pieces_, context_);
    if (request_.window) {
      cut_at_window();
    }
    drop_points();
    if (result_.size() > request_.most_lines) {
      throw Error(ErrorCode::resource_exhausted,
                  "there are " + std::to_string(result_.size()) +
                      " isolines, more than the limit of " + std::to_string(request_.most_lines) +
                      " lines: ask for fewer levels or a larger error, or raise the limit",
                  store_.path());
    }
    store_.pages().check_unchanged();
    finish();
    return std::move(result_);
  }

 private:
  /// Traces the triangles of a tile, or of its halves when their records do not fit.
  void trace(const GridBox& tile) {
    context_.check_stop();
    const PredicatePtr predicate = tile == store_.facts().bounds
                                       ? predicate_
                                       : all_of({predicate_, std::make_shared<MeetsBox>(tile)});
    std::vector<PageId> pages;
    terrain_.index().search(*predicate, pages, context_.cost.io);
    const std::uint64_t records = most_records(store_, pages);
    const std::uint64_t bytes =
        refinement_bytes(terrain_.t0().vertices.size() + records) + records * kTraceBytes;
    if (bytes > request_.memory_limit_bytes / 2 && half_perimeter(tile) > 2 * kSmallestTile) {
      const auto [low, high] = halves(tile);
      trace(low);
      trace(high);
      return;
    }
    context_.admit(bytes);
    trace_mesh(tile, *predicate, pages, bytes);
  }

  void trace_mesh(const GridBox& tile, const AttributePredicate& predicate,
                  std::span<const PageId> pages, std::uint64_t bytes) {
    std::vector<PendingSplit> splits;
    read_pages(store_, pages, predicate, context_, splits);
    Refinement refinement(terrain_.t0());
    refinement.apply(splits, context_);
    splits = {};
    const StoreFacts& facts = store_.facts();
    const TraceScope scope{tile, region_ ? &*region_ : nullptr};
    const TraceCounts counts =
        trace_isolines(refinement.tin(), levels_, facts.heights, facts.map, scope, bytes, context_,
                       result_.pieces_, result_.points_);
    result_.crossed.triangles += counts.triangles;
    result_.crossed.vertices += counts.vertices;
    result_.crossed.segments += counts.segments;
    ++result_.tiles;
  }

  void cut_at_window() {
    PointStore points(request_.memory_limit_bytes / 4, request_.temporary_folder);
    std::vector<IsolinePiece> pieces;
    JoinedLines lines;
    std::vector<MapPoint> line;
    for (const JoinedLine& joined : result_.lines_.lines) {
      context_.check_stop();
      points_of(joined, result_.lines_, result_.pieces_, result_.points_, line);
      const ClippedParts clipped = clip_line(line, *request_.window);
      for (const std::vector<MapPoint>& part : clipped.parts) {
        IsolinePiece piece;
        piece.level = joined.level;
        piece.ring = joined.ring && clipped.whole;
        piece.first = points.size();
        piece.count = static_cast<std::uint32_t>(part.size());
        lines.lines.push_back({joined.level, piece.ring, joined.smallest, lines.order.size(), 1});
        lines.order.push_back(static_cast<std::uint32_t>(pieces.size()));
        pieces.push_back(piece);
        points.add(part);
      }
    }
    result_.points_ = std::move(points);
    result_.pieces_ = std::move(pieces);
    result_.lines_ = std::move(lines);
  }

  /// Leaves out lines that are one point: all their cuts are at one vertex, a peak at the level.
  void drop_points() {
    std::vector<MapPoint> points;
    std::erase_if(result_.lines_.lines, [&](const JoinedLine& line) {
      for (std::uint32_t k = 0; k < line.pieces; ++k) {
        if (result_.pieces_[result_.lines_.order[line.first_piece + k]].count > 1) {
          return false;  // its points differ in a row
        }
      }
      points_of(line, result_.lines_, result_.pieces_, result_.points_, points);
      return points.empty();
    });
  }

  void finish() {
    const Certificate certificate = certify_below(store_, request_.tolerance.value_or(-1.0));
    result_.levels_ = levels_.heights();
    result_.certified_error = certificate.error;
    result_.certified_deviation = certificate.deviation;
    result_.exact = certificate.complete && store_.facts().base_error == 0;
    result_.cost = context_.cost;
  }

  const ProgressiveTin& terrain_;
  const StoreFile& store_;
  const IsolineRequest& request_;
  LevelSet levels_;
  std::optional<GridRegion> region_;
  PredicatePtr predicate_;
  QueryContext context_;
  Isolines result_;
};

Isoline Isolines::line(std::size_t i, std::vector<MapPoint>& points) const {
  points_of(lines_.lines[i], lines_, pieces_, points_, points);
  return {lines_.lines[i].level, lines_.lines[i].ring, points};
}

Isolines isolines(const ProgressiveTin& terrain, const IsolineRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  Isolines result = IsolineExtraction(terrain, request).run();
  result.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace ptin
