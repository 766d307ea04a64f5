// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/tin_soup_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return ptin::fuzz::fuzz_reader(ptin::read_obj, data, size);
}
