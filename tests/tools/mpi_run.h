// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs other programs, and `ptin build` under mpirun where that is installed.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "tests/tools/program.h"

namespace ptin::tools::testing {

/// A program that was started, with its output going to files. Killed when the object goes.
class StartedProgram {
 public:
  /// @param command      The program, looked for in PATH, and its arguments.
  /// @param environment  "NAME=value", besides or in the place of those of this process.
  explicit StartedProgram(const std::vector<std::string>& command,
                          const std::vector<std::string>& environment = {});
  ~StartedProgram();
  StartedProgram(const StartedProgram&) = delete;
  StartedProgram& operator=(const StartedProgram&) = delete;

  /// Processes that it started itself and that run.
  [[nodiscard]] std::vector<pid_t> children() const;
  [[nodiscard]] bool is_running();
  /// Waits for its end; kills it after two minutes, so that no test hangs.
  Outcome wait();

 private:
  TestFolder folder_;
  pid_t pid_ = 0;
  bool has_ended_ = false;
  int status_ = -1;
};

/// Why no build can be run under mpirun here: `GTEST_SKIP() << why`; "" when it can.
[[nodiscard]] const std::string& why_no_mpi();
/// The program that was made with MPI.
[[nodiscard]] std::string mpi_program();
/// `mpirun` with what it needs on any machine: root, few processors, containers.
[[nodiscard]] std::vector<std::string> mpirun(const std::vector<std::string>& arguments);
[[nodiscard]] std::vector<std::string> mpi_environment();
/// Runs `ptin ARGUMENTS` with so many ranks.
Outcome run_ranks(int ranks, const std::vector<std::string>& arguments);

/// A small source of a kind: "raster", "points" or "tin", with the arguments of its build.
struct ClusterSource {
  std::string input;
  std::vector<std::string> options;
  [[nodiscard]] std::vector<std::string> build(const std::string& output,
                                               const std::vector<std::string>& more = {}) const;
};
[[nodiscard]] ClusterSource cluster_source(const TestFolder& folder, const std::string& kind);

/// Expects the same bytes of one thread, of two, and of each of these numbers of ranks.
void expect_same_bytes_on_ranks(const std::string& kind, const std::vector<int>& ranks);

/// Kills a random rank at a random moment of builds with three ranks, until that happened `times`
/// times, and goes on each time with 0 (without MPI), 2 or 4 ranks. Expects the same bytes.
void expect_kills_lose_nothing(const std::string& kind, int times);

}  // namespace ptin::tools::testing
