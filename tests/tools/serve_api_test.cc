// SPDX-License-Identifier: GPL-3.0-or-later
//
// The description as OpenAPI, and that the service does what it says.
#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

TEST_F(Serve, DescribesItselfAsOpenApi) {
  const json api = get("/api").json();
  EXPECT_EQ(api["openapi"], "3.0.3");
  std::set<std::string> ids;
  std::size_t operations = 0;
  for (const auto& [path, methods] : api["paths"].items()) {
    for (const auto& [method, operation] : methods.items()) {
      SCOPED_TRACE(method + " " + path);
      ++operations;
      ids.insert(operation["operationId"].get<std::string>());
      EXPECT_TRUE(operation["responses"].contains("200"));
      EXPECT_TRUE(operation["responses"].contains("4XX"));
      EXPECT_EQ(operation["responses"]["default"]["$ref"], "#/components/responses/Problem");
      std::string in_path;
      std::set<std::string> names;
      for (const json& parameter : operation["parameters"]) {
        const std::string type = parameter["schema"]["type"];
        if (parameter.contains("example")) {
          const json& example = parameter["example"];
          EXPECT_TRUE(type == "integer"   ? example.is_number_integer()
                      : type == "number"  ? example.is_number()
                      : type == "boolean" ? example.is_boolean()
                      : type == "array"   ? example.is_array()
                                          : example.is_string())
              << parameter;
        }
        EXPECT_TRUE(names
                        .insert(parameter["in"].get<std::string>() + " " +
                                parameter["name"].get<std::string>())
                        .second);
        if (parameter["in"] == "path") in_path += "{" + parameter["name"].get<std::string>() + "}";
      }
      std::string braces;
      for (std::size_t at = 0; (at = path.find('{', at)) != std::string::npos; ++at) {
        braces += path.substr(at, path.find('}', at) + 1 - at);
      }
      EXPECT_EQ(in_path, braces);
    }
  }
  EXPECT_EQ(ids.size(), operations);
  EXPECT_TRUE(api["components"]["responses"]["Problem"].contains("content"));
  EXPECT_EQ(api["paths"]["/v1/{path}"]["get"]["responses"]["4XX"]["$ref"],
            "#/components/responses/Refusal");
  EXPECT_TRUE(api["components"]["responses"]["Refusal"]["content"].contains("application/json"));
  EXPECT_TRUE(api["paths"].contains("/collections/{id}/position"));
  EXPECT_TRUE(api["paths"]["/collections/{id}/sight"]["post"]["requestBody"]["content"].contains(
      "application/x-www-form-urlencoded"));
  // A number in hertz, or text with a unit.
  const json& of_sight = api["paths"]["/collections/{id}/sight"]["post"]["requestBody"]["content"];
  EXPECT_FALSE(of_sight["application/json"]["schema"]["properties"]["frequency"].contains("type"));
  // A number, or text: nan.
  const json& of_elevation = api["paths"]["/v1/{path}"]["post"]["requestBody"]["content"];
  EXPECT_FALSE(
      of_elevation["application/json"]["schema"]["properties"]["nodata_value"].contains("type"));
  EXPECT_FALSE(api["servers"].empty());
  EXPECT_EQ(api["security"], json::array());  // This service wants no token.
  EXPECT_FALSE(api["components"].contains("securitySchemes"));
}

TEST(ServeToken, IsPartOfTheDescription) {
  TestFolder folder;
  serve::ServeOptions options = serve_options(folder);
  options.token = "secret";
  ServedTerrains served(options);
  const json api = served.get("/api", "Authorization: Bearer secret\r\n").json();
  EXPECT_EQ(api["security"], json::array({{{"bearer", json::array()}}}));
  EXPECT_EQ(api["components"]["securitySchemes"]["bearer"]["type"], "http");
}

/// Path, query of all examples but for `f`, and the media of the answer to a GET.
struct ListedQuestion {
  std::string target;
  json content;
};

std::vector<ListedQuestion> listed_questions(const json& api) {
  std::vector<ListedQuestion> all;
  for (const auto& [path, methods] : api["paths"].items()) {
    if (path.find("{path}") != std::string::npos && path != "/v1/{path}") continue;  // Tiles.
    std::string target = path;
    for (const std::string mark : {"{id}", "{path}"}) {
      const std::size_t at = target.find(mark);
      if (at != std::string::npos) target.replace(at, mark.size(), "mountains");
    }
    char before = '?';
    for (const json& parameter : methods["get"]["parameters"]) {
      if (parameter["in"] != "query" || !parameter.contains("example")) continue;
      const bool is_alternative =
          parameter["description"].get<std::string>().find("instead of") != std::string::npos;
      if (parameter["name"] == "f" || is_alternative) continue;
      const json& value = parameter["example"];
      target += before + parameter["name"].get<std::string>() + "=" +
                encoded(value.is_string() ? value.get<std::string>() : value.dump());
      before = '&';
    }
    all.push_back({target, methods["get"]["responses"]["200"]["content"]});
  }
  return all;
}

TEST_F(Serve, AnswersItsExamplesInTheMediaThatItLists) {
  const std::vector<ListedQuestion> all = listed_questions(get("/api").json());
  EXPECT_GE(all.size(), 15U);
  for (const ListedQuestion& question : all) {
    for (const auto& [media, unused] : question.content.items()) {
      const bool is_features_of_v1 =  // Others' clients ask for them by `format`.
          (question.target.starts_with("/v1") || question.target.starts_with("/maps/")) &&
          media == "application/geo+json";
      if (is_features_of_v1) continue;
      SCOPED_TRACE(question.target + " as " + media);
      const HttpAnswer answer = get(question.target, "Accept: " + media + "\r\n");
      EXPECT_EQ(answer.status, 200) << answer.body;
      EXPECT_TRUE(answer.header("content-type").starts_with(media))
          << answer.header("content-type");
    }
  }
}

}  // namespace
}  // namespace ptin::tools::testing
