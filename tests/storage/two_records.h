// SPDX-License-Identifier: GPL-3.0-or-later
//
// The worked example of FORMAT.md: a square of two triangles, and two vertices split into it.
//
//   (0,8)---------(8,8)
//     | \         / |
//     |   \     /   |        1. (4,4) from w = (0,0), vl = (8,0), vr = (0,8)
//     |    (4,4)    |        2. (4,1) from w = (0,0), vl = (8,0), vr = (4,4)
//     |   / |   \   |
//     | / (4,1)   \ |
//   (0,0)---------(8,0)
#pragma once

#include "tests/storage/store_fixture.h"

namespace ptin::test {

/// Adds a record with w, vl, vr, roi and heights of its ring.
inline void add_star_of(StoreContent& c, VertexSplit r, const std::vector<RingCorner>& ring) {
  name_by_ring(r, ring);
  r.height_lo = r.height_hi = r.height;
  hold_ring(r, ring, c.facts.heights);
  c.segments.resize(1);
  add_star(c.segments[0], r, ring);
}

inline StoreContent two_records() {
  StoreContent c;
  c.facts.map = {1000.0, 2000.0, 10.0, 10.0};
  c.facts.heights = {HeightType::int32, 0.5, 100.0};
  c.facts.bounds = {0, 0, 8, 8};
  c.facts.min_height = 100.0;
  c.facts.max_height = 105.0;
  c.facts.source_samples = 6;
  c.metadata = "{}";
  c.t0.vertices = {{{0, 0}, 0, 1}, {{8, 0}, 2, 1}, {{8, 8}, 4, 1}, {{0, 8}, 6, 1}};
  c.t0.triangles = {{{0, 1, 2}, 0}, {{0, 2, 3}, 0}};
  c.t0.triangles[0].death = 4.0F;
  c.t0.triangles[1].death = 4.0F;
  VertexSplit first;
  first.u = {4, 4};
  first.height = 10;
  first.error = 4.0F;
  first.deviation = 4.0F;
  first.rank = 1;
  add_star_of(c, first,
              {{{0, 0}, 0, 1.25F, 0},
               {{8, 0}, 2, kLivesOn, 0},
               {{8, 8}, 4, kLivesOn, 0},
               {{0, 8}, 6, kLivesOn, 0}});
  VertexSplit second;
  second.u = {4, 1};
  second.height = 1;
  second.error = 1.25F;
  second.deviation = 1.25F;
  add_star_of(c, second,
              {{{0, 0}, 0, kLivesOn, 0}, {{8, 0}, 2, kLivesOn, 0}, {{4, 4}, 10, kLivesOn, 0}});
  return c;
}

}  // namespace ptin::test
