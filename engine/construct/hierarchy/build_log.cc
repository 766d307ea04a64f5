// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/hierarchy/build_log.h"

#include <utility>

#include "engine/error.h"

namespace ptin {

namespace {

nlohmann::json json_of(const TileId& id) { return {id.level, id.x, id.y}; }
nlohmann::json json_of(const ArrayFileFacts& f) { return {f.bytes, f.checksum}; }

TileId tile_in(const nlohmann::json& j) {
  return {j.at(0).get<int>(), j.at(1).get<std::int64_t>(), j.at(2).get<std::int64_t>()};
}
ArrayFileFacts facts_in(const nlohmann::json& j) {
  return {j.at(0).get<std::uint64_t>(), j.at(1).get<std::uint64_t>()};
}

}  // namespace

BuildLog::BuildLog(Workspace& workspace, SegmentOutput& output, std::chrono::milliseconds interval)
    : workspace_(workspace), output_(output), interval_(interval) {
  for (const nlohmann::json& line : workspace.lines()) {
    take_up(line);
  }
  if (position_.is_null()) {
    position_ = output_.position();
  }
  // Also at the beginning: what the output holds behind the position goes.
  output_.resume(position_);
}

void BuildLog::take_up(const nlohmann::json& line) {
  if (line.contains("collapsed")) {
    collapsed_[tile_in(line["collapsed"])] = {
        facts_in(line.at("segment")), facts_in(line.at("pushed")), facts_in(line.at("records")),
        line.at("lone").get<std::uint64_t>()};
  } else if (line.contains("tightened")) {
    tightened_[tile_in(line["tightened"])] = facts_in(line.at("bounds"));
  } else if (line.contains("checkpoint")) {
    position_ = line["checkpoint"];
    leaves_written_ = line.at("leaves").get<std::uint64_t>();
    batches_written_ = line.at("batches").get<std::uint64_t>();
  }
}

std::string BuildLog::name(const TileId& id, const char* ending) {
  return std::to_string(id.level) + "-" + std::to_string(id.x) + "-" + std::to_string(id.y) +
         ending;
}

void BuildLog::note_collapsed(const TileId& id, const CollapsedTile& tile) {
  collapsed_[id] = tile;
  lines_.push_back({{"collapsed", json_of(id)},
                    {"segment", json_of(tile.segment)},
                    {"pushed", json_of(tile.pushed)},
                    {"records", json_of(tile.records)},
                    {"lone", tile.lone_samples}});
  for (const auto& [facts, ending] : {std::pair{tile.segment, kSegmentEnding},
                                      {tile.pushed, kPushedEnding},
                                      {tile.records, kRecordsEnding}}) {
    if (facts.bytes > 0) {
      unsynced_.push_back(path(id, ending));
    }
  }
}

void BuildLog::note_tightened(const TileId& id, const ArrayFileFacts& bounds) {
  tightened_[id] = bounds;
  lines_.push_back({{"tightened", json_of(id)}, {"bounds", json_of(bounds)}});
  unsynced_.push_back(path(id, kBoundsEnding));
}

void BuildLog::note_written(std::uint64_t leaves, std::uint64_t batches) {
  leaves_written_ = leaves;
  batches_written_ = batches;
  position_ = output_.position();
}

void BuildLog::remove_later(const TileId& id, const char* ending) {
  superfluous_.push_back(name(id, ending));
}

void BuildLog::checkpoint(bool force) {
  const auto now = std::chrono::steady_clock::now();
  if (!force && now - last_ < interval_) {
    return;
  }
  output_.sync();
  for (const std::string& file : unsynced_) {
    ScratchFile(workspace_.files(), file, ScratchFile::Kept::kExisting).sync();
  }
  workspace_.sync_names();
  lines_.push_back(
      {{"checkpoint", position_}, {"leaves", leaves_written_}, {"batches", batches_written_}});
  workspace_.append(lines_);
  for (const std::string& file : superfluous_) {
    workspace_.remove(file);
  }
  lines_.clear();
  unsynced_.clear();
  superfluous_.clear();
  last_ = now;
}

}  // namespace ptin
