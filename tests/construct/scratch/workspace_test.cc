// SPDX-License-Identifier: GPL-3.0-or-later
//
// The folder of a build in the making: whose it is, what is found in it whenever a process was killed,
// and what of its files is believed.
#include "engine/construct/scratch/workspace.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/construct/scratch/array_file.h"
#include "engine/construct/scratch/manifest.h"
#include "engine/error.h"
#include "storage/file/file_layer.h"
#include "storage/file/sigbus_guard.h"
#include "tests/construct/made_raster.h"

namespace ptin {
namespace {

using oracle::ScratchFolder;

TEST(Workspace, IsOneBuildsOnly) {
  const ScratchFolder folder;
  FileLayer& files = FileLayer::system();
  const std::string output = folder.file("a.ptin");
  {
    Workspace workspace(files, output, "", Unfinished::kRefuse, {{"of", 1}});
    EXPECT_THROW(Workspace(files, output, "", Unfinished::kResume, {{"of", 1}}), Error);
    EXPECT_THROW(Workspace::discard(files, output), Error);
  }
  EXPECT_THROW(Workspace(files, output, "", Unfinished::kRefuse, {{"of", 1}}), Error);
  EXPECT_THROW(Workspace(files, output, "", Unfinished::kResume, {{"of", 2}}), Error);
  { const Workspace again(files, output, "", Unfinished::kResume, {{"of", 1}}); }
  EXPECT_TRUE(Workspace::discard(files, output));
  EXPECT_FALSE(Workspace::discard(files, output));
  EXPECT_TRUE(folder.names().empty());
}

TEST(Workspace, KeepsTemporaryFilesWhereItIsTold) {
  const ScratchFolder folder, tmp;
  const std::string at = std::filesystem::path(tmp.file("x")).parent_path().string();
  Workspace workspace(FileLayer::system(), folder.file("a.ptin"), at, Unfinished::kRefuse, {});
  std::ofstream(workspace.temporary("file")) << "something";
  EXPECT_EQ(tmp.names().size(), 1U);
  workspace.remove_all();
  EXPECT_TRUE(tmp.names().empty());
  EXPECT_TRUE(folder.names().empty());
}

/// Neither option can know what is of it: all that they could remove is named by what is damaged.
TEST(Workspace, SaysThatItsManifestIsDamagedAndTouchesNothing) {
  const ScratchFolder folder;
  FileLayer& files = FileLayer::system();
  const std::string output = folder.file("a.ptin");
  const std::string manifest = Workspace::folder_of(output) + "/manifest";
  {
    Workspace workspace(files, output, "", Unfinished::kRefuse, {{"of", 1}});
    workspace.append({{{"work", 1}}});
    oracle::write_text(workspace.temporary("file"), "something");
  }
  const std::string sound = oracle::bytes_of(manifest);
  std::string damaged = sound;
  damaged[3] ^= 1;
  oracle::write_text(manifest, damaged);
  const auto expect_refused = [&](const std::function<void()>& work) {
    try {
      work();
      ADD_FAILURE() << "went on";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::corruption) << e.what();
      EXPECT_NE(e.message().find("remove this folder"), std::string::npos) << e.message();
    }
    EXPECT_EQ(oracle::bytes_of(manifest), damaged);
  };
  for (const Unfinished u : {Unfinished::kRefuse, Unfinished::kResume, Unfinished::kDiscard}) {
    expect_refused([&] { const Workspace again(files, output, "", u, {{"of", 1}}); });
  }
  expect_refused([&] { Workspace::discard(files, output); });
  oracle::write_text(manifest, sound + "torn");
  {
    Workspace workspace(files, output, "", Unfinished::kResume, {{"of", 1}});
    EXPECT_EQ(workspace.lines().size(), 1U);
    EXPECT_EQ(oracle::bytes_of(manifest), sound + "torn");
    workspace.append({{{"work", 2}}});
  }
  { EXPECT_EQ(Manifest(files, manifest).entries().size(), 3U); }
  EXPECT_TRUE(Workspace::discard(files, output));
}

TEST(Workspace, LeavesAFolderAloneThatIsNotOneOfOurs) {
  const ScratchFolder folder, tmp;
  FileLayer& files = FileLayer::system();
  const std::string output = folder.file("a.ptin");
  const std::string at = Workspace::folder_of(output);
  std::filesystem::create_directory(at);
  oracle::write_text(at + "/letters.txt", "dear");
  for (const Unfinished u : {Unfinished::kRefuse, Unfinished::kResume, Unfinished::kDiscard}) {
    EXPECT_THROW(Workspace(files, output, "", u, {{"of", 1}}), Error);
  }
  EXPECT_THROW(Workspace::discard(files, output), Error);
  EXPECT_EQ(oracle::bytes_of(at + "/letters.txt"), "dear");
  std::filesystem::remove_all(at);

  // A folder in --tmp of the right name.
  const std::string in = std::filesystem::path(tmp.file("x")).parent_path().string();
  {
    Workspace workspace(files, output, in, Unfinished::kRefuse, {{"of", 1}});
    workspace.remove_all();
  }
  std::string name;
  {
    Workspace workspace(files, output, in, Unfinished::kRefuse, {{"of", 1}});
    name = workspace.temporary_folder();
    workspace.remove_all();
  }
  std::filesystem::create_directory(name);
  oracle::write_text(name + "/letters.txt", "dear");
  EXPECT_THROW(Workspace(files, output, in, Unfinished::kRefuse, {{"of", 1}}), Error);
  EXPECT_EQ(oracle::bytes_of(name + "/letters.txt"), "dear");
  EXPECT_TRUE(folder.names().empty());
}

/// The system's files, until the process dies with one of the calls that change something.
class DyingFiles : public FileLayer {
 public:
  explicit DyingFiles(int calls) : left_(calls) {}
  int create(const std::string& path, int& fd) noexcept override {
    count();
    return FileLayer::create(path, fd);
  }
  int write_at(int fd, std::span<const std::byte> bytes, std::uint64_t offset,
               std::size_t& written) noexcept override {
    count();
    return FileLayer::write_at(fd, bytes, offset, written);
  }
  int sync(int fd) noexcept override {
    count();
    return FileLayer::sync(fd);
  }
  int unlink(const std::string& path) noexcept override {
    count();
    return FileLayer::unlink(path);
  }
  int make_folder(const std::string& path) noexcept override {
    count();
    return FileLayer::make_folder(path);
  }
  int sync_folder(const std::string& path) noexcept override {
    count();
    return FileLayer::sync_folder(path);
  }

 private:
  void count() noexcept {
    if (left_-- == 0) {
      ::_exit(7);
    }
  }
  int left_;
};

/// Begins a build in a process of its own that dies with its n-th call. False when it lived.
bool dies_beginning(const std::string& output, const std::string& tmp, int calls) {
  const pid_t child = ::fork();
  if (child == 0) {
    DyingFiles files(calls);
    const Workspace workspace(files, output, tmp, Unfinished::kRefuse, {{"of", 1}});
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 7;
}

TEST(Workspace, IsFoundWheneverItsProcessWasKilled) {
  const ScratchFolder folder, tmp;
  FileLayer& files = FileLayer::system();
  const std::string output = folder.file("a.ptin");
  const std::string in = std::filesystem::path(tmp.file("x")).parent_path().string();
  int calls = 0;
  for (; dies_beginning(output, in, calls); ++calls) {
    SCOPED_TRACE(calls);
    Workspace::discard(files, output);
    EXPECT_TRUE(folder.names().empty());
    EXPECT_TRUE(tmp.names().empty());
    ASSERT_TRUE(dies_beginning(output, in, calls));
    // A build that has not begun is begun, whatever it is asked; one that has is resumed.
    Workspace again(files, output, in, Unfinished::kResume, {{"of", 1}});
    EXPECT_EQ(tmp.names().size(), 1U);
    again.remove_all();
    EXPECT_TRUE(folder.names().empty());
    EXPECT_TRUE(tmp.names().empty());
  }
  EXPECT_GT(calls, 6);
  EXPECT_TRUE(Workspace::discard(files, output));
  EXPECT_TRUE(tmp.names().empty());
}

TEST(Workspace, TakesUpAndDiscardsOnlyAFolderThatIsItsOwn) {
  const ScratchFolder folder, tmp;
  FileLayer& files = FileLayer::system();
  const std::string output = folder.file("a.ptin");
  const std::string in = std::filesystem::path(tmp.file("x")).parent_path().string();
  std::string name;
  {
    Workspace workspace(files, output, in, Unfinished::kRefuse, {{"of", 1}});
    name = workspace.temporary_folder();
    workspace.append({{{"work", 1}}});
  }
  const std::string owner = oracle::bytes_of(name + "/owner");
  oracle::write_text(name + "/owner", "/of/somebody/else");
  oracle::write_text(name + "/letters.txt", "dear");
  EXPECT_THROW(Workspace(files, output, in, Unfinished::kResume, {{"of", 1}}), Error);
  EXPECT_THROW(Workspace::discard(files, output), Error);
  EXPECT_EQ(oracle::bytes_of(name + "/letters.txt"), "dear");
  oracle::write_text(name + "/owner", owner);
  { const Workspace workspace(files, output, in, Unfinished::kResume, {{"of", 1}}); }
  EXPECT_TRUE(Workspace::discard(files, output));
  EXPECT_TRUE(tmp.names().empty());
}

/// The output is named from its folder first, then from the root, and then from another folder.
TEST(Workspace, IsTakenUpHoweverItsOutputIsNamed) {
  namespace fs = std::filesystem;
  FileLayer& files = FileLayer::system();
  const fs::path before = fs::current_path();
  for (const bool is_moved : {false, true}) {
    const ScratchFolder folder, other;
    const fs::path home = fs::path(folder.file("a.ptin")).parent_path();
    fs::current_path(home);
    {
      Workspace workspace(files, "a.ptin", "", Unfinished::kRefuse, {{"of", 1}});
      workspace.append({{{"work", 1}}});
    }
    fs::path now = home;
    if (is_moved) {
      now = fs::path(other.file("moved"));
      fs::rename(home, now);
      fs::create_directory(home);
    }
    fs::current_path("/");
    const std::string whole = (now / "a.ptin").string();
    {
      const Workspace workspace(files, whole, "", Unfinished::kResume, {{"of", 1}});
      EXPECT_EQ(workspace.lines().size(), 1U);
    }
    fs::current_path(now.parent_path());
    EXPECT_TRUE(Workspace::discard(files, now.filename().string() + "/a.ptin"));
    EXPECT_TRUE(fs::is_empty(now));
    fs::current_path(before);
  }
}

TEST(ArrayFile, SaysThatItWasCutShortWhileItWasRead) {
  install_sigbus_guard();
  const ScratchFolder folder;
  const std::string path = folder.file("array");
  const std::vector<std::uint64_t> numbers(10000, 7);
  ArrayFileFacts facts;
  {
    ArrayFileWriter file(FileLayer::system(), path);
    file.put(numbers);
    facts = file.finish();
  }
  ArrayFileReader file(path, facts);
  const auto span = file.take<std::uint64_t>();
  EXPECT_NO_THROW(file.require_undamaged());
  std::filesystem::resize_file(path, 4096);
  EXPECT_NE(span[9999], 7U);  // a hole, not a crash
  EXPECT_THROW(file.require_undamaged(), Error);
}

TEST(Manifest, BelievesLinesUpToTheFirstThatIsNotWhole) {
  const ScratchFolder folder;
  const std::string path = folder.file("manifest");
  {
    Manifest manifest(FileLayer::system(), path);
    manifest.append({{{"a", 1}}, {{"b", 2}}});
    manifest.append({{{"c", 3}}});
  }
  const std::string whole = oracle::bytes_of(path);
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    oracle::write_text(path, whole.substr(0, length));
    const Manifest manifest(FileLayer::system(), path);
    const bool has_first = length > whole.find('\n');
    EXPECT_EQ(manifest.entries().size(), length == whole.size() ? 3U : has_first ? 2U : 0U);
  }
  std::string damaged = whole;
  damaged[whole.find("\"c\":3") + 4] = '9';
  oracle::write_text(path, damaged);
  EXPECT_EQ(Manifest(FileLayer::system(), path).entries().size(), 2U);
}

}  // namespace
}  // namespace ptin
