// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one table from error codes to the exit status of the program and the HTTP status that the
// service answers.
#pragma once

#include "engine/error.h"

namespace ptin::tools {

/// Exit status of a program that did what was asked.
inline constexpr int kExitDone = 0;
/// Exit status of a negative answer: `verify` found damage. Not an error: the question was
/// answered.
inline constexpr int kExitNegative = 1;

/// Exit status and HTTP status of an error code. In a service the file that is missing, damaged or
/// unreadable is its own, and what takes too much memory is the question.
struct ErrorStatus {
  int exit;
  unsigned http;
};

/// The row of `code`. Total: a value outside of the enum has the row of `internal`.
[[nodiscard]] ErrorStatus status_of(ErrorCode code) noexcept;

/// What to report for the exception being handled: an Error as it is, std::bad_alloc as
/// resource_exhausted, everything else as internal. What was reported when memory_was_refused(),
/// and blames a file or the program, is resource_exhausted too. REQUIRES: called inside a catch
/// block.
/// @throws std::bad_alloc
[[nodiscard]] Error current_error();

}  // namespace ptin::tools
