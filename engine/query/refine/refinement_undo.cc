// SPDX-License-Identifier: GPL-3.0-or-later
//
// Splits taken back.
#include <algorithm>

#include "engine/check.h"
#include "engine/error.h"
#include "engine/mesh/collapse.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/refine/split_site.h"

namespace ptin {

void throw_refused(const PendingSplit& s, const std::string& why, const QueryContext& context) {
  const GridPoint u = point_of(s.u);
  throw Error(ErrorCode::corruption,
              "page " + std::to_string(s.page) + ", record of vertex (" + std::to_string(u.x) +
                  ", " + std::to_string(u.y) + "): " + why +
                  "; run verify, and build the file again",
              context.file());
}

void Refinement::undo(std::span<const PendingSplit> splits, QueryContext& context) {
  PTIN_CHECK(!track_pages_);  // the page that made a triangle before its split is not known
  RankOrder falling(splits);
  std::vector<std::uint32_t> order(splits.size());
  for (std::uint32_t i = 0; i < splits.size(); ++i) {
    order[falling.take(splits[i].rank)] = i;
  }
  Star star;
  for (std::size_t i = order.size(); i-- > 0;) {
    if (i % kStopInterval == 0) {
      context.check_stop();
    }
    if (i >= 8) {
      ids_.prefetch(splits[order[i - 8]].u);
    }
    undo_one(splits[order[i]], star, context);
  }
}

/// Undoes one split. Before it changes anything it checks that the collapse is the inverse of the
/// split, down to the ends vl and vr: a record that applied records still need has another star.
void Refinement::undo_one(const PendingSplit& s, Star& star, const QueryContext& context) {
  const VertexId u = ids_.find(tin_, s.u);
  const VertexId w = ids_.find(tin_, s.w);
  if (u == kNone || w == kNone) {
    throw_refused(s, "it cannot be undone, it or its w is not in the mesh", context);
  }
  walk_star(tin_, u, star);
  const auto at = static_cast<std::size_t>(std::find(star.link.begin(), star.link.end(), w) -
                                           star.link.begin());
  const bool can = at < star.link.size() && can_collapse(tin_, star, at);
  const CollapseSite site = can ? collapse_site(star, at) : CollapseSite{};
  if (!can || tin_.position(site.vl) != point_of(s.vl) || tin_.position(site.vr) != point_of(s.vr))
      [[unlikely]] {
    throw_refused(s, "it cannot be undone, since records that stay need it", context);
  }
  collapse(tin_, star, at);
  ids_.erase(tin_, s.u);
  free_vertices_.push_back(u);
  for (const TriangleId t : {site.left, site.right}) {
    if (t != kNone) {
      free_triangles_.push_back(t);
    }
  }
}

}  // namespace ptin
