// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/measure/deadline.h"

#include <algorithm>
#include <utility>

namespace ptin::tools {

Deadline::Deadline(double seconds, std::stop_token caller)
    : caller_(std::move(caller)),
      of_caller_(caller_, Fire{source_}),
      timer_([this, seconds](const std::stop_token& done) { wait(done, seconds); }) {}

void Deadline::wait(const std::stop_token& done, double seconds) {
  constexpr double kLongest = 1e8;  // three years; the clock holds them
  const std::chrono::duration<double> length(std::min(seconds, kLongest));
  std::unique_lock lock(lock_);
  change_.wait_for(lock, done, length, [] { return false; });
  if (!done.stop_requested()) source_.request_stop();
}

}  // namespace ptin::tools
