// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/profile.h"

#include "tools/facts/answers.h"

namespace ptin::ask {

namespace {

constexpr Door kProgram = Door::kProgram, kService = Door::kService;

Json id_of(const std::string* id) { return id == nullptr ? kLeftOut : Json(*id); }

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

const Fields<ProfileRow>& profile_fields() {
  static const Fields<ProfileRow> fields = {
      {{"line", "integer", "", "Which line of the input, from 0."},
       [](const ProfileRow& r) -> Json { return r.point.line; }},
      {{"distance", "number", "`units.length`", "Along the line, from its beginning."},
       [](const ProfileRow& r) -> Json { return r.point.distance; }},
      {{"x", "number", "map unit", "Of the point.", Door::kBoth, As::kNoFeature},
       [](const ProfileRow& r) -> Json { return r.at.x; }},
      {{"y", "number", "map unit", "Of the point.", Door::kBoth, As::kNoFeature},
       [](const ProfileRow& r) -> Json { return r.at.y; }},
      {{"height", "number or null", "height's unit", "Null where no surface touches the line."},
       [](const ProfileRow& r) -> Json { return r.point.height; }},
      {{"state", "string", "",
        "What the stretch that begins here runs over; of a line's last point, what the one before "
        "does."},
       [](const ProfileRow& r) -> Json { return tools::name_of(r.point.state); }},
      {{"height_min", "number or null", "height's unit", "The exact height is no lower.", kProgram,
        As::kTableRow},
       [](const ProfileRow& r) -> Json { return r.point.height - r.deviation; }},
      {{"height_max", "number or null", "height's unit", "The exact height is no higher.", kProgram,
        As::kTableRow},
       [](const ProfileRow& r) -> Json { return r.point.height + r.deviation; }},
      {{"certified_deviation", "number", "height's unit", "How far the height is off, at most.",
        kProgram, As::kFeature},
       [](const ProfileRow& r) -> Json { return r.deviation; }},
      {{"station", "boolean", "", "The point is a station; left out without `--stations`.",
        Door::kBoth, As::kNoFeature},
       [](const ProfileRow& r) -> Json {
         return r.has_stations ? Json(r.point.is_station) : kLeftOut;
       }},
      {{"id", "string", "", "The attribute of its line.", kProgram, As::kNoObject},
       [](const ProfileRow& r) { return id_of(r.id); }}};
  return fields;
}

const Fields<ProfileLineRow>& profile_line_fields() {
  static const Fields<ProfileLineRow> fields = {
      {{"line", "integer", "", "Which line of the input, from 0."},
       [](const ProfileLineRow& r) -> Json { return r.points.front().line; }},
      {{"length", "number", "`units.length`", "Of the line."},
       [](const ProfileLineRow& r) -> Json { return r.points.back().distance; }},
      {{"certified_error", "number", "height's unit", "At samples.", kProgram},
       [](const ProfileLineRow& r) -> Json { return r.profile.certified_error; }},
      {{"certified_deviation", "number", "height's unit", "At any point.", kProgram},
       [](const ProfileLineRow& r) -> Json { return r.profile.certified_deviation; }},
      {{"exact", "boolean", "", "Nothing was left out.", kProgram},
       [](const ProfileLineRow& r) -> Json { return r.profile.exact; }},
      {{"id", "string", "", "The attribute of the line.", kProgram},
       [](const ProfileLineRow& r) { return id_of(r.id); }}};
  return fields;
}

const Fields<ProfileAnswer>& profile_answer_fields() {
  static const Fields<ProfileAnswer> fields = {
      {{"bent_at_most", "number", "map unit",
        "How far a side, straight in the client's CRS, is from the line that was walked.",
        kService},
       [](const ProfileAnswer& a) -> Json { return a.bent_at_most; }},
      {{"length_unit", "string", "",
        "Of distances along lines: the map unit, in a geographic CRS metres.", kService},
       [](const ProfileAnswer& a) -> Json { return length_unit_of(a.crs); }},
      {{"lines", "integer", "", "Lines with a length.", kProgram},
       [](const ProfileAnswer& a) -> Json { return tools::lines_of(a.profile).size(); }},
      {{"skipped_lines", "integer", "", "Lines without length."},
       [](const ProfileAnswer& a) -> Json { return a.profile.skipped_lines; }},
      {{"length", "number", "`units.length`", "Of all lines together.", kProgram},
       [](const ProfileAnswer& a) -> Json {
         double length = 0.0;
         for (const auto& line : tools::lines_of(a.profile)) length += line.back().distance;
         return length;
       }},
      {{"ids", "array of strings", "",
        "The attribute (`--id`) of each line of the input; left out where that has none.",
        kProgram},
       [](const ProfileAnswer& a) { return a.ids == nullptr ? kLeftOut : Json(*a.ids); }},
      {{"units.length", "string", "",
        "Of distances along lines: the map unit, in a geographic CRS metres.", kProgram},
       [](const ProfileAnswer& a) -> Json { return length_unit_of(a.crs); }}};
  return fields;
}

}  // namespace ptin::ask
