// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin info: what a file holds, without reading its record pages.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "engine/crs/base_map.h"
#include "engine/crs/credits.h"
#include "engine/crs/crs_facts.h"
#include "storage/index_shape.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/ptin/error_stats.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

constexpr double kQuantiles[] = {0.5, 0.9, 0.99, 0.999, 1.0};

nlohmann::json text_or_null(const std::string& text) {
  return text.empty() ? nlohmann::json() : nlohmann::json(text);
}

nlohmann::json crs_json(const CrsFacts& crs) {
  return {{"wkt", text_or_null(crs.wkt)},
          {"name", text_or_null(crs.name)},
          {"code", text_or_null(crs.code)},
          {"vertical_known", !crs.vertical_name.empty()},
          {"vertical_name", text_or_null(crs.vertical_name)},
          {"vertical_code", text_or_null(crs.vertical_code)},
          {"geographic", crs.geographic}};
}

nlohmann::json bounds_json(const StoreFacts& facts) {
  const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint high = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  return {{"min_x", low.x}, {"min_y", low.y}, {"max_x", high.x}, {"max_y", high.y}};
}

nlohmann::json heights_json(const StoreFacts& facts) {
  if (facts.min_height > facts.max_height) return nullptr;  // All of it is void.
  return {{"min", facts.min_height},
          {"max", facts.max_height},
          {"stored_as", facts.heights.type == HeightType::int32 ? "int32" : "float32"},
          {"step", facts.heights.step},
          {"offset", facts.heights.offset}};
}

nlohmann::json tree_json(const StoreFile& store) {
  const IndexShape& shape = store.index_shape();
  nlohmann::json levels = nlohmann::json::array();
  for (std::uint32_t level = shape.levels(); level-- > 0;) levels.push_back(shape.nodes(level));
  return {{"page_bytes", store.pages().page_bytes()},
          {"pages", store.pages().page_count()},
          {"fan_out", layout::kFanOut},
          {"nodes_of_levels", levels}};
}

nlohmann::json errors_json(const StoreFile& store, const char* key) {
  nlohmann::json rows = nlohmann::json::array();
  for (const double share : kQuantiles) {
    rows.push_back({{"share", share}, {key, error_quantile(store, share)}});
  }
  return rows;
}

/// What opening a file that lies elsewhere cost.
nlohmann::json remote_json(const StoreFile& store) {
  const std::optional<IoCounters> cost = store.remote_cost();
  if (!cost) return nullptr;
  return {{"rounds", cost->remote_rounds},
          {"requests", cost->remote_requests},
          {"bytes", cost->remote_bytes}};
}

nlohmann::json info_json(const StoreFile& store, const CrsFacts& crs) {
  const StoreFacts& facts = store.facts();
  const nlohmann::json metadata = metadata_of(store);
  nlohmann::json sections = nlohmann::json::array();
  for (const SectionInfo& s : store.sections()) {
    sections.push_back({{"name", s.name}, {"offset", s.offset}, {"bytes", s.bytes}});
  }
  nlohmann::json levels = nlohmann::json::array();
  for (const double tolerance : round_tolerances(store, 12)) {
    levels.push_back({{"tolerance", tolerance}, {"vertices", vertices_at(store, tolerance)}});
  }
  std::uint64_t void_vertices = 0;
  for (const ErrorBin& bin : store.error_bins()) void_vertices += bin.void_vertices;
  for (const auto& v : store.t0().vertices) void_vertices += v.has_height == 0;
  nlohmann::json json{{"file", store.path()},
                      {"bytes", store.file_bytes()},
                      {"crs", crs_json(crs)},
                      {"units", ask::units_json(crs)},
                      {"bounds", bounds_json(facts)},
                      {"grid",
                       {{"origin", {facts.map.origin_x, facts.map.origin_y}},
                        {"step", {facts.map.step_x, facts.map.step_y}}}},
                      {"heights", heights_json(facts)},
                      {"source_samples", facts.source_samples},
                      {"free_of_voids", facts.free_of_voids},
                      {"vertices", store.t0().vertices.size() + store.record_count()},
                      {"void_vertices", void_vertices},
                      {"records", store.record_count()},
                      {"t0_vertices", store.t0().vertices.size()},
                      {"t0_triangles", store.t0().triangles.size()},
                      {"rank", store.max_rank()},
                      {"base_error", facts.base_error},
                      {"base_deviation", facts.base_deviation},
                      {"error_quantiles", errors_json(store, "error")},
                      {"vertices_at_tolerance", levels},
                      {"tree", tree_json(store)},
                      {"sections", sections},
                      {"remote", remote_json(store)},
                      {"metadata", metadata}};
  add_credits(json, credits_of(metadata));
  add_base_map(json, base_map_of(metadata));
  return json;
}

/// Numbers as they are, or a list of whole ones as ranges: [0-6,8-17,19-255].
std::string short_list(const nlohmann::json& value) {
  const auto is_whole = [](const nlohmann::json& one) { return one.is_number_integer(); };
  if (!value.is_array() || !std::all_of(value.begin(), value.end(), is_whole)) return value.dump();
  std::string text;
  for (std::size_t i = 0; i < value.size();) {
    const auto first = value[i].get<std::int64_t>();
    std::size_t end = i + 1;
    while (end < value.size() &&
           value[end].get<std::int64_t>() == first + static_cast<std::int64_t>(end - i)) {
      ++end;
    }
    text += (text.empty() ? "" : ",") + std::to_string(first);
    if (end > i + 2) text += "-" + std::to_string(first + static_cast<std::int64_t>(end - i - 1));
    i = end > i + 2 ? end : i + 1;
  }
  return "[" + text + "]";
}

/// Prints metadata as "key value" lines, flattened, but for what has a line of its own.
void print_metadata(const nlohmann::json& object, const std::string& prefix) {
  for (const auto& [key, value] : object.items()) {
    if (key == "crs" || key == "crs_wkt" || value.is_null()) continue;
    const std::string name = prefix.empty() ? key : prefix + "." + key;
    constexpr std::array<std::string_view, 4> kShown = {
        "options.title", "options.attribution", "options.base_map", "options.base_map_attribution"};
    if (std::find(kShown.begin(), kShown.end(), name) != kShown.end()) continue;
    if (value.is_object()) {
      print_metadata(value, name);
    } else {
      const std::string text = value.is_string() ? value.get<std::string>() : short_list(value);
      if (!text.empty()) std::printf("  %-28s %s\n", name.c_str(), printable(text).c_str());
    }
  }
}

void print_credits(const Credits& credits, const BaseMap& map) {
  // Texts that count hold no control characters.
  if (!credits.title.empty()) std::printf("title      %s\n", credits.title.c_str());
  if (!credits.attribution.empty()) std::printf("credit     %s\n", credits.attribution.c_str());
  if (map.tiles.empty()) return;
  const std::string whom = map.attribution.empty() ? "" : " (" + map.attribution + ")";
  std::printf("base map   %s%s\n", map.tiles.c_str(), whom.c_str());
}

void print_place(const StoreFile& store, const CrsFacts& crs) {
  const StoreFacts& facts = store.facts();
  const std::string name = crs.wkt.empty() ? "unknown; build with --a-srs to state it" : crs.name;
  std::printf("CRS        %s%s\n", name.c_str(),
              crs.code.empty() ? "" : (" (" + crs.code + ")").c_str());
  if (crs.vertical_name.empty()) {
    std::printf("vertical   unknown; build with --vertical-crs to state it\n");
  } else if (crs.has_third_axis) {
    std::printf("vertical   %s, of this CRS\n", printable(crs.vertical_name).c_str());
  } else {
    std::printf("vertical   %s%s\n", printable(crs.vertical_name).c_str(),
                crs.vertical_code.empty() ? "" : (" (" + crs.vertical_code + ")").c_str());
  }
  const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint high = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  std::printf("bounds     %s %s %s %s (%s)\n", exact_number(low.x).c_str(),
              exact_number(low.y).c_str(), exact_number(high.x).c_str(),
              exact_number(high.y).c_str(), printable(crs.horizontal_unit).c_str());
  if (facts.min_height > facts.max_height) {
    std::printf("heights    none: all void\n");
  } else {
    std::printf("heights    %s to %s (%s)\n", short_number(facts.min_height).c_str(),
                short_number(facts.max_height).c_str(), printable(crs.vertical_unit).c_str());
  }
}

void print_counts(const StoreFile& store) {
  const StoreFacts& facts = store.facts();
  const std::uint64_t vertices = store.t0().vertices.size() + store.record_count();
  std::printf("samples    %s\n", grouped(facts.source_samples).c_str());
  std::printf(
      "vertices   %s: %s in T0, %s in records; %.1f bytes each\n", grouped(vertices).c_str(),
      grouped(store.t0().vertices.size()).c_str(), grouped(store.record_count()).c_str(),
      vertices > 0 ? static_cast<double>(store.file_bytes()) / static_cast<double>(vertices) : 0.0);
  if (facts.base_error > 0) {
    std::printf(
        "base       error %s at samples, deviation %s anywhere: the finest TIN in this file\n",
        short_number(facts.base_error).c_str(), short_number(facts.base_deviation).c_str());
  }
  std::printf("rank       %u\n", unsigned{store.max_rank()});
  const IndexShape& shape = store.index_shape();
  std::printf(
      "tree       %s of %s under %s in %s\n", counted(store.pages().page_count(), "page").c_str(),
      human_bytes(store.pages().page_bytes()).c_str(), counted(shape.total_nodes(), "node").c_str(),
      counted(shape.levels(), "level").c_str());
}

void print_errors(const StoreFile& store) {
  std::printf("errors    ");
  for (const double share : kQuantiles) {
    std::printf(" %g %%: %s%s", share * 100, short_number(error_quantile(store, share)).c_str(),
                share < 1 ? "," : "\n");
  }
  const std::vector<double> tolerances = round_tolerances(store, 12);
  if (!tolerances.empty()) std::printf("vertices needed at a tolerance\n");
  const double all = static_cast<double>(store.t0().vertices.size() + store.record_count());
  for (const double tolerance : tolerances) {
    const std::uint64_t n = vertices_at(store, tolerance);
    std::printf("  %8s  %14s  %5.1f %%\n", short_number(tolerance).c_str(), grouped(n).c_str(),
                100.0 * static_cast<double>(n) / all);
  }
}

void print_info(const StoreFile& store, const CrsFacts& crs) {
  std::printf("file       %s, %s\n", store.path().c_str(), human_bytes(store.file_bytes()).c_str());
  if (const std::optional<IoCounters> cost = store.remote_cost()) {
    std::printf(
        "elsewhere  opened by %s in %s, %s\n", counted(cost->remote_requests, "request").c_str(),
        counted(cost->remote_rounds, "round").c_str(), human_bytes(cost->remote_bytes).c_str());
  }
  print_credits(credits_of(store), base_map_of(store));
  print_place(store, crs);
  print_counts(store);
  print_errors(store);
  std::printf("sections\n");
  for (const SectionInfo& s : store.sections()) {
    std::printf("  %-14s %16s bytes at %s\n", s.name.c_str(), grouped(s.bytes).c_str(),
                grouped(s.offset).c_str());
  }
  std::printf("built with\n");
  print_metadata(metadata_of(store), "");
}

}  // namespace

Declared declare_info(Context& context) {
  const auto options = std::make_shared<TerrainOptions>();
  Declared declared;
  add_terrain(declared.parameters, *options, false);
  declared.run = [options, &context] {
    const auto store = open_store(*options, context);
    const CrsFacts crs = crs_facts(*store);
    context.json ? print_json(info_json(*store, crs)) : print_info(*store, crs);
    return kExitDone;
  };
  return declared;
}

}  // namespace ptin::tools
