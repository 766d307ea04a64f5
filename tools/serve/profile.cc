// SPDX-License-Identifier: GPL-3.0-or-later
//
// The height along lines, with a break at every edge of the TIN: `profile`, and OGC EDR's
// `trajectory`, which is the same as a coverage.
#include <array>
#include <string>
#include <vector>

#include "tools/facts/answers.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/coverage.h"
#include "tools/serve/lines.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

constexpr ParameterFact kCoords{"coords", "string", "lines as WKT, LINESTRING or MULTILINESTRING",
                                "LINESTRING(-118.3 34.34, -118.29 34.35)", true};
constexpr ParameterFact kStations{
    "stations", "number",
    "a point at every multiple of this distance too, in the unit of distances: that of the map, in "
    "degrees metres",
    "100"};

constexpr auto kProfileParameters =
    std::to_array<ParameterFact>({kCoords,
                                  kStations,
                                  kErrorParameter,
                                  kVerticesParameter,
                                  kCrsParameter,
                                  {"f", "string", "json, geojson or csv", "csv"}});
constexpr auto kProfileFormats =
    std::to_array<OfferedFormat>({{"json", kJson}, {"geojson", kGeoJson}, {"csv", kCsv}});

constexpr auto kTrajectoryParameters =
    std::to_array<ParameterFact>({kCoords,
                                  kStations,
                                  kErrorParameter,
                                  kVerticesParameter,
                                  kCrsParameter,
                                  kNamesParameter,
                                  kDatetimeParameter,
                                  kZParameter,
                                  {"f", "string", "covjson, geojson or csv", "geojson"}});
constexpr auto kTrajectoryFormats = std::to_array<OfferedFormat>(
    {{"covjson", kCoverageJson}, {"geojson", kGeoJson}, {"csv", kCsv}});

std::string csv_of(const AlongLines& along, const Asked& asked) {
  LongText text(asked);
  text.add("line,distance,x,y,height,state,station\n");
  for (std::size_t i = 0; i < along.client.size(); ++i) {
    const ProfilePoint& p = along.profile.points[i];
    text.number(p.line).add(",").number(p.distance).add(",");
    text.number(along.client[i].x).add(",").number(along.client[i].y).add(",");
    if (p.height == p.height) text.number(p.height);
    text.add(",").add(tools::name_of(p.state)).add(p.is_station ? ",1\n" : ",0\n");
  }
  return text.take();
}

Json certainty_of(const AlongLines& along, const Asked& asked) {
  Json certainty = certainty_json(asked, along.profile.certified_error,
                                  along.profile.certified_deviation, along.profile.exact);
  certainty["bent_at_most"] = along.bent_at_most;
  return certainty;
}

std::string json_of(const AlongLines& along, const Asked& asked) {
  LongText text(asked);
  char before = '{';
  const Json certainty = certainty_of(along, asked);
  for (const auto& [name, value] : certainty.items()) {
    text.add({&before, 1}).add("\"").add(name).add("\":").json(value);
    before = ',';
  }
  text.add(",\"length_unit\":").json(along.length_unit);
  text.add(",\"skipped_lines\":").number(static_cast<double>(along.profile.skipped_lines));
  text.add(",\"points\":[");
  for (std::size_t i = 0; i < along.client.size(); ++i) {
    const ProfilePoint& p = along.profile.points[i];
    text.add(i == 0 ? "{\"line\":" : ",{\"line\":").number(p.line);
    text.add(",\"distance\":").number(p.distance).add(",\"x\":").number(along.client[i].x);
    text.add(",\"y\":").number(along.client[i].y).add(",\"height\":").number(p.height);
    text.add(",\"state\":\"").add(tools::name_of(p.state)).add("\",\"station\":");
    text.truth(p.is_station).add("}");
  }
  return text.add("]}\n").take();
}

/// The stretches of the points from `begin` to `end` that have heights, as arrays of positions.
void add_stretches(LongText& text, const AlongLines& along, std::size_t begin, std::size_t end) {
  const std::vector<ProfilePoint>& points = along.profile.points;
  bool is_first = true;
  for (std::size_t i = begin; i < end;) {
    std::size_t last = i;  // of the stretch that begins here
    while (last + 1 < end && points[last].state == PointState::kSurface &&
           points[last + 1].height == points[last + 1].height) {
      ++last;
    }
    if (last > i && points[i].height == points[i].height) {
      text.add(is_first ? "[" : ",[");
      is_first = false;
      for (std::size_t j = i; j <= last; ++j) {
        text.add(j == i ? "[" : ",[").number(along.client[j].x).add(",");
        text.number(along.client[j].y).add(",").number(points[j].height).add("]");
      }
      text.add("]");
    }
    i = last + 1;
  }
}

/// One feature a line: stretches over surface, as a MultiLineString with heights.
std::string geojson_of(const AlongLines& along, const Asked& asked) {
  LongText text(asked);
  text.add(R"({"type":"FeatureCollection","features":[)");
  const std::vector<ProfilePoint>& points = along.profile.points;
  for (std::size_t begin = 0; begin < points.size();) {
    std::size_t end = begin;
    while (end < points.size() && points[end].line == points[begin].line) ++end;
    text.add(begin == 0 ? "{" : ",{").add(R"("type":"Feature","geometry":)");
    text.add(R"({"type":"MultiLineString","coordinates":[)");
    add_stretches(text, along, begin, end);
    text.add(R"(]},"properties":{"line":)").number(points[begin].line);
    text.add(",\"length\":").number(points[end - 1].distance).add("}}");
    begin = end;
  }
  return text.add("],\"ptin:certainty\":").json(certainty_of(along, asked)).add("}\n").take();
}

std::string coverage_of(const AlongLines& along, const Asked& asked, const Places& places) {
  const auto value = [&](std::size_t i) {
    const ProfilePoint& p = along.profile.points[i];
    const double deviation = along.profile.certified_deviation;
    // The last point before a gap stands on surface: it has a height, whatever begins there.
    const CoverageState state = p.height == p.height           ? CoverageState::kSurface
                                : p.state == PointState::kVoid ? CoverageState::kVoid
                                                               : CoverageState::kOutside;
    return CoverageValue{p.height, p.height - deviation, p.height + deviation, state};
  };
  return coverage_text(asked, places, coverage_at(along.client, value), certainty_of(along, asked));
}

http::Response respond(const Asked& asked, std::span<const OfferedFormat> formats) {
  const OfferedFormat& format = format_of(asked, formats);
  const Places places(asked.collection->crs, asked.question.text("crs"), asked.collection->bounds,
                      asked.request.share);
  const AlongLines along = walk_lines(asked, places);
  std::string text;
  if (format.name == "csv") {
    text = csv_of(along, asked);
  } else if (format.name == "geojson") {
    text = geojson_of(along, asked);
  } else if (format.name == "covjson") {
    text = coverage_of(along, asked, places);
  } else {
    text = json_of(along, asked);
  }
  http::Response response = text_response(std::move(text), format.media);
  add_choice(response, asked);
  add_cost(response, along.profile.cost);
  add_certainty(response, along.profile.certified_error, along.profile.exact);
  return response;
}

}  // namespace

std::span<const ParameterFact> profile_parameters() noexcept { return kProfileParameters; }
std::span<const ParameterFact> trajectory_parameters() noexcept { return kTrajectoryParameters; }

http::Response answer_profile(const Asked& asked) { return respond(asked, kProfileFormats); }

http::Response answer_trajectory(const Asked& asked) {
  static_cast<void>(asked_names(asked.question));
  return respond(asked, kTrajectoryFormats);
}

}  // namespace ptin::serve
