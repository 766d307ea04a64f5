// SPDX-License-Identifier: GPL-3.0-or-later
//
// The share of their cases that tests look at which repeat one thing often, or on several terrains.
#pragma once

#include <array>
#include <cstddef>
#include <cstdlib>
#include <initializer_list>
#include <vector>

namespace ptin::test {

/// Whether the environment asks for all cases.
inline bool wants_all_cases() { return std::getenv("PTIN_ALL_CASES") != nullptr; }

/// `n`: look at each n-th case, or at an n-th of them. 1 where all are asked for.
inline int share_of_cases(int n) { return wants_all_cases() ? 1 : n; }

/// All cases; under the sanitizers, where each takes four times as long, every second one, and the last.
/// Faults of memory and of numbers show in those; `release` looks at each.
template <class Case>
std::vector<Case> some_of(std::vector<Case> cases) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  if (!wants_all_cases()) {
    std::vector<Case> some;
    for (std::size_t i = (cases.size() + 1) % 2; i < cases.size(); i += 2) {
      some.push_back(cases[i]);
    }
    return some;
  }
#endif
  return cases;
}
template <class Case>
std::vector<Case> some_of(std::initializer_list<Case> cases) {
  return some_of(std::vector<Case>(cases));
}
template <class Case, std::size_t kCount>
std::vector<Case> some_of(const std::array<Case, kCount>& cases) {
  return some_of(std::vector<Case>(cases.begin(), cases.end()));
}

}  // namespace ptin::test
