// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one observer sees, as a picture or as GeoJSON.
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "engine/error.h"
#include "tools/ask/questions.h"
#include "tools/http/problem.h"
#include "tools/plot/png.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/coverage.h"
#include "tools/serve/questions.h"
#include "tools/serve/wkt_places.h"

namespace ptin::serve {

namespace {

ViewshedRequest request_of(const Asked& asked, const ask::ViewshedQuestion& question,
                           const Places& places, bool as_picture) {
  const std::vector<MapPoint> eye = points_of_wkt(asked.question.text("coords"), "coords");
  if (eye.size() != 1) throw http::Problem(400, "one observer has one position").at("coords");
  ViewshedRequest request = question.request;
  request.eye = places.to_terrain(eye[0]);
  request.radius = question.radius;
  ask::set_ground(request, asked.collection->ground);
  request.pixels = as_picture;
  request.list_vertices = !as_picture;
  check_detail(asked, request.detail);
  request.limits = engine_limits(asked);
  return request;
}

/// @throws http::Problem 400  the observer stands outside of the terrain, or below its surface
Viewshed viewshed_of(const Asked& asked, const ViewshedRequest& request) {
  try {
    return asked.terrain().viewshed(request);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_argument) throw;
    throw http::Problem(400, error.message()).at("coords");
  }
}

/// Pixels as colours: visible green, perhaps visible yellow, hidden dark, nothing clear.
std::string png_of(const Viewshed& seen) {
  std::vector<std::uint32_t> pixels;
  pixels.reserve(seen.pixels.size());
  for (const Sight s : seen.pixels) {
    pixels.push_back(s == Sight::kVisible          ? 0xB02E9E4FU
                     : s == Sight::kPerhapsVisible ? 0xB0C8B13AU
                     : s == Sight::kPerhapsHidden  ? 0x806B5A3AU
                     : s == Sight::kHidden         ? 0x80303038U
                                                   : 0x00000000U);
  }
  return tools::png_of(static_cast<int>(seen.width), static_cast<int>(seen.height), pixels);
}

/// "west,south,east,north" of the picture, map units.
std::string bounds_text(const Viewshed& seen) {
  const double west = seen.first.x - seen.step_x / 2, north = seen.first.y + seen.step_y / 2;
  std::string text;
  append_json_number(text, west);
  append_json_number(text += ',', north - seen.step_y * seen.height);
  append_json_number(text += ',', west + seen.step_x * seen.width);
  append_json_number(text += ',', north);
  return text;
}

std::string geojson_of(const Viewshed& seen, const Asked& asked, const Places& places) {
  check_count(seen.vertices.size(), asked.options.question.vertices, "vertices", "vertices",
              "radius");
  const auto add_geometry = [&](LongText& text, std::size_t i) {
    add_point(text, seen.vertices[i].position, places);
  };
  Json more = ask::viewshed_fields().told(kObject).object_of(seen);
  more["ptin:certainty"] = certainty_of(asked, seen);
  return features_text(
      asked, ask::target_fields(), seen.vertices.size(),
      [&](std::size_t i) -> const Viewshed::Target& { return seen.vertices[i]; }, add_geometry,
      more);
}

/// The raster has the terrain's own pixels: a radius that would make too many is told at once.
void check_pixels(const Asked& asked, const ViewshedRequest& request) {
  const StoreFacts& facts = asked.facts();
  const MapPoint a = facts.map.to_map(0, 0), b = facts.map.to_map(1, 1);
  const double across = 2 * request.radius / (std::abs(b.x - a.x) * request.ground_per_map_x) + 1;
  const double down = 2 * request.radius / (std::abs(b.y - a.y) * request.ground_per_map_y) + 1;
  if (across * down <= static_cast<double>(asked.options.question.pixels)) return;
  throw http::Problem(413, "the picture has more than " +
                               std::to_string(asked.options.question.pixels) +
                               " pixels; ask for a smaller radius, or for geojson at an error")
      .at("radius")
      .beyond("pixels");
}

}  // namespace

http::Response answer_viewshed(const Asked& asked) {
  const ask::Format& format = format_of(asked);
  const bool as_picture = format.name == "png";
  const auto question = read<ask::ViewshedQuestion>(asked);
  const Places places = places_of(asked);
  const ViewshedRequest request = request_of(asked, question, places, as_picture);
  if (as_picture) check_pixels(asked, request);
  const Viewshed seen = viewshed_of(asked, request);
  http::Response response = answered(
      asked, as_picture ? png_of(seen) : geojson_of(seen, asked, places), format.media, seen);
  if (as_picture) response.add("Ptin-Bounds", bounds_text(seen));
  return response;
}

}  // namespace ptin::serve
