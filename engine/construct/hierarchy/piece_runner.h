// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs pieces of work on several threads, as many at once as memory admits.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>

namespace ptin {

/// A piece: long work that others may run beside, then its result, one piece at a time.
struct Piece {
  std::uint64_t bytes = 0;  ///< What run() and the result may take until commit() is done.
  /// Returns what is to be done with the result. Looks at the token.
  std::function<std::function<void()>(const std::stop_token&)> run;
};

/// Where pieces come from. Never called by two threads at once, nor beside a commit.
class PieceSource {
 public:
  PieceSource() = default;
  PieceSource(const PieceSource&) = delete;
  PieceSource& operator=(const PieceSource&) = delete;
  virtual ~PieceSource() = default;

  /// The size of the piece that should be started next; none when all pieces are handed out, or
  /// those that are not wait for others.
  [[nodiscard]] virtual std::optional<std::uint64_t> next_bytes() = 0;
  /// Hands that piece out. @param worker  Number of the thread, from 0: it runs one piece at a
  /// time.
  [[nodiscard]] virtual Piece take(int worker) = 0;
};

struct PieceLimits {
  int threads = 1;
  std::uint64_t bytes = ~std::uint64_t{0};  ///< Of all pieces that run at once.
  /// Gives freed memory back to the system where it stands in the way of `bytes`: those of all
  /// pieces that run, and of the next. May be empty. Called by a worker that has to wait, and
  /// before a piece larger than the worker's last: what a heap keeps of pieces that have ended is
  /// counted for none that runs.
  std::function<void(std::uint64_t bytes)> give_back;
};

/// Runs all pieces. One runs whatever its size; more than one only within the limit. The first
/// error stops the others and is thrown when all have ended.
/// @throws Error cancelled  `stop` fired; and whatever a piece, the source or give_back throws
/// @return The most bytes that were admitted at once.
std::uint64_t run_pieces(PieceSource& source, const PieceLimits& limits,
                         const std::stop_token& stop);

}  // namespace ptin
