// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>

#include "engine/error.h"
#include "tools/ask/questions.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/facts/quantity.h"
#include "tools/output/file_name.h"

namespace ptin::ask {

namespace {

constexpr double kSpeedOfLight = 299792458.0;  // m/s
constexpr std::size_t kFewPairs = 16;          // Fewer pairs are not worth a coarse level.

/// The frequency in hertz that a text names, as 5.8GHz, 5800MHz or 5.8e9; large and small letters
/// are the same.
/// @throws Error invalid_argument  no number, another unit; below 1 MHz, where a number without its
///                                 unit is what was meant
double hertz_of(const std::string& text) {
  constexpr std::array<std::pair<const char*, double>, 5> kHertzUnits = {
      {{"", 1.0}, {"hz", 1.0}, {"khz", 1e3}, {"mhz", 1e6}, {"ghz", 1e9}}};
  const std::optional<tools::Quantity> quantity = tools::quantity_of(text);
  const std::string unit = quantity ? tools::lower_case(quantity->unit) : std::string();
  const auto* const known = std::find_if(kHertzUnits.begin(), kHertzUnits.end(),
                                         [&](const auto& u) { return unit == u.first; });
  if (!quantity || known == kHertzUnits.end()) {
    refuse("\"" + tools::shown(text) +
           "\" is no frequency; expected one as 5.8GHz, 5800MHz or 5.8e9 (hertz)");
  }
  const double hertz = quantity->number * known->second;
  constexpr double kLeast = 1e6;
  if (hertz < kLeast || !std::isfinite(hertz)) {
    refuse(tools::exact_number(hertz) +
           " hertz is no radio link's frequency, which is 1 MHz at least; give the unit, as 5.8GHz "
           "or 5800MHz");
  }
  return hertz;
}

/// Adds an object of JSON for a place on the line: null where there is none.
/// @param tables  What tables and layers have of it.
void add_place(Fields<SightRow>& fields, const std::string& name, std::string_view type,
               std::string_view meaning, std::optional<SightPoint> SightRow::*place,
               std::initializer_list<std::string_view> tables) {
  using Point = SightPoint;
  Fields<Point> parts;
  const auto told = [&](std::string_view part) {
    return std::count(tables.begin(), tables.end(), part) > 0 ? Told::kAll : Told::kObject;
  };
  parts.add("x", "number", kMapUnit, "Where it is.", told("x"),
            [](const Point& p) { return p.position.x; });
  parts.add("y", "number", kMapUnit, "Where it is.", told("y"),
            [](const Point& p) { return p.position.y; });
  parts.add("distance", "number", kHeightUnit, "Over ground, from the first end.", told("distance"),
            &Point::distance);
  parts.add("height", "number", kHeightUnit, "Height of the line there.", told("height"),
            &Point::height);
  fields.add_object(name, type, meaning, parts, place);
}

/// Adds a bound of the clearance, which objects tell of a place alone.
void add_clearance(Fields<SightRow>& fields, const std::string& name, std::string_view meaning,
                   double SightResult::*bound) {
  fields.add(name, "number or null", kHeightUnit, meaning, Told::kObject,
             [bound](const SightRow& r) { return r.clearance ? Json(r.result.*bound) : kLeftOut; });
  fields.add(name, "number", kHeightUnit, "The same.", Told::kNoObject,
             [bound](const SightRow& r) { return r.result.*bound; });
}

}  // namespace

void add_question(Parameters& rows, SightQuestion& question) {
  SightRequest& request = question.request;
  add_coords(
      rows,
      "The two ends as WKT, LINESTRING of two positions, or a MULTILINESTRING of several pairs",
      "LINESTRING(-118.3 34.34, -118.29 34.35)")
      .required_at(Door::kNone);
  add_text(rows, "pairs", "Pairs instead of coords: [x, y, height, x, y, height] each")
      .excluding("coords")
      .as_json();
  rows.add("heights", &question.end_heights, "",
           "Heights of the two ends of coords; 2,2 without it")
      .in(Unit::kHeight)
      .values(2, 2)
      .at(Door::kService)
      .like("2,10");
  rows.add("absolute", &request.absolute, "", "Heights of the ends are absolute").like("true");
  rows.add("verdict", &request.verdict_only, "",
           "Only the verdict: faster; obstruction is then any point below ground");
  add_curvature(rows, request.curvature.coefficient);
  rows.add(
          "frequency", [&question](const std::string& text) { question.hertz = hertz_of(text); },
          "F",
          "Measure the first Fresnel zone at this frequency, as 5.8GHz, 5800MHz or 5.8e9 (hertz); "
          "1 MHz at least")
      .excluding("verdict")
      .bound(Door::kProgram)
      .as_json()
      .like("5.8e9");
  add_detail(rows, request.detail, ": finer records are left out; may answer undecided",
             "Leave out what is not among the terrain's N most important vertices, instead of an "
             "error; may answer undecided");
  rows.add("budget", &request.budget, "N",
           "Stop after this many stars (by heights: samples; by splits: records) for a pair; may "
           "answer "
           "undecided")
      .at(Door::kProgram);
  add_crs(rows);
}

void set_ground(SightQuestion& question, const Ground& ground) {
  SightRequest& request = question.request;
  request.curvature.earth_diameter = ground.earth_diameter;
  request.ground_distance = ground.distance;
  if (question.hertz) {
    request.wavelength = kSpeedOfLight / *question.hertz / ground.metres_per_height;
  }
}

std::uint64_t coarse_records_for(std::size_t pairs) {
  return pairs < kFewPairs ? 0 : SightSolver::kCoarseRecords;
}

SightRow::SightRow(const SightResult& line,
                   const std::function<void(std::span<MapPoint>)>& to_client)
    : result(line), obstruction(line.obstruction), clearance(line.clearance_at) {
  if (line.fresnel_ratio) fresnel = line.fresnel_at;
  if (!to_client) return;
  for (auto* const place : {&obstruction, &clearance, &fresnel}) {
    if (*place) to_client({&(*place)->position, 1});
  }
}

Fields<SightRow> sight_fields() {
  using Row = SightRow;
  Fields<Row> fields;
  fields.add("verdict", "string or null", "",
             "`visible`, `hidden` or `undecided`; null: heights are above ground, and an end has "
             "none below it.",
             Told::kObject, [](const Row& r) {
               const bool is_defined = r.result.verdict != SightVerdict::kUndefined;
               return is_defined ? Json(tools::name_of(r.result.verdict)) : Json();
             });
  fields.add("verdict", "string", "", "The same; `undefined` in the place of null.",
             Told::kNoObject, [](const Row& r) { return tools::name_of(r.result.verdict); });
  fields.add("ends", "array of strings", "", "The state of the ground below each end.",
             Told::kObject, [](const Row& r) {
               return Json{tools::name_of(r.result.state_a), tools::name_of(r.result.state_b)};
             });
  fields.add("length", "number", kHeightUnit, "Length of the line over ground.",
             [](const Row& r) { return r.result.length; });
  add_place(fields, "obstruction", "object or null",
            "Where the line first goes below ground; null unless hidden.", &Row::obstruction,
            {"x", "y", "distance"});
  add_clearance(fields, "clearance.min", "The exact clearance is no less; null: without limit.",
                &SightResult::clearance_min);
  add_clearance(fields, "clearance.max", "The exact clearance is no more; null: without limit.",
                &SightResult::clearance_max);
  add_place(fields, "clearance", "object or null",
            "The least height of the line above ground, ends included; null where none is known.",
            &Row::clearance, {"distance"});
  fields.add("void_length", "number or null", kHeightUnit,
             "Length of the line over voids; null where it is not known.",
             [](const Row& r) { return r.result.void_length; });
  fields.add("fresnel.ratio", "number or null", "", "That clearance over that radius.",
             [](const Row& r) { return r.result.fresnel_ratio; });
  add_place(fields, "fresnel", "object",
            "With `--frequency`: the least clearance over the radius of the first Fresnel zone, "
            "ends left out.",
            &Row::fresnel, {"x", "y", "distance", "height"});
  fields.add("certified_deviation", "number or null", kHeightUnit,
             "What is not known of the surface where the line is undecided; 0: nothing.",
             Told::kObject, [](const Row& r) { return r.result.certified_deviation; });
  fields.add("exact", "boolean", "", "All that is told holds of the source.", Told::kObject,
             [](const Row& r) { return r.result.exact; });
  fields.add("cost", "object", "", "What the pair took.", Told::kProgram & Told::kObject,
             [](const Row& r) { return cost_json(r.result.cost); });
  fields.add("id", "string", "",
             "Column or attribute of each of `pairs` (`--id`); left out where the input has none.",
             Told::kProgram, &Row::id);
  return fields;
}

}  // namespace ptin::ask
