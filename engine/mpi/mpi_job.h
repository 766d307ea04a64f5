// SPDX-License-Identifier: GPL-3.0-or-later
//
// A build by the ranks of an MPI job (mpirun, srun): rank 0 hands out tasks and keeps the journal, the
// others do them. Messages have less than 1 KB a task; everything else goes by files that all ranks
// see under the same names: the inputs, and the build's folder beside the output.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/construct/build.h"

namespace ptin {

/// This process as a rank. Begins MPI and ends it: one for a process.
/// Threads: all members from the one that made it.
class MpiJob {
 public:
  /// @throws Error internal  MPI does not begin
  MpiJob();
  /// On rank 0 this sends the other ranks home.
  ~MpiJob();
  MpiJob(const MpiJob&) = delete;
  MpiJob& operator=(const MpiJob&) = delete;

  [[nodiscard]] int rank() const noexcept;
  [[nodiscard]] int ranks() const noexcept;

  /// For BuildResources::driver of build() on rank 0; null where there is no other rank. A rank that
  /// dies ends the job, as MPI has it: the build is then resumed, with whatever number of ranks.
  [[nodiscard]] TaskDriver* driver() noexcept;

  /// What the other ranks do: wait for a build, do its tasks until they are sent home. What a rank
  /// meets is sent to rank 0, whose build() throws it.
  /// @param inputs, options, resources  As BuildWorker.
  /// @throws Error io_error  messages do not arrive
  void work(const std::vector<std::string>& inputs, const BuildOptions& options,
            const BuildResources& resources);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ptin
