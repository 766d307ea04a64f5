// SPDX-License-Identifier: GPL-3.0-or-later
//
// A limit on what this process may take of the system, for as long as a test wants it.
#pragma once

#include <sys/resource.h>

namespace ptin::test {

/// The soft limit of one resource, of this program and those that it runs, while it lives.
class ResourceLimit {
 public:
  using Resource = decltype(RLIMIT_DATA);
  ResourceLimit(Resource resource, rlim_t bytes) : resource_(resource) {
    ::getrlimit(resource_, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    is_set_ = ::setrlimit(resource_, &limit) == 0;
  }
  ResourceLimit(const ResourceLimit&) = delete;
  ResourceLimit& operator=(const ResourceLimit&) = delete;
  ~ResourceLimit() { ::setrlimit(resource_, &before_); }
  [[nodiscard]] bool is_set() const { return is_set_; }

 private:
  Resource resource_;
  rlimit before_{};
  bool is_set_ = false;
};

}  // namespace ptin::test
