// SPDX-License-Identifier: GPL-3.0-or-later
//
// The memory that all requests together may take.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>

namespace ptin::http {

/// Bytes that are lent out, fairly among the clients that borrow them. Threads: any.
class MemoryBudget : public std::enable_shared_from_this<MemoryBudget> {
 public:
  /// A part of the budget, given back when the lease ends. Threads: one at a time.
  class Lease {
   public:
    Lease(std::shared_ptr<MemoryBudget> budget, std::string client, std::uint64_t bytes)
        : budget_(std::move(budget)), client_(std::move(client)), bytes_(bytes) {}
    ~Lease() { shrink_to(0); }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;

    [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
    /// Gives back what is beyond `bytes`.
    void shrink_to(std::uint64_t bytes) noexcept {
      if (bytes >= bytes_) return;
      budget_->take_back(client_, bytes_ - bytes);
      bytes_ = bytes;
    }
    /// @param is_beyond_share  Whatever the client has already.
    /// @return False where it is not lent: the lease is as it was.
    [[nodiscard]] bool grow_to(std::uint64_t bytes, bool is_beyond_share = false) {
      if (bytes <= bytes_) return true;
      if (!budget_->take(client_, bytes - bytes_, is_beyond_share)) return false;
      bytes_ = bytes;
      return true;
    }

   private:
    std::shared_ptr<MemoryBudget> budget_;
    std::string client_;
    std::uint64_t bytes_;
  };

  /// To be owned by a shared pointer: leases may outlive who made it.
  /// @param returned  Called, on any thread, whenever something was given back.
  explicit MemoryBudget(std::uint64_t bytes, std::function<void()> returned = {})
      : bytes_(bytes), returned_(std::move(returned)) {}

  /// Null where fewer than `bytes` are left, or where the client has more than is left for all
  /// others: so one that is new always finds something. An empty name is no client.
  [[nodiscard]] std::shared_ptr<Lease> lend(std::uint64_t bytes, const std::string& client = {}) {
    auto lease = std::make_shared<Lease>(shared_from_this(), client, 0);
    return lease->grow_to(bytes) ? lease : nullptr;
  }

  /// Whether lend() would lend it now.
  [[nodiscard]] bool has(std::uint64_t bytes, const std::string& client = {}) const {
    const std::lock_guard lock(mutex_);
    const auto held = held_.find(client);
    return bytes <= bytes_ - lent_ && (held == held_.end() || is_within_share(held->second));
  }

  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  [[nodiscard]] std::uint64_t lent() const {
    const std::lock_guard lock(mutex_);
    return lent_;
  }

 private:
  /// With the mutex.
  [[nodiscard]] bool is_within_share(std::uint64_t held) const { return held <= bytes_ - lent_; }
  bool take(const std::string& client, std::uint64_t bytes, bool is_beyond_share) {
    const std::lock_guard lock(mutex_);
    if (bytes > bytes_ - lent_) return false;
    if (!client.empty()) {
      std::uint64_t& held = held_[client];
      if (!is_within_share(held) && !is_beyond_share) return false;
      held += bytes;
    }
    lent_ += bytes;
    return true;
  }
  void take_back(const std::string& client, std::uint64_t bytes) noexcept {
    {
      const std::lock_guard lock(mutex_);
      lent_ -= bytes;
      const auto held = client.empty() ? held_.end() : held_.find(client);
      if (held != held_.end() && (held->second -= bytes) == 0) held_.erase(held);
    }
    if (returned_) returned_();
  }

  const std::uint64_t bytes_;
  const std::function<void()> returned_;
  mutable std::mutex mutex_;
  std::uint64_t lent_ = 0;
  std::unordered_map<std::string, std::uint64_t> held_;
};

}  // namespace ptin::http
