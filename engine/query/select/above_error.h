// SPDX-License-Identifier: GPL-3.0-or-later
//
// The predicate of errors.
#pragma once

#include "engine/query/select/predicate.h"

namespace ptin {

/// True above a bound, which, unlike error_above()'s tolerance, may be negative (always true) or
/// infinite (never). Monotone, exact. Threads: immutable.
class AboveError final : public BoundedPredicate {
 public:
  explicit AboveError(double bound) : bound_(bound) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override { return a.error > bound_; }
  [[nodiscard]] bool holds_for_all(const Attributes&, double least_error) const noexcept override {
    return least_error > bound_;
  }

 private:
  double bound_;
};

}  // namespace ptin
