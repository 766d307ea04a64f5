// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reading a source as tasks, before the tree of its tiles is known.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/scratch/plain_value.h"

namespace ptin {

/// Tasks that do not depend on one another. All are done before the next stage begins.
struct SourceStage {
  std::string name;                  ///< For progress: "reading".
  std::vector<std::uint64_t> sizes;  ///< Of each task, in a unit of the stage's own: for progress.
  std::string facts;                 ///< What each task is told; at most half a KB.
  std::uint64_t task_bytes = 0;      ///< Memory that a task takes at least, by estimate.
};

/// One of them, as it is done.
struct StageTask {
  std::string name;          ///< The stage's.
  std::size_t number = 0;    ///< Among the stage's tasks.
  std::string facts;         ///< The stage's.
  std::uint64_t memory = 0;  ///< What the task may take, bytes.
  std::stop_token stop;
  /// Told now and then how much of its size is done; may be empty.
  std::function<void(std::uint64_t done)> progress;
};

/// Does tasks of a source. What a task needs beside the inputs and the options it takes from files
/// that earlier stages wrote, or from the facts: any process that sees these does it.
class StageWorker {
 public:
  StageWorker() = default;
  StageWorker(const StageWorker&) = delete;
  StageWorker& operator=(const StageWorker&) = delete;
  virtual ~StageWorker() = default;

  /// Does a task. It can be done again, with the same result.
  /// Threads: several tasks at once.
  /// @return What it tells to the process that directs; at most 1 KB.
  /// @throws Error as the source
  [[nodiscard]] virtual std::string run(const StageTask& task) = 0;
};

/// Has the tasks of a stage done, by whomever, and returns what they tell, by number.
/// @throws Error  of the tasks that failed, that of the lowest number
using RunStage = std::function<std::vector<std::string>(const SourceStage&, StageWorker&)>;

/// A RunStage: one task after the other, on this thread.
[[nodiscard]] std::vector<std::string> run_alone(const SourceStage& stage, StageWorker& worker);
/// Runs it alone within `memory`, until it is stopped. `progress`, which is told of each task,
/// may be empty.
/// @throws Error  as the first task that fails
[[nodiscard]] std::vector<std::string> run_alone_within(
    const SourceStage& stage, StageWorker& worker, std::uint64_t memory,
    const std::stop_token& stop,
    const std::function<void(std::uint64_t done, std::uint64_t total)>& progress);

/// Bytes as two digits each, and back.
[[nodiscard]] std::string digits_of(std::span<const std::byte> bytes);
/// @throws Error invalid_argument  the text is not what digits_of() makes of so many bytes
void take_digits(const std::string& text, std::span<std::byte> bytes);

/// A plain value as a text that another process of the same program takes up.
template <PlainValue T>
[[nodiscard]] std::string text_of_value(const T& value) {
  return digits_of(std::as_bytes(std::span(&value, 1)));
}
/// @throws Error as take_digits()
template <class T>
[[nodiscard]] T value_in_text(const std::string& text) {
  std::array<std::byte, sizeof(T)> bytes{};
  take_digits(text, bytes);
  return std::bit_cast<T>(bytes);
}

}  // namespace ptin
