// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/coverage.h"

#include <algorithm>
#include <utility>

#include "engine/error.h"
#include "tools/ask/questions.h"
#include "tools/facts/human.h"

namespace ptin::serve {

namespace {

struct StateName {
  const char* id;  ///< As `state` of other formats has it.
  const char* label;
};
constexpr std::array kStates = {StateName{"surface", "surface"}, StateName{"void", "void"},
                                StateName{"outside", "outside of the terrain"},
                                StateName{"outside of the polygon", "outside of the polygon"}};
constexpr std::array<std::string_view, 4> kNames = {"height", "height_min", "height_max", "state"};

/// @throws Error invalid_argument  another name
CoverageNames names_in(std::string_view given) {
  CoverageNames names;
  for (const std::string_view part : ask::parts_of(given, ',')) {
    const std::string_view name = ask::trimmed(part);
    const auto* const known = std::find(kNames.begin(), kNames.end(), name);
    if (known == kNames.end()) {
      refuse("\"" + tools::shown(name) +
             "\" is no parameter of this coverage; it has height, height_min, height_max, state");
    }
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(*known);
  }
  return names;
}

Json number_parameter(const char* what, const std::string& unit) {
  return {{"type", "Parameter"},
          {"unit", {{"label", {{"en", unit}}}}},
          {"observedProperty", {{"label", {{"en", what}}}}}};
}

Json state_parameter() {
  Json property = {{"label", {{"en", "what the position is on"}}}, {"categories", Json::array()}};
  Json encoding = Json::object();
  for (std::size_t i = 0; i < kStates.size(); ++i) {
    property["categories"].push_back(
        {{"id", kStates[i].id}, {"label", {{"en", kStates[i].label}}}});
    encoding[kStates[i].id] = i;
  }
  return {{"type", "Parameter"},
          {"observedProperty", std::move(property)},
          {"categoryEncoding", std::move(encoding)}};
}

/// The object "referencing" of positions in the CRS of `places`: its axes in the order of the
/// authority, whatever order the numbers of the domain have.
Json referencing_json(const Places& places) {
  Json system = {{"type", places.is_geographic() ? "GeographicCRS" : "ProjectedCRS"}};
  if (!places.uri().empty()) system["id"] = places.uri();
  Json axes = {"x", "y"};
  if (places.is_north_first()) axes = {"y", "x"};
  return Json::array({{{"coordinates", std::move(axes)}, {"system", std::move(system)}}});
}

void add_domain(LongText& text, const Coverage& coverage, const Places& places) {
  text.add(R"({"type":"Domain","domainType":)");
  if (coverage.positions.empty()) {
    text.add(R"("Grid","axes":)").json(coverage.grid_axes);
  } else if (coverage.positions.size() == 1) {
    const MapPoint& p = coverage.positions[0];
    text.add(R"("Point","axes":{"x":{"values":[)").number(p.x);
    text.add(R"(]},"y":{"values":[)").number(p.y).add("]}}");
  } else {
    text.add(R"("MultiPoint","axes":{"composite":{"dataType":"tuple","coordinates":["x","y"],)");
    text.add("\"values\":[");
    for (std::size_t i = 0; i < coverage.positions.size(); ++i) {
      if (i > 0) text.add(",");
      add_pair(text, coverage.positions[i]);
    }
    text.add("]}}");
  }
  text.add(",\"referencing\":").json(referencing_json(places)).add("}");
}

void add_value(LongText& text, std::string_view name, const CoverageValue& value) {
  if (name == "state") {
    text.number(static_cast<double>(value.state));
  } else if (value.state != CoverageState::kSurface) {
    text.add("null");
  } else {
    text.number(name == "height"       ? value.height
                : name == "height_min" ? value.height_min
                                       : value.height_max);
  }
}

void add_range(LongText& text, std::string_view name, const Coverage& coverage) {
  text.add("\"").add(name).add(R"(":{"type":"NdArray","dataType":)");
  text.add(name == "state" ? "\"integer\"" : "\"float\"");
  if (!coverage.shape.empty()) {
    text.add(",\"axisNames\":").json(coverage.axes).add(",\"shape\":").json(coverage.shape);
  }
  text.add(",\"values\":[");
  for (std::size_t i = 0; i < coverage.size; ++i) {
    if (i > 0) text.add(",");
    add_value(text, name, coverage.value(i));
  }
  text.add("]}");
}

}  // namespace

CoverageValue value_of(const LocatedPoint& p) noexcept {
  const CoverageState state = p.state == PointState::kSurface ? CoverageState::kSurface
                              : p.state == PointState::kVoid  ? CoverageState::kVoid
                                                              : CoverageState::kOutside;
  return {p.height, p.height_min, p.height_max, state};
}

Coverage coverage_at(std::span<const MapPoint> positions,
                     std::function<CoverageValue(std::size_t)> value) {
  Coverage coverage{positions, {}, {}, {}, positions.size(), std::move(value)};
  if (positions.size() != 1) {
    coverage.shape = {positions.size()};
    coverage.axes = {"composite"};
  }
  return coverage;
}

Json coverage_parameters(const std::string& unit) {
  return {{"height", number_parameter("height", unit)},
          {"height_min", number_parameter("least height that is certain", unit)},
          {"height_max", number_parameter("largest height that is certain", unit)},
          {"state", state_parameter()}};
}

namespace {

void add_names(ask::Parameters& rows, CoverageNames& names) {
  rows.add(
          "parameter-name", [&names](const std::string& text) { names = names_in(text); }, "",
          "height, height_min, height_max, state, or several between commas; all without it. "
          "CoverageJSON holds these alone, other formats all")
      .at(ask::Door::kService)
      .like("height,state");
}

}  // namespace

ask::Parameters with_coverage(ask::Parameters rows) {
  CoverageNames names;
  add_names(rows, names);
  ask::add_text(rows, "datetime", "Accepted and without effect: a terrain has no time");
  ask::add_text(rows, "z", "Accepted and without effect: a surface has one height at a position");
  return rows;
}

CoverageNames coverage_names(const Asked& asked) {
  CoverageNames names;
  ask::Parameters rows;
  add_names(rows, names);
  asked.question.read(rows);
  return names;
}

std::string coverage_text(const Asked& asked, const Places& places,
                          const CoverageNames& asked_names, const Coverage& coverage,
                          const Json& certainty) {
  CoverageNames names = asked_names;
  if (names.empty()) names.assign(kNames.begin(), kNames.end());
  const Json all = coverage_parameters(asked.collection->crs.vertical_unit);
  Json parameters = Json::object();
  for (const std::string_view name : names) parameters[std::string(name)] = all[std::string(name)];
  LongText text = long_text(asked);
  text.add(R"({"type":"Coverage","domain":)");
  add_domain(text, coverage, places);
  text.add(",\"parameters\":").json(parameters).add(",\"ranges\":{");
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text.add(",");
    add_range(text, names[i], coverage);
  }
  return text.add("},\"ptin:certainty\":").json(certainty).add("}\n").take();
}

std::string points_in(const ask::Format& format, const Asked& asked, const Places& places,
                      const CoverageNames& names, std::span<const MapPoint> client,
                      const LocateResult& result, const Coverage& coverage) {
  const auto row_at = [&](std::size_t i) {
    return ask::LocatedRow(client[i], result.points[i], asked.facts().map);
  };
  const auto fields = ask::located_fields();
  if (format.name == "csv") return csv_text(asked, fields, client.size(), row_at);
  const Json certainty = certainty_of(asked, result);
  if (format.name == "covjson") return coverage_text(asked, places, names, coverage, certainty);
  return features_text(asked, fields, client.size(), row_at,
                       [&](LongText& text, std::size_t i) { add_point(text, client[i]); },
                       {{"ptin:certainty", certainty}});
}

}  // namespace ptin::serve
