// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/serving.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "engine/crs/base_map.h"
#include "engine/crs/credits.h"
#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "tools/region/on_terrain.h"

namespace ptin::tools {

namespace {

[[noreturn]] void throw_unreadable(const std::string& why) {
  throw Error(ErrorCode::invalid_argument,
              why +
                  "; expected what `ptin unstream --json` prints as \"have\": a list of objects "
                  "with window, error, levels and splits",
              "--have");
}

Serving serving_of(const nlohmann::json& json) {
  if (!json.is_object()) throw_unreadable("a serving is no object");
  Serving serving;
  try {
    for (const auto& [name, value] : json.items()) {
      if (name == "window") {
        value.get_to(serving.window);
      } else if (name == "error") {
        serving.error = value.get<double>();
      } else if (name == "levels") {
        value.get_to(serving.levels);
      } else if (name == "splits") {
        if (!value.is_number_unsigned()) throw_unreadable("splits is no whole number >= 0");
        serving.splits = value.get<std::uint64_t>();
      } else {
        throw_unreadable("\"" + name + "\" is no part of a serving");
      }
    }
  } catch (const nlohmann::json::exception&) {
    throw_unreadable("a value is not of its type");
  }
  if (!serving.window.empty() && serving.window.size() != 4) {
    throw_unreadable("a window has four numbers");
  }
  return serving;
}

}  // namespace

PredicatePtr predicate_of(const Serving& serving, const StoreFacts& facts,
                          const std::string& option) {
  std::vector<PredicatePtr> parts;
  if (!serving.window.empty()) {
    const Window window = window_of(serving.window, option);
    check_on_terrain(window, facts, option);
    parts.push_back(meets_region(window, facts.map));
  }
  if (serving.error) parts.push_back(error_above(*serving.error));
  if (!serving.levels.empty()) {
    // By the rule of isolines, by which 254.97 is the stored height 25497 x 0.01.
    parts.push_back(LevelSet(serving.levels, facts.heights).crossing());
  }
  return all_of(std::move(parts));
}

bool covers(const std::vector<Serving>& served, const Serving& asked) {
  const std::vector<double>& inner = asked.window;
  const auto has_window = [&](const Serving& s) {
    const std::vector<double>& outer = s.window;
    return outer.empty() || (outer[0] <= inner[0] && outer[1] <= inner[1] && inner[2] <= outer[2] &&
                             inner[3] <= outer[3]);
  };
  const auto has = [&](const Serving& s, double level) {
    return has_window(s) && (s.levels.empty() ||
                             std::find(s.levels.begin(), s.levels.end(), level) != s.levels.end());
  };
  if (asked.levels.empty()) {
    return std::any_of(served.begin(), served.end(),
                       [&](const Serving& s) { return has_window(s) && s.levels.empty(); });
  }
  return std::all_of(asked.levels.begin(), asked.levels.end(), [&](double level) {
    return std::any_of(served.begin(), served.end(),
                       [&](const Serving& s) { return has(s, level); });
  });
}

nlohmann::json to_json(const Serving& serving) {
  nlohmann::json json = nlohmann::json::object();
  if (!serving.window.empty()) json["window"] = serving.window;
  if (serving.error) json["error"] = *serving.error;
  if (!serving.levels.empty()) json["levels"] = serving.levels;
  if (serving.splits) json["splits"] = *serving.splits;
  return json;
}

std::vector<Serving> servings_of(const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) throw_unreadable("this is no JSON");
  std::vector<Serving> servings;
  if (!json.is_array()) return {serving_of(json)};
  for (const nlohmann::json& one : json) servings.push_back(serving_of(one));
  return servings;
}

std::string metadata_of_stream(const StoreFile& store, const Serving& wanted) {
  const nlohmann::json all = metadata_of(store);
  nlohmann::json metadata = {{"request", to_json(wanted)}};
  for (const char* name : {"crs", "crs_wkt", "units"}) {
    if (const auto it = all.find(name); it != all.end()) metadata[name] = *it;
  }
  // A receiver without a library of projections tells lengths over ground by these.
  metadata["ground"] = json_of(ground_facts_of(crs_facts_of(all)));
  if (metadata.contains("crs") && metadata["crs"].is_object()) metadata["crs"].erase("facts");
  add_credits(metadata, credits_of(all));
  add_base_map(metadata, base_map_of(all));
  metadata["free_of_voids"] = store.facts().free_of_voids;
  const nlohmann::json options = all.value("options", nlohmann::json::object());
  if (const auto it = options.find("void_slope"); it != options.end()) {
    metadata["options"] = {{"void_slope", *it}};
  }
  return metadata.dump();
}

}  // namespace ptin::tools
