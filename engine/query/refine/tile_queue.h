// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain worked on tile by tile, by several threads: boxes of the grid that are halved until each
// fits.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "engine/geometry/box.h"

namespace ptin {

/// The two halves of a box, across its longer side: every grid position is in one. REQUIRES: more
/// than one position.
[[nodiscard]] std::pair<GridBox, GridBox> halves(const GridBox& box) noexcept;

/// Tiles that wait for work. A tile in work may come back as its halves, so no worker leaves before
/// all tiles are done. Threads: any.
class TileQueue {
 public:
  explicit TileQueue(const GridBox& all) : waiting_{all} {}

  /// Works until all tiles are done, or until one failed: hands each to `work`, which may call
  /// put_halves() for it.
  void run(const std::function<void(const GridBox& tile)>& work) noexcept;
  /// Puts the halves of the tile in work in its place.
  void put_halves(const GridBox& tile);
  /// Throws what the first tile threw that failed, if any did.
  void rethrow() const;

 private:
  std::optional<GridBox> take();
  void done();
  void fail(std::exception_ptr failure);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<GridBox> waiting_;
  int in_work_ = 0;
  std::exception_ptr failed_;
};

/// Calls work(0) to work(count - 1), each on a thread of its own, the first on the caller's. Where
/// the system gives no more threads, only those that there are: each must be able to do all of the
/// work. `work` does not throw.
void run_on_threads(int count, const std::function<void(int worker)>& work);

}  // namespace ptin
