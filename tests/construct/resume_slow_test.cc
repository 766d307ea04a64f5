// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every call of the file layer fails in turn: the result is an error and no output, or the output;
// and the build can be resumed from there.
#include <gtest/gtest.h>

#include "tests/construct/hierarchy_fixture.h"
#include "tests/construct/resume_fixture.h"

namespace ptin {
namespace {

TEST(ResumeSlow, GivesTheSameBytesWhicheverCallFailed) {
  int calls = 1;
  for (int nth = 1; nth <= calls; ++nth) {
    SCOPED_TRACE(nth);
    const test::InterruptibleBuild interrupted;
    test::FailingFiles files(nth);
    BuildResources resources = test::InterruptibleBuild::resources();
    resources.files = &files;
    static_cast<void>(interrupted.run(resources));  // some calls may fail without harm
    calls = files.calls();
    interrupted.expect_resumed_to_the_same_bytes();
  }
  EXPECT_GT(calls, 200);
}

}  // namespace
}  // namespace ptin
