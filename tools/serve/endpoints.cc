// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <string>
#include <vector>

#include "tools/ask/questions.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/coverage.h"
#include "tools/serve/endpoint.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

using http::Lane;

constexpr ask::Format kCoverageFormat{"covjson", kCoverageJson},
    kGeoJsonFormat{"geojson", kGeoJson}, kCsvFormat{"csv", kCsv}, kJsonFormat{"json", kJson};
constexpr std::array kPageFormats{kJsonFormat};
constexpr std::array kLandingFormats{kJsonFormat, ask::Format{"html", "text/html"}};
constexpr std::array kApiFormats{
    ask::Format{"json", "application/vnd.oai.openapi+json;version=3.0"}};
constexpr std::array kPositionFormats{kCoverageFormat, kGeoJsonFormat, kCsvFormat, kJsonFormat};
constexpr std::array kHeightFormats{kCoverageFormat, kGeoJsonFormat, kCsvFormat};
constexpr std::array kProfileFormats{kJsonFormat, kGeoJsonFormat, kCsvFormat};
constexpr std::array kFeatureFormats{kGeoJsonFormat};
constexpr std::array kViewshedFormats{ask::Format{"png", "image/png"}, kGeoJsonFormat};
constexpr std::array kRasterFormats{ask::Format{"geotiff", "image/tiff; application=geotiff"},
                                    ask::Format{"cog", "image/tiff; application=geotiff"}};
constexpr std::array kMeshFormats{ask::Format{"glb", "model/gltf-binary"},
                                  ask::Format{"ply", "application/x-ply"}};
// Of these no parameter `f` chooses.
constexpr std::array kViewerMedia{ask::Format{"", "text/html"}, ask::Format{"", "text/javascript"},
                                  ask::Format{"", "application/wasm"}};
constexpr std::array kStyleMedia{ask::Format{"", "text/css; charset=utf-8"}};
constexpr std::array kThumbnailMedia{ask::Format{"", "image/png"}};
constexpr std::array kStreamMedia{ask::Format{"", "application/vnd.ptin.stream"}};
constexpr std::array kTileMedia{ask::Format{"", "application/vnd.quantized-mesh"},
                                ask::Format{"", kJson}};
constexpr std::array kSchemaMedia{ask::Format{"", "application/schema+json"}};
constexpr std::array kTilesetMedia{ask::Format{"", kJson}};
constexpr std::array kSubtreeMedia{ask::Format{"", "application/octet-stream"}};
constexpr std::array kContentMedia{ask::Format{"", "model/gltf-binary"}};
constexpr std::array kDemMedia{ask::Format{"", "image/png"}, ask::Format{"", "image/webp"},
                               ask::Format{"", kJson}};
constexpr std::array kContourMedia{ask::Format{"", "application/vnd.mapbox-vector-tile"},
                                   ask::Format{"", kJson}};
constexpr std::array kFileMedia{ask::Format{"", "application/vnd.ptin"}};
constexpr std::array kElevationMedia{ask::Format{"", kJson}, ask::Format{"", kGeoJson}};

/// Has an endpoint tell the fields of its answers: those of an object, or of a feature.
/// @param rows  The array of an object in which they stand, as "points[]."; empty: in none.
template <typename Row>
void add_fields(std::vector<Endpoint>& all, std::string_view name, const ask::Fields<Row>& fields,
                Told form, const std::string& rows = {}) {
  for (Endpoint& endpoint : all) {
    if (endpoint.name != name) continue;
    auto& told = form == Told::kFeature ? endpoint.properties : endpoint.members;
    for (ask::Field& field : fields.told(Told::kService & form)) {
      field.name.insert(0, rows);
      told.push_back(std::move(field));
    }
  }
}

void add_all_fields(std::vector<Endpoint>& all) {
  for (const char* name : {"position", "area", "cube", "radius", "corridor"}) {
    add_fields(all, name, ask::located_fields(), Told::kFeature);
  }
  for (const char* name : {"trajectory", "profile"}) {
    add_fields(all, name, ask::profile_line_fields(), Told::kFeature);
  }
  add_fields(all, "position", ask::located_fields(), Told::kDocument, "points[].");
  add_fields(all, "profile", ask::profile_fields(), Told::kDocument, "points[].");
  add_fields(all, "profile", ask::profile_answer_fields(), Told::kDocument);
  add_fields(all, "volume", ask::volume_fields(), Told::kDocument);
  add_fields(all, "sight", ask::sight_fields(), Told::kDocument, "pairs[].");
  add_fields(all, "isolines", ask::isoline_row_fields(), Told::kFeature);
  add_fields(all, "highest", ask::highest_place_fields(), Told::kFeature);
  add_fields(all, "highest", ask::highest_fields(), Told::kDocument);
  add_fields(all, "viewshed", ask::target_fields(), Told::kFeature);
  add_fields(all, "viewshed", ask::viewshed_fields(), Told::kDocument);
}

/// The parameters stand in other files.
std::vector<Endpoint> made_table() {
  const ask::Parameters none;
  std::vector<Endpoint> all = {
      {"/", "landing", false, "What there is, for people and as JSON", none, kLandingFormats,
       Lane::kPoint, Reserves::kNothing, answer_landing},
      {"/viewer/*", "viewer", false, "The viewer: /viewer/index.html?collection=ID",
       viewer_parameters(), kViewerMedia, Lane::kPoint, Reserves::kNothing, answer_viewer},
      {"/style.css", "style", false, "The style of the page of the terrains", none, kStyleMedia,
       Lane::kPoint, Reserves::kNothing, answer_style},
      {"/conformance", "conformance", false, "The standards that this service keeps", none,
       kPageFormats, Lane::kPoint, Reserves::kNothing, answer_conformance},
      {"/api", "api", false, "This service as OpenAPI 3.0", none, kApiFormats, Lane::kPoint,
       Reserves::kNothing, answer_api},
      {"/collections", "collections", false, "The terrains", none, kPageFormats, Lane::kPoint,
       Reserves::kNothing, answer_collections},
      {"/collections/{id}", "collection", false, "One terrain: extent, CRS, questions", none,
       kPageFormats, Lane::kPoint, Reserves::kNothing, answer_collection},
      {"/collections/{id}/thumbnail.png", "thumbnail", false,
       "A small picture of the terrain from above", thumbnail_parameters(), kThumbnailMedia,
       Lane::kTile, Reserves::kAll, answer_thumbnail},
      {"/collections/{id}/position", "position", true, "Heights at positions",
       with_coverage(described<LocateRequest>()), kPositionFormats, Lane::kPoint,
       Reserves::kQuarter, answer_position},
      {"/collections/{id}/trajectory", "trajectory", true, "Heights along lines, as a coverage",
       with_coverage(described<ProfileRequest>()), kHeightFormats, Lane::kTile, Reserves::kQuarter,
       answer_trajectory},
      {"/collections/{id}/area", "area", true, "Heights on a grid within a polygon",
       area_parameters(), kHeightFormats, Lane::kTile, Reserves::kQuarter, answer_area},
      {"/collections/{id}/cube", "cube", true, "Heights on a grid within a window",
       cube_parameters(), kHeightFormats, Lane::kTile, Reserves::kQuarter, answer_cube},
      {"/collections/{id}/radius", "radius", true, "Heights on a grid around positions",
       radius_parameters(), kHeightFormats, Lane::kTile, Reserves::kQuarter, answer_radius},
      {"/collections/{id}/corridor", "corridor", true, "Heights on a grid along lines",
       corridor_parameters(), kHeightFormats, Lane::kTile, Reserves::kQuarter, answer_corridor},
      {"/collections/{id}/coverage", "coverage", false,
       "Heights of a window as a GeoTIFF, or cloud-optimized", raster_parameters(), kRasterFormats,
       Lane::kSweep, Reserves::kAll, answer_raster},
      {"/collections/{id}/schema", "schema", false, "The values of the coverage, as JSON Schema",
       none, kSchemaMedia, Lane::kPoint, Reserves::kNothing, answer_schema},
      {"/collections/{id}/mesh", "mesh", false, "A mesh of a window", mesh_parameters(),
       kMeshFormats, Lane::kSweep, Reserves::kAll, answer_mesh},
      {"/collections/{id}/isolines", "isolines", false, "Isolines of a window",
       described<ask::IsolineQuestion>(), kFeatureFormats, Lane::kSweep, Reserves::kAll,
       answer_isolines},
      {"/collections/{id}/highest", "highest", false, "The highest or lowest point of a window",
       described<ask::HighestQuestion>(), kFeatureFormats, Lane::kTile, Reserves::kQuarter,
       answer_highest},
      {"/collections/{id}/viewshed", "viewshed", false, "What an observer sees",
       described<ask::ViewshedQuestion>(), kViewshedFormats, Lane::kSweep, Reserves::kAll,
       answer_viewshed},
      {"/collections/{id}/profile", "profile", true,
       "The height along lines, with a break at every edge of the TIN", described<ProfileRequest>(),
       kProfileFormats, Lane::kTile, Reserves::kQuarter, answer_profile},
      {"/collections/{id}/sight", "sight", true, "Lines of sight, visible or hidden",
       described<ask::SightQuestion>(), kPageFormats, Lane::kSweep, Reserves::kAll, answer_sight},
      {"/collections/{id}/volume", "volume", true,
       "Cut and fill against a height or another collection", volume_parameters(), kPageFormats,
       Lane::kSweep, Reserves::kAll, answer_volume},
      {"/collections/{id}/stream", "stream", true,
       "Progressive transmission: what matters most, then what a client lacks", stream_parameters(),
       kStreamMedia, Lane::kSweep, Reserves::kAll, answer_stream},
      {"/collections/{id}/tiles/*", "tiles", false,
       "layer.json, and z/x/y.terrain: quantized-mesh 1.0, as Cesium asks", tiles_parameters(),
       kTileMedia, Lane::kTile, Reserves::kAll, answer_tiles},
      {"/collections/{id}/tileset.json", "tileset", false, "The terrain as 3D Tiles 1.1", none,
       kTilesetMedia, Lane::kTile, Reserves::kAll, answer_tileset},
      {"/collections/{id}/subtrees/*", "subtree", false, "Which tiles there are below one", none,
       kSubtreeMedia, Lane::kTile, Reserves::kAll, answer_subtree},
      {"/collections/{id}/content/*", "content", false, "A tile of 3D Tiles", none, kContentMedia,
       Lane::kTile, Reserves::kAll, answer_content},
      {"/collections/{id}/dem/*", "dem", false,
       "tilejson.json, and z/x/y.png or .webp: heights as colours, as web maps ask (raster-dem)",
       dem_parameters(), kDemMedia, Lane::kTile, Reserves::kAll, answer_dem},
      {"/collections/{id}/contours/*", "contours", false,
       "tilejson.json, and z/x/y.mvt or .pbf: contours as vector tiles, as web maps ask",
       contours_parameters(), kContourMedia, Lane::kTile, Reserves::kAll, answer_contours},
      {"/collections/{id}/file", "file", false, "The file itself, whole or by a range", none,
       kFileMedia, Lane::kPoint, Reserves::kNothing, answer_file},
      {"/v1/*", "elevation", true,
       "Elevations in metres, as Google's Elevation API and opentopodata answer",
       elevation_parameters(), kElevationMedia, Lane::kPoint, Reserves::kQuarter, answer_elevation,
       refuse_elevation},
      {"/maps/api/elevation/json", "google_elevation", true,
       "The same from all terrains, the finest one first, at the path of Google's API",
       elevation_parameters(), kElevationMedia, Lane::kPoint, Reserves::kQuarter,
       answer_google_elevation, refuse_elevation},
      {"/api/v1/lookup", "lookup", true,
       "Elevations in metres from all terrains, the finest one first, as open-elevation answers",
       lookup_parameters(), kTilesetMedia, Lane::kPoint, Reserves::kQuarter, answer_lookup,
       refuse_elevation},
  };
  std::string unread;
  for (Endpoint& endpoint : all) {
    if (endpoint.formats.front().name.empty()) continue;
    ask::add_format(endpoint.parameters, unread, endpoint.formats);
  }
  add_all_fields(all);
  return all;
}

}  // namespace

std::span<const Endpoint> endpoints() noexcept {
  static const std::vector<Endpoint> all = made_table();
  return all;
}

}  // namespace ptin::serve
