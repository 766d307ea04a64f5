// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/admission.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <utility>

#include <sys/resource.h>

namespace ptin::http {

namespace {

constexpr std::size_t kReaders = 4;
/// Threads that compute for long give way to those that answer at once: they are nicer by so much.
constexpr int kNicer = 10;
/// After so long without a question there is nothing to do: longer than a person, or a page that draws
/// what came, takes to ask again.
constexpr std::chrono::seconds kBeforeRest{2};

std::size_t index_of(Lane lane) noexcept { return static_cast<std::size_t>(lane); }

/// Whose threads a lane has.
std::size_t group_of(Lane lane) noexcept {
  return index_of(lane == Lane::kSweep ? Lane::kTile : lane);
}

bool is_long(Lane lane) noexcept { return lane == Lane::kTile || lane == Lane::kSweep; }

MemoryUse use_of(Lane lane) noexcept {
  return lane == Lane::kPoint ? MemoryUse::kPoint : MemoryUse::kQuestion;
}

/// Linux has a niceness for each thread. Where it is refused, all threads are equal.
void be_nicer() {
  const int now = ::getpriority(PRIO_PROCESS, 0);
  static_cast<void>(::setpriority(PRIO_PROCESS, 0, now + kNicer));
}

}  // namespace

const char* name_of(Lane lane) noexcept {
  constexpr std::array<const char*, kLanes> kNames = {"point", "tile", "sweep", "read"};
  return kNames[index_of(lane)];
}

/// The tickets that wait in a lane: each client's in their order, and the clients by turns.
class Line {
 public:
  void add(std::shared_ptr<Ticket> ticket) {
    auto& own = tickets_[ticket->client];
    if (own.empty()) turns_.push_back(ticket->client);
    own.push_back(std::move(ticket));
    ++size_;
  }

  /// The next ticket that `lends` gives its memory to; its client goes to the end of the row.
  template <class Lends>
  std::shared_ptr<Ticket> take(const Lends& lends) {
    for (std::size_t i = 0; i < turns_.size(); ++i) {
      const std::string client = turns_[i];
      const std::shared_ptr<Ticket> first = tickets_[client].front();
      if (!lends(*first)) continue;
      turns_.erase(turns_.begin() + static_cast<std::ptrdiff_t>(i));
      auto& own = tickets_[client];
      own.pop_front();
      --size_;
      if (own.empty()) {
        tickets_.erase(client);
      } else {
        turns_.push_back(client);
      }
      return first;
    }
    return nullptr;
  }

  bool withdraw(const Ticket& ticket) {
    const auto own = tickets_.find(ticket.client);
    if (own == tickets_.end()) return false;
    const auto at = std::find_if(own->second.begin(), own->second.end(),
                                 [&](const auto& one) { return one.get() == &ticket; });
    if (at == own->second.end()) return false;
    own->second.erase(at);
    --size_;
    if (own->second.empty()) {
      turns_.erase(std::find(turns_.begin(), turns_.end(), ticket.client));
      tickets_.erase(own);
    }
    return true;
  }

  /// The next ticket of a client; null: it has none.
  [[nodiscard]] std::shared_ptr<const Ticket> first_of(const std::string& client) const {
    const auto own = tickets_.find(client);
    return own == tickets_.end() ? nullptr : own->second.front();
  }

  /// The last ticket of the client that has most, where that is more than `client` would have.
  std::shared_ptr<Ticket> displace_for(const std::string& client) {
    const auto own = tickets_.find(client);
    const std::size_t has = own == tickets_.end() ? 0 : own->second.size();
    const auto most = std::max_element(
        tickets_.begin(), tickets_.end(),
        [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    if (most == tickets_.end() || most->second.size() <= has + 1) return nullptr;
    std::shared_ptr<Ticket> last = most->second.back();
    withdraw(*last);
    return last;
  }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  std::map<std::string, std::deque<std::shared_ptr<Ticket>>> tickets_;
  std::deque<std::string> turns_;
  std::size_t size_ = 0;
};

struct Admission::Shared {
  /// The ticket of these lanes whose turn it is, with its memory; null: none may begin.
  std::shared_ptr<Ticket> next(const std::vector<Lane>& among,
                               std::shared_ptr<MemoryBudget::Lease>& lease) {
    for (const Lane lane : among) {
      const std::size_t i = index_of(lane);
      if (running[i] >= width(lane, sizes)) continue;
      auto ticket = lines[i].take([&](const Ticket& one) {
        lease = memory->lend(one.memory, one.client, use_of(lane));
        wants_memory = wants_memory || !lease;
        return lease != nullptr;
      });
      if (!ticket) continue;
      ++running[i];
      ticket->begun_ = Clock::now().time_since_epoch().count();
      has_worked = has_worked || is_long(lane);
      return ticket;
    }
    return nullptr;
  }
  /// The lack of a ticket that stands in its line. Behind one of its own client's that lacks memory it
  /// lacks memory too.
  [[nodiscard]] WaitsFor lack_of(const Ticket& ticket) const {
    const std::size_t i = index_of(ticket.lane);
    const std::size_t of_long = running[index_of(Lane::kTile)] + running[index_of(Lane::kSweep)];
    const bool is_thread_free = running[i] < width(ticket.lane, sizes) &&
                                (!is_long(ticket.lane) || of_long <= sizes.threads);
    const auto first = lines[i].first_of(ticket.client);
    const bool lacks_memory =
        is_thread_free && first && !memory->has(first->memory, first->client, use_of(ticket.lane));
    return lacks_memory ? WaitsFor::kMemory : WaitsFor::kTurn;
  }
  /// Notes the end of a task. Whether it is time to look at what is kept of freed memory.
  [[nodiscard]] bool is_to_bound(std::uint64_t given_back) {
    ended += given_back;
    if (!bounds || sizes.memory.kept == 0 || ended < sizes.memory.kept / 2) return false;
    ended = 0;
    return true;
  }
  [[nodiscard]] bool is_at_rest() const {
    return running == std::array<std::size_t, kLanes>{} &&
           std::all_of(lines.begin(), lines.end(), [](const Line& l) { return l.size() == 0; });
  }

  Sizes sizes;
  std::function<void()> rests, bounds;
  std::shared_ptr<MemoryBudget> memory;
  mutable std::mutex mutex;
  std::array<std::condition_variable, kLanes> changed;  ///< Those of a tile and a sweep are one.
  std::array<Line, kLanes> lines;
  std::array<std::size_t, kLanes> running{};
  bool wants_memory = false;  ///< A ticket waits for memory that was not there.
  bool has_worked = false;    ///< Much memory came back since the last rest, or will.
  std::uint64_t ended = 0;    ///< Memory of tasks that ended since the bounds were looked at.
  bool ends = false;
};

std::size_t Admission::width(Lane lane, const Sizes& sizes) noexcept {
  return lane == Lane::kRead ? kReaders : sizes.threads;
}

Admission::Admission(const Sizes& sizes, std::function<void()> rests, std::function<void()> bounds)
    : shared_(std::make_shared<Shared>()) {
  shared_->sizes = sizes;
  shared_->rests = std::move(rests);
  shared_->bounds = std::move(bounds);
  const std::weak_ptr<Shared> weak = shared_;
  shared_->memory = std::make_shared<MemoryBudget>(sizes.memory, [weak](MemoryUse use) {
    const auto shared = weak.lock();
    if (!shared) return;
    {
      const std::lock_guard lock(shared->mutex);
      const bool is_to_rest = use != MemoryUse::kPoint && !shared->has_worked;
      if (!shared->wants_memory && !is_to_rest) return;
      shared->wants_memory = false;
      shared->has_worked = shared->has_worked || is_to_rest;
    }
    for (auto& changed : shared->changed) changed.notify_all();
  });
  const auto start = [&](std::size_t threads, const std::vector<Lane>& lanes) {
    for (std::size_t i = 0; i < threads; ++i) {
      threads_.emplace_back([this, lanes] { work(lanes); });
    }
  };
  start(sizes.threads, {Lane::kPoint});
  // One more than either lane is wide: neither has them all.
  start(sizes.threads + 1, {Lane::kTile, Lane::kSweep});
  start(kReaders, {Lane::kRead});
}

Admission::~Admission() {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->ends = true;
  }
  for (auto& changed : shared_->changed) changed.notify_all();
  for (std::thread& thread : threads_) thread.join();
  std::array<Line, kLanes> left;
  {
    const std::lock_guard lock(shared_->mutex);
    std::swap(left, shared_->lines);
  }
}

bool Admission::add(std::shared_ptr<Ticket> ticket) {
  std::shared_ptr<Ticket> displaced;
  {
    const std::lock_guard lock(shared_->mutex);
    const Lane lane = ticket->lane;
    const std::size_t i = index_of(lane);
    Line& line = shared_->lines[i];
    // A ticket that finds an idle thread does not wait: as many as there are idle threads may stand
    // in the line beside those that wait.
    const std::size_t idle = width(lane, shared_->sizes) - shared_->running[i];
    if (lane != Lane::kRead && line.size() >= shared_->sizes.waiting + idle) {
      displaced = line.displace_for(ticket->client);
      if (!displaced) return false;
    }
    line.add(std::move(ticket));
    shared_->changed[group_of(lane)].notify_one();
  }
  if (displaced) displaced->displaced();
  return true;
}

std::optional<WaitsFor> Admission::withdraw(const Ticket& ticket) {
  const std::lock_guard lock(shared_->mutex);
  const WaitsFor lack = shared_->lack_of(ticket);
  if (!shared_->lines[index_of(ticket.lane)].withdraw(ticket)) return std::nullopt;
  return lack;
}

const std::shared_ptr<MemoryBudget>& Admission::memory() const noexcept { return shared_->memory; }

std::size_t Admission::waiting() const {
  const std::lock_guard lock(shared_->mutex);
  std::size_t waiting = 0;
  for (std::size_t i = 0; i < index_of(Lane::kRead); ++i) waiting += shared_->lines[i].size();
  return waiting;
}

std::size_t Admission::running() const {
  const std::lock_guard lock(shared_->mutex);
  std::size_t running = 0;
  for (std::size_t i = 0; i < index_of(Lane::kRead); ++i) running += shared_->running[i];
  return running;
}

void Admission::work(const std::vector<Lane>& lanes) {
  const bool is_patient = is_long(lanes.front());
  if (is_patient) be_nicer();
  const std::shared_ptr<Shared> shared = shared_;
  std::condition_variable& changed = shared->changed[group_of(lanes.front())];
  std::unique_lock lock(shared->mutex);
  while (true) {
    std::shared_ptr<MemoryBudget::Lease> lease;
    std::shared_ptr<Ticket> ticket;
    const auto is_called = [&] {
      ticket = shared->ends ? nullptr : shared->next(lanes, lease);
      return ticket || shared->ends;
    };
    if (!is_patient || !shared->has_worked) {
      changed.wait(lock, [&] { return is_called() || (is_patient && shared->has_worked); });
      if (!ticket && !shared->ends) continue;
    } else if (!changed.wait_for(lock, kBeforeRest, is_called)) {
      if (!shared->has_worked || !shared->is_at_rest()) continue;
      shared->has_worked = false;
      lock.unlock();
      if (shared->rests) shared->rests();
      lock.lock();
      continue;
    }
    if (!ticket) return;
    lock.unlock();
    ticket->run(std::move(lease));
    const Lane lane = ticket->lane;
    const std::uint64_t memory = ticket->memory;
    ticket.reset();
    lease.reset();
    lock.lock();
    --shared->running[index_of(lane)];
    if (!shared->is_to_bound(memory)) continue;
    lock.unlock();
    changed.notify_one();  // Who waits for this one's place need not wait for that.
    shared->bounds();
    lock.lock();
  }
}

}  // namespace ptin::http
