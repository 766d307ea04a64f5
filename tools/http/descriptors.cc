// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/descriptors.h"

#include <algorithm>
#include <filesystem>
#include <iterator>

#include <sys/resource.h>

namespace ptin::http {

namespace {

/// Descriptors of files that are opened for an answer, and of connections that hear that
/// there are too many.
constexpr std::size_t kKept = 64;

}  // namespace

std::size_t raise_descriptor_limit() noexcept {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return 1024;
  rlimit raised = limit;
  raised.rlim_cur = limit.rlim_max;
  if (::setrlimit(RLIMIT_NOFILE, &raised) == 0) limit = raised;
  constexpr rlim_t kMost = rlim_t{1} << 20;
  return static_cast<std::size_t>(std::min(limit.rlim_cur, kMost));
}

std::size_t open_descriptors() {
  std::error_code unknown;
  const std::filesystem::directory_iterator all("/proc/self/fd", unknown);
  return unknown ? 0 : static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

std::size_t connections_for(std::size_t descriptors, std::size_t open, std::size_t each) noexcept {
  const std::size_t taken = open + kKept;
  return std::max<std::size_t>(1, (descriptors - std::min(descriptors, taken)) / each);
}

}  // namespace ptin::http
