// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/viewshed.h"

namespace ptin::ask {

void add_viewshed(Parameters& rows, ViewshedQuestion& question) {
  ViewshedRequest& request = question.request;
  rows.add("x", &question.x, "", "The observer's position")
      .spelled("X")
      .in(Unit::kMap)
      .required_at(Door::kBoth)
      .at(Door::kProgram);
  rows.add("y", &question.y, "", "The observer's position")
      .spelled("Y")
      .in(Unit::kMap)
      .required_at(Door::kBoth)
      .at(Door::kProgram);
  rows.add("height", &request.eye_height, "", "The observer's height above the surface")
      .spelled("H")
      .in(Unit::kHeight)
      .required_at(Door::kProgram)
      .like("2");
  rows.add("radius", &question.radius, "R", "How far to look")
      .in(Unit::kGround)
      .within(kPositive)
      .required_at(Door::kBoth)
      .at(Door::kProgram);
  rows.add("radius", &question.radius, "", "How far to look, over ground")
      .in(Unit::kHeight)
      .within(kPositive)
      .required_at(Door::kBoth)
      .at(Door::kService)
      .like("5000");
  rows.add("absolute", &request.absolute, "",
           "The observer's height is one of itself, not above the surface")
      .like("false");
  rows.add("target", &request.target_height, "T",
           "Height of targets above the surface; 0 without it")
      .spelled("--target-height")
      .in(Unit::kHeight)
      .like("0");
  add_curvature(rows, request.curvature.coefficient);
  add_detail(
      rows, request.detail,
      " at the radius, less towards the observer; where the full TIN may answer otherwise, a "
      "target is undecided (192 seems visible, 64 hidden; `certain` is 0)",
      "The TIN of the terrain's N most important vertices, and more towards the observer, "
      "instead of an error; undecided targets as with an error");
}

void set_ground(ViewshedRequest& request, const Ground& ground) {
  const MapPoint per_unit = ground.per_map_unit(request.eye);
  request.ground_per_map_x = per_unit.x;
  request.ground_per_map_y = per_unit.y;
  request.curvature.earth_diameter = ground.earth_diameter;
}

}  // namespace ptin::ask
