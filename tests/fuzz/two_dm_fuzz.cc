// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/tin_reader_target.h"

PTIN_FUZZ_TARGET(two_dm, data, size) {
  return ptin::fuzz::fuzz_reader(ptin::read_two_dm, data, size);
}
