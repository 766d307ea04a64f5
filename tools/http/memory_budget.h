// SPDX-License-Identifier: GPL-3.0-or-later
//
// The memory that all requests together may take.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>

namespace ptin::http {

/// The use that memory is lent for.
enum class MemoryUse : std::uint8_t {
  kQuestion,  ///< A tile, a sweep or a piece of a file: while it is computed.
  kPoint,     ///< A question in the lane of points: while it is computed.
  kAnswer,    ///< Until its last byte is written: a client may take its time.
  kBody       ///< While it arrives, and until its question is answered.
};
inline constexpr std::size_t kMemoryUses = 4;

/// How the budget is divided. What clients can hold for long has a bounded part, so that what is
/// computed finds the rest.
struct MemoryParts {
  std::uint64_t all = 0;           ///< Lent at most.
  std::uint64_t points = 0;        ///< Nothing but points may take these.
  std::uint64_t most_answers = 0;  ///< At most for all answers that are written.
  std::uint64_t most_bodies = 0;   ///< At most for all bodies.
  std::uint64_t kept = 0;          ///< Beside them all, lent to nobody: what was freed and is kept.
};

/// Bytes that are lent out, fairly among the clients that borrow them. Threads: any.
class MemoryBudget : public std::enable_shared_from_this<MemoryBudget> {
 public:
  /// A part of the budget, given back when the lease ends. Threads: one at a time.
  class Lease {
   public:
    Lease(std::shared_ptr<MemoryBudget> budget, MemoryUse use, std::string client)
        : budget_(std::move(budget)), use_(use), client_(std::move(client)) {}
    ~Lease() { shrink_to(0); }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;

    [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
    /// Gives back what is beyond `bytes`.
    void shrink_to(std::uint64_t bytes) noexcept {
      if (bytes >= bytes_) return;
      budget_->take_back(use_, client_, bytes_ - bytes);
      bytes_ = bytes;
    }
    /// @param is_beyond_share  Whatever the client, and all others for this use, have already.
    /// @return False where it is not lent: the lease is as it was.
    [[nodiscard]] bool grow_to(std::uint64_t bytes, bool is_beyond_share = false) {
      if (bytes <= bytes_) return true;
      if (!budget_->take(use_, client_, bytes - bytes_, is_beyond_share)) return false;
      bytes_ = bytes;
      return true;
    }
    /// Lends the same bytes for another use from now on.
    /// @return False where they are not lent for it: the lease is as it was.
    [[nodiscard]] bool change_use(MemoryUse use) {
      if (!budget_->change_use(use_, use, client_, bytes_)) return false;
      use_ = use;
      return true;
    }

   private:
    std::shared_ptr<MemoryBudget> budget_;
    MemoryUse use_;
    std::string client_;
    std::uint64_t bytes_ = 0;
  };

  /// To be owned by a shared pointer: leases may outlive who made it.
  /// @param returned  Called, on any thread, whenever something was given back.
  explicit MemoryBudget(const MemoryParts& parts, std::function<void(MemoryUse)> returned = {})
      : parts_(parts), returned_(std::move(returned)) {}
  /// All of it for any use.
  explicit MemoryBudget(std::uint64_t bytes)
      : MemoryBudget(MemoryParts{bytes, 0, bytes, bytes, 0}) {}

  /// Null where fewer than `bytes` are left for the use, or where the client has more than is left
  /// for all others. Points have no shares: they take what is kept for them. An empty name is no client.
  [[nodiscard]] std::shared_ptr<Lease> lend(std::uint64_t bytes, const std::string& client = {},
                                            MemoryUse use = MemoryUse::kQuestion) {
    auto lease = std::make_shared<Lease>(shared_from_this(), use, client);
    return lease->grow_to(bytes) ? lease : nullptr;
  }

  /// Whether lend() would lend it now.
  [[nodiscard]] bool has(std::uint64_t bytes, const std::string& client, MemoryUse use) const;

  [[nodiscard]] std::uint64_t bytes() const noexcept { return parts_.all; }
  [[nodiscard]] std::uint64_t lent() const;

 private:
  using Uses = std::array<std::uint64_t, kMemoryUses>;

  // With the mutex.
  [[nodiscard]] std::uint64_t lent_now() const;
  /// Bytes left beside all that is lent, and for a use.
  [[nodiscard]] std::uint64_t left_beside(MemoryUse use) const;
  [[nodiscard]] std::uint64_t left_for(MemoryUse use) const;
  [[nodiscard]] bool is_within_share(const std::string& client, MemoryUse use) const;
  [[nodiscard]] bool take_locked(MemoryUse use, const std::string& client, std::uint64_t bytes,
                                 bool is_beyond_share);
  void take_back_locked(MemoryUse use, const std::string& client, std::uint64_t bytes) noexcept;

  bool take(MemoryUse use, const std::string& client, std::uint64_t bytes, bool is_beyond_share);
  void take_back(MemoryUse use, const std::string& client, std::uint64_t bytes) noexcept;
  bool change_use(MemoryUse from, MemoryUse to, const std::string& client, std::uint64_t bytes);

  const MemoryParts parts_;
  const std::function<void(MemoryUse)> returned_;
  mutable std::mutex mutex_;
  Uses lent_{};
  std::unordered_map<std::string, Uses> held_;
};

}  // namespace ptin::http
