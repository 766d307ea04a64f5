// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file/file_layer.h"

#include <array>
#include <cerrno>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "tests/storage/store_fixture.h"

namespace ptin::test {
namespace {

/// As a process sees it that is killed before it removes anything.
class NothingIsRemoved : public FileLayer {
 public:
  int unlink(const std::string&) noexcept override { return 0; }
};

/// A file system that does not know files without a name.
class EverythingHasAName final : public FileLayer {
 public:
  int create_nameless(const std::string&, int&) noexcept override { return EOPNOTSUPP; }
};

void expect_to_keep_bytes(ScratchFile& file) {
  const std::array<std::byte, 3> bytes{std::byte{1}, std::byte{2}, std::byte{3}};
  file.write_at(bytes, 7);
  std::array<std::byte, 3> back{};
  file.read_at(back, 7);
  EXPECT_EQ(back, bytes);
}

TEST(ScratchFile, WithoutANameLeavesNothingBehindWheneverTheProcessIsKilled) {
  const TestFolder folder(TestFolder::Size::kSmall);
  NothingIsRemoved files;
  const std::string at = std::filesystem::path(folder.file("x")).parent_path().string();
  ScratchFile file(files, at, "spool", true);
  EXPECT_TRUE(folder.names().empty());
  expect_to_keep_bytes(file);
}

TEST(ScratchFile, WithoutANameGetsOneForAMomentWhereTheDiskKnowsNoOtherWay) {
  const TestFolder folder(TestFolder::Size::kSmall);
  EverythingHasAName files;
  const std::string at = std::filesystem::path(folder.file("x")).parent_path().string();
  ScratchFile file(files, at, "spool", true);
  EXPECT_TRUE(folder.names().empty());
  expect_to_keep_bytes(file);
}

}  // namespace
}  // namespace ptin::test
