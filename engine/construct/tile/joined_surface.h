// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full surface under a tile of several leaves: the surfaces of the leaves, asked one by one.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "engine/construct/tile/full_surface.h"
#include "engine/geometry/box.h"

namespace ptin {

/// Every edge of the full TIN is in the surface of some leaf, so the largest gap over the leaves is
/// the largest of all. REQUIRES: the surface of a leaf answers for edges that lead out of the leaf.
class JoinedSurface final : public FullSurface {
 public:
  /// @param box  Holds all samples of the leaf and its full surface.
  void add(std::unique_ptr<const FullSurface> leaf, const GridBox& box) {
    has_fixed_edges_ = has_fixed_edges_ || leaf->has_fixed_edges();
    leaves_.push_back({std::move(leaf), box});
  }

  /// Cost: the crossings, in the leaves whose boxes the edge's box meets.
  [[nodiscard]] double largest_gap(const EdgeEnd& a, const EdgeEnd& b) const override {
    const GridBox edge = united(box_of(a.position), b.position);
    double worst = 0.0;
    for (const Leaf& leaf : leaves_) {
      if (meets(edge, leaf.box)) {
        worst = std::max(worst, leaf.full->largest_gap(a, b));
      }
    }
    return worst;
  }

  [[nodiscard]] double fixed_gap(const EdgeEnd& a, const EdgeEnd& b,
                                 double stop_above) const override {
    const GridBox edge = united(box_of(a.position), b.position);
    double worst = 0.0;
    for (const Leaf& leaf : leaves_) {
      if (leaf.full->has_fixed_edges() && meets(edge, leaf.box)) {
        worst = std::max(worst, leaf.full->fixed_gap(a, b, stop_above));
      }
    }
    return worst;
  }
  [[nodiscard]] bool has_fixed_edges() const noexcept override { return has_fixed_edges_; }

  [[nodiscard]] double border_move(GridPoint a, GridPoint b) const override {
    const GridBox edge = united(box_of(a), b);
    double worst = 0.0;
    for (const Leaf& leaf : leaves_) {
      if (meets(edge, leaf.box)) {
        worst = std::max(worst, leaf.full->border_move(a, b));
      }
    }
    return worst;
  }

 private:
  struct Leaf {
    std::unique_ptr<const FullSurface> full;
    GridBox box;
  };
  std::vector<Leaf> leaves_;
  bool has_fixed_edges_ = false;
};

}  // namespace ptin
