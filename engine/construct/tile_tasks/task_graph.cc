// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile_tasks/task_graph.h"

#include <algorithm>
#include <string>

#include <nlohmann/json.hpp>

#include "engine/construct/tile_tasks/batch_order.h"
#include "engine/memory_units.h"

namespace ptin {

namespace {

[[noreturn]] void refuse_join(std::uint64_t missing) {
  throw Error(ErrorCode::resource_exhausted,
              "a join of four tiles needs " + std::to_string(missing / kMiB + 1) +
                  " MiB more than --memory leaves for it; go on with that much more");
}

}  // namespace

nlohmann::json line_of(const TaskName& name, const TaskResult& result) {
  nlohmann::json line = json_of(result);
  line["done"] = json_of(name);
  return line;
}

void take_line(const nlohmann::json& line, TaskResults& results) {
  if (line.contains("done")) {
    results[task_name_in(line["done"])] = task_result_in(line);
  }
}

std::vector<std::pair<TileId, TileFile>> TaskGraph::inputs_of(const TaskName& name) const {
  std::vector<std::pair<TileId, TileFile>> inputs;
  switch (name.kind) {
    case TaskKind::kJoin:
      for (const TileId& child : tree_.children(name.tile)) {
        inputs.emplace_back(child, TileFile::kPushed);
      }
      break;
    case TaskKind::kTighten:
      inputs.emplace_back(tree_.root(), TileFile::kPushed);
      for (const TileId& above : ancestors_of(tree_, name.tile)) {
        inputs.emplace_back(above, TileFile::kSegment);
      }
      break;
    case TaskKind::kClose:
      inputs.emplace_back(name.tile, TileFile::kSegment);
      for (const TileId& child : tree_.children(name.tile)) {
        inputs.emplace_back(child, TileFile::kBounds);
      }
      break;
    case TaskKind::kPlace:
      inputs.emplace_back(name.tile, TileFile::kPages);
      break;
    default:  // what reads the source alone
      break;
  }
  return inputs;
}

std::uint64_t TaskGraph::bytes_of_join(const TileId& id, const TaskResults& results) const {
  std::uint64_t pushed = 0;
  for (const TileId& child : tree_.children(id)) {
    pushed += results.at(producer_of(child, TileFile::kPushed)).facts(TileFile::kPushed).bytes;
  }
  const std::uint64_t bytes = memory_.tile_bytes.of_join(pushed);
  const std::uint64_t most = memory_.for_tiles + (id == tree_.root() ? memory_.for_reading : 0);
  if (bytes > most) {  // the terrain keeps more than the plan expected
    refuse_join(bytes - most);
  }
  return bytes;
}

std::uint64_t TaskGraph::bytes_of(const TaskName& name, const TaskResults& results) const {
  switch (name.kind) {
    case TaskKind::kCollapse:
      return memory_.tile_bytes.of_batch(largest_leaf(tree_, name.tile));
    case TaskKind::kJoin:
      return bytes_of_join(name.tile, results);
    case TaskKind::kTighten:
      return memory_.tile_bytes.of_replay(largest_leaf(tree_, name.tile));
    case TaskKind::kClose:
      return memory_.tile_bytes.of_close(
          results.at({TaskKind::kJoin, name.tile}).facts(TileFile::kSegment).bytes);
    default:
      break;
  }
  return 0;  // pages are placed out of a mapping
}

bool TaskGraph::can_be_done(const TaskName& name, const TaskResults& results) const {
  const auto inputs = inputs_of(name);
  return std::all_of(inputs.begin(), inputs.end(), [&](const auto& input) {
    return results.contains(producer_of(input.first, input.second));
  });
}

Task TaskGraph::describe(const TaskName& name, const TaskResults& results) const {
  Task task{name, {}, 0, bytes_of(name, results)};
  for (const auto& [tile, file] : inputs_of(name)) {
    task.inputs.push_back({tile, file, results.at(producer_of(tile, file)).facts(file)});
  }
  return task;
}

}  // namespace ptin
