// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/class_changes.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "engine/geometry/packed_boxes.h"
#include "engine/query/refine/grid_cell.h"
#include "engine/query/refine/part_refiner.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/walk/walk.h"

namespace ptin {

namespace {

/// Parts of the finest TIN are cut until they take no more than this beside T0, so that they cling
/// to the border.
constexpr std::uint64_t kPartBytes = std::uint64_t{1} << 20;

/// Grid units that one border may be from the other, along x and y, rounded up; at most the grid.
struct GridReach {
  std::int32_t x, y;
};

std::int32_t steps_above(double map_units, double step) {
  if (!(map_units >= 0.0)) {
    throw Error(ErrorCode::invalid_argument, "the reach of a border must not be negative",
                std::to_string(map_units));
  }
  const double steps = std::ceil(map_units / step) + 1.0;
  return steps < double{kGridMax} ? static_cast<std::int32_t>(steps) : kGridMax;
}

/// The box, larger by `times` the reach on all sides, within the grid.
GridBox grown(const GridBox& box, const GridReach& reach, std::int64_t times) {
  const auto at = [](std::int64_t v) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, 0, kGridMax));
  };
  return {at(box.min_x - times * reach.x), at(box.min_y - times * reach.y),
          at(box.max_x + times * reach.x), at(box.max_y + times * reach.y)};
}

/// Boxes of twice the reach around the edges between surface and void. The border of the finest
/// TIN is within the reach of one of these edges, and what changed its class within the reach of
/// that.
PackedBoxes around_border(const Tin& tin, const GridReach& reach) {
  std::vector<GridBox> boxes;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.classes[t] != TriangleClass::kSurface) continue;
    const Triangle& triangle = tin.triangles[t];
    for (int i = 0; i < 3; ++i) {
      const TriangleId beyond = triangle.n[i];
      if (beyond == kNone || tin.classes[beyond] == TriangleClass::kSurface) continue;
      const GridBox edge = united(box_of(tin.position(triangle.v[next_corner(i)])),
                                  tin.position(triangle.v[previous_corner(i)]));
      boxes.push_back(grown(edge, reach, 2));
    }
  }
  return PackedBoxes(std::move(boxes));
}

bool any_meets(const PackedBoxes& boxes, const GridBox& box) {
  bool found = false;
  boxes.visit([&](const GridBox& b) { return !found && meets(b, box); },
              [&](std::size_t) { found = true; });
  return found;
}

/// True when a sample at `place` of a level keeps its class.
bool keeps_class(const Tin& tin, const Place& place, bool was_surface) {
  const Triangle& triangle = tin.triangles[place.triangle];
  const bool here = tin.classes[place.triangle] == TriangleClass::kSurface;
  if (place.lies == Lies::kInTriangle) return here == was_surface;
  if (place.lies == Lies::kOnVertex)
    return was_surface ? touches_surface(tin, triangle.v[place.index])
                       : touches_void(tin, triangle.v[place.index]);
  const TriangleId other = triangle.n[place.index];
  const bool there = other == kNone ? here : tin.classes[other] == TriangleClass::kSurface;
  return was_surface ? here || there : !here || !there;
}

class ChangeCount {
 public:
  ChangeCount(const OpenedTerrain& terrain, const ClassChangesRequest& request)
      : terrain_(terrain),
        reach_{steps_above(request.reach[0], terrain.store().facts().map.step_x),
               steps_above(request.reach[1], terrain.store().facts().map.step_y)},
        level_(terrain, {{}, request.detail, {}, half_of(request.limits)}),
        finest_(terrain, {{}, {}, {}, half_of(request.limits)}) {
    if (request.region) region_.emplace(*request.region, terrain.store().facts().map);
  }

  ClassChanges run() {
    const StoreFacts& facts = terrain_.store().facts();
    if (facts.free_of_voids || level_.detail().certificate().complete) return changes_;
    const auto fits = [&](const GridCell& cell, double) {
      return !is_wanted(cell.box()) || level_.fits(grown(cell.box(), reach_, 2));
    };
    walk_fitting_cells(facts.bounds, fits, [&](const GridCell& cell, double) {
      if (is_wanted(cell.box())) count_in(cell);
    });
    return changes_;
  }

 private:
  static QueryLimits half_of(QueryLimits limits) {
    limits.memory_bytes /= 2;
    return limits;
  }
  [[nodiscard]] bool is_wanted(const GridBox& box) const { return !region_ || region_->meets(box); }

  void count_in(const GridCell& cell) {
    const RefinedTin level = level_.refine(grown(cell.box(), reach_, 2));
    changes_.cost.add_counts(level.cost);
    const PackedBoxes near = around_border(level.tin, reach_);
    const std::uint64_t part_bytes = bytes_of(terrain_.t0()) + kPartBytes;
    const auto is_part = [&](const GridCell& part, double) {
      const GridBox box = part.box();
      return !any_meets(near, box) || !is_wanted(box) || finest_.bytes_for(box) <= part_bytes;
    };
    walk_fitting_cells(cell.box(), is_part, [&](const GridCell& part, double) {
      if (any_meets(near, part.box()) && is_wanted(part.box())) compare(part, level.tin);
    });
  }

  void compare(const GridCell& part, const Tin& level) {
    const RefinedTin finest = finest_.refine(part.box());
    changes_.cost.add_counts(finest.cost);
    TriangleId start = 0;
    for (VertexId v = 0; v < finest.tin.vertices.size(); ++v) {
      const GridPoint p = finest.tin.position(v);
      if (!part.holds(p) || !is_wanted(box_of(p))) continue;
      const Place place = find_spot(level, spot_of(p), start);
      start = place.triangle;
      const bool was_surface = touches_surface(finest.tin, v);
      if (!keeps_class(level, place, was_surface))
        ++(was_surface ? changes_.to_void : changes_.to_surface);
    }
  }

  const OpenedTerrain& terrain_;
  GridReach reach_;
  std::optional<GridRegion> region_;
  PartRefiner level_, finest_;
  ClassChanges changes_;
};

}  // namespace

ClassChanges class_changes(const OpenedTerrain& terrain, const ClassChangesRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  ClassChanges changes = ChangeCount(terrain, request).run();
  changes.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return changes;
}

}  // namespace ptin
