// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/refine/clip.h"

#include "engine/mesh/compact.h"

namespace ptin {

namespace {

/// Removes the triangles that do not meet the region; others may still name them as neighbours.
void remove_apart(Tin& tin, const GridRegion& region, const QueryContext& context) {
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (t % kStopInterval == 0) {
      context.check_stop();
    }
    Triangle& triangle = tin.triangles[t];
    if (tin.is_alive(t) && !region.meets(tin.position(triangle.v[0]), tin.position(triangle.v[1]),
                                         tin.position(triangle.v[2]))) {
      triangle.v[0] = kNone;
    }
  }
}

}  // namespace

void keep_meeting(Tin& tin, const GridRegion& region, std::vector<std::uint32_t>& pages,
                  const QueryContext& context) {
  remove_apart(tin, region, context);
  const Renumbering triangles = compact_triangles(tin);
  if (!pages.empty()) {
    keep_numbered(triangles, pages);
  }
  point_vertices(tin);
  compact_vertices(tin);
}

}  // namespace ptin
