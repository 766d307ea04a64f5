// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every call of the file layer fails in turn (where not all are asked for, each eighth of a raster, and fewer of what is sorted):
// the result is an error and no output, or the output; and the build can be resumed from there.
#include <gtest/gtest.h>

#include "tests/construct/hierarchy_fixture.h"
#include "tests/construct/resume_fixture.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

class ResumeSlow : public testing::TestWithParam<test::SourceKind> {};

TEST_P(ResumeSlow, GivesTheSameBytesWhicheverCallFailed) {
  // Points are sorted, and a TIN several times: every second or fourth of their calls is about as many as all of a raster's.
  int step = test::share_of_cases(8);
  if (GetParam() == test::SourceKind::kPoints) step *= 2;
  if (GetParam() == test::SourceKind::kTin) step *= 4;
  int nth = 0;
  bool has_failed = true;
  while (has_failed) {
    nth += step;
    SCOPED_TRACE(nth);
    const test::InterruptibleBuild interrupted(GetParam());
    test::FailingFiles files(nth);
    BuildResources resources = test::InterruptibleBuild::resources();
    resources.files = &files;
    static_cast<void>(interrupted.run(resources));  // some calls may fail without harm
    has_failed = files.calls() >= nth;
    interrupted.expect_resumed_to_the_same_bytes();
  }
  EXPECT_GT(nth, 200);
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, ResumeSlow,
                         testing::Values(test::SourceKind::kRaster, test::SourceKind::kPoints,
                                         test::SourceKind::kTin),
                         [](const auto& kind) {
                           return kind.param == test::SourceKind::kRaster   ? "Raster"
                                  : kind.param == test::SourceKind::kPoints ? "Points"
                                                                            : "Tin";
                         });

}  // namespace
}  // namespace ptin
