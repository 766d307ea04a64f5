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

Json schema_of(const ParameterFact& fact) {
  if (fact.type != "array") return {{"type", fact.type}};
  return {{"type", "string"}, {"description", "numbers between commas, or JSON"}};
}

/// The example as a value of the parameter's type.
Json example_of(const ParameterFact& fact) {
  const bool is_text = fact.type == "string" || fact.type == "array";
  return is_text ? Json(fact.example) : Json::parse(fact.example);
}

Json parameter_json(const ParameterFact& fact) {
  Json json = {{"name", fact.name},
               {"in", "query"},
               {"required", fact.is_required},
               {"description", fact.about},
               {"schema", schema_of(fact)}};
  if (!fact.example.empty()) json["example"] = example_of(fact);
  return json;
}

/// Responses: 200 in each of its types, and problems.
Json responses_of(const Endpoint& endpoint) {
  Json content = Json::object();
  std::string_view media = endpoint.media;
  while (!media.empty()) {
    const std::size_t end = std::min(media.find(' '), media.size());
    content[std::string(media.substr(0, end))] = Json::object();
    media.remove_prefix(std::min(end + 1, media.size()));
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
  for (const ParameterFact& fact : endpoint.parameters) {
    Json property = {{"description", fact.about}};
    // An array may be one of JSON too, or text: no one type says so.
    if (fact.type != "array") property["type"] = fact.type;
    if (!fact.example.empty()) property["example"] = example_of(fact);
    schema["properties"][std::string(fact.name)] = std::move(property);
    if (fact.is_required) schema["required"].push_back(fact.name);
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
    for (const ParameterFact& fact : endpoint.parameters) {
      operation["parameters"].push_back(parameter_json(fact));
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

http::Response answer_api(const Asked& asked) {
  static constexpr auto kFormats =
      std::to_array<OfferedFormat>({{"json", "application/vnd.oai.openapi+json;version=3.0"}});
  const OfferedFormat& format = format_of(asked, kFormats);
  Json paths = Json::object();
  for (const Endpoint& endpoint : endpoints()) {
    std::string path(endpoint.path);
    if (path.ends_with('*')) path.replace(path.size() - 1, 1, "{path}");
    paths[path]["get"] = operation_of(endpoint, false);
    if (endpoint.takes_post) paths[path]["post"] = operation_of(endpoint, true);
  }
  Json security = Json::array();
  Json components = {
      {"responses", {{"Problem", problem_response()}, {"Refusal", refusal_response()}}}};
  if (!asked.options.token.empty()) {
    security.push_back({{"bearer", Json::array()}});
    components["securitySchemes"] = {{"bearer", {{"type", "http"}, {"scheme", "bearer"}}}};
  }
  return json_response(
      {{"openapi", "3.0.3"},
       {"info",
        {{"title", "Terrains"},
         {"version", asked.options.version},
         {"license",
          {{"name", "GPL-3.0-or-later"}, {"url", "https://www.gnu.org/licenses/gpl-3.0.html"}}}}},
       {"servers", Json::array({{{"url", "/"}}})},
       {"security", std::move(security)},
       {"paths", std::move(paths)},
       {"components", std::move(components)}},
      format.media);
}

}  // namespace ptin::serve
