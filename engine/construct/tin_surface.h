// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full surface of a TIN of points: a copy of the full triangulation, walked along an edge.
#pragma once

#include "engine/construct/full_surface.h"

namespace ptin {

class TinSurface final : public FullSurface {
 public:
  /// Keeps a copy of `full`, whose vertex ids are those of the tile.
  TinSurface(const Tin& full, const HeightEncoding& encoding) : full_(full), encoding_(encoding) {}

  [[nodiscard]] double largest_gap(const EdgeEnd& a, const EdgeEnd& b) const override;

 private:
  struct Step;
  [[nodiscard]] Step leave_vertex(VertexId v, GridPoint from, GridPoint to) const;
  [[nodiscard]] Step cross_edge(const Step& step, GridPoint from, GridPoint to) const;
  [[nodiscard]] double code(VertexId v) const noexcept {
    return encoding_.code(full_.vertices[v].height);
  }
  [[nodiscard]] bool is_surface(TriangleId t) const noexcept {
    return t != kNone && full_.classes[t] == TriangleClass::kSurface;
  }

  Tin full_;
  HeightEncoding encoding_;
};

}  // namespace ptin
