// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of sight and viewsheds.
#include <array>
#include <vector>

#include "engine/crs/ground.h"
#include "tools/python/binding.h"

namespace ptin::python {

namespace {

constexpr double kSpeedOfLight = 299792458.0;  // m/s

using End = std::array<double, 3>;

const char* name_of_verdict(SightVerdict verdict) noexcept {
  switch (verdict) {
    case SightVerdict::kVisible:
      return "visible";
    case SightVerdict::kHidden:
      return "hidden";
    case SightVerdict::kUndecided:
      return "undecided";
    case SightVerdict::kUndefined:
      break;
  }
  return "undefined";
}

/// x, y, distance, height; None where there is no such point.
py::object tuple_of(const std::optional<SightPoint>& point) {
  if (!point) return py::none();
  return py::make_tuple(point->position.x, point->position.y, point->distance, point->height);
}

py::tuple sight(const OpenTerrain& t, const End& a, const End& b, bool absolute, bool verdict_only,
                double curvature, std::optional<double> hertz, std::optional<std::uint64_t> budget,
                const Asked& asked) {
  std::stop_source stop;
  SightRequest request;
  asked.put(request, stop.get_token());
  const Ground ground = ground_of(t.crs);
  request.absolute = absolute;
  request.verdict_only = verdict_only;
  request.budget = budget;
  request.curvature = {curvature, ground.earth_diameter};
  request.ground_distance = ground.distance;
  if (hertz) request.wavelength = kSpeedOfLight / *hertz / ground.metres_per_height;
  const SightPair pair{{a[0], a[1]}, a[2], {b[0], b[1]}, b[2]};
  const SightResult r = answer(t, stop, [&] { return t.terrain.sight(pair, request); });
  return py::make_tuple(
      name_of_verdict(r.verdict), py::make_tuple(name_of(r.state_a), name_of(r.state_b)), r.length,
      tuple_of(r.obstruction), tuple_of(r.clearance_at), r.clearance_min, r.clearance_max,
      r.void_length, r.fresnel_ratio ? py::cast(*r.fresnel_ratio) : py::none(),
      tuple_of(r.fresnel_ratio ? r.fresnel_at : std::nullopt), r.certified_deviation, r.exact);
}

py::array_t<std::uint8_t> pixels_of(Viewshed& seen) {
  static_assert(sizeof(Sight) == 1);
  auto kept = std::make_unique<std::vector<Sight>>(std::move(seen.pixels));
  auto* const first = reinterpret_cast<std::uint8_t*>(kept->data());
  const py::capsule owner(kept.get(), [](void* p) { delete static_cast<std::vector<Sight>*>(p); });
  kept.release();
  return py::array_t<std::uint8_t>({seen.height, seen.width}, first, owner);
}

py::tuple viewshed(const OpenTerrain& t, const End& eye, double radius, double target,
                   bool absolute, double curvature,
                   const std::optional<std::array<double, 2>>& pixel_size, const Asked& asked) {
  std::stop_source stop;
  ViewshedRequest request;
  asked.put(request, stop.get_token());
  const Ground ground = ground_of(t.crs);
  request.eye = {eye[0], eye[1]};
  request.eye_height = eye[2];
  request.absolute = absolute;
  request.target_height = target;
  const MapPoint per_unit = ground.per_map_unit(request.eye);
  request.ground_per_map_x = per_unit.x;
  request.ground_per_map_y = per_unit.y;
  request.radius = ground.geographic ? radius / ground.metres_per_height : radius * per_unit.x;
  request.curvature = {curvature, ground.earth_diameter};
  request.pixel_size = pixel_size;
  request.list_vertices = false;
  Viewshed seen = answer(t, stop, [&] { return t.terrain.viewshed(request); });
  const py::tuple transform = py::make_tuple(seen.step_x, 0.0, seen.first.x - seen.step_x / 2, 0.0,
                                             -seen.step_y, seen.first.y + seen.step_y / 2);
  return py::make_tuple(pixels_of(seen), transform, seen.eye_height, seen.visible_pixels,
                        seen.hidden_pixels, seen.undecided_pixels, certificate_of(seen));
}

}  // namespace

void add_sight(py::module_& module) {
  module.def("sight", sight);
  module.def("viewshed", viewshed);
}

}  // namespace ptin::python
