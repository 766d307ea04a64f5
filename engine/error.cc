// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/error.h"

#include <cerrno>
#include <system_error>

namespace ptin {

namespace {

std::string joined(std::string_view context, std::string_view message) {
  std::string text;
  if (!context.empty()) {
    text.append(context).append(": ");
  }
  return text.append(message);
}

ErrorCode code_of(int errno_value) {
  switch (errno_value) {
    case ENOENT:
    case ENOTDIR:
      return ErrorCode::not_found;
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
    case ENOMEM:
      return ErrorCode::resource_exhausted;
    default:
      return ErrorCode::io_error;
  }
}

}  // namespace

std::string_view to_string(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::invalid_argument:
      return "invalid_argument";
    case ErrorCode::not_found:
      return "not_found";
    case ErrorCode::corruption:
      return "corruption";
    case ErrorCode::unsupported_version:
      return "unsupported_version";
    case ErrorCode::io_error:
      return "io_error";
    case ErrorCode::resource_exhausted:
      return "resource_exhausted";
    case ErrorCode::cancelled:
      return "cancelled";
    case ErrorCode::internal:
      return "internal";
  }
  return "internal";
}

Error::Error(ErrorCode code, std::string_view message, std::string_view context)
    : std::runtime_error(joined(context, message)),
      code_(code),
      message_(message),
      context_(context) {}

void refuse(std::string_view message, std::string_view context) {
  throw Error(ErrorCode::invalid_argument, message, context);
}

Error system_error(int errno_value, std::string_view action, std::string_view path) {
  std::string message(action);
  message.append(": ").append(std::generic_category().message(errno_value));
  return {code_of(errno_value), message, path};
}

}  // namespace ptin
