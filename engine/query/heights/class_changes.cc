// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/class_changes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "engine/geometry/packed_boxes.h"
#include "engine/mesh/link.h"
#include "engine/mesh/triangle_holds.h"
#include "engine/query/living/tin_parts.h"
#include "engine/query/shape/grid_cell.h"

namespace ptin {

namespace {

/// Parts of the finest TIN are cut until they take no more than this, so that they cling to the
/// border.
constexpr std::uint64_t kPartBytes = std::uint64_t{1} << 20;

/// Grid units that one border may be from the other, along x and y, rounded up; at most the grid.
struct GridReach {
  std::int32_t x, y;
};

std::int32_t steps_above(double map_units, double step) {
  if (!(map_units >= 0.0)) {
    refuse("the reach of a border must not be negative", std::to_string(map_units));
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

GridBox box_of_triangle(const Tin& tin, const Triangle& t) {
  return united(united(box_of(tin.position(t.v[0])), tin.position(t.v[1])), tin.position(t.v[2]));
}

/// The triangles of a part, to be asked which of them hold a sample.
class ClassesAt {
 public:
  explicit ClassesAt(const Tin& tin) : tin_(tin) {
    std::vector<GridBox> boxes(tin.triangles.size());
    std::transform(tin.triangles.begin(), tin.triangles.end(), boxes.begin(),
                   [&](const Triangle& t) { return box_of_triangle(tin, t); });
    boxes_ = PackedBoxes(std::move(boxes));
  }
  /// True when a closed triangle of the class holds the position.
  [[nodiscard]] bool holds(TriangleClass wanted, GridPoint p) const {
    bool found = false;
    boxes_.visit([&](const GridBox& b) { return !found && contains(b, p); },
                 [&](std::size_t t) {
                   found = tin_.classes[t] == wanted && triangle_holds(tin_, tin_.triangles[t], p);
                 });
    return found;
  }

 private:
  const Tin& tin_;
  PackedBoxes boxes_;
};

/// For each vertex of a part whether a surface triangle has it as a corner.
std::vector<bool> on_surface(const Tin& tin) {
  std::vector<bool> is_on(tin.vertices.size());
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.classes[t] != TriangleClass::kSurface) continue;
    for (const VertexId v : tin.triangles[t].v) is_on[v] = true;
  }
  return is_on;
}

class ChangeCount {
 public:
  ChangeCount(const OpenedTerrain& terrain, const ClassChangesRequest& request)
      : terrain_(terrain),
        is_unbounded_(std::isinf(request.reach[0]) || std::isinf(request.reach[1])),
        reach_{steps_above(request.reach[0], terrain.store().facts().map.step_x),
               steps_above(request.reach[1], terrain.store().facts().map.step_y)},
        level_(terrain, {{}, request.detail, request.limits.share(1, 2)}),
        finest_(terrain, {{}, {}, request.limits.share(1, 2, kPartBytes)}) {
    if (request.region) region_.emplace(*request.region, terrain.store().facts().map);
  }

  ClassChanges run() {
    const StoreFacts& facts = terrain_.store().facts();
    if (facts.free_of_voids || level_.detail().certificate().complete) return changes_;
    work_on_cells(facts.bounds, [&](const GridCell& cell, double, double) {
      if (!is_wanted(cell.box())) return true;
      Tin* const level = level_.part_for(cell, grown(cell.box(), reach_, 2));
      if (level != nullptr) count_in(cell, *level);
      return level != nullptr;
    });
    changes_.cost.add_counts(level_.cost());
    changes_.cost.add_counts(finest_.cost());
    return changes_;
  }

 private:
  [[nodiscard]] bool is_wanted(const GridBox& box) const { return !region_ || region_->meets(box); }

  void count_in(const GridCell& cell, Tin& level) {
    link_tin(level);
    const PackedBoxes near = around_border(level, reach_);
    const ClassesAt at_level(level);
    // Without a bound of its move the whole border may have gone.
    const auto is_near = [&](const GridBox& box) {
      return (is_unbounded_ || any_meets(near, box)) && is_wanted(box);
    };
    work_on_cells(cell.box(), [&](const GridCell& part, double, double) {
      if (!is_near(part.box())) return true;
      const Tin* const finest = finest_.part_for(part, part.box());
      if (finest != nullptr) compare(part, *finest, at_level);
      return finest != nullptr;
    });
  }

  void compare(const GridCell& part, const Tin& finest, const ClassesAt& level) {
    const std::vector<bool> is_on_surface = on_surface(finest);
    for (VertexId v = 0; v < finest.vertices.size(); ++v) {
      const GridPoint p = finest.position(v);
      if (!part.holds(p) || !is_wanted(box_of(p))) continue;
      const bool was_surface = is_on_surface[v];
      if (!level.holds(was_surface ? TriangleClass::kSurface : TriangleClass::kVoid, p))
        ++(was_surface ? changes_.to_void : changes_.to_surface);
    }
  }

  const OpenedTerrain& terrain_;
  bool is_unbounded_;
  GridReach reach_;
  std::optional<GridRegion> region_;
  TinParts level_, finest_;
  ClassChanges changes_;
};

}  // namespace

ClassChanges class_changes(const OpenedTerrain& terrain, const ClassChangesRequest& request) {
  return timed([&] { return ChangeCount(terrain, request).run(); });
}

}  // namespace ptin
