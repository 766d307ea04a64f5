// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/gdal/guard.h"

#include <exception>
#include <new>

#include <cpl_error.h>

#include "engine/error.h"

namespace ptin::tools {

namespace {

CPLErrorNum number_of(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::invalid_argument:
      return CPLE_IllegalArg;
    case ErrorCode::not_found:
      return CPLE_OpenFailed;
    case ErrorCode::corruption:
    case ErrorCode::io_error:
      return CPLE_FileIO;
    case ErrorCode::unsupported_version:
      return CPLE_NotSupported;
    case ErrorCode::resource_exhausted:
      return CPLE_OutOfMemory;
    case ErrorCode::cancelled:
      return CPLE_UserInterrupt;
    case ErrorCode::internal:
      break;
  }
  return CPLE_AppDefined;
}

}  // namespace

void tell_gdal_of_exception() noexcept {
  try {
    throw;
  } catch (const Error& e) {
    CPLError(CE_Failure, number_of(e.code()), "ptin: %s", e.what());
  } catch (const std::bad_alloc&) {
    CPLError(CE_Failure, CPLE_OutOfMemory, "ptin: the memory of this process is used up");
  } catch (const std::exception& e) {
    CPLError(CE_Failure, CPLE_AppDefined, "ptin: %s", e.what());
  } catch (...) {
    CPLError(CE_Failure, CPLE_AppDefined, "ptin: something unknown was thrown");
  }
}

}  // namespace ptin::tools
