// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/volume/volume_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "engine/geometry/infinity.h"
#include "engine/query/living/stars_in_region.h"
#include "engine/query/shape/tiler.h"
#include "engine/query/volume/grid_box.h"
#include "engine/query/volume/overlay_mesh.h"
#include "engine/stop.h"

namespace ptin {

namespace {

constexpr double kSumSlack = 16;  // of the bounds of sums, for what rounding adds

/// What all tiles need of one walk.
struct Walk {
  const VolumeRequest& request;
  const GridBox& domain;
  const VolumeTotals& empty;  ///< Sums of the right bounds.
};

/// A worker's own triangles and sums.
class TileWorker {
 public:
  virtual ~TileWorker() = default;
  [[nodiscard]] bool work(const GridTile& tile) {
    context.check_stop();
    const bool fits = count(tile.box, tile.most_bytes);
    if (fits) {
      ++totals.tiles;
    } else if (tile.is_smallest) {
      context.admit(std::max(bytes_wanted(), tile.most_bytes + 1));
    }
    return fits;
  }

  VolumeTotals totals;
  QueryContext context;

 protected:
  TileWorker(const Walk& walk, std::uint64_t limit, const OpenedTerrain& terrain)
      : totals(walk.empty), context({limit, walk.request.limits.stop}, terrain.store().path()) {}
  TileWorker(const TileWorker&) = delete;
  TileWorker& operator=(const TileWorker&) = delete;

 private:
  /// Counts a tile. False when that takes more than `most_bytes`: nothing of it is counted then.
  virtual bool count(const GridBox& tile, std::uint64_t most_bytes) = 0;
  /// What the last tile that did not fit would have taken, as far as it came.
  [[nodiscard]] virtual std::uint64_t bytes_wanted() const = 0;
};

TileLimits tile_limits(const VolumeRequest& request) {
  return {request.limits.memory_bytes, request.tile_bytes, request.threads};
}

template <class Make>
VolumeTotals walk_tiles(const Walk& walk, const Make& make) {
  VolumeTotals totals = walk.empty;
  if (is_empty(walk.domain)) return totals;
  for (const auto& worker : workers_on_tiles(walk.domain, tile_limits(walk.request), make)) {
    worker->totals.cost.add_counts(worker->context.cost);
    totals.add(worker->totals);
  }
  return totals;
}

/// Heights of a triangle above a level.
LinearHeight above_level(const LivingTriangle& t, const HeightEncoding& heights, double level) {
  LinearHeight above;
  for (std::size_t i = 0; i < 3; ++i) {
    above.corners[i] = position_of(t.corner[i].position);
    if (t.corner[i].has_height) above.heights[i] = heights.height(t.corner[i].height) - level;
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

/// Counts the triangles of a terrain against levels, as they are read.
class LevelWorker final : public TileWorker, private LivingVisitor {
 public:
  /// @param is_alone  No other thread waits for halves of a tile.
  LevelWorker(const Walk& walk, std::uint64_t limit, const VolumeSide& side,
              std::span<const double> levels, bool is_alone)
      : TileWorker(walk, limit, side.terrain),
        side_(side),
        levels_(levels),
        is_alone_(is_alone),
        reader_(side.terrain, side.detail),
        border_(side.border_scope()) {}

  bool count(const GridBox& tile, std::uint64_t most_bytes) override {
    tile_ = tile;
    most_bytes_ = most_bytes;
    sides_.clear();
    const VolumeTotals before = totals;
    if (!reader_.read(side_.place(tile), context, *this)) {
      totals = before;
      return false;
    }
    if (border_) add_border(sides_, tile, side_.plane, *border_, totals.border);
    return true;
  }
  [[nodiscard]] std::uint64_t bytes_wanted() const override { return bytes_wanted_; }

 private:
  /// Bytes of the sides of a triangle, while their array grows.
  static constexpr std::uint64_t kBytesATriangle = 2 * 3 * sizeof(BorderSide);

  /// Without a border nothing is kept; tiles are cut for other threads alone.
  bool expect(std::uint64_t records) override {
    bytes_wanted_ = 2 * records * kBytesATriangle;
    return bytes_wanted_ <= most_bytes_ || (is_alone_ && !border_);
  }
  bool begin(std::size_t most_triangles) override {
    bytes_wanted_ = most_triangles * sizeof(RingCorner);  // of the page at hand
    if (border_) bytes_wanted_ += (sides_.size() / 3 + most_triangles) * kBytesATriangle;
    return bytes_wanted_ <= most_bytes_;
  }
  void take(const LivingTriangle& t) override {
    std::array<VertexKey, 3> keys{};
    for (std::size_t i = 0; i < 3; ++i) keys[i] = key_of(t.corner[i].position);
    if (contains(tile_, point_of(*std::min_element(keys.begin(), keys.end())))) {
      count_triangle(begun_with_least(t));
    }
    for (std::size_t i = 0; i < 3 && border_; ++i) {
      const auto [low, high] = std::minmax(keys[i], keys[i == 2 ? 0 : i + 1]);
      if (contains(tile_, point_of(low)) || contains(tile_, point_of(high))) {
        sides_.push_back({low, high, t.is_void});
      }
    }
  }

  void count_triangle(const LivingTriangle& t) {
    parts_.clear();
    const ConvexPiece whole(position_of(t.corner[0].position), position_of(t.corner[1].position),
                            position_of(t.corner[2].position));
    if (side_.cutter) {
      side_.cutter->cut(whole, parts_);
    } else {
      parts_.push_back(whole);
    }
    for (std::size_t i = 0; i < levels_.size() && !parts_.empty(); ++i) {
      const LinearHeight above = above_level(t, side_.facts().heights, levels_[i]);
      for (const ConvexPiece& part : parts_)
        count_piece(t, above, part, levels_[i], totals.sums[i]);
    }
  }

  void count_piece(const LivingTriangle& t, const LinearHeight& above, const ConvexPiece& piece,
                   double level, VolumeSums& sums) {
    if (t.is_void) {
      const Interval heights = side_.is_exact ? Interval{} : side_.heights(t);
      sums.add_void(side_.plane, piece, {heights.lo - level, heights.hi - level});
      return;
    }
    const double shift = side_.cutter ? shift_of(side_) : 0.0;
    const double noise =
        above.noise(0.0) + std::numeric_limits<double>::epsilon() * std::abs(level);
    sums.add_surface(side_.plane, piece, values_at(piece, above),
                     {side_.deviation(t), noise, shift});
  }

  std::span<const double> values_at(const ConvexPiece& piece, const LinearHeight& above) {
    values_.clear();
    for (const MapPoint p : piece.corners()) values_.push_back(above.at(p));
    return values_;
  }

  const VolumeSide& side_;
  std::span<const double> levels_;
  bool is_alone_;
  LivingReader reader_;
  std::optional<BorderScope> border_;
  GridBox tile_;
  std::uint64_t most_bytes_ = 0;
  std::uint64_t bytes_wanted_ = 0;
  std::vector<BorderSide> sides_;  ///< With an end in the tile.
  std::vector<ConvexPiece> parts_;
  std::vector<double> values_;
};

/// A triangle, and its heights on the grid of the overlay.
struct Overlaid {
  const LivingTriangle& triangle;
  LinearHeight height;
  ConvexPiece shape;
  double noise;
};

/// Counts the pairs of triangles of two terrains: those of the other one are gathered, those of the
/// first are taken as they are read.
class OverlayWorker final : public TileWorker, private LivingVisitor {
 public:
  OverlayWorker(const Walk& walk, std::uint64_t limit, const VolumeSide& side,
                const VolumeSide& other)
      : TileWorker(walk, limit, side.terrain),
        side_(side),
        other_(other),
        scale_(walk.request.other_height_scale),
        to_other_(side.facts().map, other.facts().map),
        from_other_(other.facts().map, side.facts().map),
        reader_(side.terrain, side.detail),
        overlay_(other.terrain, other.detail, from_other_),
        shift_(shift_of(side) + from_other_.rounding(other.facts().bounds)) {}

  bool count(const GridBox& tile, std::uint64_t most_bytes) override {
    tile_ = tile;
    const GridBox near = widened(tile, {2, 2});  // what rounding shares lies within a grid unit
    const GridBox there = to_other_.box_around(near, other_.facts().bounds);
    if (is_empty(there)) return true;
    if (!overlay_.gather(other_.place(there), near, most_bytes, context)) return false;
    return reader_.read(side_.place(near), context, *this);
  }
  [[nodiscard]] std::uint64_t bytes_wanted() const override { return overlay_.bytes_wanted(); }

 private:
  void take(const LivingTriangle& found) override {
    const LivingTriangle t = begun_with_least(found);
    Overlaid here{t, above_level(t, side_.facts().heights, 0.0), {}, 0.0};
    const auto& c = here.height.corners;
    here.shape = ConvexPiece(c[0], c[1], c[2]);
    here.noise = here.height.noise(0.0);
    overlay_.visit(box_of(t), [&](std::size_t i) { count_pair(here, overlay_.triangle(i)); });
  }

  [[nodiscard]] LinearHeight height_of_other(const LivingTriangle& u) const {
    LinearHeight height = above_level(u, other_.facts().heights, 0.0);
    height.corners = overlay_.corners(u);
    for (double& h : height.heights) h *= scale_;
    return height;
  }

  void count_pair(const Overlaid& here, const LivingTriangle& u) {
    const std::array<MapPoint, 3> c = overlay_.corners(u);
    ConvexPiece shared = here.shape;
    shared.keep_in({c[0], c[1], c[2]});
    if (shared.is_empty() || !is_in_tile(shared)) return;
    parts_.clear();
    if (side_.cutter) {
      side_.cutter->cut(shared, parts_);
    } else {
      parts_.push_back(shared);
    }
    if (parts_.empty()) return;
    if (here.triangle.is_void || u.is_void) {
      count_void(here, u);
    } else {
      count_surface(here, u);
    }
  }

  void count_surface(const Overlaid& here, const LivingTriangle& u) {
    const LinearHeight there = height_of_other(u);
    const double deviation = side_.deviation(here.triangle) + scale_ * other_.deviation(u);
    const double noise = here.noise + there.noise(from_other_.rounding(other_.facts().bounds));
    for (const ConvexPiece& part : parts_) {
      values_.clear();
      for (const MapPoint p : part.corners()) values_.push_back(here.height.at(p) - there.at(p));
      totals.sums[0].add_surface(side_.plane, part, values_, {deviation, noise, shift_});
    }
  }

  void count_void(const Overlaid& here, const LivingTriangle& u) {
    Interval possible;
    if (!side_.is_exact || !other_.is_exact) {
      const Interval a = side_.heights(here.triangle), b = other_.heights(u);
      if (!is_empty(a) && !is_empty(b)) possible = {a.lo - scale_ * b.hi, a.hi - scale_ * b.lo};
    }
    for (const ConvexPiece& part : parts_) {
      totals.sums[0].add_void(side_.plane, part, possible);
    }
  }

  /// Whether the tile holds the corner that comes first by y, then x; positions between those of
  /// the grid belong to the one at their lower left.
  [[nodiscard]] bool is_in_tile(const ConvexPiece& piece) const {
    MapPoint first = piece.corners().front();
    for (const MapPoint p : piece.corners()) {
      if (p.y < first.y || (p.y == first.y && p.x < first.x)) first = p;
    }
    const GridBox& all = side_.facts().bounds;
    const GridPoint at{
        std::clamp(static_cast<std::int32_t>(std::floor(first.x)), all.min_x, all.max_x),
        std::clamp(static_cast<std::int32_t>(std::floor(first.y)), all.min_y, all.max_y)};
    return contains(tile_, at);
  }

  const VolumeSide& side_;
  const VolumeSide& other_;
  double scale_;
  GridToGrid to_other_, from_other_;
  LivingReader reader_;
  OverlayMesh overlay_;
  double shift_;
  GridBox tile_;
  std::vector<ConvexPiece> parts_;
  std::vector<double> values_;
};

/// Asks for stars whose box meets a box.
class StarsInBox final : public StarPredicate {
 public:
  explicit StarsInBox(const GridBox& box) : box_(box) {}
  [[nodiscard]] bool may_hold(const StarAttributes& a) const noexcept override {
    return meets(a.box, box_);
  }

 private:
  GridBox box_;
};

/// The sums of a walk: bounds of all that can be added to them.
VolumeTotals totals_for(const VolumeSide& side, std::vector<double> most_heights) {
  const GridBox& b = side.facts().bounds;
  const double area = side.plane.area_at_most(b);
  const double longest =
      is_empty(b) ? 0.0
                  : side.plane.length_at_most({double{1} * b.min_x, double{1} * b.min_y},
                                              {double{1} * b.max_x, double{1} * b.max_y});
  for (double& most : most_heights) most *= kSumSlack;
  return {kSumSlack * area, most_heights, longest};
}

}  // namespace

VolumeSide::VolumeSide(const OpenedTerrain& opened, const VolumeRequest& request,
                       QueryContext& context)
    : terrain(opened),
      detail(request.detail, opened.record_source(), context),
      plane(opened.store().facts().map, request.ground),
      is_exact(detail.is_exact(facts())) {
  if (request.region) cutter.emplace(*request.region, facts().map);
  if (!is_exact && !facts().free_of_voids) {
    border_move = request.border_move
                      ? request.border_move(terrain.store(), detail.certificate().error)
                      : kInfinity;
    border_reach = plane.grid_reach(2 * border_move, facts().bounds);
  }
  if (!cutter) return;
  if (border_scope()) {
    stars_ = std::make_unique<StarsInBox>(widened(cutter->region().bounds(), border_reach));
  } else {
    stars_ = std::make_unique<StarsInRegion>(&cutter->region());
  }
}

std::optional<BorderScope> VolumeSide::border_scope() const {
  if (border_move == 0 || !std::isfinite(border_move)) return std::nullopt;
  return BorderScope{cutter ? &cutter->region() : nullptr, border_reach};
}

LivingPlace VolumeSide::place(const GridBox& box) const {
  LivingPlace place;
  place.box = box;
  place.stars = stars_.get();
  return place;
}

double VolumeSide::deviation(const LivingTriangle& t) const noexcept {
  if (is_exact) return 0.0;
  const Interval all = source_heights(facts());
  const double certified = std::min(t.deviation, detail.certificate().deviation);
  return std::min(std::max(certified, facts().base_deviation), std::max(all.hi - all.lo, 0.0));
}

Interval VolumeSide::heights(const LivingTriangle& t) const noexcept {
  const Interval all = source_heights(facts());
  if (is_exact) return all;
  if (t.heights.lo > t.heights.hi) return {1, 0};
  const double base = facts().base_deviation;
  return {std::max(all.lo, facts().heights.height_of_code(t.heights.lo) - base),
          std::min(all.hi, facts().heights.height_of_code(t.heights.hi) + base)};
}

Interval source_heights(const StoreFacts& facts) noexcept {
  if (facts.min_height > facts.max_height) return {1, 0};
  return {facts.min_height - facts.base_deviation, facts.max_height + facts.base_deviation};
}

void VolumeTotals::add(const VolumeTotals& other) {
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i].add(other.sums[i]);
  border.length.add(other.border.length);
  border.parts += other.border.parts;
  cost.add_counts(other.cost);
  tiles += other.tiles;
}

VolumeTotals volume_above_levels(const VolumeSide& side, std::span<const double> levels,
                                 const VolumeRequest& request) {
  const Interval all = source_heights(side.facts());
  std::vector<double> most;
  for (const double level : levels) {
    most.push_back(is_empty(all) ? 0.0
                                 : std::max({std::abs(all.lo - level), std::abs(all.hi - level),
                                             all.hi - all.lo}));
  }
  const VolumeTotals empty = totals_for(side, most);
  const Walk walk{request, side.facts().bounds, empty};
  // A level that cuts between records of one error keeps triangles until the tile has been read.
  const bool is_alone = tile_limits(request).workers() == 1 && side.detail.is_by_error();
  return walk_tiles(walk, [&](std::uint64_t limit) {
    return std::make_unique<LevelWorker>(walk, limit, side, levels, is_alone);
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
  const VolumeTotals empty = totals_for(side, {most});
  const Walk walk{request, side.facts().bounds, empty};
  return walk_tiles(walk, [&](std::uint64_t limit) {
    return std::make_unique<OverlayWorker>(walk, limit, side, other);
  });
}

}  // namespace ptin
