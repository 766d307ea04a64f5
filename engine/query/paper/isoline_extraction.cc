// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/paper/isoline_extraction.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "engine/query/isoline/isoline_tiles.h"
#include "engine/query/isoline/isoline_trace.h"
#include "engine/query/paper/selective_refinement.h"
#include "engine/query/select/predicate.h"

namespace ptin::paper {

namespace {

/// True for the records whose triangles a level may cross in the region, at the level of detail.
PredicatePtr crossed(const TileTraceRequest& asked, const std::optional<Region>& region,
                     const AffineMap& map) {
  std::vector<PredicatePtr> parts{asked.levels.crossing()};
  if (region) {
    parts.push_back(meets_region(*region, map));
  }
  if (asked.detail.is_asked()) {
    parts.push_back(std::make_shared<AboveError>(asked.detail.tolerance()));
  }
  return all_of(std::move(parts));
}

/// Traces one mesh: the terrain is its only tile.
TileTraces trace(const OpenedTerrain& terrain, const TileTraceRequest& asked,
                 const AttributePredicate& predicate, PointStore& points, QueryCost& cost) {
  const StoreFacts& facts = terrain.store().facts();
  QueryContext context({asked.tiles.memory_bytes, asked.stop}, terrain.store().path());
  SelectiveRefinement mesh(terrain, asked.detail);
  mesh.refine(predicate, context);
  mesh.release_records();
  LineTracer tracer(asked.levels, facts.heights, facts.map, context);
  tracer.begin({facts.bounds, asked.region, asked.counts_vertices},
               context.left_beside(mesh.bytes()));
  for (TriangleId t = 0; t < mesh.tin().triangles.size(); ++t) {
    if (!tracer.add(living_triangle(mesh.tin(), t))) {
      // There is no room, or more points than 32 bits number.
      context.admit(std::max(mesh.bytes() + tracer.bytes_wanted(), asked.tiles.memory_bytes + 1));
    }
  }
  TraceCollector collector(asked, points, terrain.store().path());
  collector.add(tracer.join(), tracer.counts());
  cost.add_counts(context.cost);
  return collector.release();
}

}  // namespace

Isolines isolines(const OpenedTerrain& terrain, const IsolineRequest& request) {
  return extract_isolines(
      terrain, request, [&](const TileTraceRequest& asked, PointStore& points, QueryCost& cost) {
        const PredicatePtr predicate = crossed(asked, request.region, terrain.store().facts().map);
        return trace(terrain, asked, *predicate, points, cost);
      });
}

}  // namespace ptin::paper
