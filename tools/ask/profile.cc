// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/questions.h"
#include "tools/facts/answers.h"

namespace ptin::ask {

namespace {

constexpr std::string_view kLengthUnit = "`units.length`";

}  // namespace

void add_question(Parameters& rows, ProfileRequest& request) {
  add_coords(rows, "Lines as WKT, LINESTRING or MULTILINESTRING",
             "LINESTRING(-118.3 34.34, -118.29 34.35)");
  rows.add("stations", &request.station_step, "D", "Beside the breaks, heights at equal distances")
      .in(Unit::kGround)
      .within(NumberRange::kPositive)
      .within_over_http(NumberRange::kNotNegative)  // 0: none
      .like("100");
  add_detail(rows, request.detail, "",
             "The TIN of the terrain's N most important vertices, instead of an error");
  add_crs(rows);
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

void for_each_stretch(std::span<const ProfilePoint> points,
                      const std::function<void(std::size_t first, std::size_t last)>& take) {
  for (std::size_t i = 0; i < points.size();) {
    std::size_t last = i;
    while (last + 1 < points.size() && points[last].state == PointState::kSurface &&
           points[last + 1].height == points[last + 1].height) {
      ++last;
    }
    // A height that is none is not equal to itself.
    if (last > i && points[i].height == points[i].height) take(i, last);
    i = last + 1;
  }
}

Fields<ProfileRow> profile_fields() {
  using Row = ProfileRow;
  Fields<Row> fields;
  // Tables of the command line have had it further behind.
  const auto line = [](const Row& r) { return r.point.line; };
  constexpr std::string_view kWhichLine = "Which line of the input, from 0.";
  fields.add("line", "integer", "", kWhichLine, Told::kService | Told::kNoTableRow, line);
  fields.add("distance", "number", kLengthUnit, "Along the line, from its beginning.",
             [](const Row& r) { return r.point.distance; });
  fields.add("x", "number", kMapUnit, "Place of the point.", Told::kNoFeature,
             [](const Row& r) { return r.at.x; });
  fields.add("y", "number", kMapUnit, "Place of the point.", Told::kNoFeature,
             [](const Row& r) { return r.at.y; });
  fields.add("height", "number or null", kHeightUnit, "Null where no surface touches the line.",
             [](const Row& r) { return r.point.height; });
  fields.add("state", "string", "",
             "What the stretch that begins here runs over; of a line's last point, what the one "
             "before does.",
             [](const Row& r) { return tools::name_of(r.point.state); });
  constexpr Told kTable = Told::kProgram & Told::kTableRow;
  fields.add("line", "integer", "", kWhichLine, kTable, line);
  fields.add("height_min", "number or null", kHeightUnit, "The exact height is no lower.", kTable,
             [](const Row& r) { return r.point.height - r.deviation; });
  fields.add("height_max", "number or null", kHeightUnit, "The exact height is no higher.", kTable,
             [](const Row& r) { return r.point.height + r.deviation; });
  fields.add("certified_deviation", "number", kHeightUnit, "How far the height is off, at most.",
             Told::kProgram & Told::kFeature, &Row::deviation);
  fields.add("station", "boolean", "", "The point is a station; left out without `--stations`.",
             Told::kNoFeature,
             [](const Row& r) { return r.has_stations ? Json(r.point.is_station) : kLeftOut; });
  fields.add("id", "string", "", "The attribute of its line.", Told::kProgram & Told::kNoObject,
             &Row::id);
  return fields;
}

Fields<ProfileLineRow> profile_line_fields() {
  using Row = ProfileLineRow;
  Fields<Row> fields;
  fields.add("line", "integer", "", "Which line of the input, from 0.",
             [](const Row& r) { return r.points.front().line; });
  fields.add("length", "number", kLengthUnit, "Length of the line.",
             [](const Row& r) { return r.points.back().distance; });
  fields.next = Told::kProgram;
  fields.add("certified_error", "number", kHeightUnit, "At samples.",
             [](const Row& r) { return r.profile.certified_error; });
  fields.add("certified_deviation", "number", kHeightUnit, "At any point.",
             [](const Row& r) { return r.profile.certified_deviation; });
  fields.add("exact", "boolean", "", "Nothing was left out.",
             [](const Row& r) { return r.profile.exact; });
  fields.add("id", "string", "", "The attribute of the line.", &Row::id);
  return fields;
}

Fields<ProfileAnswer> profile_answer_fields() {
  using Answer = ProfileAnswer;
  constexpr std::string_view kOfLengths =
      "Unit of distances along lines: the map unit, in a geographic CRS metres.";
  const auto length_unit = [](const Answer& a) { return length_unit_of(a.crs); };
  Fields<Answer> fields;
  fields.add("bent_at_most", "number", kMapUnit,
             "How far a side, straight in the client's CRS, is from the line that was walked.",
             Told::kService, &Answer::bent_at_most);
  fields.add("length_unit", "string", "", kOfLengths, Told::kService, length_unit);
  fields.add("lines", "integer", "", "Lines with a length.", Told::kProgram,
             [](const Answer& a) { return tools::lines_of(a.profile).size(); });
  fields.add("skipped_lines", "integer", "", "Lines without length.",
             [](const Answer& a) { return a.profile.skipped_lines; });
  fields.next = Told::kProgram;
  fields.add("length", "number", kLengthUnit, "Length of all lines together.", [](const Answer& a) {
    double length = 0.0;
    for (const auto& line : tools::lines_of(a.profile)) length += line.back().distance;
    return length;
  });
  fields.add("ids", "array of strings", "",
             "The attribute (`--id`) of each line of the input; left out where that has none.",
             &Answer::ids);
  fields.add("units.length", "string", "", kOfLengths, length_unit);
  return fields;
}

}  // namespace ptin::ask
