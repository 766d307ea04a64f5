// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file/sigbus_guard.h"

#include <cerrno>
#include <mutex>

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include "engine/error.h"

namespace ptin {

namespace {

// The handler may run at any moment, in any thread: it reads this list without a lock. Ranges are
// never freed, only used again, so that the handler never follows a dangling pointer.
std::atomic<GuardedMapping::Range*> g_ranges{nullptr};
std::uintptr_t g_system_page = 4096;
struct sigaction g_previous {};

bool fill_hole(std::uintptr_t address) noexcept {
  for (GuardedMapping::Range* r = g_ranges.load(std::memory_order_acquire); r != nullptr;
       r = r->next) {
    if (address < r->begin.load(std::memory_order_acquire) ||
        address >= r->end.load(std::memory_order_acquire)) {
      continue;
    }
    // Marked first: whoever reads a zero from the new page must find the mark afterwards.
    r->damaged.store(true, std::memory_order_seq_cst);
    void* page = reinterpret_cast<void*>(address & ~(g_system_page - 1));
    return ::mmap(page, g_system_page, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) ==
           page;
  }
  return false;
}

void on_sigbus(int signal, siginfo_t* info, void* context) {
  const int saved_errno = errno;
  if (!fill_hole(reinterpret_cast<std::uintptr_t>(info->si_addr))) {
    if ((g_previous.sa_flags & SA_SIGINFO) != 0 && g_previous.sa_sigaction != nullptr) {
      g_previous.sa_sigaction(signal, info, context);
    } else if (g_previous.sa_handler != SIG_DFL && g_previous.sa_handler != SIG_IGN) {
      g_previous.sa_handler(signal);
    } else {
      // The default action, taken when the faulting instruction is tried again.
      ::sigaction(SIGBUS, &g_previous, nullptr);
    }
  }
  errno = saved_errno;
}

}  // namespace

void install_sigbus_guard() {
  static std::once_flag once;
  std::call_once(once, [] {
    g_system_page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    struct sigaction action {};
    action.sa_sigaction = on_sigbus;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK;
    ::sigemptyset(&action.sa_mask);
    // The previous one is read first, so that it is there when the new one runs.
    if (::sigaction(SIGBUS, nullptr, &g_previous) != 0 ||
        ::sigaction(SIGBUS, &action, nullptr) != 0) {
      throw system_error(errno, "cannot install a handler for SIGBUS", "sigaction");
    }
  });
}

GuardedMapping::GuardedMapping(const void* address, std::size_t bytes) : range_(nullptr) {
  for (Range* r = g_ranges.load(std::memory_order_acquire); r != nullptr && range_ == nullptr;
       r = r->next) {
    bool free = false;
    if (r->used.compare_exchange_strong(free, true)) {
      range_ = r;
    }
  }
  if (range_ == nullptr) {
    range_ = new Range;
    range_->used = true;
    range_->next = g_ranges.load(std::memory_order_relaxed);
    while (!g_ranges.compare_exchange_weak(range_->next, range_, std::memory_order_release,
                                           std::memory_order_relaxed)) {
    }
  }
  const auto begin = reinterpret_cast<std::uintptr_t>(address);
  range_->damaged.store(false);
  range_->begin.store(begin);
  range_->end.store(begin + bytes);
}

GuardedMapping::~GuardedMapping() {
  range_->end.store(0);
  range_->begin.store(0);
  range_->used.store(false);
}

}  // namespace ptin
