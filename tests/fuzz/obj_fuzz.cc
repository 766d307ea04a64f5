// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/tin_reader_target.h"

PTIN_FUZZ_TARGET(obj, data, size) { return ptin::fuzz::fuzz_reader(ptin::read_obj, data, size); }
