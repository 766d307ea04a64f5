// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/kept_memory.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <system_error>

#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

namespace ptin::tools {

namespace {

constexpr std::uint64_t kMib = std::uint64_t{1} << 20;
/// The most that malloc takes as M_MMAP_THRESHOLD.
constexpr std::uint64_t kMostBlock = 32 * kMib;

/// Resident memory of this process that is no file's; none where the system does not tell.
std::optional<std::uint64_t> resident_bytes() noexcept {
  std::array<char, 128> text{};
  const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return std::nullopt;
  const ssize_t got = ::read(file, text.data(), text.size());
  ::close(file);
  std::array<std::uint64_t, 3> pages{};  // Of the address space, resident, and of these the files'.
  const char* at = text.data();
  const char* const end = at + std::max<ssize_t>(got, 0);
  for (std::uint64_t& number : pages) {
    const auto [stopped, fault] = std::from_chars(at, end, number);
    if (fault != std::errc()) return std::nullopt;
    at = std::min(stopped + 1, end);
  }
  return (pages[1] - std::min(pages[1], pages[2])) * static_cast<std::uint64_t>(::getpagesize());
}

std::uint64_t allocated_bytes() noexcept {
  const struct mallinfo2 all = ::mallinfo2();
  return all.uordblks + all.hblkhd;
}

}  // namespace

void return_freed_memory(int threads) {
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  mallopt(M_TRIM_THRESHOLD, 4 << 20);
  mallopt(M_ARENA_MAX, threads + 1);
}

void keep_freed_memory(const BuildPlan& plan) {
  constexpr std::uint64_t kLeast = 64 * kMib, kMost = 256 * kMib;
  const std::uint64_t room = plan.memory.limit - std::min(plan.memory.limit, plan.memory_expected);
  const std::uint64_t kept = std::min(room / static_cast<std::uint64_t>(plan.threads + 1), kMost);
  if (kept >= kLeast) {
    mallopt(M_MMAP_THRESHOLD, static_cast<int>(kMostBlock));
    // Half of it at the end of a thread's memory; as much may be kept between blocks in use.
    mallopt(M_TRIM_THRESHOLD, static_cast<int>(kept / 2));
  } else {
    return_freed_memory(plan.threads);
  }
}

std::function<void()> keep_freed_memory_of_questions(std::uint64_t kept) {
  // Each thread would else keep memory of its own that no other one gets, and of a further arena
  // malloc_trim() never gives back what is free at the end.
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_MMAP_THRESHOLD, static_cast<int>(std::clamp(kept / 2, kMib, kMostBlock)));
  mallopt(M_TRIM_THRESHOLD, static_cast<int>(std::clamp(kept, 4 * kMib, 1024 * kMib)));
  give_back_freed_memory();  // What is not allocated then is the program's own.
  const std::uint64_t now = resident_bytes().value_or(0);
  const std::uint64_t program = now - std::min(now, allocated_bytes());
  return [kept, program] {
    const auto resident = resident_bytes();
    if (resident && *resident <= program + kept) return;
    // What malloc counts as free may be with the system already: what it counts as allocated is not.
    if (resident && *resident <= program + kept + allocated_bytes()) return;
    give_back_freed_memory();
  };
}

void give_back_freed_memory() { malloc_trim(0); }

}  // namespace ptin::tools
