// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline.h"

#include <algorithm>
#include <functional>
#include <span>
#include <utility>
#include <variant>

#include "engine/error.h"
#include "engine/query/isoline/isoline_clip.h"
#include "engine/query/isoline/isoline_tiles.h"
#include "engine/query/select/detail.h"

namespace ptin {

namespace {

constexpr std::uint64_t kSmallestLimit = 1 << 20;

/// Shares of the memory, in eighths. While tiles are traced it is that of the tiles, of the pieces,
/// which cannot be put on disk, and of points. While lines are cut at a region, what the tiles have
/// given back is that of the cut pieces, of as many points and of the line at hand; where nothing is
/// cut, of the line, which has what pieces and points have not taken, too.
struct Shares {
  std::uint64_t tiles, pieces, points, cut_pieces;
};
constexpr std::uint64_t kShareOfCutLine = 1;

/// Where points cannot be put on disk either, and are not needed twice, they have more: they are most of
/// what long lines take.
Shares shares_of(const IsolineRequest& request) {
  const bool is_cut = request.region && request.cuts;
  if (is_cut || !request.temporary_folder.empty()) return {4, 3, 1, 2};
  return {2, 3, 3, 0};
}

std::uint64_t bytes_of_share(const IsolineRequest& request, std::uint64_t eighths) {
  return request.limits.share(eighths, 8).memory_bytes;
}

constexpr std::uint64_t kTileBytes = 8 * kMiB;
constexpr std::uint64_t kTileBytesOfOneThread = 256 * kMiB;
/// Bytes of a point while its line is written: the point itself, in a geometry, and as bytes of a
/// format.
constexpr std::uint64_t kBytesAPointOut = 80;

}  // namespace

/// One extraction: tiles, then joining, then cutting at the region.
class IsolineExtraction {
 public:
  IsolineExtraction(const OpenedTerrain& terrain, const IsolineRequest& request)
      : store_(terrain.store()),
        request_(request),
        levels_(request.levels, store_.facts().heights),
        context_(request.limits, store_.path()),
        detail_(request.detail, terrain.record_source(), context_),
        shares_(shares_of(request)),
        result_(PointStore(bytes_of_share(request, shares_.points), request.temporary_folder)) {
    if (!request.region) return;
    region_.emplace(*request.region, store_.facts().map);
    if (!request.cuts) return;
    if (const auto* window = std::get_if<Window>(&*request.region)) {
      clip_ = [kept = snapped(*window, store_.facts().map)](std::span<const MapPoint> line) {
        return clip_line(line, kept);
      };
    } else if (const auto* polygon = std::get_if<Polygon>(&*request.region)) {
      clip_ = [sides = PolygonClip(*polygon)](std::span<const MapPoint> line) {
        return sides.clip(line);
      };
    } else {
      refuse("isolines are cut at a window or a polygon; a point or a segment has no inside");
    }
  }

  Isolines run(const TraceTerrain& trace) {
    context_.admit(kSmallestLimit);
    trace_terrain(trace);
    result_.lines_ = join_pieces(result_.pieces_, context_);
    admit_lines();
    if (clip_) {
      cut_at_region();
    }
    drop_single_points(result_.lines_, result_.pieces_, result_.points_);
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
  void trace_terrain(const TraceTerrain& trace) {
    TileTraceRequest request{
        levels_,
        detail_,
        region_ ? &*region_ : nullptr,
        {bytes_of_share(request_, shares_.tiles),
         request_.threads <= 1 ? kTileBytesOfOneThread : kTileBytes, request_.threads},
        bytes_of_share(request_, shares_.pieces),
        request_.limits.stop};
    request.counts_vertices = request_.counts_vertices;
    TileTraces traces = trace(request, result_.points_, context_.cost);
    result_.pieces_ = std::move(traces.pieces);
    result_.crossed = traces.counts;
    result_.tiles = traces.tiles;
  }

  /// Bytes for writing one line.
  [[nodiscard]] std::uint64_t room_for_a_line() const {
    if (clip_) return bytes_of_share(request_, kShareOfCutLine);
    const std::uint64_t points = std::min<std::uint64_t>(result_.points_.size() * sizeof(MapPoint),
                                                         bytes_of_share(request_, shares_.points));
    return request_.limits.memory_bytes - points - result_.pieces_.size() * kBytesAPiece;
  }

  /// Checks that the longest line fits. Lines are joined and written in the memory that tiles have
  /// given back.
  void admit_lines() const {
    std::uint64_t longest = 0;
    for (const JoinedLine& line : result_.lines_.lines) {
      std::uint64_t points = 0;
      for (std::uint32_t k = 0; k < line.pieces; ++k) {
        points += result_.pieces_[result_.lines_.order[line.first_piece + k]].count;
      }
      longest = std::max(longest, points);
    }
    const std::uint64_t bytes = longest * kBytesAPointOut;
    if (bytes > room_for_a_line()) {
      throw Error(
          ErrorCode::resource_exhausted,
          "the longest isoline has " + std::to_string(longest) + " points, which take " +
              std::to_string((bytes + 0xFFFFF) >> 20) +
              " MiB to write, more than there is beside the others: give more memory, or ask for a "
              "window or a larger error",
          store_.path());
    }
  }

  void cut_at_region() {
    PointStore points(bytes_of_share(request_, shares_.points), request_.temporary_folder);
    std::vector<IsolinePiece> pieces;
    JoinedLines lines;
    std::vector<MapPoint> line;
    for (const JoinedLine& joined : result_.lines_.lines) {
      context_.check_stop();
      points_of(joined, result_.lines_, result_.pieces_, result_.points_, line);
      const ClippedParts clipped = clip_(line);
      for (const std::vector<MapPoint>& part : clipped.parts) {
        IsolinePiece piece;
        piece.level = joined.level;
        piece.ring = joined.ring && clipped.whole;
        piece.first = points.size();
        piece.count = static_cast<std::uint32_t>(part.size());
        if ((pieces.size() + 1) * kBytesAPiece > bytes_of_share(request_, shares_.cut_pieces)) {
          throw Error(ErrorCode::resource_exhausted,
                      "the region cuts the isolines into more than " +
                          std::to_string(pieces.size()) +
                          " parts, more than the memory holds: give more memory, or "
                          "ask for fewer levels",
                      store_.path());
        }
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

  void finish() {
    result_.levels_ = levels_.heights();
    result_.certified_error = detail_.certificate().error;
    result_.certified_deviation = detail_.certificate().deviation;
    result_.exact = detail_.is_exact(store_.facts());
    result_.cost = context_.cost;
  }

  const StoreFile& store_;
  const IsolineRequest& request_;
  LevelSet levels_;
  std::optional<GridRegion> region_;
  std::function<ClippedParts(std::span<const MapPoint>)> clip_;  ///< At the region; none: nowhere.
  QueryContext context_;
  Detail detail_;
  Shares shares_;
  Isolines result_;
};

Isoline Isolines::line(std::size_t i, std::vector<MapPoint>& points) const {
  points_of(lines_.lines[i], lines_, pieces_, points_, points);
  return {lines_.lines[i].level, lines_.lines[i].ring, points};
}

Isolines extract_isolines(const OpenedTerrain& terrain, const IsolineRequest& request,
                          const TraceTerrain& trace) {
  return timed([&] { return IsolineExtraction(terrain, request).run(trace); });
}

Isolines isolines(const OpenedTerrain& terrain, const IsolineRequest& request) {
  return extract_isolines(terrain, request,
                          [&](const TileTraceRequest& tiles, PointStore& points, QueryCost& cost) {
                            return trace_tiles(terrain, tiles, points, cost);
                          });
}

}  // namespace ptin
