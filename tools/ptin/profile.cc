// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin profile: heights along a line, as CSV, a layer or a picture.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <ogr_geometry.h>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/query/terrain.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/formats/csv_text.h"
#include "tools/formats/number_text.h"
#include "tools/formats/vector_file.h"
#include "tools/ptin/answer_output.h"
#include "tools/ptin/point_input.h"
#include "tools/ptin/query_options.h"
#include "tools/render/overlay.h"

namespace ptin::tools {

namespace {

struct ProfileOptions {
  TerrainOptions terrain;
  std::string line;
  InputChoice choice;
  DetailOptions detail;
  std::string memory;
  AnswerOptions answer;
};

/// The unit of distances along the lines.
std::string unit_of_lengths(const CrsFacts& crs) {
  return crs.geographic ? "metre" : crs.horizontal_unit;
}

/// The points of the profile, line by line.
std::vector<std::span<const ProfilePoint>> lines_of(const ProfileResult& profile) {
  std::vector<std::span<const ProfilePoint>> lines;
  const std::span<const ProfilePoint> all(profile.points);
  for (std::size_t begin = 0, i = 1; i <= all.size(); ++i) {
    if (i < all.size() && all[i].line == all[begin].line) continue;
    lines.push_back(all.subspan(begin, i - begin));
    begin = i;
  }
  return lines;
}

/// The length of all lines together.
double length_of(const ProfileResult& profile) {
  double length = 0.0;
  for (const auto& line : lines_of(profile)) length += line.back().distance;
  return length;
}

/// The profile as CSV: heights, with the interval that the certificate guarantees.
std::string csv_of(const ProfileResult& profile, const std::vector<std::string>& ids) {
  std::string text = "distance,x,y,height,state,line,height_min,height_max";
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

/// A number for a plot, with its unit where that has a short name.
std::string label_of(double value, const std::string& unit) {
  const bool metres = unit == "metre" || unit == "m" || unit == "meter";
  const bool kilo = metres && std::abs(value) >= 10'000;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.5g", kilo ? value / 1000 : value);
  return std::string(text.data()).append(metres ? (kilo ? " km" : " m") : "");
}

/// A plot of the profile: distance to the right, height upwards, both filling the picture, lines
/// one behind the other. A grey line stands at the lowest and at the highest height. These heights
/// are written beside it, and so is the length.
Image plot_of(const ProfileResult& profile, const CrsFacts& crs) {
  constexpr int kWidth = 1200, kHeight = 400, kMargin = 20;
  constexpr Colour kPaper{255, 255, 255}, kLine{150, 60, 30}, kFrame{200, 200, 200};
  Image image(kWidth, kHeight, kPaper);
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const ProfilePoint& p : profile.points) {
    if (std::isfinite(p.height)) low = std::min(low, p.height), high = std::max(high, p.height);
  }
  const double range = high > low ? high - low : 1.0;
  const double length = length_of(profile);
  double before = 0.0;
  const auto x = [&](const ProfilePoint& p) {
    return kMargin + (kWidth - 2 * kMargin) * (before + p.distance) / length;
  };
  const auto y = [&](const ProfilePoint& p) {
    return kHeight - kMargin - (kHeight - 2 * kMargin) * (p.height - low) / range;
  };
  for (const int row : {kMargin, kHeight - kMargin}) {
    draw_line(image, kMargin, row, kWidth - kMargin, row, kFrame, 1.0);
  }
  for (const std::span<const ProfilePoint> line : lines_of(profile)) {
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      if (line[i].state != PointState::kSurface) continue;
      draw_line(image, x(line[i]), y(line[i]), x(line[i + 1]), y(line[i + 1]), kLine, 1.0);
    }
    before += line.back().distance;
  }
  if (low <= high) {
    draw_text(image, kMargin, kMargin - 12, label_of(high, crs.vertical_unit));
    draw_text(image, kMargin, kHeight - kMargin + 6, label_of(low, crs.vertical_unit));
  }
  if (profile.certified_deviation > 0) {
    const std::string within = "+/- " + label_of(profile.certified_deviation, crs.vertical_unit);
    draw_text(image, kWidth - kMargin - text_width(within), kMargin - 12, within);
  }
  const std::string end = label_of(length, unit_of_lengths(crs));
  draw_text(image, kWidth - kMargin - text_width(end), kHeight - kMargin + 6, end);
  return image;
}

/// Puts the profile where it is asked for.
void write_profile(const AnswerOptions& options, AnswerForm form, bool json,
                   const ProfileResult& profile, const std::vector<std::string>& ids,
                   const CrsFacts& crs) {
  if (form == AnswerForm::kLayer) {
    write_layer(options, profile, ids, crs);
  } else if (form == AnswerForm::kOther) {
    write_png(plot_of(profile, crs), options.output, options.overwrite);
  } else if (form == AnswerForm::kCsv || !json) {
    write_csv(options, form, json, csv_of(profile, ids));
  }
}

nlohmann::json answer_of(const ProfileOptions& options, const ProfileResult& result,
                         const std::vector<std::string>& ids, const StoreFile& store,
                         const CrsFacts& crs) {
  nlohmann::json units = units_json(crs);
  units["length"] = unit_of_lengths(crs);
  nlohmann::json answer = {
      {"output", output_json(options.answer)},
      {"lines", lines_of(result).size()},
      {"skipped_lines", result.skipped_lines},
      {"length", length_of(result)},
      {"certified_error", result.certified_error},
      {"certified_deviation", result.certified_deviation},
      {"border_moved_at_most", border_move_json(store, result.certified_error)},
      {"exact", result.exact},
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
  }
  return answer;
}

int run_profile(const ProfileOptions& options, const Context& context) {
  const AnswerForm form = form_of(options.answer, context.json, ".png");
  check_detail(options.detail);
  const Terrain terrain = open_terrain(options.terrain);
  warn_of_base_error(terrain.store(), options.detail.error, context);
  const CrsFacts crs = crs_facts(terrain.store());
  const Asked<std::vector<MapPoint>> asked = read_lines(options.line, options.choice, crs.wkt);
  const std::vector<std::vector<MapPoint>>& lines = asked.all;
  ProfileRequest request;
  request.detail = detail_of(options.detail);
  request.limits = limits_of(options.memory, context);
  if (const Ground ground = ground_of(crs); ground.geographic) {  // Degrees are no lengths.
    request.ground_distance = [ground](MapPoint a, MapPoint b) {
      return ground.distance(a, b) * ground.metres_per_height;
    };
  }
  const ProfileResult result = terrain.profile(lines, request);
  if (result.skipped_lines > 0 && !context.json && !context.quiet) {
    std::fprintf(stderr, "%s of %s: no length, skipped\n", grouped(result.skipped_lines).c_str(),
                 counted(lines.size(), "line").c_str());
  }
  write_profile(options.answer, form, context.json, result, asked.ids, crs);
  if (context.json) print_json(answer_of(options, result, asked.ids, terrain.store(), crs));
  return kExitDone;
}

}  // namespace

Action declare_profile(CLI::App& app, Context& context) {
  const auto options = std::make_shared<ProfileOptions>();
  add_terrain_options(app, options->terrain, true);
  auto* line =
      app.add_option("--line", options->line,
                     "Lines: WKT (LINESTRING, MULTILINESTRING), or a file with it, or a vector "
                     "file (transformed to the terrain's CRS)");
  line->type_name("WKT_OR_FILE")->required();
  add_input_options(app, options->choice, line, "");
  add_detail_options(app, options->detail, "",
                     "Ask the TIN of the terrain's N most important vertices");
  add_memory_option(app, options->memory);
  add_answer_options(app, options->answer, ", .png (a plot)");
  return [options, &context] { return run_profile(*options, context); };
}

}  // namespace ptin::tools
