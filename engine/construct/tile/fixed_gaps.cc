// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/fixed_gaps.h"

#include <algorithm>
#include <utility>

#include "engine/geometry/box.h"
#include "engine/geometry/hilbert.h"
#include "engine/geometry/orient.h"

namespace ptin {

FixedGaps::FixedGaps(const Tin& part, std::span<const std::uint8_t> sides,
                     const HeightEncoding& encoding) {
  const auto is_surface = [&](TriangleId t) {
    return t != kNone && part.classes[t] == TriangleClass::kSurface;
  };
  const auto end_of = [&](VertexId v) {
    return EdgeEnd{part.position(v), encoding.code(part.vertices[v].height)};
  };
  for (TriangleId t = 0; t < sides.size(); ++t) {
    const Triangle& triangle = part.triangles[t];
    for (int i = 0; i < 3; ++i) {
      const bool is_first = triangle.n[i] == kNone || t < triangle.n[i];  // of the two beside it
      if ((sides[t] >> i & 1) != 0 && is_first && (is_surface(t) || is_surface(triangle.n[i]))) {
        edges_.push_back(
            {end_of(triangle.v[next_corner(i)]), end_of(triangle.v[previous_corner(i)])});
      }
    }
  }
  const auto place = [](const Edge& e) {
    return hilbert_position(static_cast<std::uint32_t>(e.p.position.x),
                            static_cast<std::uint32_t>(e.p.position.y));
  };
  std::stable_sort(edges_.begin(), edges_.end(),
                   [&](const Edge& e, const Edge& f) { return place(e) < place(f); });
  std::vector<GridBox> boxes;
  boxes.reserve(edges_.size());
  for (const Edge& e : edges_) {
    boxes.push_back(united(box_of(e.p.position), e.q.position));
  }
  boxes_ = PackedBoxes(std::move(boxes));
}

double FixedGaps::largest_gap(const EdgeEnd& a, const EdgeEnd& b, double stop_above) const {
  const GridBox around = united(box_of(a.position), b.position);
  GapMaximum gap(a.code);
  bool is_enough = false;
  // The corners of a box that lie farthest to the left and to the right of a -> b.
  const bool rises = b.position.y > a.position.y, goes_east = b.position.x > a.position.x;
  const auto may_meet = [&](const GridBox& box) {
    return !is_enough && meets(box, around) &&
           orient(a.position, b.position,
                  {rises ? box.min_x : box.max_x, goes_east ? box.max_y : box.min_y}) >= 0 &&
           orient(a.position, b.position,
                  {rises ? box.max_x : box.min_x, goes_east ? box.min_y : box.max_y}) <= 0;
  };
  boxes_.visit(may_meet, [&](std::size_t i) {
    const auto& [p, q] = edges_[i];
    const std::int64_t sp = orient(a.position, b.position, p.position);
    const std::int64_t sq = orient(a.position, b.position, q.position);
    const std::int64_t ta = orient(p.position, q.position, a.position);
    const std::int64_t tb = orient(p.position, q.position, b.position);
    // Where they only touch, a vertex decides: one of the full TIN, which is a sample.
    if ((sp > 0) == (sq > 0) || (ta > 0) == (tb > 0) || sp == 0 || sq == 0 || ta == 0 || tb == 0) {
      return;
    }
    const auto along_fixed = static_cast<double>(sp);
    const auto along_edge = static_cast<double>(ta);
    gap.add(p.code, q.code, along_fixed / (along_fixed - static_cast<double>(sq)),
            (b.code - a.code) * (along_edge / (along_edge - static_cast<double>(tb))));
    is_enough = gap.bound() > stop_above;
  });
  return gap.bound();
}

}  // namespace ptin
