// SPDX-License-Identifier: GPL-3.0-or-later
//
// Calling GDAL from a library that never prints: drivers are registered once, and GDAL's messages
// are kept for our own errors and warnings instead of going to the standard error stream.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "engine/construct/grid/source_warning.h"

namespace ptin {

/// The first `most` bytes of a file, or all of fewer; none where it cannot be opened.
[[nodiscard]] std::optional<std::string> beginning_of_file(const std::string& path,
                                                           std::size_t most);

/// A scope in which GDAL prints nothing. While a session lives, it keeps the first failure that
/// GDAL raises on this thread, and its first warnings; what is said more, and debug messages, are
/// dropped. The first
/// session of the process registers GDAL's drivers. Sessions nest: the innermost receives the
/// messages. Each belongs to the thread that made it.
class GdalSession {
 public:
  GdalSession();
  ~GdalSession();
  GdalSession(const GdalSession&) = delete;
  GdalSession& operator=(const GdalSession&) = delete;

  /// The first failure that GDAL reported in this scope, without its final full stop; "" when none.
  [[nodiscard]] const std::string& first_failure() const noexcept { return first_failure_; }
  /// True when GDAL reported a failure in this scope.
  [[nodiscard]] bool failed() const noexcept { return failed_; }

  /// `sentence`, followed by the first failure in brackets when there is one.
  [[nodiscard]] std::string explain(std::string sentence) const;

  /// Adds what GDAL warned of in this scope, and failures that it went on after: to be called when a
  /// file has been opened. Left out are messages that bear neither on places nor on heights, as about
  /// letters, tags, colours and the identifiers of features.
  void tell_warnings(const std::string& path, SourceWarnings& warnings) const;

 private:
  void note_failure(const char* text);
  void note_warning(const char* text);

  friend struct GdalSessionAccess;
  std::string first_failure_;
  bool failed_ = false;
  std::vector<std::string> warnings_;  ///< Each once.
};

}  // namespace ptin
