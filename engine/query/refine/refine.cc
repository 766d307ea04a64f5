// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/refine/refine.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "engine/error.h"
#include "engine/mesh/compact.h"
#include "engine/mesh/link.h"
#include "engine/query/living/living_tin.h"
#include "engine/query/living/stars_in_region.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/certificate.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/retrieval.h"
#include "engine/query/select/total_order.h"

namespace ptin {

namespace {

/// The records to apply, and what leaving out the others means.
struct Selection {
  std::vector<PendingSplit> splits;
  Certificate certificate;
};

/// The predicate of a request, without its number of vertices or triangles.
PredicatePtr predicate_of(const RefineRequest& request, const StoreFacts& facts) {
  std::vector<PredicatePtr> parts;
  if (request.detail.tolerance) {
    parts.push_back(error_above(*request.detail.tolerance));
  }
  if (request.region) {
    parts.push_back(meets_region(*request.region, facts.map));
  }
  if (request.also != nullptr) {
    parts.push_back(borrowed(*request.also));
  }
  return all_of(std::move(parts));
}

/// What the request's number of vertices or triangles leaves for records; none: it has none.
std::optional<Growth> growth_of(const RefineRequest& request, const StoreFile& store) {
  const DetailRequest& detail = request.detail;
  if ((detail.tolerance ? 1 : 0) + (detail.vertices ? 1 : 0) + (request.triangles ? 1 : 0) > 1) {
    refuse(
        "of a tolerance, a number of vertices and a number of triangles more than one is given: "
        "give one of them");
  }
  if (detail.vertices) return Growth{records_of_first(*detail.vertices, store)};
  if (!request.triangles) return std::nullopt;
  const std::uint64_t t0 = store.t0().triangles.size();
  if (*request.triangles < t0) {
    refuse(std::to_string(*request.triangles) +
               " triangles are asked for, but the coarsest TIN has " + std::to_string(t0) +
               ": ask for at least that many",
           store.path());
  }
  return Growth{std::min(*request.triangles - t0, 2 * store.record_count()),
                Growth::Of::kTriangles};
}

Selection select(const RefineRequest& request, const RecordSource& source,
                 std::uint64_t fixed_bytes, QueryContext& context) {
  const PredicatePtr predicate = predicate_of(request, source.store.facts());
  Selection selection;
  double left = request.detail.tolerance.value_or(-1.0);
  if (const std::optional<Growth> growth = growth_of(request, source.store)) {
    FirstRecords first = first_records(source, *predicate, *growth, fixed_bytes, context);
    selection.splits = std::move(first.splits);
    left = first.largest_error_left;
  } else {
    selection.splits = retrieve(source, *predicate, fixed_bytes, context);
  }
  // What a caller's own predicate leaves out is known only by counting what was applied.
  selection.certificate = request.also == nullptr ? certify_below(source.store, left)
                                                  : certify_applied(source.store, selection.splits);
  return selection;
}

/// Counts the parts of a result, and fills in certificate and cost.
/// @param begin  When the question was asked.
void fill_in_facts(RefinedTin& result, const OpenedTerrain& terrain, const Certificate& certificate,
                   const QueryContext& context, std::chrono::steady_clock::time_point begin) {
  result.vertices = result.tin.vertices.size();
  result.triangles = result.tin.triangles.size();
  result.void_vertices = static_cast<std::uint64_t>(
      std::count(result.tin.has_height.begin(), result.tin.has_height.end(), 0));
  result.t0_vertices = terrain.t0().vertices.size();
  result.certified_error = certificate.error;
  result.certified_deviation = certificate.deviation;
  result.exact = certificate.complete && terrain.store().facts().base_error == 0;
  result.cost = context.cost;
  result.cost.seconds = seconds_since(begin);
}

/// Whether the triangles of the result are those that live at an error and meet a region.
bool is_of_stars(const OpenedTerrain& terrain, const RefineRequest& request) {
  return request.region && request.form == ResultForm::kMeetingRegion && !request.detail.vertices &&
         !request.triangles && request.also == nullptr && !request.page_of_triangle &&
         !terrain.uses_other_index();
}

/// The triangles that meet a region, without those of the rest of the domain.
Tin gather_in_region(const OpenedTerrain& terrain, const RefineRequest& request,
                     const Detail& detail, QueryContext& context) {
  const GridRegion region(*request.region, terrain.store().facts().map);
  const StarsInRegion stars(&region);
  LivingPlace place;
  place.box = region.bounds();
  place.stars = &stars;
  place.wanted = [&](const LivingTriangle& t) {
    return region.meets(t.corner[0].position, t.corner[1].position, t.corner[2].position);
  };
  LivingTin living(terrain, detail);
  if (!living.gather(place, context.left_beside(0), context)) {
    context.admit(living.bytes_wanted());
  }
  link_tin(living.tin());
  return living.release_tin();
}

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

/// Keeps the triangles that meet `region`, and their vertices; both are renumbered and keep their
/// order. Neighbours that went become kNone. What is left need not be a disk: it may be empty or in
/// pieces. Where two pieces touch in one vertex, Vertex::triangle is a triangle of one of the
/// pieces, on the border the first of a counter-clockwise walk.
/// @param pages  Empty, or one entry for each triangle; the entries of triangles that stay are
///               kept.
/// @throws Error cancelled
/// Cost: linear.
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

}  // namespace

RefinedTin refine(const OpenedTerrain& terrain, const RefineRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  const StoreFile& store = terrain.store();
  QueryContext context(request.limits, store.path());
  if (is_of_stars(terrain, request)) {
    const Detail detail(request.detail, terrain.record_source(), context);
    RefinedTin result;
    result.tin = gather_in_region(terrain, request, detail, context);
    store.pages().check_unchanged();
    fill_in_facts(result, terrain, detail.certificate(), context, start);
    return result;
  }
  const Selection selection =
      select(request, terrain.record_source(), bytes_of(terrain.t0()), context);

  Refinement refinement(terrain.t0(), request.page_of_triangle);
  refinement.apply(selection.splits, context);
  RefinedTin result;
  result.tin = refinement.release_tin();
  result.page_of_triangle = refinement.release_pages();
  if (request.region && request.form == ResultForm::kMeetingRegion) {
    keep_meeting(result.tin, GridRegion(*request.region, store.facts().map),
                 result.page_of_triangle, context);
  }
  store.pages().check_unchanged();

  fill_in_facts(result, terrain, selection.certificate, context, start);
  return result;
}

}  // namespace ptin
