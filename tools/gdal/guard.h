// SPDX-License-Identifier: GPL-3.0-or-later
//
// The border between the library, which throws, and GDAL, which asks by calls that do not.
#pragma once

namespace ptin::tools {

/// Makes the exception that is being handled GDAL's last error, "ptin: " and one sentence, with a
/// number of GDAL's by its code. To be called in a handler.
void tell_gdal_of_exception() noexcept;

/// Runs `work`. What it throws is told to GDAL, and the result is false then: nothing is thrown
/// through frames of GDAL's. Every function that GDAL calls and that may throw goes through here.
template <class Work>
[[nodiscard]] bool guarded(const Work& work) noexcept {
  try {
    work();
    return true;
  } catch (...) {
    tell_gdal_of_exception();
    return false;
  }
}

}  // namespace ptin::tools
