// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/coarse_ground.h"

#include "engine/geometry/infinity.h"
#include "engine/query/living/living_place.h"
#include "engine/query/living/triangle_at.h"
#include "engine/query/select/detail.h"
#include "engine/query/shape/grid_cell.h"

namespace ptin {

CoarseGround::CoarseGround(const OpenedTerrain& terrain, double level, QueryContext& context) {
  DetailRequest request;
  request.tolerance = level;
  const Detail detail(request, terrain.record_source(), context);
  LivingPlace everywhere;
  everywhere.box = terrain.store().facts().bounds;
  VisitorOf gatherer(
      [&](std::size_t most_triangles) {
        // They are sorted by copying.
        context.admit(3 * (triangles_.size() + most_triangles) * sizeof(LivingTriangle));
        return true;
      },
      [&](const LivingTriangle& t) {
        if (!t.is_void) {
          triangles_.push_back(t);
        }
      });
  LivingReader(terrain, detail).read(everywhere, context, gatherer);
  build(terrain.store().facts().heights);
}

void CoarseGround::build(const HeightEncoding& heights) {
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  order.reserve(triangles_.size());
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    order.emplace_back(position_along(box_of(triangles_[i])), i);
  }
  std::sort(order.begin(), order.end());
  std::vector<LivingTriangle> sorted;
  sorted.reserve(triangles_.size());
  std::vector<Node> nodes;
  nodes.reserve(triangles_.size());
  for (const auto& [position, i] : order) {
    const LivingTriangle& t = triangles_[i];
    double top = -kInfinity;
    for (const LivingTriangle::Corner& c : t.corner) {
      top = std::max(top, heights.height(c.height));
    }
    sorted.push_back(t);
    nodes.push_back({box_of(t), {top, top - t.deviation}});
  }
  triangles_ = std::move(sorted);
  while (!nodes.empty()) {
    std::vector<Node> above;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (i % kFanOut == 0) {
        above.push_back(nodes[i]);
        continue;
      }
      Node& node = above.back();
      node.box = united(node.box, nodes[i].box);
      node.top = {std::max(node.top.surface, nodes[i].top.surface),
                  std::max(node.top.certain, nodes[i].top.certain)};
    }
    const bool is_root = nodes.size() <= kFanOut;
    levels_.push_back(std::move(nodes));
    nodes = is_root ? std::vector<Node>{} : std::move(above);
  }
}

std::uint64_t CoarseGround::bytes() const noexcept {
  return triangles_.capacity() * (sizeof(LivingTriangle) + 2 * sizeof(Node));
}

const LivingTriangle* CoarseGround::find(Spot q) const {
  const LivingTriangle* found = nullptr;
  search([&](const GridBox& box, const Top& /*top*/) { return contains(box, q) ? 1.0 : 0.0; },
         [&](const LivingTriangle& t) {
           if (holds(t, q)) {
             found = &t;
           }
           return found == nullptr;
         });
  return found;
}

}  // namespace ptin
