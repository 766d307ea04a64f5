// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/shape/tiler.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace ptin {

namespace {

/// Sides of a smallest tile, grid units. Triangles of the finest detail are about one unit long, so
/// most of those of a smaller tile would meet its neighbours too: halving it would save no memory.
constexpr std::int64_t kSmallestTile = 8;

/// Tiles that wait for work. A tile in work may come back as its halves, so no worker leaves before
/// all tiles are done. Threads: any.
class TileQueue {
 public:
  explicit TileQueue(const GridBox& domain) : waiting_{domain} {}

  /// Hands tiles to `fits` until all are done, or until one failed. A tile of which it is false comes
  /// back as its halves.
  template <class Fits>
  void run(const Fits& fits) noexcept {
    while (const std::optional<GridBox> tile = take()) {
      try {
        const bool is_done = fits(*tile);
        const std::lock_guard lock(mutex_);
        if (!is_done) put_halves(*tile);
        leave();
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!failed_) failed_ = std::current_exception();
        leave();
      }
    }
  }

  void rethrow() const {
    if (failed_) std::rethrow_exception(failed_);
  }

 private:
  /// The next tile; none when all are done, or after a failure.
  std::optional<GridBox> take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return failed_ || !waiting_.empty() || in_work_ == 0; });
    if (failed_ || waiting_.empty()) return std::nullopt;
    const GridBox tile = waiting_.back();
    waiting_.pop_back();
    ++in_work_;
    return tile;
  }

  /// The first half goes on top: it is the next to be worked on, so that one worker goes depth first
  /// and few tiles wait. REQUIRES: the lock.
  void put_halves(const GridBox& tile) {
    const auto [first, second] = divided(tile);
    waiting_.push_back(second);
    waiting_.push_back(first);
  }
  /// REQUIRES: the lock.
  void leave() {
    --in_work_;
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<GridBox> waiting_;
  int in_work_ = 0;
  std::exception_ptr failed_;
};

}  // namespace

std::array<GridBox, 2> divided(const GridBox& box) noexcept {
  std::array<GridBox, 2> halves{box, box};
  if (std::int64_t{box.max_x} - box.min_x >= std::int64_t{box.max_y} - box.min_y) {
    halves[0].max_x = std::midpoint(box.min_x, box.max_x);  // a side may be longer than an int32
    halves[1].min_x = halves[0].max_x + 1;
  } else {
    halves[0].max_y = std::midpoint(box.min_y, box.max_y);
    halves[1].min_y = halves[0].max_y + 1;
  }
  return halves;
}

int TileLimits::workers() const noexcept {
  const std::uint64_t useful = std::max<std::uint64_t>(tile_bytes / 4, 1);
  const std::uint64_t most = std::max<std::uint64_t>(memory_bytes / useful, 1);
  return static_cast<int>(std::min<std::uint64_t>(std::max(threads, 1), most));
}

void work_on_tiles(const GridBox& domain, const TileLimits& limits, const WorkOnTile& work) {
  TileQueue queue(domain);
  const std::uint64_t most = limits.worker_bytes();
  run_on_threads(limits.workers(), [&](int worker) {
    queue.run([&](const GridBox& box) {
      const bool is_smallest = half_perimeter(box) <= 2 * kSmallestTile;
      const std::uint64_t bytes = is_smallest ? most : std::min(most, limits.tile_bytes);
      return work(worker, {box, bytes, is_smallest});
    });
  });
  queue.rethrow();
}

}  // namespace ptin
