// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/progress.h"

#include <cstdlib>
#include <functional>

#include <gtest/gtest.h>

namespace ptin::tools {
namespace {

std::string shown(Progress::Style style, const std::function<void(Progress&)>& work) {
  char* text = nullptr;
  std::size_t bytes = 0;
  std::FILE* stream = open_memstream(&text, &bytes);
  {
    Progress progress(style, stream);
    work(progress);
  }
  std::fclose(stream);
  const std::string result(text, bytes);
  std::free(text);
  return result;
}

TEST(Progress, IsSparseInTheWayOfGdal) {
  const std::string text = shown(Progress::Style::kSparse, [](Progress& p) {
    for (std::uint64_t i = 0; i <= 1000; ++i) p.report("collapse", i, 1000);
    p.finish();
  });
  EXPECT_EQ(text, "collapse: 0...10...20...30...40...50...60...70...80...90...100 - done.\n");
}

TEST(Progress, EndsAStageWhenTheNextBegins) {
  const std::string text = shown(Progress::Style::kSparse, [](Progress& p) {
    p.report("read", 1, 2);
    p.report("write", 0, 2);
  });
  EXPECT_EQ(text, "read: 0...10...20...30...40...50...60...70...80...90...100 - done.\nwrite: 0\n");
}

TEST(Progress, IsSilentWhenTold) {
  EXPECT_EQ(shown(Progress::Style::kSilent, [](Progress& p) { p.report("read", 1, 2); }), "");
}

TEST(Progress, LeavesAnEmptyLineOnATerminal) {
  const std::string text =
      shown(Progress::Style::kTerminal, [](Progress& p) { p.report("read", 1, 2); });
  EXPECT_NE(text.find("50.0 %"), std::string::npos);
  EXPECT_TRUE(text.ends_with("\r\x1b[K"));
}

}  // namespace
}  // namespace ptin::tools
