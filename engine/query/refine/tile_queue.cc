// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/refine/tile_queue.h"

#include <cstdint>
#include <system_error>
#include <thread>

namespace ptin {

std::pair<GridBox, GridBox> halves(const GridBox& box) noexcept {
  std::pair<GridBox, GridBox> two{box, box};
  if (std::int64_t{box.max_x} - box.min_x >= std::int64_t{box.max_y} - box.min_y) {
    two.first.max_x = box.min_x + (box.max_x - box.min_x) / 2;
    two.second.min_x = two.first.max_x + 1;
  } else {
    two.first.max_y = box.min_y + (box.max_y - box.min_y) / 2;
    two.second.min_y = two.first.max_y + 1;
  }
  return two;
}

void TileQueue::run(const std::function<void(const GridBox& tile)>& work) noexcept {
  while (const std::optional<GridBox> tile = take()) {
    try {
      work(*tile);
      done();
    } catch (...) {
      fail(std::current_exception());
    }
  }
}

void TileQueue::put_halves(const GridBox& tile) {
  const std::lock_guard lock(mutex_);
  const auto [low, high] = halves(tile);
  waiting_.push_back(high);
  waiting_.push_back(low);
}

void TileQueue::rethrow() const {
  if (failed_) {
    std::rethrow_exception(failed_);
  }
}

/// The next tile, of which the worker then tells done() or fail(). None when all tiles are done, or
/// after a failure.
std::optional<GridBox> TileQueue::take() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return failed_ || !waiting_.empty() || in_work_ == 0; });
  if (failed_ || waiting_.empty()) {
    return std::nullopt;
  }
  const GridBox tile = waiting_.back();
  waiting_.pop_back();
  ++in_work_;
  return tile;
}

void TileQueue::done() {
  const std::lock_guard lock(mutex_);
  --in_work_;
  changed_.notify_all();
}

/// Ends a tile by a failure, of which the first is kept. No worker gets another tile.
void TileQueue::fail(std::exception_ptr failure) {
  const std::lock_guard lock(mutex_);
  if (!failed_) {
    failed_ = std::move(failure);
  }
  --in_work_;
  changed_.notify_all();
}

void run_on_threads(int count, const std::function<void(int worker)>& work) {
  std::vector<std::jthread> threads;  // joined where the function ends
  for (int i = 1; i < count; ++i) {
    try {
      threads.emplace_back([&work, i] { work(i); });
    } catch (const std::system_error&) {
      break;  // those that run do all of the work
    }
  }
  work(0);
}

}  // namespace ptin
