// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tasks/task_messages.h"

#include "engine/construct/tasks/task_schedule.h"

namespace ptin {

namespace {

/// Paths need not be UTF-8.
std::string text_of(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

nlohmann::json json_of(const Error& e) {
  return {static_cast<int>(e.code()), e.message(), e.context()};
}

Error error_in(const nlohmann::json& json) {
  return {static_cast<ErrorCode>(json.at(0).get<int>()), json.at(1).get<std::string>(),
          json.at(2).get<std::string>()};
}

}  // namespace

std::string message_of(const BuildNote& note) {
  return text_of({{"index", note.index},
                  {"folder", note.folder},
                  {"temporary", note.temporary},
                  {"inputs", note.inputs}});
}

BuildNote note_in(const std::string& message) {
  const nlohmann::json json = nlohmann::json::parse(message);
  return {json.at("index"), json.at("folder").get<std::string>(),
          json.at("temporary").get<std::string>(), json.at("inputs")};
}

std::string message_of(const Task& task) { return text_of(json_of(task)); }

Task task_in_message(const std::string& message) { return task_in(nlohmann::json::parse(message)); }

std::string answer_of(const Error& error) { return text_of({{"error", json_of(error)}}); }

std::string answer_to(const Task& task, TaskWorker& worker) {
  try {
    return text_of(json_of(worker.run(task)));
  } catch (const DamagedInput& e) {
    const InputFile input{e.tile(), e.file(), {}};
    return text_of({{"damaged", json_of(TaskName{TaskKind::kPlace, input.tile})},
                    {"file", static_cast<int>(input.file)},
                    {"error", json_of(static_cast<const Error&>(e))}});
  } catch (const Error& e) {
    return answer_of(e);
  }
}

void take_answer(const TaskName& name, const std::string& answer, TaskSchedule& schedule) {
  const nlohmann::json json = nlohmann::json::parse(answer);
  if (json.contains("damaged")) {
    const InputFile input{
        task_name_in(json["damaged"]).tile, static_cast<TileFile>(json.at("file").get<int>()), {}};
    schedule.failed(name, DamagedInput(input, error_in(json.at("error"))));
  } else if (json.contains("error")) {
    throw error_in(json["error"]);
  } else {
    schedule.done(name, task_result_in(json));
  }
}

}  // namespace ptin
