// SPDX-License-Identifier: GPL-3.0-or-later
//
// Viewsheds of files that left detail out (`build --max-error`): what they call certain is what the
// whole terrain answers.
#include <gtest/gtest.h>

#include "engine/query/questions.h"
#include "engine/query/sight/viewshed.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::run_ptin;
using testing::TestFolder;

std::string built_to(const TestFolder& folder, const std::string& name,
                     const std::string& max_error) {
  const auto made = run_ptin({"build", testing::test_data("mountains_257.tif"), "-o",
                              folder.file(name), "-q", "--max-error", max_error});
  EXPECT_EQ(made.status, 0) << made.err;
  return folder.file(name);
}

struct Counts {
  int certain = 0, visible = 0, hidden = 0, wrong = 0;
};

/// Pixels that are seen in both, target by target.
Counts compare(const Viewshed& coarse, const Viewshed& whole) {
  Counts counts;
  EXPECT_EQ(coarse.pixels.size(), whole.pixels.size());
  for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
    if (!is_certain(coarse.pixels[i])) continue;
    ++counts.certain;
    ++(is_visible(coarse.pixels[i]) ? counts.visible : counts.hidden);
    counts.wrong += coarse.pixels[i] == whole.pixels[i] ? 0 : 1;
  }
  return counts;
}

TEST(ViewshedOfLeftOutDetail, IsCertainOnlyOfWhatTheWholeTerrainAnswers) {
  const TestFolder folder;
  const Terrain whole(StoreFile::open(built_to(folder, "whole.ptin", "0")));
  const Terrain coarse(StoreFile::open(built_to(folder, "coarse.ptin", "2")));
  ASSERT_GT(coarse.store().facts().base_deviation, 2.0);
  const double far_below = 6 * coarse.store().facts().base_deviation;
  Counts all;
  for (const double eye_height : {2.0, far_below}) {
    for (const double target_height : {0.0, far_below}) {
      for (const std::optional<double> tolerance : {std::optional<double>(), {8.0}}) {
        ViewshedRequest request;
        request.eye = {380000, 3802000};
        request.eye_height = eye_height;
        request.target_height = target_height;
        request.radius = 2000;
        request.curvature.coefficient = 0;
        const Viewshed expected = viewshed(whole, request);
        EXPECT_TRUE(expected.exact);
        EXPECT_EQ(expected.undecided_pixels, 0U);
        request.detail.tolerance = tolerance;
        const Viewshed seen = viewshed(coarse, request);
        EXPECT_FALSE(seen.exact);
        const Counts counts = compare(seen, expected);
        EXPECT_EQ(counts.wrong, 0) << eye_height << " " << target_height;
        EXPECT_EQ(static_cast<std::uint64_t>(counts.visible), seen.visible_pixels);
        if (eye_height < far_below) {
          EXPECT_EQ(counts.visible, 0) << "the ground may be above it";
        }
        all.visible += counts.visible;
        all.hidden += counts.hidden;
      }
    }
  }
  EXPECT_GT(all.visible, 100);
  EXPECT_GT(all.hidden, 100);
}

}  // namespace
}  // namespace ptin::tools
