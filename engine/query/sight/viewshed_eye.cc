// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/viewshed_eye.h"

#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "engine/query/walk/walk.h"

namespace ptin {

ViewshedEye find_eye(const Tin& tin, const StoreFacts& facts, const ViewshedRequest& request) {
  const auto spot = SpotMap(facts.map, facts.bounds).spot(request.eye);
  const Place place = spot ? find_spot(tin, *spot, 0) : Place{};
  if (place.lies == Lies::kOutside) {
    refuse("the observer stands outside of the terrain");
  }
  ViewshedEye eye{*spot, place.triangle, request.eye_height, kInfinity};
  const TriangleId ground = answering_triangle(tin, place);
  if (tin.classes[ground] == TriangleClass::kSurface) {
    const Footing footing = footing_of(tin, *spot, place);
    const double surface = facts.heights.height_of_code(code_at(tin, facts.heights, footing));
    eye.above_ground = request.absolute ? request.eye_height - surface : request.eye_height;
    eye.height = request.absolute ? request.eye_height : surface + request.eye_height;
  } else if (!request.absolute) {
    refuse("the observer stands on a void, where no height is known; give an absolute height");
  }
  if (eye.above_ground < 0) {
    refuse("the observer stands below the surface; give a height above it");
  }
  return eye;
}

}  // namespace ptin
