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
#include <ogr_geometry.h>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/formats/csv_text.h"
#include "tools/formats/number_text.h"
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
  std::optional<double> stations;
  bool stations_only = false;
  InputChoice choice;
  DetailOptions detail;
  std::string memory;
  AnswerOptions answer;
};

/// The unit of distances along the lines.
std::string unit_of_lengths(const CrsFacts& crs) {
  return crs.geographic ? "metre" : crs.horizontal_unit;
}

/// The length of all lines together.
double total_length(const ProfileResult& profile) {
  double length = 0.0;
  for (const auto& line : lines_of(profile)) length += line.back().distance;
  return length;
}

/// The profile as CSV: heights, with the interval that the certificate guarantees.
std::string csv_of(const ProfileOptions& options, const ProfileResult& profile,
                   const std::vector<std::string>& ids) {
  std::string text = "distance,x,y,height,state,line,height_min,height_max";
  if (options.stations) text += ",station";
  text += ids.empty() ? "\n" : ",id\n";
  for (const ProfilePoint& p : profile.points) {
    for (const double value : {p.distance, p.position.x, p.position.y}) {
      append_number(text, value);
      text += ',';
    }
    if (std::isfinite(p.height)) append_number(text, p.height);
    text.append(",").append(name_of(p.state)).append(",").append(std::to_string(p.line));
    for (const double off : {-profile.certified_deviation, profile.certified_deviation}) {
      append_csv_number(text, p.height + off);
    }
    if (options.stations) text += p.is_station ? ",1" : ",0";
    if (!ids.empty()) append_csv_field(text += ',', ids[p.line]);
    text += '\n';
  }
  return text;
}

/// The stretches of one line that have heights.
std::unique_ptr<OGRGeometry> stretches_of(std::span<const ProfilePoint> points) {
  auto stretches = std::make_unique<OGRMultiLineString>();
  auto stretch = std::make_unique<OGRLineString>();
  const auto end_stretch = [&] {
    if (stretch->getNumPoints() > 1) stretches->addGeometryDirectly(stretch.release());
    stretch = std::make_unique<OGRLineString>();
  };
  for (const ProfilePoint& p : points) {
    const bool ground = std::isfinite(p.height);
    if (ground) stretch->addPoint(p.position.x, p.position.y, p.height);
    if (!ground || p.state != PointState::kSurface) end_stretch();
  }
  end_stretch();
  stretches->set3D(TRUE);
  return stretches;
}

/// Writes the profile as a layer, a feature for each line.
void write_layer(const AnswerOptions& options, const ProfileResult& profile,
                 const std::vector<std::string>& ids, const CrsFacts& crs) {
  using Type = VectorFile::FieldType;
  VectorFile::Layer layer{"profile",
                          wkbMultiLineString25D,
                          {{"line", Type::kInteger},
                           {"length", Type::kReal},
                           {"certified_error", Type::kReal},
                           {"certified_deviation", Type::kReal},
                           {"exact", Type::kBoolean}},
                          crs.wkt};
  if (!ids.empty()) layer.fields.push_back({"id", Type::kText});
  VectorFile file(options.output, options.overwrite, layer);
  for (const std::span<const ProfilePoint> line : lines_of(profile)) {
    const auto number = static_cast<std::int64_t>(line.front().line);
    std::vector<VectorFile::Value> values = {number, line.back().distance, profile.certified_error,
                                             profile.certified_deviation,
                                             std::int64_t{profile.exact ? 1 : 0}};
    if (!ids.empty()) values.emplace_back(ids[line.front().line]);
    file.add(stretches_of(line), values);
  }
  file.publish();
}

/// Writes stations as a layer, a feature for each.
void write_stations(const AnswerOptions& options, const ProfileResult& profile,
                    const std::vector<std::string>& ids, const CrsFacts& crs) {
  using Type = VectorFile::FieldType;
  VectorFile::Layer layer{"stations",
                          wkbPoint25D,
                          {{"line", Type::kInteger},
                           {"distance", Type::kReal},
                           {"height", Type::kReal},
                           {"state", Type::kText},
                           {"certified_deviation", Type::kReal}},
                          crs.wkt};
  if (!ids.empty()) layer.fields.push_back({"id", Type::kText});
  VectorFile file(options.output, options.overwrite, layer);
  for (const ProfilePoint& p : profile.points) {
    std::vector<VectorFile::Value> values = {std::int64_t{p.line}, p.distance, p.height,
                                             std::string(name_of(p.state)),
                                             profile.certified_deviation};
    if (!ids.empty()) values.emplace_back(ids[p.line]);
    const double z = std::isfinite(p.height) ? p.height : 0.0;  // the field tells what is unknown
    file.add(std::make_unique<OGRPoint>(p.position.x, p.position.y, z), values);
  }
  file.publish();
}

/// How the plot names units, and how distances and heights compare.
PlotUnits plot_units_of(const CrsFacts& crs) {
  const Ground ground = ground_of(crs);
  const double heights =
      ground.geographic ? 1 / ground.metres_per_height : ground.per_map_unit({}).x;
  return {unit_of_lengths(crs), crs.vertical_unit, heights};
}

/// Puts the profile where it is asked for.
void write_profile(const ProfileOptions& options, bool json, const ProfileResult& profile,
                   const std::vector<std::string>& ids, const CrsFacts& crs) {
  const AnswerOptions& answer = options.answer;
  const AnswerForm form = form_of(answer, json, {.plot = true});
  if (form == AnswerForm::kLayer && options.stations_only) {
    write_stations(answer, profile, ids, crs);
  } else if (form == AnswerForm::kLayer) {
    write_layer(answer, profile, ids, crs);
  } else if (form == AnswerForm::kPlot) {
    plot_profile(answer.output, answer.overwrite, profile, ids, plot_units_of(crs));
  } else if (form == AnswerForm::kCsv || !json) {
    write_csv(answer, form, json, csv_of(options, profile, ids));
  }
}

nlohmann::json answer_of(const ProfileOptions& options, const ProfileResult& result,
                         const Asked<std::vector<MapPoint>>& asked, const StoreFile& store,
                         const CrsFacts& crs) {
  const std::vector<std::string>& ids = asked.ids;
  nlohmann::json units = units_json(crs);
  units["length"] = unit_of_lengths(crs);
  nlohmann::json answer = {
      {"output", output_json(options.answer)},
      {"lines", lines_of(result).size()},
      {"skipped_lines", result.skipped_lines},
      {"length", total_length(result)},
      {"certified_error", result.certified_error},
      {"certified_deviation", result.certified_deviation},
      {"border_moved_at_most", border_move_json(store, result.certified_error)},
      {"exact", result.exact},
      {"transformed", transformed_json(asked.transformed)},
      {"units", units},
      {"cost", cost_json(result.cost)},
      {"points", nlohmann::json::array()}};
  if (!ids.empty()) answer["ids"] = ids;
  for (const ProfilePoint& p : result.points) {
    answer["points"].push_back({{"line", p.line},
                                {"distance", p.distance},
                                {"x", p.position.x},
                                {"y", p.position.y},
                                {"height", p.height},
                                {"state", name_of(p.state)}});
    if (options.stations) answer["points"].back()["station"] = p.is_station;
  }
  return answer;
}

int run_profile(const ProfileOptions& options, const Context& context) {
  if (const AnswerForm form =
          form_of(options.answer, context.json, {.plot = true});  // before the work
      form == AnswerForm::kPlot && options.stations_only) {
    refuse("a plot draws the ground between stations too; leave --stations-only out",
           options.answer.output);
  }
  const Terrain terrain = open_terrain(options.terrain, context);
  warn_of_terrain(terrain.store(), options.detail.error, context);
  const CrsFacts crs = crs_facts(terrain.store());
  const Asked<std::vector<MapPoint>> asked =
      read_lines(options.line, options.choice, plane_of(terrain.store().facts(), crs));
  tell_transformed(asked.transformed, "the lines", crs, context);
  const std::vector<std::vector<MapPoint>>& lines = asked.all;
  ProfileRequest request;
  request.detail = detail_of(options.detail);
  request.limits = limits_of(options.memory, context);
  request.station_step = options.stations.value_or(0.0);
  if (const Ground ground = ground_of(crs); ground.geographic) {  // Degrees are no lengths.
    request.ground_distance = [ground](MapPoint a, MapPoint b) {
      return ground.distance(a, b) * ground.metres_per_height;
    };
  }
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
  write_profile(options, context.json, result, asked.ids, crs);
  if (context.json) print_json(answer_of(options, result, asked, terrain.store(), crs));
  return kExitDone;
}

}  // namespace

Action declare_profile(CLI::App& app, Context& context) {
  const auto options = std::make_shared<ProfileOptions>();
  add_terrain_options(app, options->terrain, false);
  auto* line =
      app.add_option("--line", options->line,
                     "Lines: WKT (LINESTRING, MULTILINESTRING), or a file with it, or a vector "
                     "file (transformed to the terrain's CRS)");
  line->type_name("WKT_OR_FILE")->required();
  add_input_options(app, options->choice, line, "");
  auto* stations =
      options->terrain.measures
          .add(app, "--stations", options->stations, MeasureKind::kGround, NumberRange::kPositive,
               "Beside the breaks, heights at equal distances: map units (in degrees "
               "metres), or 50m, 0.1km, 200ft")
          ->type_name("D");
  app.add_flag("--stations-only", options->stations_only,
               "The stations alone: rows of CSV, or points of a layer")
      ->needs(stations);
  add_detail_options(app, options->terrain.measures, options->detail, "",
                     "Ask the TIN of the terrain's N most important vertices");
  add_memory_option(app, options->memory);
  add_answer_options(app, options->answer, {.plot = true});
  return [options, &context] { return run_profile(*options, context); };
}

}  // namespace ptin::tools
