// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build_parts.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <fstream>
#include <optional>
#include <sstream>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/check.h"
#include "engine/construct/build_job.h"
#include "engine/construct/build_worker.h"
#include "engine/construct/tasks/await_file.h"
#include "engine/construct/tasks/task_driver.h"
#include "engine/construct/tasks/task_messages.h"
#include "engine/construct/tasks/task_schedule.h"
#include "engine/construct/tile_tasks/batch_order.h"
#include "engine/construct/tile_tasks/task_graph.h"
#include "storage/file/checksum.h"

namespace ptin {

using namespace build_internal;

namespace {

const char* name_of(PartsPhase phase) {
  static constexpr std::array<const char*, 3> kNames{"collapse", "join", "tighten"};
  return kNames[static_cast<std::size_t>(phase)];
}

FileLayer& files_of(const BuildResources& resources) {
  return resources.files != nullptr ? *resources.files : FileLayer::system();
}

int parts_of(PartsPhase phase, int parts) { return phase == PartsPhase::kJoin ? 1 : parts; }

// -------------------------------------------------------------------------------------------------
// What jobs report: their results, in a file that appears when all of them are there.

std::string told_in(const std::string& folder, PartsPhase phase, int part) {
  return folder + "/part-" + name_of(phase) + "-" + std::to_string(part);
}

/// @throws Error invalid_argument  the note is none of begin_parts()
std::string temporary_folder_in(const std::string& note) {
  try {
    return note_in(note).temporary;
  } catch (const nlohmann::json::exception&) {
    refuse("the note of the build in parts is damaged");
  }
}

Error to_do_again(PartsPhase phase, int part, const std::string& what, const std::string& where) {
  return {ErrorCode::corruption,
          what + "; do part " + std::to_string(part) + " of the phase " + name_of(phase) +
              " again, then this job",
          where};
}

/// Removes what is damaged of a sorted source: who makes the plan again sees that it is gone. A job does
/// not write to the manifest, which is of one process.
Error to_sort_again(const Error& lost, FileLayer& files) {
  static_cast<void>(files.unlink(lost.context()));  // gone already where another job met the same
  return {lost.code(),
          lost.message() +
              "; make the plan again with --resume, which reads the source again, then "
              "do this job again",
          lost.context()};
}

void tell(FileLayer& files, const std::string& folder, PartsPhase phase, int part,
          const TaskResults& results) {
  std::string text;
  for (const auto& [name, result] : results) {
    text += line_of(name, result).dump() + "\n";
  }
  text = std::to_string(checksum_of(std::as_bytes(std::span(text)))) + "\n" + text;
  ScratchFile file(files, folder, "part", false);
  file.write_at(std::as_bytes(std::span(text)), 0);
  file.publish_as(told_in(folder, phase, part), true);
}

/// A job whose files are damaged counts as not done.
void forget_told(FileLayer& files, const std::string& folder, PartsPhase phase, int part) {
  files.unlink(told_in(folder, phase, part));  // gone already where another job met the same
}

/// Takes up what a job reported. False when it reported nothing.
/// @throws Error corruption  its report is damaged: it is forgotten
bool take_told(FileLayer& files, const std::string& folder, PartsPhase phase, int part,
               TaskResults& results) {
  std::ifstream file(told_in(folder, phase, part), std::ios::binary);
  if (!file) {
    return false;
  }
  std::string checksum;
  std::getline(file, checksum);
  std::ostringstream rest;
  rest << file.rdbuf();
  const std::string text = rest.str();
  if (checksum != std::to_string(checksum_of(std::as_bytes(std::span(text))))) {
    forget_told(files, folder, phase, part);
    throw to_do_again(phase, part, "what a job told is not what it wrote",
                      told_in(folder, phase, part));
  }
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    take_line(nlohmann::json::parse(line), results);
  }
  return true;
}

constexpr std::chrono::milliseconds kPatienceForJobs{2000};

void require_told(FileLayer& files, const std::string& folder, PartsPhase phase, int parts,
                  std::chrono::milliseconds patience, TaskResults& results) {
  for (int part = 0; part < parts_of(phase, parts); ++part) {
    // That a job was not done is likelier than that its report shows late.
    await_file(told_in(folder, phase, part), std::min(patience, kPatienceForJobs), {});
    if (!take_told(files, folder, phase, part, results)) {
      throw Error(ErrorCode::invalid_argument,
                  "part " + std::to_string(part) + " of the phase " + name_of(phase) +
                      " is not done; do it first",
                  folder);
    }
  }
}

// -------------------------------------------------------------------------------------------------
// One job.

/// The batches of a part, as places in BatchOrder::batches().
std::pair<std::size_t, std::size_t> batches_of(const BatchOrder& order, int part, int parts) {
  const auto at = [&](int i) {
    return order.batches().size() * static_cast<std::size_t>(i) / static_cast<std::size_t>(parts);
  };
  return {at(part), at(part + 1)};
}

/// The tasks of a job, each after those that write its inputs.
std::vector<TaskName> tasks_of(const BatchOrder& order, PartsPhase phase, int part, int parts) {
  std::vector<TaskName> tasks;
  if (phase == PartsPhase::kJoin) {
    std::vector<TileId> above = order.above_within(0, order.batches().size());
    for (int i = 0; i < parts; ++i) {
      const auto [begin, end] = batches_of(order, i, parts);
      const std::vector<TileId> within = order.above_within(begin, end);
      std::erase_if(above, [&](const TileId& id) {
        return std::find(within.begin(), within.end(), id) != within.end();
      });
    }
    for (const TileId& id : above) {
      tasks.push_back({TaskKind::kJoin, id});
    }
    return tasks;
  }
  const bool collapses = phase == PartsPhase::kCollapse;
  if (!collapses && order.output().size() == order.batches().size()) {
    return tasks;  // nothing lies above the only batch
  }
  const auto [begin, end] = batches_of(order, part, parts);
  for (std::size_t i = begin; i < end; ++i) {
    tasks.push_back({collapses ? TaskKind::kCollapse : TaskKind::kTighten, order.batches()[i]});
  }
  for (const TileId& id : order.above_within(begin, end)) {
    tasks.push_back({collapses ? TaskKind::kJoin : TaskKind::kClose, id});
  }
  return tasks;
}

/// Finds which part wrote a file that is damaged, and counts it as not done.
Error damaged(const DamagedInput& damage, const BatchOrder& order, FileLayer& files,
              const std::string& folder, int parts) {
  const TaskName producer = damage.producer();
  const bool is_first = producer.kind == TaskKind::kCollapse || producer.kind == TaskKind::kJoin;
  const PartsPhase phase = is_first ? PartsPhase::kCollapse : PartsPhase::kTighten;
  for (const PartsPhase p : {phase, PartsPhase::kJoin}) {
    for (int part = 0; part < parts_of(p, parts); ++part) {
      const std::vector<TaskName> tasks = tasks_of(order, p, part, parts);
      if (std::find(tasks.begin(), tasks.end(), producer) != tasks.end()) {
        forget_told(files, folder, p, part);
        return to_do_again(p, part, "a temporary file is not what was written", damage.context());
      }
    }
  }
  return damage;
}

/// A build that ends when its source is read.
class NoteTaker final : public TaskDriver {
 public:
  [[nodiscard]] bool begin(const BuildNote& note) override {
    note_ = message_of(note);
    return note.index.is_null();
  }
  [[nodiscard]] const std::string& note() const noexcept { return note_; }

 private:
  std::string note_;
};

/// Goes on from what the jobs reported.
class Publisher final : public TaskDriver {
 public:
  Publisher(int parts, const BuildResources& resources)
      : files_(files_of(resources)), parts_(parts), patience_(resources.patience) {}

  [[nodiscard]] bool begin(const BuildNote& note) override {
    if (note.index.is_null()) {
      return true;
    }
    for (const PartsPhase phase :
         {PartsPhase::kCollapse, PartsPhase::kJoin, PartsPhase::kTighten}) {
      require_told(files_, note.temporary, phase, parts_, patience_, told_);
    }
    return true;
  }
  std::uint64_t run(TaskSchedule& schedule, TaskWorker& worker, const TaskLimits& limits,
                    const std::stop_token& stop) override {
    schedule.take_up(std::exchange(told_, {}));  // of reading a raster: nothing yet
    return TaskDriver::run(schedule, worker, limits, stop);
  }

 private:
  FileLayer& files_;
  int parts_;
  std::chrono::milliseconds patience_;
  TaskResults told_;
};

void require_part(PartsPhase phase, int part, int parts) {
  if (parts < 1 || part < 0 || part >= parts_of(phase, parts)) {
    throw Error(ErrorCode::invalid_argument,
                "there is no part " + std::to_string(part) + " of the phase " + name_of(phase) +
                    ": its parts are 0 to " + std::to_string(parts_of(phase, parts) - 1));
  }
}

void do_tasks(const std::vector<std::string>& inputs, const BuildOptions& options,
              const BuildResources& resources, const std::string& note, PartsPhase phase, int part,
              int parts) {
  const std::string folder = temporary_folder_in(note);
  FileLayer& files = files_of(resources);
  TaskResults known;
  if (take_told(files, folder, phase, part, known)) {
    return;
  }
  for (const PartsPhase before : {PartsPhase::kCollapse, PartsPhase::kJoin}) {
    if (before < phase) {
      require_told(files, folder, before, parts, resources.patience, known);
    }
  }
  BuildWorker worker(inputs, options, resources, note);
  const int threads = std::max(resources.threads, 1);
  const TaskMemory memory = worker.memory(threads);
  const TaskGraph graph(worker.tree(), memory);
  const BatchOrder order(worker.tree());
  const std::vector<TaskName> names = tasks_of(order, phase, part, parts);
  TaskList tasks(
      names,
      [&graph](const TaskName& name, const TaskResults& results) {
        return graph.can_be_done(name, results) ? std::optional(graph.describe(name, results))
                                                : std::nullopt;
      },
      std::move(known));
  const TaskLimits limits{threads, memory.for_tiles, [&](std::uint64_t) {
                            if (resources.observer != nullptr) {
                              resources.observer->give_back_memory();
                            }
                          }};
  try {
    TaskDriver().run(tasks, worker.tasks(), limits, resources.stop);
  } catch (const DamagedInput& damage) {
    throw damaged(damage, order, files, folder, parts);
  }
  PTIN_CHECK(tasks.is_complete());
  TaskResults done;
  for (const TaskName& name : names) {
    done[name] = tasks.results().at(name);
  }
  tell(files, folder, phase, part, done);
}

}  // namespace

BegunParts begin_parts(const std::vector<std::string>& inputs, const std::string& output,
                       const BuildOptions& options, const BuildResources& resources) {
  NoteTaker taker;
  BuildResources to_note = resources;
  to_note.driver = &taker;
  BuildReport report = build(inputs, output, options, to_note);
  return {taker.note(), std::move(report.warnings)};
}

void do_part(const std::vector<std::string>& inputs, const BuildOptions& options,
             const BuildResources& resources, const std::string& note, PartsPhase phase, int part,
             int parts) {
  require_part(phase, part, parts);
  try {
    do_tasks(inputs, options, resources, note, phase, part, parts);
  } catch (const Error& e) {
    if (!is_lost_sorted_source(e, temporary_folder_in(note))) {
      throw;
    }
    throw to_sort_again(e, files_of(resources));
  }
}

BuildReport publish_parts(const std::vector<std::string>& inputs, const std::string& output,
                          const BuildOptions& options, const BuildResources& resources, int parts) {
  Publisher publisher(parts, resources);
  BuildResources to_publish = resources;
  to_publish.driver = &publisher;
  to_publish.unfinished = Unfinished::kResume;
  return build(inputs, output, options, to_publish);
}

}  // namespace ptin
