// SPDX-License-Identifier: GPL-3.0-or-later
//
// Does tasks of reading a source for a build that another process directs.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/construct/build.h"

namespace ptin {

/// Reads those parts of a source that it is told to. Both processes see the inputs, and the build's
/// folder of temporary files, by the same names.
class SourceReader {
 public:
  /// @param inputs, options  As those of the build.
  /// @param resources        Of this process: `memory_bytes`, `patience`, `tmp`, `files` and `stop` count.
  /// @param note             What the directing process told TaskDriver::begin_reading(), as a
  ///     message.
  /// @throws Error as build(); invalid_argument  this process sees other inputs, or does not see the
  ///     folder of temporary files
  SourceReader(const std::vector<std::string>& inputs, const BuildOptions& options,
               const BuildResources& resources, const std::string& note);
  ~SourceReader();
  SourceReader(const SourceReader&) = delete;
  SourceReader& operator=(const SourceReader&) = delete;

  /// Does the task of a message, and tells what came of it, as a message too.
  [[nodiscard]] std::string answer(const std::string& message);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ptin
