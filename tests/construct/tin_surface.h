// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full surface of a whole TIN, walked along an edge from triangle to triangle: what surfaces of
// parts are held against.
#pragma once

#include <unordered_map>

#include "engine/construct/tile/full_surface.h"
#include "engine/mesh/tin.h"

namespace ptin::oracle {

class TinSurface final : public FullSurface {
 public:
  /// Keeps a copy of `full`.
  TinSurface(const Tin& full, const HeightEncoding& encoding);

  [[nodiscard]] double largest_gap(const EdgeEnd& a, const EdgeEnd& b) const override;
  /// Of terrains without voids.
  [[nodiscard]] double border_move(GridPoint, GridPoint) const override { return 0.0; }

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
  std::unordered_map<VertexKey, VertexId> vertex_at_;
};

}  // namespace ptin::oracle
