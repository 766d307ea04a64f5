// SPDX-License-Identifier: GPL-3.0-or-later
//
// A coarse level of the whole terrain in memory: where it may hide a line, and where it is sure to.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/query/living/living_triangle.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/shape/spot.h"

namespace ptin {

/// The surface triangles that live at a level, under a packed tree of boxes. Threads: const.
class CoarseGround {
 public:
  /// How high some triangles rise, height's unit.
  struct Top {
    double surface;  ///< The triangles themselves.
    double certain;  ///< Less the deviation of each: so high the full surface rises for certain.
  };

  /// Reads the stars of a level.  @param level  An error, >= 0 or infinite.
  /// @throws Error resource_exhausted, corruption, io_error, cancelled
  CoarseGround(const OpenedTerrain& terrain, double level, QueryContext& context);

  [[nodiscard]] std::uint64_t bytes() const noexcept;
  /// A triangle that holds the spot; null where there is none. Cost: logarithmic in practice.
  [[nodiscard]] const LivingTriangle* find(Spot q) const;
  /// Calls visit(triangle) for triangles whose bound is above 0, those of large bounds first, until
  /// it returns false.
  /// @param bound  bound(box, top) of what lies in a box; may fall while triangles are visited.
  template <class Bound, class Visit>
  void search(const Bound& bound, const Visit& visit) const {
    if (!levels_.empty()) {
      static_cast<void>(descend(levels_.size(), 0, bound, visit));
    }
  }

 private:
  static constexpr std::size_t kFanOut = 8;
  struct Node {
    GridBox box;
    Top top;
  };

  void build(const HeightEncoding& heights);

  /// The nodes below node `number` of a level; of level 0 its triangle.
  template <class Bound, class Visit>
  bool descend(std::size_t level, std::size_t number, const Bound& bound,
               const Visit& visit) const {
    if (level == 0) {
      return visit(triangles_[number]);
    }
    const std::vector<Node>& nodes = levels_[level - 1];
    const std::size_t end = std::min(nodes.size(), (number + 1) * kFanOut);
    std::array<std::pair<double, std::size_t>, kFanOut> open;  // NOLINT: written before read
    std::size_t count = 0;
    for (std::size_t i = number * kFanOut; i < end; ++i) {
      const double value = bound(nodes[i].box, nodes[i].top);
      if (value > 0) {  // in falling order
        std::size_t place = count++;
        for (; place > 0 && open[place - 1].first < value; --place) {
          open[place] = open[place - 1];
        }
        open[place] = {value, i};
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      const Node& node = nodes[open[k].second];
      if (bound(node.box, node.top) > 0 && !descend(level - 1, open[k].second, bound, visit)) {
        return false;
      }
    }
    return true;
  }

  std::vector<LivingTriangle> triangles_;  ///< Along the Hilbert curve.
  std::vector<std::vector<Node>> levels_;  ///< The first has a node for each triangle.
};

}  // namespace ptin
