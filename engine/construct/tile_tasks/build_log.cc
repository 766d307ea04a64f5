// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile_tasks/build_log.h"

namespace ptin {

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
  take_line(line, results_);
  if (line.contains("checkpoint")) {
    position_ = line["checkpoint"];
    written_ = line.at("written").get<std::uint64_t>();
  }
}

void BuildLog::note_done(const TaskName& name, const TaskResult& result) {
  results_[name] = result;
  lines_.push_back(line_of(name, result));
  for (std::size_t i = 0; i < kTileFiles; ++i) {
    if (result.files[i].bytes > 0) {
      const std::string file = file_name(name.tile, static_cast<TileFile>(i));
      superfluous_.erase(file);  // it is written anew, since somebody needs it again
      unsynced_.insert(file);
    }
  }
}

void BuildLog::note_written(std::uint64_t written) {
  written_ = written;
  position_ = output_.position();
}

void BuildLog::remove_later(const TileId& tile, TileFile file) {
  superfluous_.insert(file_name(tile, file));
}

void BuildLog::checkpoint(bool force) {
  const auto now = std::chrono::steady_clock::now();
  if (!force && now - last_ < interval_) {
    return;
  }
  output_.sync();
  for (const std::string& name : unsynced_) {
    if (!superfluous_.contains(name)) {
      ScratchFile(workspace_.files(), workspace_.temporary(name), ScratchFile::Kept::kExisting)
          .sync();
    }
  }
  workspace_.sync_names();
  lines_.push_back({{"checkpoint", position_}, {"written", written_}});
  workspace_.append(lines_);
  for (const std::string& name : superfluous_) {
    workspace_.remove(name);
  }
  lines_.clear();
  unsynced_.clear();
  superfluous_.clear();
  last_ = now;
}

}  // namespace ptin
