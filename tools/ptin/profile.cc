// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin profile: heights along a line, as CSV, GeoJSON or a picture.
#include "engine/query/profile.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>

#include "engine/error.h"
#include "tools/error_status.h"
#include "tools/formats/number_text.h"
#include "tools/output_file.h"
#include "tools/ptin/answers.h"
#include "tools/ptin/crs_facts.h"
#include "tools/ptin/number_rows.h"
#include "tools/ptin/query_options.h"
#include "tools/render/overlay.h"

namespace ptin::tools {

namespace {

struct ProfileOptions {
  TerrainOptions terrain;
  std::string line;
  std::optional<double> error;
  std::string output;
  bool overwrite = false;
};

std::string csv_of(const ProfileResult& profile) {
  std::string text = "distance,x,y,height,state\n";
  for (const ProfilePoint& p : profile.points) {
    for (const double value : {p.distance, p.position.x, p.position.y}) {
      append_number(text, value);
      text += ',';
    }
    if (std::isfinite(p.height)) append_number(text, p.height);
    text.append(",").append(name_of(p.state)).append("\n");
  }
  return text;
}

/// Adds the member `crs` of GeoJSON 2008, as GDAL does, where the CRS has a code and is not WGS 84
/// (which GeoJSON means without it).
void add_crs(const CrsFacts& crs, nlohmann::json& collection) {
  const std::size_t colon = crs.code.find(':');
  if (colon == std::string::npos || crs.code == "EPSG:4326") return;
  const std::string name =
      "urn:ogc:def:crs:" + crs.code.substr(0, colon) + "::" + crs.code.substr(colon + 1);
  collection["crs"] = {{"type", "name"}, {"properties", {{"name", name}}}};
}

/// A MultiLineString of the stretches over ground, with heights.
nlohmann::json geojson_of(const ProfileResult& profile, const CrsFacts& crs) {
  nlohmann::json lines = nlohmann::json::array();
  nlohmann::json line = nlohmann::json::array();
  for (const ProfilePoint& p : profile.points) {
    const bool ground = std::isfinite(p.height);
    if (ground) line.push_back({p.position.x, p.position.y, p.height});
    if (!ground || p.state != PointState::kSurface) {
      if (line.size() > 1) lines.push_back(line);
      line = nlohmann::json::array();
    }
  }
  if (line.size() > 1) lines.push_back(line);
  const nlohmann::json properties = {{"certified_error", profile.certified_error},
                                     {"certified_deviation", profile.certified_deviation},
                                     {"exact", profile.exact}};
  const nlohmann::json feature = {
      {"type", "Feature"},
      {"properties", properties},
      {"geometry", {{"type", "MultiLineString"}, {"coordinates", lines}}}};
  nlohmann::json collection = {{"type", "FeatureCollection"},
                               {"features", nlohmann::json::array({feature})}};
  add_crs(crs, collection);
  return collection;
}

/// Distance to the right, height upwards, both filling the picture; a line at each end of the
/// heights.
Image plot_of(const ProfileResult& profile) {
  constexpr int kWidth = 1200, kHeight = 400, kMargin = 20;
  constexpr Colour kPaper{255, 255, 255}, kLine{150, 60, 30}, kFrame{200, 200, 200};
  Image image(kWidth, kHeight, kPaper);
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const ProfilePoint& p : profile.points) {
    if (std::isfinite(p.height)) low = std::min(low, p.height), high = std::max(high, p.height);
  }
  const double range = high > low ? high - low : 1.0;
  const double length = profile.points.back().distance;
  const auto x = [&](const ProfilePoint& p) {
    return kMargin + (kWidth - 2 * kMargin) * p.distance / length;
  };
  const auto y = [&](const ProfilePoint& p) {
    return kHeight - kMargin - (kHeight - 2 * kMargin) * (p.height - low) / range;
  };
  for (const int row : {kMargin, kHeight - kMargin}) {
    draw_line(image, kMargin, row, kWidth - kMargin, row, kFrame, 1.0);
  }
  for (std::size_t i = 0; i + 1 < profile.points.size(); ++i) {
    const ProfilePoint& a = profile.points[i];
    const ProfilePoint& b = profile.points[i + 1];
    if (a.state == PointState::kSurface) draw_line(image, x(a), y(a), x(b), y(b), kLine, 1.0);
  }
  return image;
}

void write_profile(const ProfileOptions& options, const ProfileResult& profile,
                   const CrsFacts& crs) {
  const std::string extension = std::filesystem::path(options.output).extension().string();
  if (extension == ".png") {
    write_png(plot_of(profile), options.output, options.overwrite);
    return;
  }
  OutputFile out(options.output, options.overwrite);
  out.write(extension == ".csv" ? csv_of(profile) : geojson_of(profile, crs).dump() + "\n");
  out.publish();
}

void check_output_name(const ProfileOptions& options) {
  if (options.output.empty()) return;
  const std::string extension = std::filesystem::path(options.output).extension().string();
  if (extension != ".png" && extension != ".csv" && extension != ".geojson" &&
      extension != ".json") {
    throw Error(ErrorCode::invalid_argument,
                "unknown format; end the name in .csv, .geojson or .png", options.output);
  }
  check_output(options.output, options.overwrite);
}

int run_profile(const ProfileOptions& options, const Context& context) {
  check_output_name(options);
  const std::vector<MapPoint> line = read_line(options.line);
  const ProgressiveTin terrain = open_terrain(options.terrain);
  const CrsFacts crs = crs_facts(terrain.store());
  ProfileRequest request;
  request.tolerance = options.error;
  request.stop = context.stop;
  const ProfileResult result = profile(terrain, line, request);
  if (!options.output.empty()) write_profile(options, result, crs);
  if (context.json) {
    nlohmann::json answer = {
        {"certified_error", result.certified_error},
        {"certified_deviation", result.certified_deviation},
        {"exact", result.exact},
        {"length", result.points.back().distance},
        {"units", {{"horizontal", crs.horizontal_unit}, {"height", crs.vertical_unit}}},
        {"cost", cost_json(result.cost)},
        {"points", nlohmann::json::array()}};
    for (const ProfilePoint& p : result.points) {
      answer["points"].push_back({{"distance", p.distance},
                                  {"x", p.position.x},
                                  {"y", p.position.y},
                                  {"height", p.height},
                                  {"state", name_of(p.state)}});
    }
    print_json(answer);
  } else if (options.output.empty()) {
    const std::string text = csv_of(result);
    std::fwrite(text.data(), 1, text.size(), stdout);
  }
  return kExitDone;
}

}  // namespace

Action declare_profile(CLI::App& app, Context& context) {
  const auto options = std::make_shared<ProfileOptions>();
  add_terrain_options(app, options->terrain, true);
  app.add_option("--line", options->line, "A line: WKT, or a file that holds it")
      ->type_name("WKT_OR_FILE")
      ->required();
  app.add_option("--error", options->error, "Certified error allowed, in the height's unit")
      ->type_name("E");
  app.add_option("-o,--output", options->output,
                 "Write .csv, .geojson (with heights) or .png (a plot); default: CSV to stdout")
      ->type_name("OUT");
  app.add_flag("--overwrite", options->overwrite, "Replace an existing output");
  add_common_options(app, context, false);
  return [options, &context] { return run_profile(*options, context); };
}

}  // namespace ptin::tools
