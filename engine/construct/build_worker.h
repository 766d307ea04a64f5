// SPDX-License-Identifier: GPL-3.0-or-later
//
// Does tasks of a build that another process directs.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/construct/build.h"

namespace ptin {

class TaskWorker;
class TileTree;
struct TaskMemory;

/// Does the tasks of reading a source, or opens one that was read as the process that directs did, and
/// does the tasks of its tiles; it reads of the source only what its tasks want. Both processes see
/// the inputs, the output's folder and that of temporary files by the same names.
class BuildWorker {
 public:
  /// @param inputs, options  As those of the build.
  /// @param resources        `memory_bytes`, `patience`, `files`, `stop` and `observer` count.
  /// @param note             What the directing process gave TaskDriver::begin(), as a message.
  /// @throws Error as build(); invalid_argument  this process does not see the folders of the build, or
  ///     other inputs; corruption  what the directing process wrote is not there
  BuildWorker(const std::vector<std::string>& inputs, const BuildOptions& options,
              const BuildResources& resources, const std::string& note);
  ~BuildWorker();
  BuildWorker(const BuildWorker&) = delete;
  BuildWorker& operator=(const BuildWorker&) = delete;

  /// Does the task of a message, and returns what came of it as a message too: its result, or what
  /// went wrong. Threads: several at once.
  [[nodiscard]] std::string answer(const std::string& message);

  [[nodiscard]] TaskWorker& tasks() noexcept;
  /// REQUIRES: the note has an index.
  [[nodiscard]] const TileTree& tree() const noexcept;
  /// What tasks of tiles may take here now, on so many threads.
  [[nodiscard]] TaskMemory memory(int threads) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ptin
