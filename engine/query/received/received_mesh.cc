// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/received/received_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "engine/query/heights/ground_stretches.h"
#include "engine/query/heights/located_point.h"
#include "engine/query/heights/profile_points.h"
#include "engine/query/living/living_triangle.h"
#include "engine/query/refine/bounded_surface.h"
#include "engine/query/sight/sight_measure.h"
#include "engine/query/sight/sight_view.h"
#include "engine/query/walk/spot_path.h"

namespace ptin {

namespace {

/// The certificate is all that is known of any triangle.
class CertifiedSurface final : public BoundedSurface {
 public:
  explicit CertifiedSurface(const ReceivedMesh& mesh)
      : tin_(mesh.tin), bounds_{mesh.certificate.deviation, {-kInfinity, kInfinity}} {}
  [[nodiscard]] const Tin& tin() const noexcept override { return tin_; }
  [[nodiscard]] SurfaceBounds bounds(TriangleId /*t*/) const noexcept override { return bounds_; }

 private:
  const Tin& tin_;
  SurfaceBounds bounds_;
};

Spot end_of(const ReceivedMesh& mesh, MapPoint p) {
  const std::optional<Spot> spot = SpotMap(mesh.facts.map, mesh.facts.bounds).spot(p);
  if (!spot) refuse("an end lies too far from the terrain: give map units of its CRS");
  return *spot;
}

SightFacts facts_of(const ReceivedMesh& mesh) {
  SightFacts facts;
  facts.heights = mesh.facts.heights;
  facts.file_deviation = mesh.facts.base_deviation;
  facts.finest_deviation = mesh.certificate.deviation;
  facts.min_height = mesh.facts.min_height;
  facts.max_height = mesh.facts.max_height;
  facts.is_level_asked = !mesh.certificate.complete;
  facts.has_voids = !mesh.facts.free_of_voids;
  facts.exact_settles = !facts.has_voids || mesh.facts.base_error == 0;
  facts.final_settles = facts.exact_settles && (!facts.has_voids || mesh.certificate.complete);
  return facts;
}

SightVerdict verdict_of(const SightView& view) {
  if (view.hidden_piece() != nullptr || view.is_touched_from_below()) return SightVerdict::kHidden;
  const bool is_open = view.open_touch() || view.may_be_touched_from_below() ||
                       std::any_of(view.pieces.begin(), view.pieces.end(), [](const SightPiece& p) {
                         return p.verdict == PieceVerdict::kUndecided;
                       });
  return is_open ? SightVerdict::kUndecided : SightVerdict::kVisible;
}

}  // namespace

Certificate certificate_by_relief(const StoreFacts& facts) {
  const double relief = std::max(0.0, facts.max_height - facts.min_height);
  return {relief + facts.base_error, relief + facts.base_deviation, false};
}

LocatedPoint locate_on(const ReceivedMesh& mesh, MapPoint at) {
  const std::optional<Spot> spot = SpotMap(mesh.facts.map, mesh.facts.bounds).spot(at);
  if (!spot || !contains(mesh.facts.bounds, *spot)) return {};
  const Place place = find_spot(mesh.tin, *spot, 0);
  LocatedPoint point = located_at(mesh.tin, mesh.facts.heights, *spot, place);
  if (point.state == PointState::kSurface) {
    set_interval({mesh.certificate.deviation, {-kInfinity, kInfinity}}, mesh.certificate.complete,
                 mesh.facts, point);
  }
  return point;
}

std::vector<ProfilePoint> profile_on(
    const ReceivedMesh& mesh, MapPoint from, MapPoint to,
    const std::function<double(MapPoint, MapPoint)>& ground_distance, std::uint64_t memory_bytes) {
  ProfileRequest request;
  request.ground_distance = ground_distance;
  const std::array<MapPoint, 2> ends{from, to};
  const SpotLine line = spot_line(ends, 0, 1, mesh.facts, request);
  if (line.spots.size() < 2) {
    refuse("the line has no length: expected at least two different points");
  }
  const SpotPath path({{line.spots[0], line.spots[1]}});
  GroundStretches stretches(path, mesh.facts.heights, memory_bytes);
  for (TriangleId t = 0; t < mesh.tin.triangles.size(); ++t) {
    stretches.take(living_triangle(mesh.tin, t));
    if (!stretches.begin(0)) {
      throw Error(ErrorCode::resource_exhausted,
                  "the line crosses more triangles than the memory holds; take a shorter one");
    }
  }
  stretches.sort();
  std::vector<ProfilePoint> points;
  SegmentWriter(mesh.facts, line, points).write(0, stretches.of(0));
  return points;
}

SightResult sight_on(const ReceivedMesh& mesh, const SightPair& pair, const SightRequest& request) {
  check(request.curvature);
  const Spot p = end_of(mesh, pair.a);
  const Spot q = end_of(mesh, pair.b);
  if (p == q) refuse("both ends are at one place: a line of sight has two");
  const SightFacts facts = facts_of(mesh);
  SightResult result;
  result.length = request.ground_distance(pair.a, pair.b);
  if (!std::isfinite(result.length)) refuse("the distance between the ends is not known");
  SightView view(facts, p, q, pair, request.absolute, request.curvature.drop_at(result.length));
  view.known.push_back({0.0, 1.0, -1.0, mesh.certificate.complete});
  view.a.known = view.b.known = mesh.certificate.complete;
  view.look(CertifiedSurface(mesh));
  result.state_a = state_of(view.a);
  result.state_b = state_of(view.b);
  const bool is_certain = !facts.has_voids || mesh.certificate.complete;
  if (!view.ends_defined()) {
    result.verdict = is_certain ? SightVerdict::kUndefined : SightVerdict::kUndecided;
    result.certified_deviation = is_certain ? 0.0 : mesh.certificate.deviation;
    return result;
  }
  // An end that stands on the mesh may stand in a void of the full TIN, from which nothing is seen.
  result.verdict = is_certain || request.absolute ? verdict_of(view) : SightVerdict::kUndecided;
  const bool is_measured = measure(view, facts, pair, request.wavelength, result);
  if (result.verdict == SightVerdict::kUndecided) {
    result.certified_deviation = mesh.certificate.deviation;
  }
  result.exact = mesh.certificate.complete && mesh.facts.base_error == 0 && is_measured &&
                 result.verdict != SightVerdict::kUndecided;
  return result;
}

}  // namespace ptin
