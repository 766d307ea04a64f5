// SPDX-License-Identifier: GPL-3.0-or-later
//
// This process as a rank of an MPI job (mpirun, srun).
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace ptin {

/// Begins MPI and ends it. One for a process. Threads: all members from the one that made it.
class MpiSession {
 public:
  /// @throws Error internal  MPI does not begin
  MpiSession();
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;

  [[nodiscard]] int rank() const noexcept { return rank_; }
  [[nodiscard]] int ranks() const noexcept { return ranks_; }

  /// Sends a text. Returns when it may be forgotten.  @throws Error io_error
  void send(int rank, const std::string& text) const;

  struct Received {
    int from = 0;
    std::string text;
  };
  /// A text that has come from any rank; none when there is none.  @throws Error io_error
  [[nodiscard]] std::optional<Received> receive() const;

 private:
  int rank_ = 0, ranks_ = 1;
};

}  // namespace ptin
