// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/refused_memory.h"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include <unistd.h>

#include "tools/error_status.h"
#include "tools/output/temporary_path.h"

namespace ptin::tools {

namespace {

#define PTIN_REFUSED_MEMORY                                                                    \
  "the system gives no more memory; ask for less (a window, a larger --error) or close other " \
  "programs"

constexpr std::size_t kReserveBytes = std::size_t{1} << 20;

std::atomic<void*> reserve{nullptr};
std::atomic<bool> was_refused{false};
std::atomic<bool> is_json{false};

void give_reserve_and_refuse() {
  was_refused = true;
  std::free(reserve.exchange(nullptr));
  throw std::bad_alloc();
}

/// True for std::bad_alloc as the exception that ends the process.
bool ends_without_memory() noexcept {
  try {
    const std::exception_ptr now = std::current_exception();
    if (now) std::rethrow_exception(now);
  } catch (const std::bad_alloc&) {
    return true;
  } catch (...) {
  }
  return false;
}

std::terminate_handler terminate_before = nullptr;

[[noreturn]] void end_with_sentence() noexcept {
  remove_temporary_paths();
  const char* const text =
      is_json ? "{\"error\":{\"code\":\"resource_exhausted\",\"message\":\"" PTIN_REFUSED_MEMORY
                "\"}}\n"
              : "ptin: " PTIN_REFUSED_MEMORY "\n";
  std::fputs(text, stderr);
  _exit(status_of(ErrorCode::resource_exhausted).exit);
}

[[noreturn]] void end_process() {
  if (ends_without_memory()) end_with_sentence();
  if (terminate_before != nullptr) terminate_before();
  std::abort();
}

/// Libraries of C abort where memory is refused, and so do assertions in others (PROJ's).
void end_aborted(int) {
  if (was_refused) end_with_sentence();
}

}  // namespace

void prepare_for_refused_memory() {
  is_json = false;
  was_refused = false;
  if (reserve.load() == nullptr) std::free(reserve.exchange(std::malloc(kReserveBytes)));
  std::set_new_handler(give_reserve_and_refuse);
  std::signal(SIGABRT, end_aborted);
  const std::terminate_handler before = std::set_terminate(end_process);
  if (before != end_process) terminate_before = before;
}

void tell_refused_memory_as_json(bool as_json) noexcept { is_json = as_json; }

bool memory_was_refused() noexcept { return was_refused; }

void require_memory_given(const std::string& path) {
  if (was_refused) throw Error(ErrorCode::resource_exhausted, PTIN_REFUSED_MEMORY, path);
}

const char* refused_memory_sentence() noexcept { return PTIN_REFUSED_MEMORY; }

}  // namespace ptin::tools
