// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one exception type of the project, and the codes it carries.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace ptin {

/// Why an operation failed. Each code has one exit status and one HTTP status
/// (tools/error_status.h).
enum class ErrorCode {
  invalid_argument,  ///< The caller's value or input is outside of the contract.
  not_found,         ///< The file or data set does not exist.
  corruption,        ///< Stored bytes cannot be what was written: checksum, offset, count or order.
  unsupported_version,  ///< Well-formed, but of a newer major version than this library reads.
  io_error,             ///< The system refused: read, write, sync, rename, map.
  resource_exhausted,   ///< The given memory or the disk is used up.
  cancelled,            ///< The caller's stop token fired.
  internal,             ///< A fault of this project, detected; never raised for bad input.
};

/// The code as it appears in JSON: "invalid_argument", "not_found", ...
[[nodiscard]] std::string_view to_string(ErrorCode code) noexcept;

/// An error: a code, one sentence (what, expected, what to do) and the place that it concerns.
/// Thrown where the fact is known; caught in `main`, around a service request, at the top of a
/// task, in tests. An answer that is merely "no" (outside, void, hidden) is a value and never an
/// Error.
class Error : public std::runtime_error {
 public:
  /// @param code     What kind of failure.
  /// @param message  One sentence; what() returns "context: message" when there is a context.
  /// @param context  The file, page or line concerned; may be empty.
  Error(ErrorCode code, std::string_view message, std::string_view context = {});

  [[nodiscard]] ErrorCode code() const noexcept { return code_; }
  [[nodiscard]] const std::string& message() const noexcept { return message_; }
  [[nodiscard]] const std::string& context() const noexcept { return context_; }

 private:
  ErrorCode code_;
  std::string message_;
  std::string context_;
};

/// Throws the commonest error: a value or an input of the caller cannot be used.
/// @param message, context  As Error's.
/// @throws Error invalid_argument  always
[[noreturn]] void refuse(std::string_view message, std::string_view context = {});

/// The error for a call of the system that failed: not_found (ENOENT, ENOTDIR), resource_exhausted
/// (ENOSPC, EDQUOT, EFBIG, ENOMEM) or else io_error.
/// @param action  What was attempted, for the message: "cannot open", "cannot write".
/// @param path    The file concerned.
[[nodiscard]] Error system_error(int errno_value, std::string_view action, std::string_view path);

}  // namespace ptin
