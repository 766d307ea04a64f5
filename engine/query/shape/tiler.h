// SPDX-License-Identifier: GPL-3.0-or-later
//
// Work on what may not fit the memory as a whole: what does not fit is divided, and its parts are
// worked on in its place.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <system_error>
#include <thread>
#include <vector>

#include "engine/geometry/box.h"

namespace ptin {

/// The halves of a box, across its longer side: every grid position is in one. REQUIRES: more than
/// one position.
[[nodiscard]] std::array<GridBox, 2> divided(const GridBox& box) noexcept;
/// The halves of a row. REQUIRES: more than one thing.
template <class T>
[[nodiscard]] std::array<std::span<T>, 2> divided(std::span<T> row) noexcept {
  return {row.first(row.size() / 2), row.subspan(row.size() / 2)};
}

/// Calls work(piece). Where that returns false, because the piece does not fit, its parts are worked
/// on in its place, in the order in which divided(piece) has them.
/// REQUIRES: of a piece that cannot be divided `work` returns true, or throws.
template <class Piece, class Work>
void work_in_parts(const Piece& piece, const Work& work) {
  if (work(piece)) return;
  for (const Piece& part : divided(piece)) work_in_parts(part, work);
}

/// Calls work(0) to work(count - 1), each on a thread of its own, the first on the caller's. Where
/// the system gives no more threads, those that there are do all of the work.
template <class Work>
void run_on_threads(int count, const Work& work) {
  std::vector<std::jthread> threads;  // joined where the function ends
  for (int i = 1; i < count; ++i) {
    try {
      threads.emplace_back([&work, i] { work(i); });
    } catch (const std::system_error&) {
      break;
    }
  }
  work(0);
}

/// What the tiles of a terrain may take.
struct TileLimits {
  std::uint64_t memory_bytes;  ///< All tiles in work together.
  std::uint64_t tile_bytes;    ///< A tile, where it can be halved.
  int threads;                 ///< At most.

  /// As many threads as may be, as long as each has room for a quarter of a tile: with less it would
  /// read most pages several times. At least one.
  [[nodiscard]] int workers() const noexcept;
  /// Bytes of one worker.
  [[nodiscard]] std::uint64_t worker_bytes() const noexcept {
    return memory_bytes / static_cast<std::uint64_t>(workers());
  }
};

/// A tile in work.
struct GridTile {
  GridBox box;
  std::uint64_t most_bytes;  ///< What it may take: of a smallest tile all that its worker has.
  bool is_smallest;          ///< It is not halved: if it does not fit, more memory is needed.
};

/// Works on one tile. False: it does not fit, and nothing of it was counted.
/// @param worker  From 0 to workers() - 1: a worker is on one tile at a time.
using WorkOnTile = std::function<bool(int worker, const GridTile& tile)>;

/// Works on a domain tile by tile, on threads: a tile that does not fit is halved. With one worker
/// tiles come in the order of work_in_parts().
/// REQUIRES: `work` throws where a smallest tile does not fit.
/// @throws what `work` threw first; the tiles that waited then are left
void work_on_tiles(const GridBox& domain, const TileLimits& limits, const WorkOnTile& work);

/// The same by workers with memory of their own, which serves tile after tile.
/// @param make  make(bytes) returns a std::unique_ptr to a worker that may hold so many bytes, whose
///              work(tile) is as WorkOnTile.
/// @returns the workers, once all tiles are done
template <class Make>
[[nodiscard]] auto workers_on_tiles(const GridBox& domain, const TileLimits& limits,
                                    const Make& make) {
  std::vector<decltype(make(std::uint64_t{}))> workers;
  for (int i = 0; i < limits.workers(); ++i) workers.push_back(make(limits.worker_bytes()));
  work_on_tiles(domain, limits, [&](int worker, const GridTile& tile) {
    return workers[static_cast<std::size_t>(worker)]->work(tile);
  });
  return workers;
}

}  // namespace ptin
