// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>

#include "tools/serve/endpoint.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

using http::Lane;

constexpr std::string_view kHeights = "application/prs.coverage+json application/geo+json text/csv";
constexpr std::string_view kHeightsAndPlain =
    "application/prs.coverage+json application/geo+json text/csv application/json";

/// Built at the first call: the parameters stand in other files.
const std::vector<Endpoint>& table() {
  static const std::vector<Endpoint> all = {
      {"/", "landing", false, "What there is, for people and as JSON", landing_parameters(),
       "text/html application/json", Lane::kPoint, Reserves::kNothing, answer_landing},
      {"/viewer/*", "viewer", false, "The viewer: /viewer/index.html?collection=ID",
       viewer_parameters(), "text/html text/javascript application/wasm", Lane::kPoint,
       Reserves::kNothing, answer_viewer},
      {"/conformance", "conformance", false, "The standards that this service keeps",
       page_parameters(), "application/json", Lane::kPoint, Reserves::kNothing, answer_conformance},
      {"/api", "api", false, "This service as OpenAPI 3.0", page_parameters(),
       "application/vnd.oai.openapi+json;version=3.0", Lane::kPoint, Reserves::kNothing,
       answer_api},
      {"/collections", "collections", false, "The terrains", page_parameters(), "application/json",
       Lane::kPoint, Reserves::kNothing, answer_collections},
      {"/collections/{id}", "collection", false, "One terrain: extent, CRS, questions",
       page_parameters(), "application/json", Lane::kPoint, Reserves::kNothing, answer_collection},
      {"/collections/{id}/position", "position", true, "Heights at positions",
       position_parameters(), kHeightsAndPlain, Lane::kPoint, Reserves::kQuarter, answer_position},
      {"/collections/{id}/trajectory", "trajectory", true, "Heights along lines, as a coverage",
       trajectory_parameters(), kHeights, Lane::kTile, Reserves::kQuarter, answer_trajectory},
      {"/collections/{id}/area", "area", true, "Heights on a grid within a polygon",
       area_parameters(), kHeights, Lane::kTile, Reserves::kQuarter, answer_area},
      {"/collections/{id}/mesh", "mesh", false, "A mesh of a window", mesh_parameters(),
       "model/gltf-binary application/x-ply", Lane::kSweep, Reserves::kAll, answer_mesh},
      {"/collections/{id}/isolines", "isolines", false, "Isolines of a window",
       isolines_parameters(), "application/geo+json", Lane::kSweep, Reserves::kAll,
       answer_isolines},
      {"/collections/{id}/highest", "highest", false, "The highest or lowest point of a window",
       highest_parameters(), "application/geo+json", Lane::kTile, Reserves::kQuarter,
       answer_highest},
      {"/collections/{id}/viewshed", "viewshed", false, "What an observer sees",
       viewshed_parameters(), "image/png application/geo+json", Lane::kSweep, Reserves::kAll,
       answer_viewshed},
      {"/collections/{id}/profile", "profile", true,
       "The height along lines, with a break at every edge of the TIN", profile_parameters(),
       "application/json application/geo+json text/csv", Lane::kTile, Reserves::kQuarter,
       answer_profile},
      {"/collections/{id}/sight", "sight", true, "Lines of sight, visible or hidden",
       sight_parameters(), "application/json", Lane::kSweep, Reserves::kAll, answer_sight},
      {"/collections/{id}/stream", "stream", true,
       "Progressive transmission: what matters most, then what a client lacks", stream_parameters(),
       "application/vnd.ptin.stream", Lane::kSweep, Reserves::kAll, answer_stream},
      {"/collections/{id}/tiles/*", "tiles", false,
       "layer.json, and z/x/y.terrain: quantized-mesh 1.0, as Cesium asks", tiles_parameters(),
       "application/vnd.quantized-mesh application/json", Lane::kTile, Reserves::kAll,
       answer_tiles},
      {"/collections/{id}/tileset.json",
       "tileset",
       false,
       "The terrain as 3D Tiles 1.1",
       {},
       "application/json",
       Lane::kTile,
       Reserves::kAll,
       answer_tileset},
      {"/collections/{id}/subtrees/*",
       "subtree",
       false,
       "Which tiles there are below one",
       {},
       "application/octet-stream",
       Lane::kTile,
       Reserves::kAll,
       answer_subtree},
      {"/collections/{id}/content/*",
       "content",
       false,
       "A tile of 3D Tiles",
       {},
       "model/gltf-binary",
       Lane::kTile,
       Reserves::kAll,
       answer_content},
      {"/collections/{id}/file",
       "file",
       false,
       "The file itself, whole or by a range",
       {},
       "application/vnd.ptin",
       Lane::kPoint,
       Reserves::kNothing,
       answer_file},
      {"/v1/*", "elevation", true,
       "Elevations in metres, as Google's Elevation API and opentopodata answer",
       elevation_parameters(), "application/json application/geo+json", Lane::kPoint,
       Reserves::kQuarter, answer_elevation, refuse_elevation},
  };
  return all;
}

}  // namespace

std::span<const Endpoint> endpoints() noexcept { return table(); }

}  // namespace ptin::serve
