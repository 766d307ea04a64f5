// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/profile.h"

#include "tools/facts/answers.h"

namespace ptin::ask {

namespace {

constexpr Door kProgram = Door::kProgram;
constexpr std::string_view kLengthUnit = "`units.length`";

}  // namespace

void add_profile(Parameters& rows, ProfileRequest& request) {
  rows.add("stations", &request.station_step, "D", "Beside the breaks, heights at equal distances")
      .in(Unit::kGround)
      .within(kPositive)
      .within_over_http(kNotNegative)  // 0: none
      .like("100");
  add_detail(rows, request.detail, "",
             "The TIN of the terrain's N most important vertices, instead of an error");
}

void set_ground(ProfileRequest& request, const Ground& ground) {
  if (!ground.geographic) return;
  request.ground_distance = [ground](MapPoint a, MapPoint b) {
    return ground.distance(a, b) * ground.metres_per_height;
  };
}

std::string length_unit_of(const CrsFacts& crs) {
  return crs.geographic ? "metre" : crs.horizontal_unit;
}

Fields<ProfileRow> profile_fields() {
  using Row = ProfileRow;
  Fields<Row> fields;
  fields.add("line", "integer", "", "Which line of the input, from 0.",
             [](const Row& r) { return r.point.line; });
  fields.add("distance", "number", kLengthUnit, "Along the line, from its beginning.",
             [](const Row& r) { return r.point.distance; });
  fields.add(
      "x", "number", kMapUnit, "Of the point.", [](const Row& r) { return r.at.x; },
      As::kNoFeature);
  fields.add(
      "y", "number", kMapUnit, "Of the point.", [](const Row& r) { return r.at.y; },
      As::kNoFeature);
  fields.add("height", "number or null", kHeightUnit, "Null where no surface touches the line.",
             [](const Row& r) { return r.point.height; });
  fields.add("state", "string", "",
             "What the stretch that begins here runs over; of a line's last point, what the one "
             "before does.",
             [](const Row& r) { return tools::name_of(r.point.state); });
  fields.add("height_min", "number or null", kHeightUnit, "The exact height is no lower.",
             [](const Row& r) { return r.point.height - r.deviation; }, {kProgram, As::kTableRow});
  fields.add("height_max", "number or null", kHeightUnit, "The exact height is no higher.",
             [](const Row& r) { return r.point.height + r.deviation; }, {kProgram, As::kTableRow});
  fields.add("certified_deviation", "number", kHeightUnit, "How far the height is off, at most.",
             &Row::deviation, {kProgram, As::kFeature});
  fields.add(
      "station", "boolean", "", "The point is a station; left out without `--stations`.",
      [](const Row& r) { return r.has_stations ? Json(r.point.is_station) : kLeftOut; },
      As::kNoFeature);
  fields.add("id", "string", "", "The attribute of its line.", &Row::id, {kProgram, As::kNoObject});
  return fields;
}

Fields<ProfileLineRow> profile_line_fields() {
  using Row = ProfileLineRow;
  Fields<Row> fields;
  fields.add("line", "integer", "", "Which line of the input, from 0.",
             [](const Row& r) { return r.points.front().line; });
  fields.add("length", "number", kLengthUnit, "Of the line.",
             [](const Row& r) { return r.points.back().distance; });
  fields.add(
      "certified_error", "number", kHeightUnit, "At samples.",
      [](const Row& r) { return r.profile.certified_error; }, kProgram);
  fields.add(
      "certified_deviation", "number", kHeightUnit, "At any point.",
      [](const Row& r) { return r.profile.certified_deviation; }, kProgram);
  fields.add(
      "exact", "boolean", "", "Nothing was left out.", [](const Row& r) { return r.profile.exact; },
      kProgram);
  fields.add("id", "string", "", "The attribute of the line.", &Row::id, kProgram);
  return fields;
}

Fields<ProfileAnswer> profile_answer_fields() {
  using Answer = ProfileAnswer;
  constexpr std::string_view kOfLengths =
      "Of distances along lines: the map unit, in a geographic CRS metres.";
  const auto length_unit = [](const Answer& a) { return length_unit_of(a.crs); };
  Fields<Answer> fields;
  fields.add("bent_at_most", "number", kMapUnit,
             "How far a side, straight in the client's CRS, is from the line that was walked.",
             &Answer::bent_at_most, Door::kService);
  fields.add("length_unit", "string", "", kOfLengths, length_unit, Door::kService);
  fields.add(
      "lines", "integer", "", "Lines with a length.",
      [](const Answer& a) { return tools::lines_of(a.profile).size(); }, kProgram);
  fields.add("skipped_lines", "integer", "", "Lines without length.",
             [](const Answer& a) { return a.profile.skipped_lines; });
  fields.add(
      "length", "number", kLengthUnit, "Of all lines together.",
      [](const Answer& a) {
        double length = 0.0;
        for (const auto& line : tools::lines_of(a.profile)) length += line.back().distance;
        return length;
      },
      kProgram);
  fields.add("ids", "array of strings", "",
             "The attribute (`--id`) of each line of the input; left out where that has none.",
             &Answer::ids, kProgram);
  fields.add("units.length", "string", "", kOfLengths, length_unit, kProgram);
  return fields;
}

}  // namespace ptin::ask
