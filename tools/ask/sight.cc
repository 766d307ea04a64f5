// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/sight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "engine/error.h"
#include "tools/ask/answer_facts.h"
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

using Place = std::optional<SightPoint> SightRow::*;
template <Place place>
Json object_at(const SightRow& row) {
  return row.*place ? Json::object() : Json();
}
template <Place place>
Json x_at(const SightRow& row) {
  return row.*place ? Json((row.*place)->position.x) : kLeftOut;
}
template <Place place>
Json y_at(const SightRow& row) {
  return row.*place ? Json((row.*place)->position.y) : kLeftOut;
}
template <Place place>
Json distance_at(const SightRow& row) {
  return row.*place ? Json((row.*place)->distance) : kLeftOut;
}
template <Place place>
Json height_at(const SightRow& row) {
  return row.*place ? Json((row.*place)->height) : kLeftOut;
}

/// Least and largest clearance: objects tell them of a place alone.
Json clearance_min(const SightRow& row) {
  return row.clearance ? Json(row.result.clearance_min) : kLeftOut;
}
Json clearance_max(const SightRow& row) {
  return row.clearance ? Json(row.result.clearance_max) : kLeftOut;
}

/// Heights above ground that an end does not have there have no verdict.
Json verdict_of(const SightRow& row) {
  const bool is_defined = row.result.verdict != SightVerdict::kUndefined;
  return is_defined ? Json(tools::name_of(row.result.verdict)) : Json();
}

}  // namespace

void add_sight(Parameters& rows, SightQuestion& question) {
  SightRequest& request = question.request;
  rows.add("absolute", &request.absolute, "", "Heights of the ends are absolute").like("true");
  rows.add("verdict", &request.verdict_only, "",
           "Only the verdict: faster; obstruction is then any point below ground");
  add_curvature(rows, request.curvature.coefficient);
  rows.add(
          "frequency", [&question](const std::string& text) { question.hertz = hertz_of(text); },
          "F",
          "Measure the first Fresnel zone at this frequency, as 5.8GHz, 5800MHz or "
          "5.8e9 (hertz); 1 MHz at least")
      .excluding("verdict")
      .bound(Door::kProgram)
      .like("5.8e9");
  add_detail(rows, request.detail, ": finer records are left out; may answer undecided",
             "Leave out what is not among the terrain's N most important vertices, instead of an "
             "error; may answer undecided");
  rows.add("budget", &request.budget, "N",
           "Stop after this many stars (--by splits: records) for a pair; may answer "
           "undecided")
      .at(Door::kProgram);
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

const Fields<SightRow>& sight_fields() {
  constexpr Place kHit = &SightRow::obstruction, kNear = &SightRow::clearance;
  constexpr Place kZone = &SightRow::fresnel;
  constexpr Door kBoth = Door::kBoth;
  static const Fields<SightRow> fields = {
      {{"verdict", "string or null", "",
        "`visible`, `hidden` or `undecided`; null: heights are above ground, and an end has none "
        "below it.",
        kBoth, As::kObject},
       verdict_of},
      {{"verdict", "string", "", "The same; `undefined` in the place of null.", kBoth,
        As::kNoObject},
       [](const SightRow& r) -> Json { return tools::name_of(r.result.verdict); }},
      {{"ends", "array of strings", "", "The state of the ground below each end.", kBoth,
        As::kObject},
       [](const SightRow& r) -> Json {
         return Json::array({tools::name_of(r.result.state_a), tools::name_of(r.result.state_b)});
       }},
      {{"length", "number", "height's unit", "Of the line over ground."},
       [](const SightRow& r) -> Json { return r.result.length; }},
      {{"obstruction", "object or null", "",
        "Where the line first goes below ground; null unless hidden.", kBoth, As::kObject},
       object_at<kHit>},
      {{"obstruction.x", "number", "map unit", "Of that place."}, x_at<kHit>},
      {{"obstruction.y", "number", "map unit", "Of that place."}, y_at<kHit>},
      {{"obstruction.distance", "number", "height's unit", "Over ground, from the first end."},
       distance_at<kHit>},
      {{"obstruction.height", "number", "height's unit", "Of the line there.", kBoth, As::kObject},
       height_at<kHit>},
      {{"clearance", "object or null", "",
        "The least height of the line above ground, ends included; null where none is known.",
        kBoth, As::kObject},
       object_at<kNear>},
      {{"clearance.min", "number or null", "height's unit",
        "The exact clearance is no less; null: without limit.", kBoth, As::kObject},
       clearance_min},
      {{"clearance.max", "number or null", "height's unit",
        "The exact clearance is no more; null: without limit.", kBoth, As::kObject},
       clearance_max},
      {{"clearance.min", "number", "height's unit", "The same.", kBoth, As::kNoObject},
       [](const SightRow& r) -> Json { return r.result.clearance_min; }},
      {{"clearance.max", "number", "height's unit", "The same.", kBoth, As::kNoObject},
       [](const SightRow& r) -> Json { return r.result.clearance_max; }},
      {{"clearance.x", "number", "map unit", "Of the place.", kBoth, As::kObject}, x_at<kNear>},
      {{"clearance.y", "number", "map unit", "Of the place.", kBoth, As::kObject}, y_at<kNear>},
      {{"clearance.distance", "number", "height's unit", "Over ground, from the first end."},
       distance_at<kNear>},
      {{"clearance.height", "number", "height's unit", "Of the line there.", kBoth, As::kObject},
       height_at<kNear>},
      {{"void_length", "number or null", "height's unit",
        "Of the line over voids; null where it is not known."},
       [](const SightRow& r) -> Json { return r.result.void_length; }},
      {{"fresnel", "object", "",
        "With `--frequency`: the least clearance over the radius of the first Fresnel zone, ends "
        "left out.",
        kBoth, As::kObject},
       [](const SightRow&) -> Json { return kLeftOut; }},
      {{"fresnel.ratio", "number or null", "", "That clearance over that radius."},
       [](const SightRow& r) -> Json {
         return r.result.fresnel_ratio ? Json(*r.result.fresnel_ratio) : kLeftOut;
       }},
      {{"fresnel.x", "number", "map unit", "Of the place."}, x_at<kZone>},
      {{"fresnel.y", "number", "map unit", "Of the place."}, y_at<kZone>},
      {{"fresnel.distance", "number", "height's unit", "Over ground, from the first end."},
       distance_at<kZone>},
      {{"fresnel.height", "number", "height's unit", "Of the line there."}, height_at<kZone>},
      {{"certified_deviation", "number or null", "height's unit",
        "What is not known of the surface where the line is undecided; 0: nothing.", kBoth,
        As::kObject},
       [](const SightRow& r) -> Json { return r.result.certified_deviation; }},
      {{"exact", "boolean", "", "All that is told holds of the source.", kBoth, As::kObject},
       [](const SightRow& r) -> Json { return r.result.exact; }},
      {{"cost", "object", "", "What the pair took.", Door::kProgram, As::kObject},
       [](const SightRow& r) { return cost_json(r.result.cost); }},
      {{"id", "string", "",
        "Of each of `pairs`: its column or attribute (`--id`); left out where the input has none.",
        Door::kProgram},
       [](const SightRow& r) -> Json { return r.id == nullptr ? kLeftOut : Json(*r.id); }}};
  return fields;
}

}  // namespace ptin::ask
