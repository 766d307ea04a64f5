// SPDX-License-Identifier: GPL-3.0-or-later
//
// Calling GDAL from a library that never prints: drivers are registered once, and what GDAL has to
// say is collected for our own errors instead of going to the standard error stream.
#pragma once

#include <string>

namespace ptin {

/// While one lives, errors and warnings that GDAL raises on this thread are kept here and printed
/// nowhere. The first one registers GDAL's drivers. Scopes nest; each belongs to the thread that
/// made it.
class GdalSession {
 public:
  GdalSession();
  ~GdalSession();
  GdalSession(const GdalSession&) = delete;
  GdalSession& operator=(const GdalSession&) = delete;

  /// The first failure that GDAL reported in this scope, without its final full stop; "" when none.
  [[nodiscard]] const std::string& first_failure() const noexcept { return first_failure_; }
  [[nodiscard]] bool failed() const noexcept { return failed_; }

  /// `sentence`, followed by GDAL's own words in brackets when there are any.
  [[nodiscard]] std::string explain(std::string sentence) const;

 private:
  void note_failure(const char* text);

  friend struct GdalSessionAccess;
  std::string first_failure_;
  bool failed_ = false;
};

}  // namespace ptin
