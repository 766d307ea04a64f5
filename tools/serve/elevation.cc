// SPDX-License-Identifier: GPL-3.0-or-later
//
// Elevations as Google's Elevation API and opentopodata answer them: latitude before longitude,
// metres, a `status` in the body. Their clients work unchanged; what they do not know is further
// members (`state`, `elevation_min`, `elevation_max`).
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/crs/ground.h"
#include "engine/number.h"
#include "tools/ask/questions.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/geodesic_path.h"
#include "tools/serve/polyline.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

using http::Problem;

struct ElevationQuestion {
  std::string nodata, format = "json";
  std::optional<std::uint64_t> samples;
  std::optional<double> error;  ///< Metres.
};

void add_question(ask::Parameters& rows, ElevationQuestion& question) {
  constexpr ask::Door kService = ask::Door::kService;
  ask::add_text(
      rows, "locations",
      "lat,lng|lat,lng... or an encoded polyline; in the JSON of a POST an array of [lat, lng] too",
      "34.34,-118.3|34.35,-118.29")
      .as_json();
  ask::add_text(rows, "path", "Positions instead of locations; with samples, positions along it")
      .as_json();
  rows.add("samples", &question.samples, "",
           "Positions at equal distances along the path or the locations, by the shortest way over "
           "ground")
      .at(kService)
      .like("10");
  ask::add_text(rows, "interpolation", "Accepted and without effect: a TIN is linear", "bilinear");
  rows.add("nodata_value", &question.nodata, "",
           "What stands for no elevation: null, nan or a number")
      .at(kService)
      .as_json()
      .like("null");
  rows.add("format", &question.format, "", "json or geojson")
      .of({"json", "geojson"})
      .at(kService)
      .like("json");
  // What others' clients, and libraries below them, put into every request.
  for (const char* name : {"key", "client", "signature", "channel", "solution_channel", "sensor",
                           "language", "region", "units", "_"}) {
    ask::add_text(rows, name, "Accepted and without effect");
  }
  rows.add("error", &question.error, "",
           "Certified error allowed, in metres; without it: full detail")
      .within(NumberRange::kNotNegative)
      .at(kService)
      .like("5");
}

struct LookupQuestion {
  std::optional<double> error;  ///< Metres.
};

void add_question(ask::Parameters& rows, LookupQuestion& question) {
  ask::add_text(rows, "locations",
                "lat,lng|lat,lng... or an encoded polyline; in the JSON of a POST an array of "
                "{latitude, longitude}",
                "34.34,-118.3|34.35,-118.29")
      .as_json();
  rows.add("error", &question.error, "",
           "Certified error allowed, in metres; without it: full detail")
      .within(NumberRange::kNotNegative)
      .at(ask::Door::kService)
      .like("5");
}

std::optional<double> finite_in(std::string_view text) {
  const std::optional<double> number = parse_number<double>(ask::trimmed(text));
  return number && std::isfinite(*number) ? number : std::nullopt;
}

/// A position of latitude and longitude, as MapPoint{longitude, latitude}.
/// @param text  As the client wrote it.
MapPoint place_at(std::optional<double> lat, std::optional<double> lng, std::string_view text) {
  if (!lat || !lng || std::abs(*lat) > 90 || std::abs(*lng) > 180) {
    throw Problem(400, "\"" + tools::shown(text) +
                           "\" is no position; expected latitude,longitude in degrees")
        .at("locations");
  }
  return {*lng, *lat};
}

MapPoint place_of(std::string_view text) {
  const std::size_t comma = text.find(',');
  return place_at(
      finite_in(text.substr(0, comma)),
      comma == std::string_view::npos ? std::nullopt : finite_in(text.substr(comma + 1)), text);
}

/// [latitude, longitude], {"lat", "lng"}, {"latitude", "longitude"} or "latitude,longitude".
MapPoint place_of(const nlohmann::json& json) {
  if (json.is_string()) return place_of(std::string_view(json.get_ref<const std::string&>()));
  const auto number = [](const nlohmann::json& value) {
    return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
  };
  const auto member = [&](const char* name) {
    return json.is_object() && json.contains(name) ? number(json.at(name)) : std::nullopt;
  };
  std::optional<double> lat = member("lat"), lng = member("lng");
  if (!lat) lat = member("latitude");
  if (!lng) lng = member("longitude");
  if (json.is_array() && json.size() == 2) lat = number(json[0]), lng = number(json[1]);
  return place_at(lat, lng, json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::vector<MapPoint> places_of(std::string_view text) {
  if (text.starts_with("enc:")) return decode_polyline(text.substr(4));
  if (text.find(',') == std::string_view::npos) return decode_polyline(text);
  std::vector<MapPoint> places;
  for (const std::string_view part : ask::parts_of(text, '|')) {
    if (!part.empty()) places.push_back(place_of(part));
  }
  return places;
}

/// The positions of a parameter: an array of JSON, or text. A text without a comma is an encoded polyline,
/// which may begin as an array does; what came as JSON never is one.
std::vector<MapPoint> given_places(const Question& question, const char* name) {
  const std::string& text = question.text(name);
  const bool is_text = !text.starts_with('[') || text.find(',') == std::string::npos;
  if (is_text && !question.is_json(name)) return places_of(text);
  std::vector<MapPoint> places;
  const nlohmann::json array = question.json(name);
  if (!array.is_array()) {
    throw Problem(400, "expected an array of positions, as [[34.34, -118.3]]").at(name);
  }
  for (const nlohmann::json& place : array) places.push_back(place_of(place));
  return places;
}

std::vector<MapPoint> asked_places(const Asked& asked, const ElevationQuestion& question) {
  const Question& q = asked.question;
  if (q.has("locations") == q.has("path")) {
    throw Problem(400, "give either locations or path, as latitude,longitude between |")
        .at("locations");
  }
  const std::vector<MapPoint> given = given_places(q, q.has("path") ? "path" : "locations");
  if (given.empty()) throw Problem(400, "no position is given").at("locations");
  check_count(given.size(), asked.options.question.points, "positions", "points", "locations");
  const std::optional<std::uint64_t>& samples = question.samples;
  if (!samples) return given;
  check_count(static_cast<std::size_t>(*samples), asked.options.question.points, "samples",
              "points", "samples");
  if (*samples < 2 || given.size() < 2) {
    throw Problem(400, "a path has two positions at least, and so have its samples").at("samples");
  }
  return along_geodesics(given, *samples);
}

/// What stands where there is no elevation.
Json nodata_of(const std::string& text) {
  std::string word;
  for (const char c : text) word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (word.empty() || word == "null" || word == "nan") return nullptr;  // JSON has no NaN.
  if (const std::optional<double> number = finite_in(text)) return *number;
  throw Problem(400, "\"" + text + "\" is neither null, nan nor a number").at("nodata_value");
}

struct Elevations {
  std::vector<LocatedPoint> points;
  std::vector<std::string> dataset;  ///< From which each point is.
  std::vector<double> metres;        ///< In a unit of its heights.
  QueryCost cost;
  double certified_error = 0.0;
  bool exact = true;
};

using Collections = std::vector<std::shared_ptr<const Collection>>;

/// The collections that the path names, with a slash behind them or without, all of them looked up
/// before the first one is asked.
Collections collections_of(const Asked& asked) {
  Collections collections;
  std::string_view names = asked.rest;
  if (names.ends_with('/')) names.remove_suffix(1);
  do {
    const std::size_t end = std::min(names.find(','), names.size());
    collections.push_back(asked.catalogue.find(std::string(names.substr(0, end))));
    names.remove_prefix(std::min(end + 1, names.size()));
    if (collections.back()) continue;
    throw Problem(404, "there is no collection of this name; /collections lists them").at("id");
  } while (!names.empty());
  return collections;
}

/// Metres between samples if they lay on a grid over the terrain's box: how fine a terrain is, also where
/// its grid is finer than its points.
double sample_distance(const Collection& c) {
  const Window& w = c.bounds;
  const auto unit = metres_per_map_unit(c.crs, {(w.min_x + w.max_x) / 2, (w.min_y + w.max_y) / 2});
  const auto samples = static_cast<double>(c.terrain.store().facts().source_samples);
  if (!unit || samples == 0) return std::numeric_limits<double>::infinity();
  return std::sqrt((w.max_x - w.min_x) * unit->x * (w.max_y - w.min_y) * unit->y / samples);
}

/// All collections that have a place on the Earth, the finest first; of equal ones by name.
Collections collections_by_detail(const Asked& asked) {
  std::vector<std::pair<double, std::shared_ptr<const Collection>>> ordered;
  for (auto& collection : asked.catalogue.all()) {  // By name.
    if (!collection->lon_lat) continue;
    const double distance = sample_distance(*collection);
    ordered.emplace_back(distance, std::move(collection));
  }
  if (ordered.empty()) {
    throw Problem(404,
                  "no terrain of this service states its CRS, so none has a known place on the "
                  "Earth; /collections lists them");
  }
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  Collections collections;
  for (auto& [distance, collection] : ordered) collections.push_back(std::move(collection));
  return collections;
}

/// Whether a position may lie in a collection.
bool may_hold(const Collection& collection, const MapPoint& lon_lat) {
  if (!collection.lon_lat) return true;
  const Window& w = *collection.lon_lat;
  if (lon_lat.y < w.min_y || lon_lat.y > w.max_y) return false;
  const bool is_east = lon_lat.x >= w.min_x, is_west = lon_lat.x <= w.max_x;
  return w.min_x <= w.max_x ? is_east && is_west : is_east || is_west;
}

/// @param error  Allowed, in metres.
LocateResult locate_in(const Collection& collection, const Asked& asked, std::vector<MapPoint> at,
                       std::optional<double> error) {
  const Places places(collection.crs, "CRS84", collection.bounds);
  places.to_terrain(at, "locations");
  LocateRequest request;
  if (error) request.detail.tolerance = *error / collection.ground.metres_per_height;
  request.limits = engine_limits(asked, at.size() * kAnswerBytesOfPlace);
  return collection.terrain.locate(at, request);
}

/// Asks the collections one after the other for what the ones before have no surface at.
Elevations elevations_of(const Asked& asked, const Collections& collections,
                         const std::vector<MapPoint>& lon_lat, std::optional<double> error) {
  Elevations found;
  found.points.resize(lon_lat.size());
  found.dataset.resize(lon_lat.size());
  found.metres.assign(lon_lat.size(), 1.0);
  std::vector<std::size_t> open(lon_lat.size());
  for (std::size_t i = 0; i < open.size(); ++i) open[i] = i;
  for (const auto& collection : collections) {
    // The others are outside: the extent holds all of the terrain.
    const auto far = std::stable_partition(
        open.begin(), open.end(), [&](std::size_t i) { return may_hold(*collection, lon_lat[i]); });
    for (const std::size_t i : open) {
      if (found.dataset[i].empty()) found.dataset[i] = collection->id;
    }
    if (far == open.begin()) continue;
    std::vector<std::size_t> still_open(far, open.end());
    open.erase(far, open.end());
    std::vector<MapPoint> at;
    for (const std::size_t i : open) at.push_back(lon_lat[i]);
    const LocateResult result = locate_in(*collection, asked, std::move(at), error);
    found.cost.add_counts(result.cost);
    found.cost.seconds += result.cost.seconds;
    found.exact = found.exact && result.exact;
    const double metres = collection->ground.metres_per_height;
    found.certified_error = std::max(found.certified_error, result.certified_error * metres);
    for (std::size_t i = 0; i < open.size(); ++i) {
      const LocatedPoint& p = result.points[i];
      if (p.state != PointState::kOutside) {
        found.points[open[i]] = p;
        found.dataset[open[i]] = collection->id;
        found.metres[open[i]] = metres;
      }
      if (p.state != PointState::kSurface) still_open.push_back(open[i]);
    }
    open = std::move(still_open);
  }
  return found;
}

/// What is told of a located point, with heights in metres under the names of others' services.
Json result_json(const Elevations& found, const ask::Fields<ask::LocatedRow>& fields,
                 const std::vector<MapPoint>& lon_lat, std::size_t i, const Json& nodata) {
  constexpr std::string_view kHeight = "height", kElevation = "elevation";
  const ask::LocatedRow row(lon_lat[i], found.points[i], {});
  Json result = {{"elevation", nodata},
                 {"location", {{"lat", lon_lat[i].y}, {"lng", lon_lat[i].x}}},
                 {"dataset", found.dataset[i]}};
  for (const ask::Field& field : fields) {
    std::string name = field.name;
    Json value = field.value(&row);
    if (name.starts_with(kHeight)) {
      name.replace(0, kHeight.size(), kElevation);
      if (row.point.state == PointState::kSurface) {
        value = value.get<double>() * found.metres[i];
      } else {
        value = name == kElevation ? nodata : Json();
      }
    }
    result[name] = std::move(value);
  }
  return result;
}

Json feature_json(Json result) {
  const Json location = result["location"];
  Json position = {location["lng"], location["lat"]};
  if (!result["elevation"].is_null()) position.push_back(result["elevation"]);
  result.erase("location");
  return {{"type", "Feature"},
          {"geometry", {{"type", "Point"}, {"coordinates", std::move(position)}}},
          {"properties", std::move(result)}};
}

/// As Google's Elevation API and opentopodata.
http::Response elevation_answer(const Asked& asked, const Collections& collections) {
  const auto question = read<ElevationQuestion>(asked);
  const bool as_features = question.format == "geojson";
  const std::vector<MapPoint> lon_lat = asked_places(asked, question);
  const Json nodata = nodata_of(question.nodata);
  const Elevations found = elevations_of(asked, collections, lon_lat, question.error);
  const auto fields = ask::located_fields().told(kFeature);
  Json results = Json::array();
  for (std::size_t i = 0; i < lon_lat.size(); ++i) {
    Json result = result_json(found, fields, lon_lat, i, nodata);
    results.push_back(as_features ? feature_json(std::move(result)) : std::move(result));
  }
  const Json certainty = {{"certified_error", found.certified_error},  // In metres, as all here.
                          {"exact", found.exact}};
  Json json = {{"results", std::move(results)}, {"status", "OK"}};
  if (as_features) {
    json = {{"type", "FeatureCollection"}, {"features", std::move(json["results"])}};
    json["ptin:certainty"] = certainty;
  } else {
    json.update(certainty);
  }
  return answered(asked, text_of(json), as_features ? kGeoJson : kJson, found.cost,
                  found.certified_error, found.exact);
}

}  // namespace

ask::Parameters elevation_parameters() { return described<ElevationQuestion>(); }

ask::Parameters lookup_parameters() { return described<LookupQuestion>(); }

http::Response answer_elevation(const Asked& asked) {
  return elevation_answer(asked, collections_of(asked));
}

http::Response answer_google_elevation(const Asked& asked) {
  return elevation_answer(asked, collections_by_detail(asked));
}

/// Where there is no elevation it is null, and not 0 as at open-elevation, which nobody can tell from
/// the sea.
http::Response answer_lookup(const Asked& asked) {
  const auto question = read<LookupQuestion>(asked);
  const std::vector<MapPoint> lon_lat = asked_places(asked, {});
  const Elevations found =
      elevations_of(asked, collections_by_detail(asked), lon_lat, question.error);
  Json results = Json::array();
  for (std::size_t i = 0; i < lon_lat.size(); ++i) {
    const LocatedPoint& p = found.points[i];
    const bool is_surface = p.state == PointState::kSurface;
    results.push_back({{"latitude", lon_lat[i].y},
                       {"longitude", lon_lat[i].x},
                       {"elevation", is_surface ? Json(p.height * found.metres[i]) : Json()},
                       {"state", tools::name_of(p.state)},
                       {"dataset", is_surface ? Json(found.dataset[i]) : Json()}});
  }
  return answered(asked, text_of({{"results", std::move(results)}}), kJson, found.cost,
                  found.certified_error, found.exact);
}

void refuse_elevation(http::Response& refusal) {
  const Json problem = Json::parse(refusal.body);
  const bool is_denied = refusal.status == 401 || refusal.status == 403;
  const bool is_overload = refusal.status == 429 || refusal.status == 503;
  Json json = {{"error", problem["detail"]},
               {"error_message", problem["detail"]},
               {"results", Json::array()},
               {"status", is_denied               ? "REQUEST_DENIED"
                          : is_overload           ? "OVER_QUERY_LIMIT"
                          : refusal.status >= 500 ? "UNKNOWN_ERROR"
                                                  : "INVALID_REQUEST"}};
  for (const char* name : {"parameter", "limit"}) {
    if (problem.contains(name)) json[name] = problem[name];
  }
  refusal.content_type = kJson;
  refusal.body = json.dump() + "\n";
}

}  // namespace ptin::serve
