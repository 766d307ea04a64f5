// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a process that directs a build and those that do its tasks tell each other: lines of JSON.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <string>

#include <nlohmann/json.hpp>

#include "engine/construct/grid/source_stage.h"
#include "engine/construct/tasks/task.h"

namespace ptin {

class TaskSchedule;
class TaskWorker;

/// What processes that do tasks must know of a build, beside its inputs and options.
struct BuildNote {
  nlohmann::json index;   ///< Of the source, as ReadSource takes it.
  std::string folder;     ///< The build's, with the file of pages.
  std::string temporary;  ///< The folder of its temporary files.
  nlohmann::json inputs;  ///< Names, sizes and times of the inputs, which must be the same for all.
};

[[nodiscard]] std::string message_of(const BuildNote& note);
/// @throws nlohmann::json::exception  the message is none of message_of()
[[nodiscard]] BuildNote note_in(const std::string& message);

/// The message that a task be done. At most 1 KB for trees of up to 20 levels.
[[nodiscard]] std::string message_of(const Task& task);
/// Task::bytes of a message.
[[nodiscard]] std::uint64_t bytes_of_task(const std::string& message);
/// Does the task of a message, and tells what came of it: its result, the input that was damaged, or
/// the error that it met.
/// @param thread, stop  As TaskWorker::run().
[[nodiscard]] std::string answer_to(const std::string& message, TaskWorker& worker,
                                    std::size_t thread, const std::stop_token& stop);
/// The message that a task of a stage be done. At most 1 KB.
[[nodiscard]] std::string message_of(const SourceStage& stage, std::size_t number);
/// Does it, and tells what came of it: what it tells, or the error that it met.
/// @param memory  What it may take, bytes.
[[nodiscard]] std::string answer_to(const std::string& message, StageWorker& worker,
                                    std::uint64_t memory, const std::stop_token& stop);
/// What the task tells.
/// @throws Error  the error that the answer tells
[[nodiscard]] std::string told_in(const std::string& answer);
/// The answer of a process that could not begin, or to which something else happened.
[[nodiscard]] std::string answer_of(const Error& error);
/// Hands an answer to the schedule. False where the task met a damaged input, and is to be done again.
/// @throws Error  the error that the answer tells; as TaskSchedule::done() and failed()
bool take_answer(const TaskName& name, const std::string& answer, TaskSchedule& schedule);

}  // namespace ptin
