// SPDX-License-Identifier: GPL-3.0-or-later
//
// Does tasks of a build that another process directs.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "engine/construct/build.h"

namespace ptin {

class TaskWorker;
class TileTree;

/// Opens the source of a build as the process that directs it did, but reads of it only what its
/// tasks want. Both processes see the inputs, the output's folder and that of temporary files by the
/// same names.
class BuildWorker {
 public:
  /// @param inputs, options  As those of the build.
  /// @param resources        Of this process: `memory_bytes`, `patience`, `files`, `stop` and `observer`
  ///     count.
  /// @param note             What the directing process told TaskDriver::begin(), as a message.
  /// @throws Error as build(); invalid_argument  this process does not see the folders of the build, or
  ///     other inputs; corruption  what the directing process wrote is not there
  BuildWorker(const std::vector<std::string>& inputs, const BuildOptions& options,
              const BuildResources& resources, const std::string& note);
  ~BuildWorker();
  BuildWorker(const BuildWorker&) = delete;
  BuildWorker& operator=(const BuildWorker&) = delete;

  /// Does the task of a message, and tells what came of it, as a message too: its result, or what
  /// went wrong.
  /// Threads: several at once, each with a number of its own.
  [[nodiscard]] std::string answer(const std::string& message, std::size_t thread = 0);

  [[nodiscard]] TaskWorker& tasks() noexcept;
  [[nodiscard]] const TileTree& tree() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ptin
