// SPDX-License-Identifier: GPL-3.0-or-later
//
// The question of what one observer sees: `ptin viewshed`, and `viewshed` over HTTP.
#pragma once

#include "engine/crs/ground.h"
#include "tools/ask/field.h"
#include "tools/ask/groups.h"

namespace ptin::ask {

struct ViewshedQuestion {
  ViewshedQuestion() { request.eye_height = 2; }  // Of somebody who stands there.

  ViewshedRequest request;
  double x = 0, y = 0;  ///< The observer's position on the command line.
  double radius = 0;    ///< Map units, of a geographic CRS metres; over HTTP in the heights' unit.
};
void add_viewshed(Parameters& rows, ViewshedQuestion& question);
/// Fills in what the ground tells below the eye, which is set: lengths of map units, and the Earth.
void set_ground(ViewshedRequest& request, const Ground& ground);

struct ViewshedAnswer {
  const Viewshed* seen;
  bool of_pixels = false;  ///< Else of vertices.
};
[[nodiscard]] Fields<ViewshedAnswer> viewshed_fields();
/// A vertex as a feature.
[[nodiscard]] Fields<Viewshed::Target> target_fields();

}  // namespace ptin::ask
