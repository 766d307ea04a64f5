// SPDX-License-Identifier: GPL-3.0-or-later
//
// The predicate of a level of detail.
#pragma once

#include "storage/attributes.h"

namespace ptin {

/// True above a bound, which, unlike error_above()'s tolerance, may be negative (always true) or
/// infinite (never). Monotone, exact. Threads: immutable.
class AboveError final : public AttributePredicate {
 public:
  explicit AboveError(double bound) : bound_(bound) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override { return a.error > bound_; }

 private:
  double bound_;
};

}  // namespace ptin
