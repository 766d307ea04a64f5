// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output_file.h"

#include <cerrno>
#include <cstddef>

#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include "engine/error.h"
#include "tests/tools/program.h"
#include "tools/pending_file.h"

namespace ptin::tools {
namespace {

using testing::read_file;
using testing::TestFolder;
using testing::write_file;

template <typename Act>
ErrorCode code_thrown_by(const Act& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.code();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorCode::internal;
}

TEST(OutputFile, AppearsWholeOrNotAtAll) {
  const TestFolder folder;
  const std::string large(3'000'000, 'x');
  {
    OutputFile out(folder.file("kept"), false);
    out.write("begin ");
    out.write(large);
    EXPECT_FALSE(std::filesystem::exists(folder.file("kept")));
    out.publish();
  }
  {
    OutputFile out(folder.file("dropped"), false);
    out.write(large);
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"kept"});
  EXPECT_EQ(read_file(folder.file("kept")), "begin " + large);
}

TEST(OutputFile, ReplacesOnlyWhenTold) {
  const TestFolder folder;
  const std::string path = folder.file("file");
  write_file(path, "old");
  EXPECT_EQ(code_thrown_by([&] { OutputFile(path, false); }), ErrorCode::invalid_argument);
  OutputFile out(path, true);
  out.write("new");
  EXPECT_EQ(read_file(path), "old");
  out.publish();
  EXPECT_EQ(read_file(path), "new");
}

TEST(OutputFile, DoesNotReplaceWhatAppearedMeanwhile) {
  const TestFolder folder;
  OutputFile out(folder.file("file"), false);
  write_file(folder.file("file"), "another's");
  EXPECT_EQ(code_thrown_by([&] { out.publish(); }), ErrorCode::invalid_argument);
  EXPECT_EQ(read_file(folder.file("file")), "another's");
}

TEST(PendingFile, TakesItsSideFilesAlongHoweverItEnds) {
  const TestFolder folder;
  for (const bool is_published : {false, true}) {
    PendingFile file(folder.file("a.gpkg"), true);
    write_file(file.temporary(), "content");
    write_file(file.temporary() + "-journal", "");
    write_file(file.temporary() + ".aux.xml", "<PAMDataset/>");
    if (is_published) file.publish();
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.gpkg"});
}

TEST(OutputFile, NamesAMissingFolderAndRefusesAFolder) {
  const TestFolder folder;
  EXPECT_EQ(code_thrown_by([&] { check_output(folder.file("none/file"), false); }),
            ErrorCode::not_found);
  EXPECT_EQ(code_thrown_by([&] { check_output(folder.path().string(), true); }),
            ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace ptin::tools
