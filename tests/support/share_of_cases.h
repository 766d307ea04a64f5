// SPDX-License-Identifier: GPL-3.0-or-later
//
// The share of their cases that tests look at which repeat one thing often, or on several terrains.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <numeric>
#include <utility>
#include <vector>

namespace ptin::test {

/// Whether the environment asks for all cases.
inline bool wants_all_cases() { return std::getenv("PTIN_ALL_CASES") != nullptr; }

/// `n`: look at each n-th case, or at an n-th of them. 1 where all are asked for.
inline int share_of_cases(int n) { return wants_all_cases() ? 1 : n; }

/// All cases; under the sanitizers, where each takes four times as long, every `n`-th one up to the last, or
/// up to so many before it. Faults of memory and of numbers show in those; `tests/run release` looks at each,
/// and so does each night's run, but not a run of all presets. So where cases are of several kinds, the share
/// has one of each: what one test leaves out another one takes, from `before_last` on.
template <class Case>
std::vector<Case> some_of(std::vector<Case> cases, [[maybe_unused]] std::size_t n = 2,
                          [[maybe_unused]] std::size_t before_last = 0) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  if (!wants_all_cases() && !cases.empty()) {
    std::vector<Case> some;
    for (std::size_t i = (cases.size() + n - 1 - before_last % n) % n; i < cases.size(); i += n) {
      some.push_back(cases[i]);
    }
    return some;
  }
#endif
  return cases;
}
template <class Case>
std::vector<Case> some_of(std::initializer_list<Case> cases, std::size_t n = 2,
                          std::size_t before_last = 0) {
  return some_of(std::vector<Case>(cases), n, before_last);
}
template <class Case, std::size_t kCount>
std::vector<Case> some_of(const std::array<Case, kCount>& cases, std::size_t n = 2,
                          std::size_t before_last = 0) {
  return some_of(std::vector<Case>(cases.begin(), cases.end()), n, before_last);
}
/// Some of the numbers 1 to `count`: seeds, say.
inline std::vector<std::uint64_t> some_of_first(std::uint64_t count, std::size_t n = 2) {
  std::vector<std::uint64_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::uint64_t{1});
  return some_of(std::move(numbers), n);
}

}  // namespace ptin::test
