// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/memory_budget.h"

#include <algorithm>
#include <numeric>

namespace ptin::http {

namespace {

std::size_t index_of_use(MemoryUse use) noexcept { return static_cast<std::size_t>(use); }

std::uint64_t without(std::uint64_t all, std::uint64_t part) noexcept {
  return all - std::min(all, part);
}

}  // namespace

bool MemoryBudget::has(std::uint64_t bytes, const std::string& client, MemoryUse use) const {
  const std::lock_guard lock(mutex_);
  return bytes <= left_for(use) && is_within_share(client, use);
}

std::uint64_t MemoryBudget::lent() const {
  const std::lock_guard lock(mutex_);
  return lent_now();
}

std::uint64_t MemoryBudget::lent_now() const {
  return std::accumulate(lent_.begin(), lent_.end(), std::uint64_t{0});
}

std::uint64_t MemoryBudget::left_beside(MemoryUse use) const {
  const std::uint64_t left = without(parts_.all, lent_now());
  if (use == MemoryUse::kPoint) return left;
  return without(left, without(parts_.points, lent_[index_of_use(MemoryUse::kPoint)]));
}

std::uint64_t MemoryBudget::left_for(MemoryUse use) const {
  const std::uint64_t left = left_beside(use), lent = lent_[index_of_use(use)];
  if (use == MemoryUse::kAnswer) return std::min(left, without(parts_.most_answers, lent));
  if (use == MemoryUse::kBody) return std::min(left, without(parts_.most_bodies, lent));
  return left;
}

/// For what has a part of its own, what the client has of that part counts; or else all that it has.
bool MemoryBudget::is_within_share(const std::string& client, MemoryUse use) const {
  if (client.empty() || use == MemoryUse::kPoint) return true;
  const auto held = held_.find(client);
  if (held == held_.end()) return true;
  const Uses& has = held->second;
  const std::uint64_t counts = use == MemoryUse::kQuestion
                                   ? std::accumulate(has.begin(), has.end(), std::uint64_t{0})
                                   : has[index_of_use(use)];
  return counts <= left_for(use);
}

bool MemoryBudget::take_locked(MemoryUse use, const std::string& client, std::uint64_t bytes,
                               bool is_beyond_share) {
  if (bytes > (is_beyond_share ? left_beside(use) : left_for(use))) return false;
  if (!is_beyond_share && !is_within_share(client, use)) return false;
  if (!client.empty()) held_[client][index_of_use(use)] += bytes;
  lent_[index_of_use(use)] += bytes;
  return true;
}

void MemoryBudget::take_back_locked(MemoryUse use, const std::string& client,
                                    std::uint64_t bytes) noexcept {
  lent_[index_of_use(use)] -= bytes;
  const auto held = client.empty() ? held_.end() : held_.find(client);
  if (held == held_.end()) return;
  held->second[index_of_use(use)] -= bytes;
  if (held->second == Uses{}) held_.erase(held);
}

bool MemoryBudget::take(MemoryUse use, const std::string& client, std::uint64_t bytes,
                        bool is_beyond_share) {
  const std::lock_guard lock(mutex_);
  return take_locked(use, client, bytes, is_beyond_share);
}

void MemoryBudget::take_back(MemoryUse use, const std::string& client,
                             std::uint64_t bytes) noexcept {
  {
    const std::lock_guard lock(mutex_);
    take_back_locked(use, client, bytes);
  }
  if (returned_) returned_(use);
}

bool MemoryBudget::change_use(MemoryUse from, MemoryUse to, const std::string& client,
                              std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  take_back_locked(from, client, bytes);
  if (take_locked(to, client, bytes, false)) return true;
  static_cast<void>(take_locked(from, client, bytes, true));
  return false;
}

}  // namespace ptin::http
