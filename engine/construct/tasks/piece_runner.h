// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs pieces of work on several threads, as many at once as memory admits.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>

namespace ptin {

/// A piece of work in two steps. The first, run(), is long: those of several pieces run at once. It
/// returns the second, a commit, which takes the result over: commits run one at a time.
struct Piece {
  std::uint64_t bytes = 0;  ///< Memory that it takes until its commit is done, by estimate.
  /// Does the work and returns the commit. Looks at the token; once a stop is asked for, no commit
  /// is called.
  std::function<std::function<void()>(const std::stop_token&)> run;
};

/// Where pieces come from. Its functions are never called by two threads at once, nor while a
/// commit runs.
class PieceSource {
 public:
  PieceSource() = default;
  PieceSource(const PieceSource&) = delete;
  PieceSource& operator=(const PieceSource&) = delete;
  virtual ~PieceSource() = default;

  /// `bytes` of the piece that should be started next. None when all pieces have been handed out,
  /// or when those that have not must wait for the commit of one that runs.
  [[nodiscard]] virtual std::optional<std::uint64_t> next_bytes() = 0;
  /// Hands that piece out. REQUIRES: next_bytes() has a value.
  /// @param worker  Number of the thread, from 0. It runs one piece at a time.
  [[nodiscard]] virtual Piece take(int worker) = 0;
};

struct PieceLimits {
  int threads = 1;
  std::uint64_t bytes = ~std::uint64_t{0};  ///< The sum over all pieces that run at once.
  /// Told that the pieces at work take `bytes`; to give freed memory back to the system where so
  /// much would not fit beside what the process holds. What a heap keeps of pieces that have ended
  /// is counted for no piece. Called by a worker that must wait (`bytes` includes the piece that it
  /// waits to start), and by one whose next piece is larger than its last. May be empty.
  std::function<void(std::uint64_t bytes)> give_back;
};

/// Runs all pieces. A piece starts whatever its size when no other runs, and else only within the
/// limit. The first error stops the other pieces and is thrown when all have ended.
/// @throws Error cancelled  `stop` fired; and whatever a piece, the source or give_back throws
/// @return The most bytes that were admitted at once.
std::uint64_t run_pieces(PieceSource& source, const PieceLimits& limits,
                         const std::stop_token& stop);

}  // namespace ptin
