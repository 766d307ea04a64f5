// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a process that directs a build and those that do its tasks send each other: lines of JSON.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "engine/construct/tasks/task.h"

namespace ptin {

class TaskSchedule;

/// What processes that do tasks must know of a build, beside its inputs and options.
struct BuildNote {
  nlohmann::json
      index;           ///< The source's, as take_up_source() takes it; null while it is being read.
  std::string folder;  ///< The build's, with the file of pages; "" where there is none yet.
  std::string temporary;  ///< The folder of its temporary files; likewise.
  nlohmann::json inputs;  ///< Names, sizes and times of the inputs, which must be the same for all.
};

[[nodiscard]] std::string message_of(const BuildNote& note);
/// @throws nlohmann::json::exception  the message is none of message_of()
[[nodiscard]] BuildNote note_in(const std::string& message);

/// The message that a task be done. At most 1 KB for trees of up to 20 levels.
[[nodiscard]] std::string message_of(const Task& task);
/// @throws nlohmann::json::exception  the message is none of message_of()
[[nodiscard]] Task task_in_message(const std::string& message);
/// Does a task, and returns what came of it: its result, the input that was damaged, or the error
/// that it met.
[[nodiscard]] std::string answer_to(const Task& task, TaskWorker& worker);
/// The answer of a process that could not begin, or to which something else happened.
[[nodiscard]] std::string answer_of(const Error& error);
/// Hands an answer to the schedule.
/// @throws Error  the error that the answer holds; as TaskSchedule::done() and failed()
void take_answer(const TaskName& name, const std::string& answer, TaskSchedule& schedule);

}  // namespace ptin
