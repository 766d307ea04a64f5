// SPDX-License-Identifier: GPL-3.0-or-later
//
// Assertions about our own code. Input never reaches one: bad input is an Error of its own kind.
#pragma once

#include "engine/error.h"

/// Throws Error internal when `condition` is false, in every build. For facts that only a bug can
/// make false and that cost nothing beside the work around them.
#define PTIN_CHECK(condition)                               \
  do {                                                      \
    if (!(condition)) [[unlikely]] {                        \
      ::ptin::check_failed(#condition, __FILE__, __LINE__); \
    }                                                       \
  } while (false)

/// As PTIN_CHECK in builds without NDEBUG; does nothing in builds with NDEBUG. For inner loops.
#ifdef NDEBUG
#define PTIN_DCHECK(condition) \
  do {                         \
  } while (false)
#else
#define PTIN_DCHECK(condition) PTIN_CHECK(condition)
#endif

namespace ptin {

[[noreturn]] inline void check_failed(const char* condition, const char* file, int line) {
  throw Error(ErrorCode::internal, std::string("this should hold and does not: ") + condition,
              std::string(file) + ":" + std::to_string(line));
}

}  // namespace ptin
