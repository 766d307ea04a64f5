// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain without a surface: the build and every question say so.
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/no_surface.h"

namespace ptin::tools {
namespace {

using testing::kNoSurface;
using testing::NoSurface;
using testing::Outcome;
using testing::run_ptin;

TEST_F(NoSurface, BuildAndEveryQuestionWarn) {
  using Pixels = std::vector<std::array<int, 2>>;
  for (const Pixels& pixels : {Pixels{}, Pixels{{5, 5}}, Pixels{{5, 5}, {12, 9}}}) {
    const Outcome built = build(pixels);
    EXPECT_EQ(built.status, 0);
    EXPECT_TRUE(has(built.err, store() + " " + kNoSurface)) << built.err;
    EXPECT_TRUE(has(built.err, pixels.empty() ? "no sample of the source has a height"
                                              : "no sample with a height has a triangle"));
    EXPECT_TRUE(has(built.err, "--nodata")) << "what to look at";
    const Arguments questions[] = {
        {"export", store(), "-o", file("a.tif"), "--overwrite"},
        {"export", store(), "-o", file("a.ply"), "--overwrite"},
        {"volume", store(), "--level", "5"},
        {"render", store(), "-o", file("a.png"), "--overwrite"},
        {"refine", store(), "-o", file("a.ply"), "--overwrite"},
        {"highest", store()},
        {"locate", store(), "500100", "3999800"},
        {"isoline", store(), "--level", "5", "-o", file("a.gpkg"), "--overwrite"},
        {"stream", store(), "-o", file("a.pts"), "--overwrite"}};
    for (Arguments words : questions) {
      EXPECT_TRUE(has(warned(words), "ptin: warning: " + store() + " " + kNoSurface)) << words[0];
      words.emplace_back("-q");
      EXPECT_EQ(warned(words), "") << words[0];
    }
  }
  build({});
  const Outcome lines = run_ptin({"isoline", store(), "-i", "10", "-o", file("b.gpkg")});
  EXPECT_EQ(lines.status, 0) << lines.err;
  EXPECT_TRUE(has(lines.err, "no surface crosses these levels; the layer is empty"));
}

}  // namespace
}  // namespace ptin::tools
