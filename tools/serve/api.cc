// SPDX-License-Identifier: GPL-3.0-or-later
//
// The service as OpenAPI 3.0, made from the table of its questions.
#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

Json type_of(const ask::Parameter& row) {
  if (ask::is_flag(row)) return {{"type", "boolean"}};
  if (ask::is_text(row)) {
    Json schema = {{"type", "string"}};
    for (const std::string_view choice : row.choices) schema["enum"].push_back(choice);
    return schema;
  }
  const NumberRange range = ask::range_at(row, ask::Door::kService);
  const bool is_whole = ask::is_whole(row);
  const double least = is_whole ? std::max(0.0, range.least) : range.least;
  Json number = {{"type", is_whole ? "integer" : "number"}};
  if (least > NumberRange::kFinite.least) number["minimum"] = least;
  if (range.is_above) number["exclusiveMinimum"] = true;
  if (range.most < NumberRange::kFinite.most) number["maximum"] = range.most;
  if (!ask::is_list(row)) return number;
  Json schema = {{"type", "array"}, {"items", std::move(number)}, {"minItems", row.least_values}};
  if (row.most_values != ask::kAnyNumberOfValues) schema["maxItems"] = row.most_values;
  return schema;
}

/// A value of the parameter's type.
Json json_value(const ask::Parameter& row, std::string text) {
  if (ask::is_list(row)) return Json::parse("[" + text + "]");
  return ask::is_text(row) ? Json(std::move(text)) : Json::parse(text);
}

Json schema_of(const ask::Parameter& row) {
  Json schema = type_of(row);
  if (!row.default_value.empty()) schema["default"] = json_value(row, row.default_value);
  return schema;
}

void add_help(Json& json, const ask::Parameter& row) {
  json["description"] = ask::help_at(row, ask::Door::kService);
  if (!row.example.empty()) json["example"] = json_value(row, std::string(row.example));
}

Json parameter_json(const ask::Parameter& row) {
  Json json = {{"name", row.name},
               {"in", "query"},
               {"required", is_at(row.required, ask::Door::kService)},
               {"schema", schema_of(row)}};
  if (ask::is_list(row)) json["explode"] = false;  // Values stand between commas.
  add_help(json, row);
  return json;
}

/// The type of a field as documents say it: "number or null", "array of strings".
Json schema_of(const ask::Field& facts) {
  const std::string type(facts.type.substr(0, facts.type.find(' ')));
  Json schema = {{"type", type}, {"description", facts.meaning}};
  if (!facts.unit.empty()) {
    schema["description"] = std::string(facts.meaning) + " In " + std::string(facts.unit) + ".";
  }
  if (facts.type.ends_with("or null")) schema["nullable"] = true;
  if (type != "array") return schema;
  schema["items"] = Json::object();
  if (const std::size_t of = facts.type.find("of "); of != std::string_view::npos) {
    std::string item(facts.type.substr(of + 3));
    item.pop_back();  // "strings"
    schema["items"]["type"] = item;
  }
  return schema;
}

/// The schema of `a.b`, or of `a[].b`, within that of an object.
Json& place_of(Json& object, std::string_view name) {
  object["type"] = "object";
  const std::size_t point = name.find('.');
  std::string_view first = name.substr(0, point);
  const bool is_array = first.ends_with("[]");
  if (is_array) first.remove_suffix(2);
  Json* place = &object["properties"][std::string(first)];
  if (is_array) {
    (*place)["type"] = "array";
    place = &(*place)["items"];
  }
  return point == std::string_view::npos ? *place : place_of(*place, name.substr(point + 1));
}

Json schema_of(std::span<const ask::Field> fields) {
  Json schema = {{"type", "object"}};
  for (const ask::Field& facts : fields) place_of(schema, facts.name).update(schema_of(facts));
  return schema;
}

/// The schema of an answer; empty: only the type of its body is told.
Json schema_of_answer(const Endpoint& endpoint, std::string_view media) {
  const bool is_collection = media == kGeoJson;
  if ((endpoint.members.empty() && endpoint.properties.empty()) ||
      (!is_collection && media != kJson)) {
    return Json::object();
  }
  const bool has_object =
      std::any_of(endpoint.formats.begin(), endpoint.formats.end(),
                  [](const ask::Format& format) { return format.media == kJson; });
  Json schema = {{"type", "object"}};
  if (!is_collection || !has_object) schema = schema_of(endpoint.members);
  const Json certainty = schema_of(ask::answer_fields().told(Told::kService & Told::kDocument));
  if (!is_collection) {
    schema["properties"].update(certainty["properties"]);
    return schema;
  }
  schema["properties"]["ptin:certainty"] = certainty;
  schema["properties"]["type"] = {{"type", "string"}, {"enum", {"FeatureCollection"}}};
  Json feature = {{"type", "object"}};
  feature["properties"] = {{"type", {{"type", "string"}}},
                           {"geometry", {{"type", "object"}}},
                           {"properties", schema_of(endpoint.properties)}};
  schema["properties"]["features"] = {{"type", "array"}, {"items", std::move(feature)}};
  return schema;
}

/// Responses: 200 in each of its types, and problems.
Json responses_of(const Endpoint& endpoint) {
  Json content = Json::object();
  for (const ask::Format& format : endpoint.formats) {
    const std::string_view media = format.media.substr(0, format.media.find("; charset"));
    Json& of_media = content[std::string(media)] = Json::object();
    if (Json schema = schema_of_answer(endpoint, media); !schema.empty()) {
      of_media["schema"] = std::move(schema);
    }
  }
  Json responses = {{"200", {{"description", endpoint.about}, {"content", std::move(content)}}},
                    {"4XX", {{"$ref", "#/components/responses/Problem"}}}};
  if (endpoint.refusal != nullptr) {
    responses["4XX"] = responses["5XX"] = {{"$ref", "#/components/responses/Refusal"}};
  }
  responses["default"] = {{"$ref", "#/components/responses/Problem"}};
  return responses;
}

/// The parameters as members of an object, or as fields of a form.
Json body_of(const Endpoint& endpoint) {
  Json schema = {{"type", "object"}, {"properties", Json::object()}};
  for (const ask::Parameter& row : endpoint.parameters) {
    // A value of JSON may be text, too: no one type says so.
    Json property = row.is_json ? Json::object() : schema_of(row);
    add_help(property, row);
    schema["properties"][std::string(row.name)] = std::move(property);
    if (is_at(row.required, ask::Door::kService)) schema["required"].push_back(row.name);
  }
  return {{"content",
           {{"application/json", {{"schema", schema}}},
            {"application/x-www-form-urlencoded", {{"schema", schema}}}}}};
}

Json operation_of(const Endpoint& endpoint, bool is_post) {
  Json operation = {
      {"operationId", std::string(is_post ? "post_" : "get_") + std::string(endpoint.name)},
      {"summary", endpoint.about},
      {"parameters", Json::array()},
      {"responses", responses_of(endpoint)}};
  for (const auto& [mark, name] : {std::pair{"{id}", "id"}, {"*", "path"}}) {
    if (endpoint.path.find(mark) == std::string_view::npos) continue;
    operation["parameters"].push_back(
        {{"name", name}, {"in", "path"}, {"required", true}, {"schema", {{"type", "string"}}}});
  }
  if (!is_post) {
    for (const ask::Parameter& row : endpoint.parameters) {
      operation["parameters"].push_back(parameter_json(row));
    }
    return operation;
  }
  operation["requestBody"] = body_of(endpoint);
  return operation;
}

Json problem_response() {
  return {{"description", "RFC 9457: what is wrong, and at which parameter"},
          {"content",
           {{"application/problem+json",
             {{"schema",
               {{"type", "object"},
                {"required", {"title", "status", "detail"}},
                {"properties",
                 {{"type", {{"type", "string"}}},
                  {"title", {{"type", "string"}}},
                  {"status", {{"type", "integer"}}},
                  {"detail", {{"type", "string"}}},
                  {"parameter", {{"type", "string"}}},
                  {"limit", {{"type", "string"}}}}}}}}}}}};
}

/// The refusals of `/v1`.
Json refusal_response() {
  return {{"description", "what is wrong, as Google's Elevation API tells it"},
          {"content",
           {{"application/json",
             {{"schema",
               {{"type", "object"},
                {"required", {"status", "error_message", "results"}},
                {"properties",
                 {{"status",
                   {{"type", "string"},
                    {"enum",
                     {"INVALID_REQUEST", "REQUEST_DENIED", "OVER_QUERY_LIMIT", "UNKNOWN_ERROR"}}}},
                  {"error_message", {{"type", "string"}}},
                  {"error", {{"type", "string"}}},
                  {"results", {{"type", "array"}, {"items", Json::object()}}},
                  {"parameter", {{"type", "string"}}},
                  {"limit", {{"type", "string"}}}}}}}}}}}};
}

}  // namespace

Json openapi(std::span<const Endpoint> all, const ServeOptions& options, const std::string& base) {
  Json paths = Json::object();
  for (const Endpoint& endpoint : all) {
    std::string path(endpoint.path);
    if (path.ends_with('*')) path.replace(path.size() - 1, 1, "{path}");
    paths[path]["get"] = operation_of(endpoint, false);
    if (endpoint.takes_post) paths[path]["post"] = operation_of(endpoint, true);
  }
  Json security = Json::array();
  Json components = {
      {"responses", {{"Problem", problem_response()}, {"Refusal", refusal_response()}}}};
  if (!options.token.empty()) {
    security.push_back({{"bearer", Json::array()}});
    components["securitySchemes"] = {{"bearer", {{"type", "http"}, {"scheme", "bearer"}}}};
  }
  return {
      {"openapi", "3.0.3"},
      {"info",
       {{"title", "Terrains"},
        {"version", options.version},
        {"license",
         {{"name", "GPL-3.0-or-later"}, {"url", "https://www.gnu.org/licenses/gpl-3.0.html"}}}}},
      {"servers", Json::array({{{"url", base.empty() ? "/" : base}}})},
      {"security", std::move(security)},
      {"paths", std::move(paths)},
      {"components", std::move(components)}};
}

http::Response answer_api(const Asked& asked) {
  return json_response(openapi(endpoints(), asked.options, asked.request.base),
                       format_of(asked).media);
}

}  // namespace ptin::serve
