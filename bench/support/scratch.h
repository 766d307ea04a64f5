// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where benchmarks find terrains and leave files for a while.
#pragma once

#include <string>

#include "tests/support/test_folder.h"

namespace ptin::bench {

/// The path of a file in the folder of larger terrains (PTIN_SHARED_DATA at configuration); empty
/// when the file is not there.
[[nodiscard]] std::string shared_terrain(const std::string& name);

/// A folder of its own in the build folder. The build folder is on a disk; a temporary folder need
/// not be.
class ScratchFolder : public test::TestFolder {
 public:
  ScratchFolder();
};

/// The store that benchmarks of queries read: the one that the environment variable
/// PTIN_BENCH_STORE names, else one that is built from srtm1_bigtujunga on the first call and
/// removed when the program ends. Empty when there is neither.
[[nodiscard]] const std::string& bench_store();

}  // namespace ptin::bench
