// SPDX-License-Identifier: GPL-3.0-or-later
//
// The seconds that one part of a benchmark has.
#pragma once

#include <algorithm>

#include "engine/query/questions.h"
#include "tools/measure/deadline.h"
#include "tools/measure/io_report.h"

namespace ptin::tools {

/// Begins when it is made. Once its seconds are over, a part begins only what it has no figure of
/// yet; after as many again it is broken off. Threads: const functions may be called at once.
class PartTime {
 public:
  /// @param seconds  > 0; a stop that the request asks for ends the part, too.
  PartTime(const IoRequest& request, double seconds)
      : seconds_(seconds),
        deadline_(2 * seconds, request.stop),
        limits_{request.memory_bytes, deadline_.token()} {}

  /// What bounds the questions of this part: memory of the request, the token of the deadline.
  [[nodiscard]] const QueryLimits& limits() const noexcept { return limits_; }
  [[nodiscard]] double elapsed() const { return deadline_.elapsed(); }
  /// How much of its seconds is over, at most 1.
  [[nodiscard]] double share() const { return std::min(1.0, elapsed() / seconds_); }
  /// Its seconds are over.
  [[nodiscard]] bool is_late() const { return elapsed() >= seconds_; }
  /// The deadline has passed, and the token of limits() has fired.
  [[nodiscard]] bool is_over() const noexcept { return deadline_.is_over(); }

 private:
  double seconds_;
  Deadline deadline_;
  QueryLimits limits_;
};

}  // namespace ptin::tools
