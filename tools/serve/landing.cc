// SPDX-License-Identifier: GPL-3.0-or-later
//
// The pages about the service itself: landing page, conformance, collections.
#include <array>
#include <string>
#include <vector>

#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/coverage.h"
#include "tools/serve/landing_page.h"
#include "tools/serve/limit_table.h"
#include "tools/serve/places.h"
#include "tools/serve/questions.h"
#include "tools/tiles/web_mercator.h"

namespace ptin::serve {

namespace {

constexpr std::array kStandards = {
    "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/core",
    "http://www.opengis.net/spec/ogcapi-common-2/1.0/conf/collections",
    // Of the draft: the coverage at /coverage, whole or by bbox, as GeoTIFF.
    "http://www.opengis.net/spec/ogcapi-coverages-1/1.0/conf/core",
    "http://www.opengis.net/spec/ogcapi-coverages-1/1.0/conf/geotiff",
    "http://www.opengis.net/spec/ogcapi-edr-1/1.0/conf/core",
    "http://www.opengis.net/spec/ogcapi-edr-1/1.0/conf/covjson",
    "http://www.opengis.net/spec/ogcapi-edr-1/1.0/conf/geojson"};

/// What OGC EDR calls a data query; what else there is stands among the links.
constexpr std::array kDataQueries = {"position", "trajectory", "area",
                                     "cube",     "radius",     "corridor"};
constexpr std::array kDataFormats = {"covjson", "geojson", "csv"};  // of each of them

Json link(const std::string& href, const char* rel, std::string_view type, const char* title) {
  return {{"href", href}, {"rel", rel}, {"type", type}, {"title", title}};
}

/// For clients that turn places into degrees themselves.
Json lon_lat_json(const std::optional<LonLatNodes>& of) {
  if (!of) return nullptr;
  Json nodes = Json::array();
  for (const MapPoint& p : of->nodes) nodes.push_back({p.x, p.y});
  return {{"nodes", std::move(nodes)}, {"within", of->within}};
}

/// What this service knows of a terrain beyond what OGC asks for.
Json terrain_json(const Collection& c) {
  const StoreFacts& facts = c.terrain.store().facts();
  return {{"bounds", {c.bounds.min_x, c.bounds.min_y, c.bounds.max_x, c.bounds.max_y}},
          {"heights", {facts.min_height, facts.max_height}},
          {"vertices", c.terrain.store().t0().vertices.size() + c.terrain.store().record_count()},
          {"base_error", facts.base_error},
          {"crs", c.crs.horizontal_text()},
          {"vertical_crs", c.crs.has_third_axis ? c.crs.vertical_name : c.crs.vertical_text()},
          {"units", {{"horizontal", c.crs.horizontal_unit}, {"height", c.crs.vertical_unit}}},
          {"geographic", c.crs.geographic},
          {"lon_lat", lon_lat_json(c.degree_nodes)},
          {"free_of_voids", facts.free_of_voids},
          {"fingerprint", c.fingerprint},
          {"bytes", c.terrain.store().file_bytes()}};
}

/// Whether there are tiles of web maps beyond doubt: a terrain that reaches to a pole may have none.
bool has_web_tiles(const Collection& c) {
  if (!c.lon_lat || c.lon_lat->min_y <= -90 || c.lon_lat->max_y >= 90) return false;
  return c.lon_lat->min_y < tools::kMostMercatorLatitude &&
         c.lon_lat->max_y > -tools::kMostMercatorLatitude;
}

Json collection_json(const Collection& c, const std::string& root) {
  const std::string base = root + "/collections/" + c.id, crs = uri_of(c.crs);
  Json json = {
      {"id", c.id},
      {"links",
       {link(base, "self", kJson, "this document"),
        link(base + "/coverage", "http://www.opengis.net/def/rel/ogc/1.0/coverage",
             "image/tiff; application=geotiff", "heights as GeoTIFF"),
        link(base + "/schema", "http://www.opengis.net/def/rel/ogc/1.0/schema",
             "application/schema+json", "the values of the coverage"),
        link(base + "/stream", "item", "application/vnd.ptin.stream", "progressive transmission"),
        link(base + "/thumbnail.png", "preview", "image/png", "a small picture")}}};
  if (has_web_tiles(c)) {
    json["links"].push_back(
        link(base + "/dem/tilejson.json", "item", kJson, "heights as colours, as TileJSON"));
    json["links"].push_back(
        link(base + "/contours/tilejson.json", "item", kJson, "contours as TileJSON"));
  }
  add_credits(json, c.credits);
  const Window w = c.lon_lat.value_or(c.bounds);
  json["extent"]["spatial"] = {{"bbox", {{w.min_x, w.min_y, w.max_x, w.max_y}}},
                               {"crs", c.lon_lat ? kCrs84 : std::string_view(crs)}};
  json["crs"] = Json::array();
  if (c.lon_lat) json["crs"].push_back(kCrs84);
  if (!crs.empty()) json["crs"].push_back(crs);
  json["storageCrs"] = crs.empty() ? Json() : Json(crs);
  json["data_queries"] = Json::object();
  for (const char* query : kDataQueries) {
    json["data_queries"][query]["link"] = {
        {"href", base + "/" + query},
        {"rel", "data"},
        {"variables", {{"query_type", query}, {"output_formats", kDataFormats}}}};
  }
  const auto set_units = [&](const char* query, const char* name) {
    json["data_queries"][query]["link"]["variables"][name] = {"m", "km", "ft"};
  };
  set_units("radius", "within_units");
  set_units("corridor", "width_units");
  set_units("corridor", "height_units");
  json["parameter_names"] = coverage_parameters(c.crs.vertical_unit);
  json["output_formats"] = kDataFormats;
  json["terrain"] = terrain_json(c);
  return json;
}

/// What bounds a question, so that clients ask within it.
Json limits_json(const ServeOptions& options) {
  Json limits = Json::object();
  for (const LimitFact& limit : limit_table()) {
    for (const char* name : {"question_memory", "computing", "points", "vertices", "held_vertices",
                             "have", "pixels", "most_stream_bytes"}) {
      if (limit.name == name) limits[name] = limit.get(options);
    }
  }
  limits["held_vertices"] = most_held_vertices(options.question);
  return limits;
}

Json all_json(const Asked& asked) {
  Json collections = Json::array();
  for (const auto& collection : asked.catalogue.all()) {
    collections.push_back(collection_json(*collection, asked.request.base));
  }
  return {{"links", {link(asked.request.base + "/collections", "self", kJson, "this document")}},
          {"collections", std::move(collections)}};
}

Json landing_json(const std::string& root) {
  return {{"title", "Terrains"},
          {"description",
           "Heights, contours, lines of sight and meshes of terrains, each answer "
           "exact or within a certified error"},
          {"links",
           {link(root + "/", "self", kJson, "this document"),
            link(root + "/api", "service-desc", "application/vnd.oai.openapi+json;version=3.0",
                 "the service as OpenAPI"),
            link(root + "/conformance", "conformance", kJson, "standards"),
            link(root + "/collections", "data", kJson, "the terrains")}}};
}

std::string landing_html(const Asked& asked) {
  const std::string& root = asked.request.base;  // It holds nothing that HTML would read.
  std::vector<ListedTerrain> terrains;
  for (const auto& c : asked.catalogue.all()) terrains.push_back({c, collection_json(*c, root)});
  return landing_page(terrains, root);
}

}  // namespace

http::Response answer_landing(const Asked& asked) {
  http::Response response = format_of(asked).name == "json"
                                ? json_response(landing_json(asked.request.base))
                                : text_response(landing_html(asked), "text/html; charset=utf-8");
  if (!asked.question.has("f")) response.add("Vary", "Accept");
  return response;
}

http::Response answer_style(const Asked& asked) {
  return text_response(std::string(landing_style()), asked.formats.front().media);
}

http::Response answer_conformance(const Asked& asked) {
  return json_response({{"conformsTo", kStandards}}, format_of(asked).media);
}

http::Response answer_collections(const Asked& asked) {
  return json_response(all_json(asked), format_of(asked).media);
}

http::Response answer_collection(const Asked& asked) {
  Json json = collection_json(*asked.collection, asked.request.base);
  json["limits"] = limits_json(asked.options);
  add_base_map(json, base_map_of(asked.options, *asked.collection));
  return json_response(json, format_of(asked).media);
}

}  // namespace ptin::serve
