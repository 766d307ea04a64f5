// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/source_samples.h"

#include <algorithm>
#include <limits>

#include <nlohmann/json.hpp>

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
  const nlohmann::json metadata = metadata_of(store);
  const auto it = metadata.find("options");
  const nlohmann::json options =
      it != metadata.end() && it->is_object() ? *it : nlohmann::json::object();
  SampleChoices choices;
  if (const auto nodata = options.find("nodata"); nodata != options.end()) {
    choices.nodata = nodata_of(*nodata);
  }
  if (const auto slope = options.find("void_slope"); slope != options.end() && slope->is_number()) {
    choices.void_slope = slope->get<double>();
  }
  if (const auto step = options.find("resolution"); step != options.end() && step->is_number()) {
    choices.resolution = step->get<double>();
  }
  if (const auto edge = options.find("max_edge"); edge != options.end() && edge->is_number()) {
    choices.max_edge = edge->get<double>();
  }
  if (const auto classes = options.find("classes");
      classes != options.end() && classes->is_array()) {
    for (const auto& c : *classes) {
      if (c.is_number_integer()) choices.points.classes.push_back(c.get<int>());
    }
  }
  const auto text = [&](const char* name) {
    const auto found = options.find(name);
    return found != options.end() && found->is_string() ? found->get<std::string>() : "";
  };
  if (const auto names = options.find("columns"); names != options.end() && names->is_array()) {
    for (const auto& name : *names) {
      if (name.is_string()) choices.points.columns.push_back(name.get<std::string>());
    }
  }
  const std::string returns = text("returns"), duplicates = text("duplicates");
  if (returns == "first") choices.points.returns = ReturnChoice::kFirst;
  if (returns == "last") choices.points.returns = ReturnChoice::kLast;
  if (duplicates == "min") choices.duplicates = PointMerge::kLowest;
  if (duplicates == "max") choices.duplicates = PointMerge::kHighest;
  if (duplicates == "first") choices.duplicates = PointMerge::kFirst;
  const auto skips = options.find("skip_invalid");
  choices.points.skip_invalid = skips != options.end() && skips->is_boolean() && skips->get<bool>();
  choices.points.layer = text("layer");
  choices.points.z_field = text("z_field");
  if (const auto bbox = options.find("bbox");
      bbox != options.end() && bbox->is_array() && bbox->size() == 4) {
    choices.bbox = store.facts().bounds;
    if (std::all_of(bbox->begin(), bbox->end(), [](const auto& v) { return v.is_number(); })) {
      choices.asked_bbox = bbox->get<std::array<double, 4>>();
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
  throw Error(ErrorCode::invalid_argument,
              "not the source of this file: " + what +
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

}  // namespace

void check_is_source(const std::vector<std::string>& paths, const StoreFile& store,
                     const SampleResources& resources) {
  check_all_there(paths);
  if (!open_raster_samples(paths, store)) check_first_points(paths, store, resources);
}

std::unique_ptr<SourceSamples> open_samples(const std::vector<std::string>& paths,
                                            const StoreFile& store,
                                            const SampleResources& resources) {
  check_all_there(paths);
  std::unique_ptr<SourceSamples> samples = open_raster_samples(paths, store);
  if (samples && !resources.lines.is_empty()) {
    throw Error(ErrorCode::invalid_argument,
                "--breaklines and --boundary are for points, and this is a raster; leave them out",
                paths.front());
  }
  return samples ? std::move(samples) : open_point_samples(paths, store, resources);
}

}  // namespace ptin::tools
