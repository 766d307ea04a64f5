// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/groups.h"

#include <cmath>
#include <utility>

#include "engine/error.h"
#include "engine/number.h"
#include "tools/facts/human.h"
#include "tools/facts/quantity.h"

namespace ptin::ask {

namespace {

/// The coefficient of curvature for a radius of the Earth that is so many times as long: "4/3",
/// "1.333".
/// @throws Error invalid_argument  no number above 0, nor two with a stroke between them
double coefficient_of_factor(const std::string& text) {
  const std::size_t stroke = text.find('/');
  const auto part = [](const std::string& of) { return parse_number<double>(of).value_or(-1.0); };
  const double over = part(text.substr(0, stroke));
  const double under = stroke == std::string::npos ? 1.0 : part(text.substr(stroke + 1));
  const double coefficient = under / over;
  if (over > 0 && under > 0 && std::isfinite(coefficient)) return coefficient;
  refuse("\"" + text + "\" is no factor of the Earth's radius; expected a number above 0, as 4/3");
}

}  // namespace

Parameter& add_error(Parameters& rows, std::optional<double>& error, std::string help) {
  return rows.add("error", &error, "E", std::move(help))
      .in(Unit::kHeight)
      .within(NumberRange::kTolerance)
      .like("5");
}

void add_detail(Parameters& rows, DetailRequest& detail, const std::string& error_more,
                const std::string& vertices_help, Door doors) {
  add_error(rows, detail.tolerance, "Certified error allowed" + error_more).at(doors);
  rows.add("vertices", &detail.vertices, "N", vertices_help).excluding("error").at(doors);
}

void add_window(Parameters& rows, RegionText& region, Door doors) {
  if (is_at(doors, Door::kService)) {
    rows.add("bbox", &region.window, "",
             "West, south, east, north; across the antimeridian west is larger than east")
        .values(4, 6)
        .at(Door::kService)
        .like("-118.31,34.34,-118.3,34.35");
  }
  if (!is_at(doors, Door::kProgram)) return;
  rows.add("window", &region.window, "XMIN YMIN XMAX YMAX", "A window")
      .in(Unit::kMap)
      .values(4, 4)
      .at(Door::kProgram);
}

void add_region(Parameters& rows, RegionText& region, Door doors) {
  add_window(rows, region, doors);
  rows.add("polygon", &region.polygon, "WKT_OR_FILE", "A polygon: WKT, or a file that holds it")
      .excluding("window")
      .read_by_gdal()
      .at(Door::kProgram);
}

void add_levels(Parameters& rows, Levels& levels, const std::string& level_help,
                const std::string& interval_help, Door doors) {
  rows.add("level", &levels.levels, "H...", level_help)
      .spelled("--level,--fl")
      .in(Unit::kHeight)
      .values(0, kAnyNumberOfValues)  // A list of JSON may be empty: there are no lines then.
      .at(doors);
  rows.add("interval", &levels.interval, "D", interval_help)
      .spelled("-i,--interval")
      .in(Unit::kHeight)
      .within(NumberRange::kPositive)
      .excluding("level")
      .at(doors)
      .like("100");
  rows.add("base", &levels.base, "B", "Where the intervals are counted from; 0 without it")
      .spelled("--base,--off")
      .in(Unit::kHeight)
      .needing("interval")
      .bound(Door::kProgram)
      .at(doors)
      .like("0");
}

std::vector<double> levels_of(const Levels& levels, const StoreFacts& facts) {
  if (!levels.interval) return levels.levels;
  if (facts.min_height > facts.max_height) return {levels.base};
  std::vector<double> heights =
      levels_at(*levels.interval, levels.base, facts.min_height, facts.max_height);
  // The answer is empty then, as it is with a level that nothing crosses.
  if (heights.empty()) {
    const double steps = std::ceil((facts.max_height - levels.base) / *levels.interval);
    heights.push_back(levels.base + steps * *levels.interval);
  }
  return heights;
}

void add_curvature(Parameters& rows, double& coefficient) {
  rows.add("curvature", &coefficient, "C",
           "The Earth's curvature less refraction: GDAL's coefficient; 0 is a flat Earth, 1 one "
           "without refraction, 0.75 the 4/3 Earth of radio")
      .within({.least = 0, .most = 1})
      // Air that bends light upwards has more than 1.
      .within_over_http(NumberRange::kNotNegative)
      .with_default()
      .like("0.857")
      .hinting("An Earth of so many times its radius is --refraction ");
  rows.add(
          "refraction",
          [&coefficient](const std::string& text) { coefficient = coefficient_of_factor(text); },
          "K",
          "Instead: how many times as long the Earth's radius is taken for refraction, as 4/3, "
          "which is usual for radio links (--curvature 0.75)")
      .excluding("curvature")
      .at(Door::kProgram);
}

void add_by(Parameters& rows, AnswerBy& by) {
  const auto read = [&by](const std::string& name) {
    by = name == "heights" ? AnswerBy::kHeights
                           : (name == "splits" ? AnswerBy::kSplits : AnswerBy::kStars);
  };
  rows.add(
          "by", read, "TEXT",
          "heights: read those of the raster, for the full TIN; stars: look up the triangles that "
          "live at the level; splits: refine T0, as the paper has it. An exact answer is the same, "
          "at a level both are true (default heights where the file has them, else stars)")
      .of({"heights", "stars", "splits"})
      .at(Door::kProgram);
}

void add_threads(Parameters& rows, int& threads, std::string help, double most) {
  rows.add("threads", &threads, "N", std::move(help))
      .within({.least = 1, .most = most})
      .at(Door::kProgram);
}

Parameter& add_memory(Parameters& rows, std::optional<std::uint64_t>& memory, std::string help) {
  const auto read = [&memory](const std::string& text) { memory = tools::parse_memory(text, {}); };
  return rows.add("memory", read, "SIZE", std::move(help)).at(Door::kProgram);
}

void add_format(Parameters& rows, std::string& format, std::span<const Format> formats) {
  rows.add("f", &format, "", "The format of the answer; without it the header Accept chooses")
      .at(Door::kService)
      .like(formats.front().name);
  for (const Format& one : formats) rows.back().choices.push_back(one.name);
}

Parameter& add_text(Parameters& rows, std::string_view name, std::string help,
                    std::string_view example) {
  return rows
      .add(
          name, [](const std::string&) {}, "", std::move(help))
      .at(Door::kService)
      .like(example);
}

Parameter& add_coords(Parameters& rows, std::string help, std::string_view example) {
  return add_text(rows, "coords", std::move(help), example).required_at(Door::kService);
}

void add_crs(Parameters& rows) {
  add_text(rows, "crs",
           "CRS of positions that come and go: CRS84 (longitude, latitude; without it), native, or "
           "an EPSG code or OGC URI",
           "CRS84");
}

}  // namespace ptin::ask
