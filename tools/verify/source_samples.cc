// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/source_samples.h"

#include <algorithm>
#include <limits>

#include <nlohmann/json.hpp>

#include "engine/construct/read/input_kind.h"
#include "engine/construct/source_files.h"
#include "engine/crs/crs_facts.h"
#include "engine/error.h"
#include "storage/file/file_questions.h"
#include "tools/facts/human.h"

namespace ptin::tools {

namespace {

/// The nodata value in the metadata: a number, or one of the words "nan", "inf" and "-inf", since
/// JSON has no numbers for these.
std::optional<double> nodata_of(const nlohmann::json& value) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (value.is_number()) return value.get<double>();
  if (value == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (value == "inf") return kInfinity;
  if (value == "-inf") return -kInfinity;
  return std::nullopt;
}

}  // namespace

SampleChoices choices_of(const StoreFile& store) {
  const nlohmann::json options = options_of_build(store);
  const auto of_name = [&](const char* name) {
    const auto found = options.find(name);
    return found != options.end() ? *found : nlohmann::json();
  };
  const auto number = [&](const char* name) {
    const nlohmann::json value = of_name(name);
    return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
  };
  const auto text = [&](const char* name) {
    const nlohmann::json value = of_name(name);
    return value.is_string() ? value.get<std::string>() : "";
  };
  SampleChoices choices;
  choices.nodata = nodata_of(of_name("nodata"));
  choices.void_slope = number("void_slope").value_or(0.0);
  choices.resolution = number("resolution");
  choices.max_edge = number("max_edge");
  for (const nlohmann::json& c : of_name("classes")) {
    if (c.is_number_integer()) choices.points.classes.push_back(c.get<int>());
  }
  for (const nlohmann::json& name : of_name("columns")) {
    if (name.is_string()) choices.points.columns.push_back(name.get<std::string>());
  }
  const std::string returns = text("returns"), duplicates = text("duplicates");
  if (returns == "first") choices.points.returns = ReturnChoice::kFirst;
  if (returns == "last") choices.points.returns = ReturnChoice::kLast;
  if (duplicates == "min") choices.duplicates = PointMerge::kLowest;
  if (duplicates == "max") choices.duplicates = PointMerge::kHighest;
  if (duplicates == "first") choices.duplicates = PointMerge::kFirst;
  choices.points.skip_invalid = of_name("skip_invalid") == true;
  choices.points.layer = text("layer");
  choices.points.z_field = text("z_field");
  if (const nlohmann::json bbox = of_name("bbox"); bbox.is_array() && bbox.size() == 4) {
    choices.bbox.emplace();
    for (std::size_t i = 0; i < 4; ++i) {
      // JSON has no infinite numbers: what is none leaves its side open.
      const double open = (i < 2 ? -1 : 1) * std::numeric_limits<double>::infinity();
      (*choices.bbox)[i] = bbox[i].is_number() ? bbox[i].get<double>() : open;
    }
  }
  return choices;
}

std::string inputs_text(const std::vector<std::string>& paths) {
  if (paths.size() == 1) return paths.front();
  return paths.front() + " and " + counted(paths.size() - 1, "more input");
}

void check_extent(const SourceExtent& extent, const std::vector<std::string>& paths,
                  const StoreFacts& facts, const SampleChoices& choices) {
  const GridBox& b = facts.bounds;
  const bool same = extent.min_x == b.min_x && extent.min_y == b.min_y && extent.max_x == b.max_x &&
                    extent.max_y == b.max_y;
  const bool covers = extent.min_x <= b.min_x && extent.min_y <= b.min_y &&
                      extent.max_x >= b.max_x && extent.max_y >= b.max_y;
  if (same || (choices.bbox && covers)) return;
  const auto text = [&](double min_x, double min_y, double max_x, double max_y) {
    const MapPoint low = facts.map.to_map(min_x, min_y);
    const MapPoint high = facts.map.to_map(max_x, max_y);
    return exact_number(low.x) + " " + exact_number(low.y) + " to " + exact_number(high.x) + " " +
           exact_number(high.y);
  };
  const std::string what = extent.min_x <= extent.max_x
                               ? "its samples reach from " +
                                     text(extent.min_x, extent.min_y, extent.max_x, extent.max_y) +
                                     ", the terrain's from " +
                                     text(b.min_x, b.min_y, b.max_x, b.max_y)
                               : "it holds no sample";
  refuse("not the source of this file: " + what +
             "; name every input of the build behind --against, and no other",
         inputs_text(paths));
}

namespace {

void check_all_there(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    if (path.rfind("/vsi", 0) != 0 && !is_there(path)) {
      throw Error(ErrorCode::not_found, "no such file", path);
    }
  }
}

bool are_rasters(const std::vector<std::string>& paths, const StoreFile& store) {
  const PointChoice choice = choices_of(store).points;
  return std::all_of(paths.begin(), paths.end(), [&](const std::string& path) {
    return kind_of_input(path, choice) == InputKind::kRaster;
  });
}

}  // namespace

void check_is_source(const std::vector<std::string>& inputs, const StoreFile& store,
                     const SampleResources& resources) {
  const std::vector<std::string> paths = with_folders_opened(inputs);
  check_all_there(paths);
  if (are_rasters(paths, store)) {
    static_cast<void>(open_raster_samples(paths, store));
  } else {
    check_first_points(paths, store, resources);
  }
}

std::unique_ptr<SourceSamples> open_samples(const std::vector<std::string>& inputs,
                                            const StoreFile& store,
                                            const SampleResources& resources) {
  const std::vector<std::string> paths = with_folders_opened(inputs);
  check_all_there(paths);
  if (!are_rasters(paths, store)) return open_point_samples(paths, store, resources);
  if (!resources.lines.is_empty()) {
    refuse("--breaklines and --boundary are for points, and this is a raster; leave them out",
           paths.front());
  }
  return open_raster_samples(paths, store);
}

}  // namespace ptin::tools
