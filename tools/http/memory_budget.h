// SPDX-License-Identifier: GPL-3.0-or-later
//
// The memory that all questions together may take.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

namespace ptin::http {

/// Bytes that are lent out. Threads: any.
class MemoryBudget : public std::enable_shared_from_this<MemoryBudget> {
 public:
  /// A part of the budget, given back when the lease ends.
  class Lease {
   public:
    Lease(std::shared_ptr<MemoryBudget> budget, std::uint64_t bytes)
        : budget_(std::move(budget)), bytes_(bytes) {}
    ~Lease() { budget_->lent_ -= bytes_; }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;

    [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
    /// Gives back what is beyond `bytes`.
    void shrink_to(std::uint64_t bytes) noexcept {
      const std::uint64_t kept = std::min(bytes, bytes_);
      budget_->lent_ -= bytes_ - kept;
      bytes_ = kept;
    }

   private:
    std::shared_ptr<MemoryBudget> budget_;
    std::uint64_t bytes_;
  };

  /// To be owned by a shared pointer: leases may outlive who made it.
  explicit MemoryBudget(std::uint64_t bytes) : bytes_(bytes) {}

  /// Null where fewer than `bytes` are left.
  [[nodiscard]] std::shared_ptr<Lease> lend(std::uint64_t bytes) {
    std::uint64_t lent = lent_.load();
    do {
      if (bytes > bytes_ || lent > bytes_ - bytes) return nullptr;
    } while (!lent_.compare_exchange_weak(lent, lent + bytes));
    return std::make_shared<Lease>(shared_from_this(), bytes);
  }

  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  [[nodiscard]] std::uint64_t lent() const noexcept { return lent_.load(); }

 private:
  std::uint64_t bytes_;
  std::atomic<std::uint64_t> lent_{0};
};

}  // namespace ptin::http
