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

/// All cases; under the sanitizers, where each takes four times as long, every `n`-th one up to the last:
/// at least that one, where there is any. Faults of memory and of numbers show in those; `release` looks
/// at each.
template <class Case>
std::vector<Case> some_of(std::vector<Case> cases, [[maybe_unused]] std::size_t n = 2) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  if (!wants_all_cases() && !cases.empty()) {
    std::vector<Case> some;
    for (std::size_t i = (cases.size() - 1) % n; i < cases.size(); i += n) {
      some.push_back(cases[i]);
    }
    return some;
  }
#endif
  return cases;
}
template <class Case>
std::vector<Case> some_of(std::initializer_list<Case> cases, std::size_t n = 2) {
  return some_of(std::vector<Case>(cases), n);
}
template <class Case, std::size_t kCount>
std::vector<Case> some_of(const std::array<Case, kCount>& cases, std::size_t n = 2) {
  return some_of(std::vector<Case>(cases.begin(), cases.end()), n);
}
/// Some of the numbers 1 to `count`: seeds, say.
inline std::vector<std::uint64_t> some_of_first(std::uint64_t count, std::size_t n = 2) {
  std::vector<std::uint64_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::uint64_t{1});
  return some_of(std::move(numbers), n);
}

}  // namespace ptin::test

/// TEST and TEST_F of a case whose size, or the number of programs that it runs, is what it looks at. It is compiled but not run
/// under the sanitizers, which see the same code in smaller cases.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TEST_IN_RELEASE(suite, name) [[maybe_unused]] static void suite##_##name##_in_release()
#define TEST_F_IN_RELEASE(suite, name)               \
  class suite##_##name##_in_release : public suite { \
    [[maybe_unused]] void body();                    \
  };                                                 \
  void suite##_##name##_in_release::body()
#else
#define TEST_IN_RELEASE(suite, name) TEST(suite, name)
#define TEST_F_IN_RELEASE(suite, name) TEST_F(suite, name)
#endif
