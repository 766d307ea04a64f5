// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tasks/task.h"

#include <nlohmann/json.hpp>

namespace ptin {

namespace {

constexpr std::array<const char*, kTileFiles> kEndings{".pushed", ".segment",      ".bounds",
                                                       ".pages",  ".descriptions", ".index"};

std::string numbers_of(const TileId& id) {
  return std::to_string(id.level) + "-" + std::to_string(id.x) + "-" + std::to_string(id.y);
}

TileId tile_in(const nlohmann::json& j, std::size_t at) {
  return {j.at(at).get<int>(), j.at(at + 1).get<std::int64_t>(), j.at(at + 2).get<std::int64_t>()};
}

}  // namespace

std::string to_string(const TaskName& name) {
  static constexpr std::array<const char*, 9> kVerbs{
      "scanning band",   "reading portion", "sharing out part",
      "sorting range",   "collapsing tile", "joining tile",
      "tightening tile", "closing tile",    "placing the pages of tile"};
  const std::string verb = kVerbs[static_cast<std::size_t>(name.kind)];
  return verb + " " +
         (name.kind < TaskKind::kCollapse ? std::to_string(name.tile.x) : numbers_of(name.tile));
}

const char* stage_of(TaskKind kind) noexcept {
  static constexpr std::array<const char*, 9> kStages{"reading",    "reading",    "sharing out",
                                                      "sorting",    "collapsing", "collapsing",
                                                      "tightening", "tightening", "writing"};
  return kStages[static_cast<std::size_t>(kind)];
}

std::string file_name(const TileId& tile, TileFile file) {
  return numbers_of(tile) + kEndings[static_cast<std::size_t>(file)];
}

TaskName producer_of(const TileId& tile, TileFile file) noexcept {
  const bool is_batch = tile.level <= 1;
  switch (file) {
    case TileFile::kPushed:
      return {is_batch ? TaskKind::kCollapse : TaskKind::kJoin, tile};
    case TileFile::kSegment:
      return {TaskKind::kJoin, tile};
    case TileFile::kBounds:
      return {is_batch ? TaskKind::kTighten : TaskKind::kClose, tile};
    case TileFile::kPages:
    case TileFile::kDescriptions:
    case TileFile::kIndex:
      break;
  }
  return {is_batch ? TaskKind::kCollapse : TaskKind::kClose, tile};
}

nlohmann::json json_of(const ArrayFileFacts& facts) { return {facts.bytes, facts.checksum}; }

ArrayFileFacts array_facts_in(const nlohmann::json& json) {
  return {json.at(0).get<std::uint64_t>(), json.at(1).get<std::uint64_t>()};
}

nlohmann::json json_of(const TaskName& name) {
  return {static_cast<int>(name.kind), name.tile.level, name.tile.x, name.tile.y};
}

TaskName task_name_in(const nlohmann::json& json) {
  return {static_cast<TaskKind>(json.at(0).get<int>()), tile_in(json, 1)};
}

nlohmann::json json_of(const Task& task) {
  nlohmann::json inputs = nlohmann::json::array();
  for (const InputFile& i : task.inputs) {
    inputs.push_back({i.tile.level, i.tile.x, i.tile.y, static_cast<int>(i.file), i.facts.bytes,
                      i.facts.checksum});
  }
  return {{"task", json_of(task.name)}, {"in", inputs}, {"at", task.offset}, {"bytes", task.bytes}};
}

Task task_in(const nlohmann::json& json) {
  Task task{task_name_in(json.at("task")),
            {},
            json.at("at").get<std::uint64_t>(),
            json.at("bytes").get<std::uint64_t>()};
  for (const nlohmann::json& i : json.at("in")) {
    task.inputs.push_back({tile_in(i, 0),
                           static_cast<TileFile>(i.at(3).get<int>()),
                           {i.at(4).get<std::uint64_t>(), i.at(5).get<std::uint64_t>()}});
  }
  return task;
}

nlohmann::json json_of(const TaskResult& result) {
  nlohmann::json files = nlohmann::json::array();
  for (const ArrayFileFacts& f : result.files) {
    files.push_back(json_of(f));
  }
  nlohmann::json json{
      {"files", files}, {"page_bytes", result.page_bytes}, {"lone", result.lone_samples}};
  if (!result.told.empty()) {
    json["told"] = result.told;
  }
  return json;
}

TaskResult task_result_in(const nlohmann::json& json) {
  TaskResult result;
  for (std::size_t i = 0; i < kTileFiles; ++i) {
    result.files[i] = array_facts_in(json.at("files").at(i));
  }
  result.page_bytes = json.at("page_bytes").get<std::uint64_t>();
  result.lone_samples = json.at("lone").get<std::uint64_t>();
  result.told = json.value("told", "");
  return result;
}

}  // namespace ptin
