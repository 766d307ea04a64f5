// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin profile: heights along a line, as CSV, a layer or a plot.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "tools/ask/questions.h"
#include "tools/error_status.h"
#include "tools/facts/human.h"
#include "tools/formats/vector_file.h"
#include "tools/plot/profile_plot.h"
#include "tools/ptin/answer_output.h"
#include "tools/ptin/point_input.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

struct ProfileOptions {
  TerrainOptions terrain;
  std::string line;
  bool stations_only = false;
  InputChoice choice;
  ProfileRequest request;
  std::optional<std::uint64_t> memory;
  OutputOptions answer;

  [[nodiscard]] bool has_stations() const { return request.station_step > 0; }
};

/// A profile that is written, with the ids of its lines.
struct Written {
  const ProfileOptions& options;
  const ProfileResult& profile;
  const std::vector<std::string>& ids;
  const CrsFacts& crs;

  [[nodiscard]] const std::string* id(std::uint32_t line) const {
    return ids.empty() ? nullptr : &ids[line];
  }
  [[nodiscard]] ask::ProfileRow row(std::size_t i) const {
    const ProfilePoint& p = profile.points[i];
    return {p, p.position, profile.certified_deviation, options.has_stations(), id(p.line)};
  }
};

/// The stretches of one line that have heights.
Geometry stretches_of(std::span<const ProfilePoint> points) {
  Geometry stretches;
  ask::for_each_stretch(points, [&](std::size_t first, std::size_t last) {
    for (const ProfilePoint& p : points.subspan(first, last - first + 1)) {
      stretches.points.push_back(p.position);
      stretches.heights.push_back(p.height);
    }
    stretches.end_path();
  });
  return stretches;
}

/// How the plot names units, and how distances and heights compare.
PlotUnits plot_units_of(const CrsFacts& crs) {
  const Ground ground = ground_of(crs);
  const double heights =
      ground.geographic ? 1 / ground.metres_per_height : ground.per_map_unit({}).x;
  return {ask::length_unit_of(crs), crs.vertical_unit, heights};
}

/// The same fields, but `id` where the input has none.
template <typename Row>
ask::Fields<Row> fields_of(const Written& written, const ask::Fields<Row>& all) {
  return written.ids.empty() ? all.without("id") : all;
}

/// Writes the profile as a layer, a feature for each line.
void write_lines(const Written& written, const Context& context) {
  const std::vector<std::span<const ProfilePoint>> lines = lines_of(written.profile);
  const auto row_at = [&](std::size_t i) {
    return ask::ProfileLineRow{lines[i], written.profile, written.id(lines[i].front().line)};
  };
  write_rows(written.options.answer, AnswerForm::kLayer, context,
             {"profile", GeometryKind::kMultiLineZ, {}, written.crs},
             fields_of(written, ask::profile_line_fields()), lines.size(), row_at,
             [&](std::size_t i) { return stretches_of(lines[i]); });
}

/// Writes points as CSV, or as a layer.
void write_points(const Written& written, AnswerForm form, const Context& context) {
  auto fields = fields_of(written, ask::profile_fields());
  if (!written.options.has_stations()) fields = fields.without("station");
  const std::vector<ProfilePoint>& points = written.profile.points;
  const auto geometry_at = [&](std::size_t i) {
    const ProfilePoint& p = points[i];
    const double z = std::isfinite(p.height) ? p.height : 0.0;  // the field tells what is unknown
    return point_geometry(p.position, z);
  };
  write_rows(
      written.options.answer, form, context, {"stations", GeometryKind::kPointZ, {}, written.crs},
      fields, points.size(), [&](std::size_t i) { return written.row(i); }, geometry_at);
}

/// Puts the profile where it is asked for.
void write_profile(const Written& written, const Context& context) {
  const OutputOptions& answer = written.options.answer;
  const AnswerForm form = form_of(answer, context.json, {.plot = true});
  if (form == AnswerForm::kPlot) {
    plot_profile(answer.output, answer.overwrite, written.profile, written.ids,
                 plot_units_of(written.crs));
  } else if (form == AnswerForm::kLayer && !written.options.stations_only) {
    write_lines(written, context);
  } else {
    write_points(written, form, context);
  }
}

int run_profile(const ProfileOptions& options, const Context& context) {
  if (const AnswerForm form =
          form_of(options.answer, context.json, {.plot = true});  // before the work
      form == AnswerForm::kPlot && options.stations_only) {
    refuse("a plot draws the ground between stations too; leave --stations-only out",
           options.answer.output);
  }
  const Terrain terrain = open_terrain(options.terrain, options.request.detail.tolerance, context);
  const CrsFacts crs = crs_facts(terrain.store());
  const Asked<std::vector<MapPoint>> asked =
      read_lines(options.line, options.choice, plane_of(terrain.store().facts(), crs));
  tell_transformed(asked.transformed, "the lines", crs, context);
  const std::vector<std::vector<MapPoint>>& lines = asked.all;
  ProfileRequest request = options.request;
  request.limits = limits_of(options.memory, context);
  ask::set_ground(request, ground_of(crs));
  ProfileResult result = terrain.profile(lines, request);
  const auto is_outside = [](const ProfilePoint& p) { return p.state == PointState::kOutside; };
  if (std::all_of(result.points.begin(), result.points.end(), is_outside)) {
    std::vector<MapPoint> corners;
    for (const auto& corners_of_line : lines) {
      corners.insert(corners.end(), corners_of_line.begin(), corners_of_line.end());
    }
    warn_of_outside(corners, "corner of the lines", terrain.store().facts(), crs, context);
  }
  if (result.skipped_lines > 0 && !context.json && !context.quiet) {
    std::fprintf(stderr, "%s of %s: no length, skipped\n", grouped(result.skipped_lines).c_str(),
                 counted(lines.size(), "line").c_str());
  }
  if (options.stations_only) {
    std::erase_if(result.points, [](const ProfilePoint& p) { return !p.is_station; });
  }
  const Written written{options, result, asked.ids, crs};
  write_profile(written, context);
  if (!context.json) return kExitDone;
  print_answer({{"output", output_json(options.answer)},
                {"points", objects_of(ask::profile_fields(), result.points.size(),
                                      [&](std::size_t i) { return written.row(i); })}},
               ask::profile_answer_fields(),
               {result, crs, asked.ids.empty() ? nullptr : &asked.ids},
               ask::facts_of(result, terrain.store(), crs, &asked.transformed));
  return kExitDone;
}

void add_question(ask::Parameters& rows, ProfileOptions& options) {
  add_terrain(rows, options.terrain, false);
  rows.add("line", &options.line, "WKT_OR_FILE",
           "Lines: WKT (LINESTRING, MULTILINESTRING), or a file with it, or a vector file "
           "(transformed to the terrain's CRS)")
      .read_by_gdal()
      .required_at(ask::Door::kBoth);
  add_input_choice(rows, options.choice, "line", "");
  ask::add_question(rows, options.request);
  rows.add("stations-only", &options.stations_only, "",
           "The stations alone: rows of CSV, or points of a layer")
      .needing("stations");
  ask::add_memory(rows, options.memory);
  add_answer_output(rows, options.answer, {.plot = true});
}

}  // namespace

Declared declare_profile(Context& context) {
  return declared<ProfileOptions>(context, run_profile);
}

}  // namespace ptin::tools
