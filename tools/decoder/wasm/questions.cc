// SPDX-License-Identifier: GPL-3.0-or-later
//
// The engine's questions of a mesh that was received (engine/query/received), for WebAssembly: a module beside the decoder,
// which the page fetches when it is asked for the first time. src/questions.ts, its only caller, copies the decoder's mesh into
// it. Answers are arrays of doubles, valid until the next question; src/questions.ts knows their order.
//
// Errors: what is refused leaves the module for good (module.h), and the host takes a new instance.
#include "engine/query/questions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "engine/error.h"
#include "tools/decoder/wasm/ground.h"
#include "tools/decoder/wasm/module.h"

namespace {

using ptin::MapPoint;
using ptin::viewer::ground;

constexpr std::uint64_t kAnswerBytes = std::uint64_t{256} << 20;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// The mesh that is asked, as the decoder had it, and what the host knows of it.
struct Asked {
  ptin::Tin tin;
  ptin::StoreFacts facts;
  ptin::Certificate certificate;
};
Asked& asked() {
  static Asked the_asked;
  return the_asked;
}

ptin::ReceivedMesh mesh() { return {asked().tin, asked().facts, asked().certificate}; }

/// The distance along a profile, as the program has it: in map units, of degrees in metres.
double length_along(const ptin::Ground& on, MapPoint a, MapPoint b) {
  if (on.geographic) return on.distance(a, b) * on.metres_per_height;
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  return std::sqrt(dx * dx + dy * dy);
}

std::vector<double>& answer() {
  static std::vector<double> numbers;
  return numbers;
}

void add(const std::optional<ptin::SightPoint>& point) {
  const ptin::SightPoint none{{kUnknown, kUnknown}, kUnknown, kUnknown, kUnknown};
  const ptin::SightPoint& p = point ? *point : none;
  for (const double number : {p.position.x, p.position.y, p.distance, p.height})
    answer().push_back(number);
}

}  // namespace

const ptin::Tin& ptin::viewer::tin() { return asked().tin; }
const ptin::StoreFacts& ptin::viewer::facts() { return asked().facts; }

/// Room for a mesh, which the host fills: the arrays of engine/mesh/tin.h. Valid until the next call.
PTIN_EXPORT(makeRoom) void make_room(std::size_t vertices, std::size_t triangles) {
  ptin::Tin& tin = asked().tin;
  tin = {};  // The mesh before is not copied along.
  tin.vertices.resize(vertices);
  tin.has_height.resize(vertices);
  tin.triangles.resize(triangles);
  tin.classes.resize(triangles);
}

/// Takes what the metadata tell of voids, and the certificate of the stream at the places that are asked next: infinity where
/// it has none. `is_whole`: no record of the file is missing there.
PTIN_EXPORT(describe)
void describe(bool free_of_voids, double error, double deviation, bool is_whole) {
  Asked& now = asked();
  now.facts.free_of_voids = free_of_voids;
  const ptin::Certificate relief = ptin::certificate_by_relief(now.facts);
  now.certificate = {std::min(error, relief.error), std::min(deviation, relief.deviation),
                     is_whole};
}

/// State (0 surface, 1 void, 2 outside), height, the interval of the full terrain's, and three corners: x, y on the map, height.
PTIN_EXPORT(locate) const double* locate(double x, double y) {
  const ptin::ReceivedMesh of = mesh();
  const ptin::LocatedPoint p = ptin::locate_on(of, {x, y});
  answer() = {static_cast<double>(p.state), p.height, p.height_min, p.height_max};
  for (const ptin::LocatedPoint::Corner& corner : p.triangle) {
    const MapPoint at = of.facts.map.to_map(corner.position.x, corner.position.y);
    answer().insert(answer().end(), {at.x, at.y, corner.height});
  }
  return answer().data();
}

/// The number of points, and of each: distance, x, y, height, state.
PTIN_EXPORT(profile) const double* profile(double ax, double ay, double bx, double by) {
  const auto length = [on = ground()](MapPoint a, MapPoint b) { return length_along(on, a, b); };
  if (!std::isfinite(length({ax, ay}, {bx, by}))) {
    ptin::refuse("the length of a line around the Earth is not known here; take a shorter one");
  }
  const std::vector<ptin::ProfilePoint> points =
      ptin::profile_on(mesh(), {ax, ay}, {bx, by}, length, kAnswerBytes);
  answer() = {static_cast<double>(points.size())};
  for (const ptin::ProfilePoint& p : points) {
    answer().insert(answer().end(), {p.distance, p.position.x, p.position.y, p.height,
                                     static_cast<double>(p.state)});
  }
  return answer().data();
}

/// Verdict (as SightVerdict), length, clearance from and to, Fresnel ratio, and of clearance and Fresnel zone: x, y, distance,
/// height. Lengths are in the unit of heights; not a number: there is none.
PTIN_EXPORT(sight)
const double* sight(double ax, double ay, double height_a, double bx, double by, double height_b,
                    double hertz) {
  const ptin::Ground on = ground();
  ptin::SightRequest request;
  request.curvature.earth_diameter = on.earth_diameter;
  request.ground_distance = on.distance;
  if (hertz > 0) request.wavelength = ptin::viewer::kSpeedOfLight / hertz / on.metres_per_height;
  const ptin::SightResult r =
      ptin::sight_on(mesh(), {{ax, ay}, height_a, {bx, by}, height_b}, request);
  answer() = {static_cast<double>(r.verdict), r.length, r.clearance_min, r.clearance_max,
              r.fresnel_ratio.value_or(kUnknown)};
  add(r.clearance_at);
  add(r.fresnel_at);
  return answer().data();
}
