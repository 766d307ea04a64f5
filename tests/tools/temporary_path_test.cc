// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output/temporary_path.h"

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using std::filesystem::exists;
using testing::TestFolder;
using testing::write_file;

constexpr std::array kBeside = {"-journal", ".aux.xml"};

TEST(TemporaryPath, GoesWithWhatLiesBesideIt) {
  const TestFolder folder;
  for (const char* name : {"a.tmp", "a.tmp-journal", "a.tmp.aux.xml", "other"})
    write_file(folder.file(name), "x");
  { const TemporaryPath path(folder.file("a.tmp"), kBeside); }
  EXPECT_FALSE(exists(folder.file("a.tmp")) || exists(folder.file("a.tmp-journal")) ||
               exists(folder.file("a.tmp.aux.xml")));
  EXPECT_TRUE(exists(folder.file("other")));
}

TEST(TemporaryPath, StaysWhereItIsKeptButNotWhatLiesBesideIt) {
  const TestFolder folder;
  write_file(folder.file("a"), "x");
  write_file(folder.file("a-journal"), "x");
  {
    TemporaryPath path(folder.file("a"), kBeside);
    path.keep();
  }
  EXPECT_TRUE(exists(folder.file("a")));
  EXPECT_FALSE(exists(folder.file("a-journal")));
}

TEST(TemporaryPath, MayBeAFolderWithFiles) {
  const TestFolder folder;
  std::filesystem::create_directory(folder.file("f"));
  write_file(folder.file("f/a"), "x");
  { const TemporaryPath path(folder.file("f")); }
  EXPECT_FALSE(exists(folder.file("f")));
  { const TemporaryPath path(folder.file("was never made")); }
}

// As a process does that ends without destructors. More than are known are removed by theirs.
TEST(TemporaryPath, IsRemovedWithAllOthersThatLive) {
  const TestFolder folder;
  std::vector<std::unique_ptr<TemporaryPath>> paths;
  for (int i = 0; i < 40; ++i) {
    paths.push_back(std::make_unique<TemporaryPath>(folder.file(std::to_string(i))));
    write_file(paths.back()->path(), "x");
  }
  remove_temporary_paths();
  EXPECT_FALSE(exists(folder.file("0")) || exists(folder.file("31")));
  EXPECT_TRUE(exists(folder.file("32")));
  paths.clear();
  EXPECT_FALSE(exists(folder.file("32")));
  const TemporaryPath again(folder.file("again"));
  write_file(again.path(), "x");
  remove_temporary_paths();
  EXPECT_FALSE(exists(again.path())) << "places become free";
}

}  // namespace
}  // namespace ptin::tools
