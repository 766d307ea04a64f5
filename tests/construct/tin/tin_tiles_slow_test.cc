// SPDX-License-Identifier: GPL-3.0-or-later
//
// TINs built within little memory: not under a sanitizer, since what it keeps of freed memory counts.
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/tin/holed_ply.h"

namespace ptin {
namespace {

TEST(TinsOverTiles, GiveTheSameBytesWithinLittleMemory) {
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file("in.ply"), test::holed_ply(PointKind::kClusters, 1500, 2, 4));
  BuildOptions options;
  options.tile = 8;
  const auto built = [&](const char* name, const BuildResources& resources) {
    build({folder.file("in.ply")}, folder.file(name), options, resources);
    return oracle::bytes_of(folder.file(name));
  };
  BuildResources resources;
  resources.threads = 3;
  const std::string expected = built("much", resources);
  resources.memory_bytes = std::uint64_t{160} << 20;
  EXPECT_TRUE(built("little", resources) == expected);
}

}  // namespace
}  // namespace ptin
