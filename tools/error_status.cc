// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/error_status.h"

#include <exception>
#include <new>
#include <string>
#include <system_error>

#include "tools/refused_memory.h"

namespace ptin::tools {

ErrorStatus status_of(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::invalid_argument:
      return {2, 400};
    case ErrorCode::not_found:
      return {3, 500};
    case ErrorCode::corruption:
      return {4, 500};
    case ErrorCode::unsupported_version:
      return {5, 500};
    case ErrorCode::io_error:
      return {6, 500};
    case ErrorCode::resource_exhausted:
      return {7, 413};
    case ErrorCode::cancelled:
      return {8, 503};
    case ErrorCode::internal:
      return {70, 500};
  }
  return {70, 500};
}

namespace {

Error error_at_hand() {
  try {
    throw;
  } catch (const Error& error) {
    return error;
  } catch (const std::bad_alloc&) {
    return {ErrorCode::resource_exhausted, refused_memory_sentence()};
  } catch (const std::system_error& error) {  // Only starting a thread throws this.
    if (error.code() == std::errc::resource_unavailable_try_again) {
      return {ErrorCode::resource_exhausted,
              "the system gives no more threads; raise the limit on processes, or close other "
              "programs"};
    }
    return {ErrorCode::io_error, std::string("the system refused: ") + error.what()};
  } catch (const std::exception& error) {
    return {ErrorCode::internal, std::string("a fault of this program: ") + error.what()};
  } catch (...) {
    return {ErrorCode::internal, "a fault of this program: an unknown exception"};
  }
}

}  // namespace

Error current_error() {
  Error error = error_at_hand();
  const bool blames_another =
      error.code() == ErrorCode::io_error || error.code() == ErrorCode::internal;
  if (!blames_another || !memory_was_refused()) return error;
  return {ErrorCode::resource_exhausted,
          std::string(refused_memory_sentence()).append(" (").append(error.message()).append(")"),
          error.context()};
}

}  // namespace ptin::tools
