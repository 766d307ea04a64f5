// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output/spill_file.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::TestFolder;

/// A file system without nameless files, where the first name cannot be removed but for `failure`
/// 0.
class EveryFileHasAName final : public FileLayer {
 public:
  explicit EveryFileHasAName(int failure) : failure_(failure) {}
  int create_nameless(const std::string&, int&) noexcept override { return EOPNOTSUPP; }
  int unlink(const std::string& path) noexcept override {
    const int failure = std::exchange(failure_, 0);
    return failure != 0 ? failure : FileLayer::unlink(path);
  }

 private:
  int failure_;
};

void expect_read_back(const TestFolder& folder, SpillFile& file) {
  EXPECT_EQ(folder.names().size(), 0U);
  std::string text;
  for (int i = 0; i < 300'000; ++i) text += std::to_string(i) + "\n";
  for (std::size_t i = 0; i < text.size(); i += 1000)
    file.write(text.data() + i, std::min<std::size_t>(1000, text.size() - i));
  std::string read;
  for (auto bytes = file.read(); !bytes.empty(); bytes = file.read())
    read.append(bytes.data(), bytes.size());
  EXPECT_TRUE(read == text) << read.size() << " bytes of " << text.size();
  EXPECT_TRUE(file.read().empty());
}

TEST(SpillFile, GivesBackWhatItWasGivenAndHasNoName) {
  const TestFolder folder;
  SpillFile file(folder.file("out.ply"));
  expect_read_back(folder, file);
  EveryFileHasAName files(0);
  SpillFile other(folder.file("out.ply"), files);
  expect_read_back(folder, other);
  SpillFile empty(folder.file("out.ply"));
  EXPECT_TRUE(empty.read().empty());
}

TEST(SpillFile, SaysWhenItsNameStays) {
  const TestFolder folder;
  EveryFileHasAName files(EIO);
  EXPECT_THROW(SpillFile(folder.file("out.ply"), files), Error);
  EXPECT_THROW(SpillFile(folder.file("none/out.ply")), Error);
}

}  // namespace
}  // namespace ptin::tools
