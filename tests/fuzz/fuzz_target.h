// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a fuzz target is written: PTIN_FUZZ_TARGET(name, data, size) { ... return 0; }. libFuzzer gets
// a program a target; the replay program holds all of them, by name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <string>

namespace ptin::fuzz {

using Target = int (*)(const std::uint8_t* data, std::size_t size);

/// All targets of this program.
inline std::map<std::string, Target>& targets() {
  static std::map<std::string, Target> all;
  return all;
}

/// Ends the process where something does not hold: a finding.
inline void require(bool holds) {
  if (!holds) std::abort();
}

struct Registered {
  Registered(const char* name, Target target) { targets().emplace(name, target); }
};

}  // namespace ptin::fuzz

#ifdef PTIN_LIBFUZZER
#define PTIN_FUZZ_TARGET(name, data, size) \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
#else
#define PTIN_FUZZ_TARGET(name, data, size)                                   \
  static int fuzz_##name(const std::uint8_t* data, std::size_t size);        \
  static const ptin::fuzz::Registered registered_##name(#name, fuzz_##name); \
  static int fuzz_##name(const std::uint8_t* data, std::size_t size)
#endif
