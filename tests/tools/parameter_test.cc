// SPDX-License-Identifier: GPL-3.0-or-later
//
// A question is written once: a row that is added to it appears wherever questions are read, and a
// value that is none is refused in the same words at both doors.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "tests/tools/program.h"
#include "tools/ask/field.h"
#include "tools/ask/groups.h"
#include "tools/http/problem.h"
#include "tools/ptin/command_line.h"
#include "tools/ptin/man_page.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"

namespace ptin::tools {
namespace {

/// A question that there is not, with each kind of parameter.
struct Smoothing {
  std::optional<double> error, reach;
  std::uint64_t rounds = 3;
  std::string kernel = "cubic";
  std::vector<double> weights;
  bool is_slow = false;
};

void add_question(ask::Parameters& rows, Smoothing& smoothing) {
  ask::add_error(rows, smoothing.error, "Certified error allowed");
  rows.add("reach", &smoothing.reach, "R", "How far to smooth")
      .in(ask::Unit::kGround)
      .within(NumberRange::kPositive)
      .excluding("error")
      .like("50");
  rows.add("rounds", &smoothing.rounds, "N", "How often")
      .within({.least = 1, .most = 9})
      .with_default()
      .like("2");
  rows.add("kernel", &smoothing.kernel, "NAME", "Which kernel")
      .spelled("-K,--kernel")
      .of({"cubic", "linear"})
      .like("linear");
  rows.add("weights", &smoothing.weights, "W...", "Its weights")
      .within(NumberRange::kNotNegative)
      .values(2, 4)
      .needing("kernel")
      .like("1,2");
  rows.add("slow", &smoothing.is_slow, "", "Take time").like("true");
}

ask::Parameters parameters_of(Smoothing& smoothing) { return serve::rows_of(smoothing); }

Smoothing& last_asked() {
  static Smoothing smoothing;
  return smoothing;
}

Declared declare_smooth(Context&) {
  last_asked() = {};
  return {parameters_of(last_asked()), [] { return 0; }};
}

const std::vector<Command>& smooth_alone() {
  static const std::vector<Command> all = {
      {"smooth", "Smooth a terrain", "Example:\n  ptin smooth\n", declare_smooth}};
  return all;
}

/// Why words mean nothing; empty: they do.
std::string fault_of(std::vector<std::string> words) {
  Context context;
  words.insert(words.begin(), "smooth");
  return parse_words(words, context, smooth_alone()).fault;
}

/// What `ptin smooth --help` prints.
std::string help_of_smooth() {
  Context context;
  ::testing::internal::CaptureStdout();
  const ParsedWords parsed = parse_words({"smooth", "--help"}, context, smooth_alone());
  EXPECT_EQ(parsed.status, 0);
  return ::testing::internal::GetCapturedStdout();
}

struct Refused {
  std::string detail, parameter;
};
/// The refusal of a request; its parameters are name, value, name, value.
Refused refusal_of(const std::vector<std::pair<std::string, std::string>>& parameters) {
  http::Request request;
  request.method = "GET";
  request.parameters = {parameters.begin(), parameters.end()};
  Smoothing smoothing;
  const ask::Parameters rows = parameters_of(smoothing);
  try {
    serve::Question(request, rows).read(rows);
    return {};
  } catch (const http::Problem& problem) {
    return {problem.detail(), problem.parameter()};
  }
}

TEST(Parameter, IsReadAtBothDoors) {
  EXPECT_EQ(fault_of({"--reach", "5m", "--rounds", "4", "-K", "LINEAR", "--weights", "1", "2.5",
                      "--slow"}),
            "");
  EXPECT_EQ(last_asked().reach, 5.0);
  EXPECT_EQ(last_asked().rounds, 4U);
  EXPECT_EQ(last_asked().kernel, "linear");
  EXPECT_EQ(last_asked().weights, (std::vector<double>{1, 2.5}));
  EXPECT_TRUE(last_asked().is_slow);

  http::Request request;
  request.method = "POST";
  request.headers = {{"content-type", "application/json"}};
  request.body =
      R"({"reach": 5, "rounds": 4, "kernel": "linear", "weights": [1, 2.5], "slow": true})";
  Smoothing smoothing;
  const ask::Parameters rows = parameters_of(smoothing);
  serve::Question(request, rows).read(rows);
  EXPECT_EQ(smoothing.reach, 5.0);
  EXPECT_EQ(smoothing.rounds, 4U);
  EXPECT_EQ(smoothing.kernel, "linear");
  EXPECT_EQ(smoothing.weights, (std::vector<double>{1, 2.5}));
  EXPECT_TRUE(smoothing.is_slow);
}

TEST(Parameter, IsToldByHelpManualCompletionAndOpenApi) {
  const std::string help = help_of_smooth();
  const std::string manual = man_page(smooth_alone()), script = bash_script(smooth_alone());
  const std::vector<serve::Endpoint> endpoints = {{"/smooth",
                                                   "smooth",
                                                   true,
                                                   "A smoothed terrain",
                                                   serve::described<Smoothing>(),
                                                   {},
                                                   http::Lane::kPoint,
                                                   serve::Reserves::kNothing,
                                                   nullptr}};
  const nlohmann::json operation = serve::openapi(endpoints, {})["paths"]["/smooth"]["get"];
  for (const std::string name : {"error", "reach", "rounds", "kernel", "weights", "slow"}) {
    SCOPED_TRACE(name);
    EXPECT_NE(help.find("--" + name), std::string::npos) << help;
    EXPECT_NE(manual.find("\\-\\-" + name), std::string::npos);
    EXPECT_NE(script.find(" --" + name), std::string::npos);
    const auto& all = operation["parameters"];
    EXPECT_EQ(
        std::count_if(all.begin(), all.end(), [&](const auto& p) { return p["name"] == name; }), 1);
  }
  const auto schema = [&](std::size_t i) { return operation["parameters"][i]["schema"]; };
  EXPECT_EQ(schema(1),
            nlohmann::json::parse(R"({"type":"number","minimum":0.0,"exclusiveMinimum":true})"));
  EXPECT_EQ(schema(2),
            nlohmann::json::parse(R"({"type":"integer","minimum":1.0,"maximum":9.0,"default":3})"));
  EXPECT_EQ(schema(3), nlohmann::json::parse(R"({"type":"string","enum":["cubic","linear"]})"));
  EXPECT_EQ(schema(4), nlohmann::json::parse(R"({"type":"array","minItems":2,"maxItems":4,
                                                 "items":{"type":"number","minimum":0.0}})"));
  EXPECT_EQ(operation["parameters"][4]["example"], nlohmann::json::parse("[1,2]"));
}

/// One sentence for both doors, which the command line has with two hyphens.
TEST(Parameter, IsRefusedInTheSameWords) {
  const struct {
    std::vector<std::string> words;
    std::vector<std::pair<std::string, std::string>> parameters;
    const char* sentence;
  } all[] = {
      {{"--rounds", "10"}, {{"rounds", "10"}}, "must be a whole number from 1 to 9; 10 is none"},
      {{"--rounds", "2.5"}, {{"rounds", "2.5"}}, "must be a whole number from 1 to 9; 2.5 is none"},
      {{"--kernel", "linaer"},
       {{"kernel", "linaer"}},
       "linaer is none of cubic, linear; did you mean linear?"},
      {{"--kernel", "cubic", "--weights", "1", "-1"},
       {{"kernel", "cubic"}, {"weights", "1,-1"}},
       "must be a finite number >= 0; -1 is none"},
  };
  for (const auto& one : all) {
    SCOPED_TRACE(one.sentence);
    const std::string name = one.parameters.back().first;
    EXPECT_EQ(fault_of(one.words), "--" + name + ": " + one.sentence);
    const Refused refused = refusal_of(one.parameters);
    EXPECT_EQ(refused.detail, name + ": " + one.sentence);
    EXPECT_EQ(refused.parameter, name);
  }
  EXPECT_EQ(fault_of({"--error", "1", "--reach", "2"}),
            "--reach: excludes --error; give one of them");
  EXPECT_EQ(refusal_of({{"error", "1"}, {"reach", "2"}}).detail,
            "reach: excludes error; give one of them");
  EXPECT_EQ(fault_of({"--weights", "1", "2"}), "--weights: needs --kernel; give both");
  EXPECT_EQ(refusal_of({{"weights", "1,2"}}).parameter, "weights");
  EXPECT_EQ(refusal_of({{"weights", "1"}, {"kernel", "cubic"}}).parameter, "weights");
  EXPECT_EQ(refusal_of({{"error", "inf"}}).parameter, "error");
}

/// What HTTP always answered stays answered where the command line is stricter.
TEST(Parameter, MayTakeMoreOverHttp) {
  const auto refusal = [](ask::Door door, const std::string& bend, bool is_flat) -> std::string {
    double value = 0.0;
    bool flat = false;
    const ask::Parameters rows = {{.name = "flat", .into = &flat},
                                  {.name = "bend",
                                   .into = &value,
                                   .range = {.least = 0, .most = 1},
                                   .range_over_http = NumberRange::kNotNegative,
                                   .excludes = "flat",
                                   .bound_at = ask::Door::kProgram}};
    ask::Reading reading(door);
    try {
      if (is_flat) reading.take(rows[0], std::vector<std::string>{"true"});
      reading.take(rows[1], std::vector<std::string>{bend});
      reading.check(rows);
    } catch (const Error& e) {
      return e.message();
    }
    return "";
  };
  EXPECT_EQ(refusal(ask::Door::kProgram, "1.5", false),
            "must be a number from 0 to 1; 1.5 is none");
  EXPECT_EQ(refusal(ask::Door::kProgram, "1", true), "excludes --flat; give one of them");
  EXPECT_EQ(refusal(ask::Door::kService, "1.5", true), "");
  EXPECT_EQ(refusal(ask::Door::kService, "-1", false), "must be a finite number >= 0; -1 is none");
}

/// An answer that there is not.
struct Hill {
  double height;
  std::string name;
  bool is_bald;
};

ask::Fields<Hill> hill_fields() {
  using ask::Told;
  ask::Fields<Hill> fields;
  fields.add("name", "string", "", "How it is called.", &Hill::name);
  fields.add("top.height", "number or null", "height's unit", "Of its top.", &Hill::height);
  fields.add("bald", "boolean", "", "Nothing grows on it.", Told::kProgram,
             [](const Hill& h) { return h.is_bald ? ask::Json(true) : ask::kLeftOut; });
  fields.add("note", "string", "", "For programs.", Told::kObject, [](const Hill&) { return "-"; });
  return fields;
}

TEST(Field, StandsInEveryFormatOfItsDoor) {
  const std::vector<Hill> hills = {{12.5, "Old, Man", true}, {std::nan(""), "x", false}};
  using ask::Told;
  const auto object = [&](const Hill& hill, Told door) {
    return hill_fields().told(door & Told::kObject).object_of(hill).dump();
  };
  EXPECT_EQ(object(hills[0], Told::kProgram),
            R"({"name":"Old, Man","top":{"height":12.5},"bald":true,"note":"-"})");
  EXPECT_EQ(object(hills[1], Told::kProgram), R"({"name":"x","top":{"height":null},"note":"-"})");
  EXPECT_EQ(object(hills[0], Told::kService),
            R"({"name":"Old, Man","top":{"height":12.5},"note":"-"})");
  ask::LongText csv;
  ask::add_csv(csv, hill_fields().told(Told::kProgram & Told::kTableRow), hills.size(),
               [&](std::size_t i) { return hills[i]; });
  EXPECT_EQ(csv.take(), "name,top_height,bald\n\"Old, Man\",12.5,1\nx,,\n");
  const auto feature = hill_fields().told(Told::kService & Told::kFeature);
  const auto layer = ask::layer_fields_of(feature);
  ASSERT_EQ(layer.size(), 2U);
  EXPECT_EQ(layer[1].name, "top_height");
  EXPECT_EQ(layer[1].type, VectorFile::FieldType::kReal);
  EXPECT_EQ(std::get<std::string>(ask::layer_values_of(feature.values_of(hills[0]))[0]),
            "Old, Man");
}

/// A part of a row is an object, which may be absent; several are an array of objects.
TEST(Field, HasParts) {
  struct Range {
    std::optional<Hill> highest;
    std::vector<Hill> all;
  };
  ask::Fields<Hill> hill;
  hill.add("height", "number", "", "", &Hill::height);
  ask::Fields<Range> fields;
  fields.add_object("highest", "object or null", "", hill, &Range::highest);
  fields.add_array("all", "", hill, &Range::all);
  const auto text = [&](const Range& range) {
    return fields.told(ask::Told::kProgram & ask::Told::kObject).object_of(range).dump();
  };
  EXPECT_EQ(text({}), R"({"highest":null,"all":[]})");
  EXPECT_EQ(text({Hill{3, "", false}, {{1, "", false}, {3, "", false}}}),
            R"({"highest":{"height":3.0},"all":[{"height":1.0},{"height":3.0}]})");
}

TEST(Field, IsInTheSchemaOfTheAnswer) {
  constexpr std::array kFormats = {ask::Format{"json", "application/json"},
                                   ask::Format{"geojson", "application/geo+json"}};
  serve::Endpoint endpoint{"/hills",
                           "hills",
                           false,
                           "Hills",
                           {},
                           kFormats,
                           http::Lane::kPoint,
                           serve::Reserves::kNothing,
                           nullptr};
  for (ask::Field field : hill_fields().told(ask::Told::kService & ask::Told::kDocument)) {
    field.name.insert(0, "all[].");
    endpoint.members.push_back(std::move(field));
  }
  const auto properties = hill_fields().told(ask::Told::kService & ask::Told::kFeature);
  endpoint.properties.assign(properties.begin(), properties.end());
  const std::vector<serve::Endpoint> all = {endpoint};
  const auto paths = serve::openapi(all, {})["paths"];
  const auto content = paths["/hills"]["get"]["responses"]["200"]["content"];
  const auto object = content["application/json"]["schema"]["properties"];
  const auto hill = object["all"]["items"]["properties"];
  EXPECT_EQ(hill["name"]["type"], "string");
  EXPECT_EQ(hill["top"]["properties"]["height"]["nullable"], true);
  EXPECT_FALSE(hill.contains("bald"));
  EXPECT_EQ(object["certified_error"]["type"], "number");
  const auto collection = content["application/geo+json"]["schema"]["properties"];
  EXPECT_TRUE(collection["ptin:certainty"]["properties"].contains("exact"));
  EXPECT_TRUE(
      collection["features"]["items"]["properties"]["properties"]["properties"].contains("name"));
}

}  // namespace
}  // namespace ptin::tools
