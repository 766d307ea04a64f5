// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/volume/volume_tiles.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "engine/geometry/infinity.h"
#include "engine/query/refine/tile_queue.h"
#include "engine/query/volume/grid_box.h"
#include "engine/query/volume/overlay_mesh.h"
#include "engine/query/volume/tile_mesh.h"
#include "engine/stop.h"

namespace ptin {

namespace {

constexpr std::int64_t kSmallestTile = 8;  // grid units a side
constexpr double kSlack = 16;              // of the bounds of sums, for what rounding adds

/// What all tiles need of one walk.
struct Walk {
  const VolumeRequest& request;
  const GridBox& domain;
  std::uint64_t t0_bytes;     ///< Of the terrains together.
  const VolumeTotals& empty;  ///< Sums of the right bounds.
};

/// A worker's own meshes and sums.
class TileWorker {
 public:
  virtual ~TileWorker() = default;
  /// Most bytes that the tile takes; count() then does that tile.
  virtual std::uint64_t announce(const GridBox& tile) = 0;
  virtual void count(const GridBox& tile) = 0;

  VolumeTotals totals;
  QueryContext context;

 protected:
  TileWorker(const Walk& walk, std::uint64_t limit, const OpenedTerrain& terrain)
      : totals(walk.empty), context({limit, walk.request.limits.stop}, terrain.store().path()) {}
  TileWorker(const TileWorker&) = delete;
  TileWorker& operator=(const TileWorker&) = delete;
};

using MakeWorker = std::function<std::unique_ptr<TileWorker>(std::uint64_t limit)>;

/// As many threads as asked for, as long as each has room for a tile of a useful size.
int threads_within(const Walk& walk) {
  const std::uint64_t useful = 2 * walk.t0_bytes + walk.request.tile_bytes / 4;
  const std::uint64_t most = std::max<std::uint64_t>(walk.request.limits.memory_bytes / useful, 1);
  return static_cast<int>(std::min<std::uint64_t>(std::max(walk.request.threads, 1), most));
}

VolumeTotals walk_tiles(const Walk& walk, const MakeWorker& make) {
  VolumeTotals totals = walk.empty;
  if (is_empty(walk.domain)) return totals;
  TileQueue queue(walk.domain);
  const int count = threads_within(walk);
  const std::uint64_t limit = walk.request.limits.memory_bytes / static_cast<std::uint64_t>(count);
  const std::uint64_t wanted =
      std::min(limit, std::max(walk.request.tile_bytes, 4 * walk.t0_bytes));
  std::vector<std::unique_ptr<TileWorker>> workers;
  for (int i = 0; i < count; ++i) workers.push_back(make(limit));
  run_on_threads(count, [&](int i) {
    TileWorker& worker = *workers[static_cast<std::size_t>(i)];
    queue.run([&](const GridBox& tile) {
      worker.context.check_stop();
      const std::uint64_t bytes = worker.announce(tile);
      if (bytes > wanted && half_perimeter(tile) > 2 * kSmallestTile) {
        queue.put_halves(tile);
        return;
      }
      worker.context.admit(bytes);
      worker.count(tile);
      ++worker.totals.tiles;
    });
  });
  queue.rethrow();
  for (const auto& worker : workers) {
    worker->totals.cost.add_counts(worker->context.cost);
    totals.add(worker->totals);
  }
  return totals;
}

/// Heights of a triangle above a level.
LinearHeight above_level(const Tin& tin, TriangleId t, const HeightEncoding& heights,
                         double level) {
  LinearHeight above;
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexId v = tin.triangles[t].v[i];
    above.corners[i] = position_of(tin.position(v));
    if (tin.has_height[v] != 0) {
      above.heights[i] = heights.height(tin.vertices[v].height) - level;
    }
  }
  return above;
}

/// Most that a cut at a triangle or at a region is moved by rounding, grid units.
double shift_of(const VolumeSide& side) {
  GridBox all = side.facts().bounds;
  if (side.cutter) all = united(all, side.cutter->region().bounds());
  const double farthest =
      std::max({std::abs(double{1} * all.min_x), std::abs(double{1} * all.min_y),
                std::abs(double{1} * all.max_x), std::abs(double{1} * all.max_y)});
  return 8 * std::numeric_limits<double>::epsilon() * farthest;
}

/// Counts the triangles of a terrain against a level.
class LevelWorker final : public TileWorker {
 public:
  LevelWorker(const Walk& walk, std::uint64_t limit, const VolumeSide& side, double level)
      : TileWorker(walk, limit, side.terrain),
        side_(side),
        level_(level),
        mesh_(side.terrain, side.detail, side.wanted()),
        border_(side.border_scope()) {}

  std::uint64_t announce(const GridBox& tile) override { return mesh_.announce(tile, context); }

  void count(const GridBox& tile) override {
    mesh_.refine(context);
    const Tin& tin = mesh_.tin();
    for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
      if (t % kStopInterval == 0) context.check_stop();
      if (is_in(tile, tin, t)) count_triangle(tin, t);
    }
    if (border_) add_border(tin, tile, side_.plane, *border_, totals.border);
  }

 private:
  static bool is_in(const GridBox& tile, const Tin& tin, TriangleId t) {
    GridPoint lowest = tin.position(tin.triangles[t].v[0]);
    for (int i = 1; i < 3; ++i) {
      const GridPoint p = tin.position(tin.triangles[t].v[i]);
      if (key_of(p) < key_of(lowest)) lowest = p;
    }
    return contains(tile, lowest);
  }

  void count_triangle(const Tin& tin, TriangleId t) {
    const LinearHeight above = above_level(tin, t, side_.facts().heights, level_);
    const ConvexPiece whole(above.corners[0], above.corners[1], above.corners[2]);
    if (!side_.cutter) {
      count_piece(tin, t, above, whole);
      return;
    }
    parts_.clear();
    side_.cutter->cut(whole, parts_);
    for (const ConvexPiece& part : parts_) count_piece(tin, t, above, part);
  }

  void count_piece(const Tin& tin, TriangleId t, const LinearHeight& above,
                   const ConvexPiece& piece) {
    if (tin.classes[t] == TriangleClass::kVoid) {
      const Interval heights = mesh_.is_exact() ? Interval{} : mesh_.heights(t);
      totals.sums.add_void(side_.plane, piece, {heights.lo - level_, heights.hi - level_});
      return;
    }
    const double shift = side_.cutter ? shift_of(side_) : 0.0;
    const double noise =
        above.noise(0.0) + std::numeric_limits<double>::epsilon() * std::abs(level_);
    totals.sums.add_surface(side_.plane, piece, values_at(piece, above),
                            {mesh_.deviation(t), noise, shift});
  }

  std::span<const double> values_at(const ConvexPiece& piece, const LinearHeight& above) {
    values_.clear();
    for (const MapPoint p : piece.corners()) values_.push_back(above.at(p));
    return values_;
  }

  const VolumeSide& side_;
  double level_;
  TileMesh mesh_;
  std::optional<BorderScope> border_;
  std::vector<ConvexPiece> parts_;
  std::vector<double> values_;
};

/// A mesh, one triangle of it, and its heights on the grid of the overlay.
struct Overlaid {
  TriangleId triangle;
  bool is_surface;
  LinearHeight height;
  ConvexPiece shape;
  double noise;
};

/// Counts the pairs of triangles of two terrains.
class OverlayWorker final : public TileWorker {
 public:
  OverlayWorker(const Walk& walk, std::uint64_t limit, const VolumeSide& side,
                const VolumeSide& other)
      : TileWorker(walk, limit, side.terrain),
        side_(side),
        other_(other),
        scale_(walk.request.other_height_scale),
        to_other_(side.facts().map, other.facts().map),
        from_other_(other.facts().map, side.facts().map),
        mesh_(side.terrain, side.detail, side.wanted()),
        other_mesh_(other.terrain, other.detail, other.wanted()),
        overlay_(from_other_),
        shift_(shift_of(side) + from_other_.rounding(other.facts().bounds)) {}

  std::uint64_t announce(const GridBox& tile) override {
    near_ = widened(tile, {2, 2});  // what rounding shares lies within a grid unit
    const GridBox there = to_other_.box_around(near_, other_.facts().bounds);
    is_beside_ = is_empty(there);
    if (is_beside_) return 0;
    const std::uint64_t bytes =
        mesh_.announce(near_, context) + other_mesh_.announce(there, context);
    return bytes + OverlayMesh::kBytesATriangle * other_mesh_.most_triangles();
  }

  void count(const GridBox& tile) override {
    if (is_beside_) return;
    mesh_.refine(context);
    other_mesh_.refine(context);
    overlay_.take(other_mesh_.tin(), near_);
    const Tin& tin = mesh_.tin();
    for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
      if (t % kStopInterval == 0) context.check_stop();
      const GridBox box = united(
          united(box_of(tin.position(tin.triangles[t].v[0])), tin.position(tin.triangles[t].v[1])),
          tin.position(tin.triangles[t].v[2]));
      if (!meets(box, near_)) continue;
      const Overlaid here = of_here(t);
      overlay_.visit(box, [&](TriangleId u) { count_pair(tile, here, u); });
    }
  }

 private:
  [[nodiscard]] Overlaid of_here(TriangleId t) const {
    const Tin& tin = mesh_.tin();
    Overlaid o{t,
               tin.classes[t] == TriangleClass::kSurface,
               above_level(tin, t, side_.facts().heights, 0.0),
               {},
               0.0};
    const auto& c = o.height.corners;
    o.shape = ConvexPiece(c[0], c[1], c[2]);
    o.noise = o.height.noise(0.0);
    return o;
  }

  [[nodiscard]] ConvexPiece shape_of_other(TriangleId u) const {
    const Triangle& triangle = other_mesh_.tin().triangles[u];
    return {overlay_.position(triangle.v[0]), overlay_.position(triangle.v[1]),
            overlay_.position(triangle.v[2])};
  }

  [[nodiscard]] LinearHeight height_of_other(TriangleId u) const {
    LinearHeight height = above_level(other_mesh_.tin(), u, other_.facts().heights, 0.0);
    for (std::size_t i = 0; i < 3; ++i) {
      height.corners[i] = overlay_.position(other_mesh_.tin().triangles[u].v[i]);
      height.heights[i] *= scale_;
    }
    return height;
  }

  void count_pair(const GridBox& tile, const Overlaid& here, TriangleId u) {
    ConvexPiece shared = here.shape;
    shared.keep_in(shape_of_other(u));
    if (shared.is_empty() || !is_in(tile, shared)) return;
    parts_.clear();
    if (side_.cutter) {
      side_.cutter->cut(shared, parts_);
    } else {
      parts_.push_back(shared);
    }
    if (parts_.empty()) return;
    if (!here.is_surface || other_mesh_.tin().classes[u] == TriangleClass::kVoid) {
      count_void(here, u);
    } else {
      count_surface(here, u);
    }
  }

  void count_surface(const Overlaid& here, TriangleId u) {
    const LinearHeight there = height_of_other(u);
    const double deviation = mesh_.deviation(here.triangle) + scale_ * other_mesh_.deviation(u);
    const double noise = here.noise + there.noise(from_other_.rounding(other_.facts().bounds));
    for (const ConvexPiece& part : parts_) {
      values_.clear();
      for (const MapPoint p : part.corners()) values_.push_back(here.height.at(p) - there.at(p));
      totals.sums.add_surface(side_.plane, part, values_, {deviation, noise, shift_});
    }
  }

  void count_void(const Overlaid& here, TriangleId u) {
    Interval possible;
    if (!mesh_.is_exact() || !other_mesh_.is_exact()) {
      const Interval a = mesh_.heights(here.triangle), b = other_mesh_.heights(u);
      if (!is_empty(a) && !is_empty(b)) possible = {a.lo - scale_ * b.hi, a.hi - scale_ * b.lo};
    }
    for (const ConvexPiece& part : parts_) {
      totals.sums.add_void(side_.plane, part, possible);
    }
  }

  /// Whether the tile holds the corner that comes first by y, then x; positions between those of
  /// the grid belong to the one at their lower left.
  [[nodiscard]] bool is_in(const GridBox& tile, const ConvexPiece& piece) const {
    MapPoint first = piece.corners().front();
    for (const MapPoint p : piece.corners()) {
      if (p.y < first.y || (p.y == first.y && p.x < first.x)) first = p;
    }
    const GridBox& all = side_.facts().bounds;
    const GridPoint at{
        std::clamp(static_cast<std::int32_t>(std::floor(first.x)), all.min_x, all.max_x),
        std::clamp(static_cast<std::int32_t>(std::floor(first.y)), all.min_y, all.max_y)};
    return contains(tile, at);
  }

  const VolumeSide& side_;
  const VolumeSide& other_;
  double scale_;
  GridToGrid to_other_, from_other_;
  TileMesh mesh_, other_mesh_;
  OverlayMesh overlay_;
  double shift_;
  GridBox near_;
  bool is_beside_ = false;
  std::vector<ConvexPiece> parts_;
  std::vector<double> values_;
};

/// The sums of a walk: bounds of all that can be added to them.
VolumeTotals totals_for(const VolumeSide& side, double most_height) {
  const GridBox& b = side.facts().bounds;
  const double area = side.plane.area_at_most(b);
  const double longest =
      is_empty(b) ? 0.0
                  : side.plane.length_at_most({double{1} * b.min_x, double{1} * b.min_y},
                                              {double{1} * b.max_x, double{1} * b.max_y});
  return {kSlack * area, kSlack * most_height, longest};
}

}  // namespace

VolumeSide::VolumeSide(const OpenedTerrain& opened, const VolumeRequest& request,
                       QueryContext& context)
    : terrain(opened),
      detail(request.detail, opened.record_source(), context),
      plane(opened.store().facts().map, request.ground) {
  if (request.region) {
    cutter.emplace(*request.region, facts().map);
    in_region = meets_region(*request.region, facts().map);
  }
  if (detail.is_exact(facts()) || facts().free_of_voids) return;
  border_move = request.border_move
                    ? request.border_move(terrain.store(), detail.certificate().error)
                    : kInfinity;
  border_reach = plane.grid_reach(2 * border_move, facts().bounds);
}

std::optional<BorderScope> VolumeSide::border_scope() const {
  if (border_move == 0 || !std::isfinite(border_move)) return std::nullopt;
  return BorderScope{cutter ? &cutter->region() : nullptr, border_reach};
}

PredicatePtr VolumeSide::wanted() const {
  if (!border_scope() || !cutter) return in_region;
  const GridBox box = widened(cutter->region().bounds(), border_reach);
  return std::make_shared<MeetsBox>(box);
}

void VolumeTotals::add(const VolumeTotals& other) {
  sums.add(other.sums);
  border.length.add(other.border.length);
  border.parts += other.border.parts;
  cost.add_counts(other.cost);
  tiles += other.tiles;
}

VolumeTotals volume_above_level(const VolumeSide& side, double level,
                                const VolumeRequest& request) {
  const Interval all = source_heights(side.facts());
  const double most =
      is_empty(all)
          ? 0.0
          : std::max({std::abs(all.lo - level), std::abs(all.hi - level), all.hi - all.lo});
  const VolumeTotals empty = totals_for(side, most);
  const Walk walk{request, side.facts().bounds, bytes_of(side.terrain.t0()), empty};
  return walk_tiles(walk, [&](std::uint64_t limit) {
    return std::make_unique<LevelWorker>(walk, limit, side, level);
  });
}

VolumeTotals volume_of_overlay(const VolumeSide& side, const VolumeSide& other,
                               const VolumeRequest& request) {
  double most = 0.0;
  for (const auto& [facts, scale] :
       {std::pair{&side.facts(), 1.0}, std::pair{&other.facts(), request.other_height_scale}}) {
    const Interval all = source_heights(*facts);
    if (!is_empty(all)) most += 2 * scale * std::max(std::abs(all.lo), std::abs(all.hi));
  }
  const VolumeTotals empty = totals_for(side, most);
  const Walk walk{request, side.facts().bounds,
                  bytes_of(side.terrain.t0()) + bytes_of(other.terrain.t0()), empty};
  return walk_tiles(walk, [&](std::uint64_t limit) {
    return std::make_unique<OverlayWorker>(walk, limit, side, other);
  });
}

}  // namespace ptin
