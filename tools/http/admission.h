// SPDX-License-Identifier: GPL-3.0-or-later
//
// The order of computing: lanes for questions of different cost, turns for the clients of each, and
// the memory that all of them borrow.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tools/http/memory_budget.h"

namespace ptin::http {

/// The cost of a question. Each lane has threads that no other lane takes, so that a cheap question
/// never waits for the end of a dear one.
enum class Lane : std::uint8_t {
  kPoint,  ///< Some pages: heights at places, what is known of a terrain.
  kTile,   ///< A window of bounded size, or a line.
  kSweep,  ///< A question that may look at the whole terrain.
  kRead    ///< A piece of a file that is sent.
};
inline constexpr std::size_t kLanes = 4;
[[nodiscard]] const char* name_of(Lane lane) noexcept;

/// The lack of a task that has not begun.
enum class WaitsFor : std::uint8_t {
  kTurn,   ///< A thread: others are before it.
  kMemory  ///< There are threads that have nothing to do.
};

/// One task on its way. Made by whoever waits for it.
struct Ticket {
  Lane lane = Lane::kPoint;
  std::uint64_t memory = 0;  ///< Is lent before the task begins.
  std::string client;        ///< Whose share it is.
  /// The task; must not throw. The memory is the task's from then on.
  std::function<void(std::shared_ptr<MemoryBudget::Lease>)> run;
  /// Called instead, within add() of another ticket, where that one is let in in its place.
  std::function<void()> displaced;

  /// When the task began; nothing: it waits.
  [[nodiscard]] std::chrono::steady_clock::time_point begun() const {
    return std::chrono::steady_clock::time_point(std::chrono::steady_clock::duration(begun_));
  }
  [[nodiscard]] bool has_begun() const { return begun_ != 0; }

 private:
  friend class Admission;
  std::atomic<std::chrono::steady_clock::rep> begun_{0};
};

/// Threads: add(), withdraw() and the counts may be called from any.
class Admission {
 public:
  using Clock = std::chrono::steady_clock;

  struct Sizes {
    std::size_t threads = 1;   ///< Sweeps that are computed at once.
    std::size_t waiting = 64;  ///< Tickets that wait in each lane but that of reading.
    MemoryParts memory;
  };

  /// @param rests   Called on a thread for computing when there were long questions, or memory of
  ///                bodies or answers came back, and nothing is left to do.
  /// @param bounds  Called there whenever tasks had half of MemoryParts::kept and have ended.
  explicit Admission(const Sizes& sizes, std::function<void()> rests = {},
                     std::function<void()> bounds = {});
  /// Finishes what runs; what waits is let go.
  ~Admission();
  Admission(const Admission&) = delete;
  Admission& operator=(const Admission&) = delete;

  /// Takes a ticket. Where its lane is full and another client has more tickets in it, the last one
  /// of the client that has most is displaced.
  /// @return False: the lane is full.
  [[nodiscard]] bool add(std::shared_ptr<Ticket> ticket);
  /// Takes a ticket back that still waits.
  /// @return What it waited for to the last; none: it has begun, or was never taken.
  std::optional<WaitsFor> withdraw(const Ticket& ticket);

  [[nodiscard]] const std::shared_ptr<MemoryBudget>& memory() const noexcept;
  /// Questions that wait, and that are computed; pieces of files are none.
  [[nodiscard]] std::size_t waiting() const;
  [[nodiscard]] std::size_t running() const;
  /// How many tasks of a lane run at once.
  [[nodiscard]] static std::size_t width(Lane lane, const Sizes& sizes) noexcept;

 private:
  struct Shared;
  void work(const std::vector<Lane>& lanes);

  std::shared_ptr<Shared> shared_;
  std::vector<std::thread> threads_;
};

}  // namespace ptin::http
