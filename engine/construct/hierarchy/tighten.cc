// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/hierarchy/tighten.h"

#include <algorithm>
#include <cfloat>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>

#include "engine/check.h"
#include "engine/construct/collapse/sample_hand_over.h"
#include "engine/construct/collapse/tile_compact.h"
#include "engine/construct/measure/fan_deviation.h"
#include "engine/construct/measure/fan_error.h"
#include "engine/construct/measure/plane_blocks.h"
#include "engine/construct/measure/sample_blocks.h"
#include "engine/construct/measure/star_samples.h"
#include "engine/geometry/hilbert.h"
#include "engine/geometry/orient.h"
#include "engine/geometry/packed_boxes.h"
#include "engine/mesh/split.h"
#include "engine/mesh/triangle_holds.h"

namespace ptin {

namespace {

/// The reach that a vertex has in a replay. Construction has charged the vertex itself, so it is
/// not charged again: the reach is (nearly) 0, and its sign gives the class alone.
float no_reach(bool has_height) { return has_height ? 0.0F : -FLT_MIN; }

/// True where the samples of a leaf can be measured as blocks: over a raster with whole codes, without
/// voids in and near it, below a T0 that is all surface and not wide.
bool suits_blocks(const Tin& t0, const StartedTile& leaf) {
  GridBox bounds;
  for (const Vertex& v : t0.vertices) {
    bounds = united(bounds, v.position);
  }
  const double extent = std::max(static_cast<double>(bounds.max_x) - bounds.min_x,
                                 static_cast<double>(bounds.max_y) - bounds.min_y);
  const bool is_surface =
      std::find(t0.classes.begin(), t0.classes.end(), TriangleClass::kVoid) == t0.classes.end();
  return leaf.tile.samples_fill_grid && leaf.tile.units.exact_codes && !leaf.tile.has_voids &&
         leaf.tile.samples.used() == 0 && is_surface && extent <= kExactRadius;
}

/// The mesh of one replay: T0, refined around one leaf, with the leaf's samples in its triangles.
class Replay {
 public:
  /// @param only_surface  The records to be applied make no void triangle or vertex.
  Replay(const Tin& t0, StartedTile&& leaf, bool only_surface);
  /// Splits as the record says. Returns what the leaf shows of the record.
  RecordBounds apply(const VertexSplit& record);

  [[nodiscard]] const GridBox& box() const noexcept { return box_; }

 private:
  void take_samples(const Tile& leaf);
  void look_around();
  void place(Sample sample, std::vector<std::vector<Sample>>& lists);
  [[nodiscard]] VertexId vertex_at(GridPoint p) const;
  [[nodiscard]] VertexId add_vertex(const VertexSplit& record);
  RecordBounds measure(const VertexSplit& record, VertexId w);
  RecordBounds measure_samples(double gap);
  RecordBounds measure_blocks(const VertexSplit& record, double gap);
  void hand_to_star();

  Tile tile_;
  std::unique_ptr<FullSurface> full_;
  GridBox box_;
  std::vector<TriangleId> near_;  ///< Triangles of T0 that the leaf may touch.
  PackedBoxes near_boxes_;        ///< Boxes of the triangles in near_.
  std::unordered_map<VertexKey, VertexId> vertices_;
  std::optional<PlaneBlocks> blocks_;  ///< In the place of lists of samples, where that suits.
  StarSamples star_;
  FanFrame fan_, spokes_;
  FanAssignment assignment_;
  SampleHandOver hand_over_;
};

Replay::Replay(const Tin& t0, StartedTile&& leaf, bool only_surface) : box_(leaf.box) {
  if (only_surface && suits_blocks(t0, leaf)) {
    blocks_.emplace(leaf.tile, leaf.box);
  }
  full_ = std::move(leaf.full);
  tile_.units = leaf.tile.units;
  tile_.samples_fill_grid = leaf.tile.samples_fill_grid;
  tile_.has_voids = true;  // T0 may have void triangles where the leaf has none
  tile_.tin = t0;
  tile_.carried.resize(t0.triangles.size());
  for (VertexId v = 0; v < t0.vertices.size(); ++v) {
    vertices_.emplace(key_of(t0.position(v)), v);
    tile_.vertex_state.push_back({no_reach(t0.has_height[v] != 0), 0, false});
  }
  const Tile started = std::exchange(leaf.tile, {});  // the leaf's mesh goes
  if (!blocks_) {
    take_samples(started);
  }
}

/// Finds the triangles of T0 that the leaf may touch. T0 is two triangles over a raster without
/// voids; over points it fills the hull, and may be large.
void Replay::look_around() {
  const auto box_of_triangle = [this](TriangleId t) {
    GridBox b;
    for (const VertexId v : tile_.tin.triangles[t].v) {
      b = united(b, tile_.tin.position(v));
    }
    return b;
  };
  for (TriangleId t = 0; t < tile_.tin.triangles.size(); ++t) {
    if (meets(box_of_triangle(t), box_)) {
      near_.push_back(t);
    }
  }
  static constexpr std::size_t kMany = 64;
  if (near_.size() > kMany) {
    std::stable_sort(near_.begin(), near_.end(), [&](TriangleId a, TriangleId b) {
      const GridPoint p = tile_.tin.position(tile_.tin.triangles[a].v[0]);
      const GridPoint q = tile_.tin.position(tile_.tin.triangles[b].v[0]);
      return hilbert_position(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y)) <
             hilbert_position(static_cast<std::uint32_t>(q.x), static_cast<std::uint32_t>(q.y));
    });
  }
  std::vector<GridBox> boxes;
  for (const TriangleId t : near_) {
    boxes.push_back(box_of_triangle(t));
  }
  near_boxes_ = PackedBoxes(std::move(boxes));
}

/// Every sample of the leaf that is no vertex of T0 goes to a triangle of T0 that holds it, of its
/// own class if there is one.
void Replay::take_samples(const Tile& leaf) {
  std::vector<Sample> samples;
  samples.reserve(leaf.tin.vertices.size());
  for (VertexId v = 0; v < leaf.tin.vertices.size(); ++v) {
    const Vertex& vertex = leaf.tin.vertices[v];
    if (!vertices_.contains(key_of(vertex.position))) {
      samples.push_back({vertex.position, vertex.height, leaf.vertex_state[v].reach});
    }
  }
  for (const CarriedState& carried : leaf.carried) {  // and witnesses at corners
    const auto own = leaf.samples.samples(carried.samples);
    samples.insert(samples.end(), own.begin(), own.end());
  }
  if (leaf.samples_fill_grid) {
    join_into_blocks(samples);
  }
  look_around();
  std::vector<std::vector<Sample>> lists(near_.size());
  for (const Sample& s : samples) {
    place(s, lists);
  }
  for (std::size_t i = 0; i < near_.size(); ++i) {
    CarriedState& carried = tile_.carried[near_[i]];
    carried.samples = tile_.samples.take(static_cast<std::uint32_t>(lists[i].size()));
    std::copy(lists[i].begin(), lists[i].end(), tile_.samples.samples(carried.samples).begin());
    for (const Sample& s : lists[i]) {
      (s.reach < 0.0F ? carried.holds_voids : carried.holds_heights) = true;
    }
  }
}

/// Puts a sample or block into the list of a triangle that holds all of it. Quarters a block that
/// no triangle holds.
void Replay::place(Sample sample, std::vector<std::vector<Sample>>& lists) {
  const std::int32_t reach = (std::int32_t{1} << sample.side_log) - 1;
  const GridPoint p = sample.position;
  const auto holds_all = [&](TriangleId t) {
    if (sample.direction != kNoDirection) {
      return triangle_holds(tile_.tin, tile_.tin.triangles[t], p, sample.direction);
    }
    return triangle_holds(tile_.tin, tile_.tin.triangles[t], p) &&
           triangle_holds(tile_.tin, tile_.tin.triangles[t], {p.x + reach, p.y}) &&
           triangle_holds(tile_.tin, tile_.tin.triangles[t], {p.x, p.y + reach}) &&
           triangle_holds(tile_.tin, tile_.tin.triangles[t], {p.x + reach, p.y + reach});
  };
  const TriangleClass own = sample.reach < 0.0F ? TriangleClass::kVoid : TriangleClass::kSurface;
  std::size_t chosen = near_.size();
  near_boxes_.visit(
      [&](const GridBox& b) { return contains(b, p); },
      [&](std::size_t i) {
        if (holds_all(near_[i]) && (chosen == near_.size() || tile_.tin.classes[near_[i]] == own)) {
          chosen = i;
        }
      });
  if (chosen != near_.size()) {
    lists[chosen].push_back(sample);
    return;
  }
  PTIN_CHECK(sample.side_log > 0);
  --sample.side_log;
  const std::int32_t half = std::int32_t{1} << sample.side_log;
  for (const GridPoint offset : {GridPoint{0, 0}, {half, 0}, {0, half}, {half, half}}) {
    Sample quarter = sample;
    quarter.position = {p.x + offset.x, p.y + offset.y};
    place(quarter, lists);
  }
}

VertexId Replay::vertex_at(GridPoint p) const {
  const auto found = vertices_.find(key_of(p));
  PTIN_CHECK(found != vertices_.end());
  return found->second;
}

VertexId Replay::add_vertex(const VertexSplit& record) {
  const auto u = static_cast<VertexId>(tile_.tin.vertices.size());
  tile_.tin.vertices.push_back({record.u, record.height, kNone});
  tile_.tin.has_height.push_back(record.has_height() ? 1 : 0);
  tile_.vertex_state.push_back({no_reach(record.has_height()), 0, false});
  vertices_.emplace(key_of(record.u), u);
  return u;
}

RecordBounds Replay::apply(const VertexSplit& record) {
  SplitSite site;
  site.w = vertex_at(record.w);
  site.vl = vertex_at(record.vl);
  site.vr = vertex_at(record.vr);
  site.u = add_vertex(record);
  site.has_left = (record.flags & VertexSplit::kNoLeft) == 0;
  site.has_right = (record.flags & VertexSplit::kNoRight) == 0;
  const auto class_of = [&](VertexSplit::Flag flag) {
    return (record.flags & flag) != 0 ? TriangleClass::kVoid : TriangleClass::kSurface;
  };
  site.left_class = class_of(VertexSplit::kLeftVoid);
  site.right_class = class_of(VertexSplit::kRightVoid);
  PTIN_CHECK(split(tile_.tin, site).applied);
  tile_.carried.resize(tile_.tin.triangles.size());
  if (tile_.samples.is_sparse()) {
    lay_out_samples(tile_);
  }
  gather_star_and_samples(tile_, site.u, star_);
  return measure(record, site.w);
}

/// The star of u is there again (star_), and its triangles hold the samples of the former fan.
/// Measures these samples against the fan from w, and hands them to the triangles of the star.
RecordBounds Replay::measure(const VertexSplit& record, VertexId w) {
  const auto j = static_cast<std::size_t>(
      std::find(star_.star.link.begin(), star_.star.link.end(), w) - star_.star.link.begin());
  PTIN_CHECK(make_fan(star_, j, fan_));
  const double gap = fan_deviation(tile_, star_, fan_, *full_, box_);
  return blocks_ ? measure_blocks(record, gap) : measure_samples(gap);
}

RecordBounds Replay::measure_samples(double gap) {
  const double fixed = fan_fixed_gap(tile_, star_, fan_, {*full_, box_});
  if (star_.count == 1 && star_.surface_triangles) {  // u alone: construction has measured it
    return {height_bound(fixed, tile_.units.heights), height_bound(gap, tile_.units.heights)};
  }
  const FanError own = measure_fan(tile_, star_, fan_, full_.get(), assignment_);
  hand_to_star();
  return {height_bound(std::max(own.error, fixed), tile_.units.heights),
          height_bound(std::max(own.deviation, gap), tile_.units.heights)};
}

/// What the record says already, its error over carried samples, is not looked for again. Some
/// sample has that error, in this leaf or in another one, so the deviation of the record is that at
/// least.
RecordBounds Replay::measure_blocks(const VertexSplit& record, double gap) {
  const HeightEncoding& heights = tile_.units.heights;
  const PlaneBlocks::Centre u{record.u, heights.code(record.height), star_.star.closed};
  // A little less, since the error of the record was rounded up.
  const double known = static_cast<double>(record.error) / heights.step * (1.0 - 0x1p-20);
  const double worst = blocks_->largest_residual(fan_, u, known);
  star_.largest_z = std::max(star_.largest_z, blocks_->largest_z(u));
  float error = record.error;
  if (worst > known) {
    error = std::max(error, height_bound(certified_residual(worst, star_, tile_.units), heights));
  }
  return {error, std::max(error, height_bound(gap, heights))};
}

/// Hands the samples to the triangles around u. The sample of u itself, if the leaf has it, is
/// dropped: u is a vertex.
void Replay::hand_to_star() {
  make_spokes_of_star(star_, spokes_);
  assign_samples(star_, spokes_, assignment_.triangle, assignment_.residual);
  assign_directed(tile_, star_, spokes_, assignment_);
  if (!star_.surface_only) {
    assign_by_class(tile_, star_, spokes_, assignment_);
  }
  hand_over_.run(tile_, star_, spokes_, assignment_, star_.star.triangles, true);
}

}  // namespace

void replay_over_leaf(std::span<const ReplaySegment> chain, const Tin& t0, StartedTile&& leaf) {
  const bool only_surface = std::all_of(chain.begin(), chain.end(), [&](const ReplaySegment& s) {
    return std::none_of(s.records.begin(), s.records.end(), [&](const VertexSplit& r) {
      return (r.flags & VertexSplit::kAnyVoid) != 0 && meets(r.roi, leaf.box);
    });
  });
  Replay replay(t0, std::move(leaf), only_surface);
  for (const ReplaySegment& segment : chain) {
    for (std::size_t i = segment.records.size(); i-- > 0;) {
      const VertexSplit& record = segment.records[i];
      if (!meets(record.roi, replay.box())) {
        continue;
      }
      const RecordBounds shown = replay.apply(record);
      if (shown.error > record.error || shown.deviation > record.deviation) {
        segment.raises->push_back({record.u, shown});
      }
    }
  }
}

}  // namespace ptin
