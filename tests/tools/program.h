// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs the program and looks at what it says, returns and leaves behind: within this process, which
// saves a start of everything that it links, or, where signals, limits and pipes are the subject, as
// the program that was built.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <sys/types.h>

#include "tests/tools/small_terrains.h"

namespace ptin::tools::testing {

struct Outcome {
  int status = -1;  ///< Exit status; 128 + signal when a signal ended it.
  std::string out;
  std::string err;
  /// The processor time that a started process took.
  std::chrono::milliseconds worked{0};
};

/// Runs `ptin ARGUMENTS` within this process: all of the program but main(), with standard input
/// empty and the output streams going to files. What the arguments mean is the same as in a process
/// of its own; signals, limits on resources and the end of the process are not tested by it.
/// REQUIRES: nothing else of this process writes to stdout or stderr meanwhile.
Outcome run_ptin(const std::vector<std::string>& arguments);

/// Runs the program that was built. With `signal`, sends it once the program is ready to take it and
/// has worked for `after`: processor time, so that it is at the same place on a busy machine.
Outcome spawn_ptin(const std::vector<std::string>& arguments,
                   std::optional<int> signal = std::nullopt,
                   std::chrono::milliseconds after = std::chrono::milliseconds(0));

/// Runs the program that was built, and sends it a signal once its standard output holds a text.
Outcome spawn_ptin_until(const std::string& told, int signal,
                         const std::vector<std::string>& arguments);

/// The program that was built, while it runs. SIGTERM ends it with the object.
class StartedPtin {
 public:
  explicit StartedPtin(const std::vector<std::string>& arguments);
  ~StartedPtin();
  StartedPtin(const StartedPtin&) = delete;
  StartedPtin& operator=(const StartedPtin&) = delete;

  /// Waits until its standard output holds a text, or it has ended. @return The output.
  [[nodiscard]] std::string out_with(const std::string& text) const;
  [[nodiscard]] pid_t process() const noexcept { return process_; }
  /// Its standard error so far.
  [[nodiscard]] std::string err() const;
  void send(int signal) const;

 private:
  TestFolder folder_;
  pid_t process_;
};

/// Runs the program that was built with its output going to a file that is there. Only status and
/// err are set.
Outcome spawn_ptin_into(const std::string& output, const std::vector<std::string>& arguments);

/// Runs the program that was built with these bytes on its standard input.
Outcome spawn_ptin_reading(const std::string& input, const std::vector<std::string>& arguments);

/// Number of lines that are not empty.
[[nodiscard]] std::size_t lines_in(const std::string& text);

/// Runs ptin and expects success.
void expect_done(const std::vector<std::string>& arguments);
/// The same; returns what it printed as JSON.
[[nodiscard]] nlohmann::json answer_of(const std::vector<std::string>& arguments);

}  // namespace ptin::tools::testing
