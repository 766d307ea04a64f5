// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds that are interrupted: whenever that happens, the output is absent, and a resumed build
// gives the bytes of one that was not.
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/construct/manifest.h"
#include "engine/construct/workspace.h"
#include "tests/construct/hierarchy_fixture.h"
#include "tests/construct/resume_fixture.h"

namespace ptin {
namespace {

using oracle::ScratchFolder;
using test::InterruptibleBuild;

TEST(Resume, GivesTheSameBytesWhereverTheBuildWasStopped) {
  for (int stop_at = 1; stop_at < 60; stop_at += 4) {
    SCOPED_TRACE(stop_at);
    const InterruptibleBuild interrupted;
    std::stop_source source;
    BuildResources resources = InterruptibleBuild::resources();
    resources.stop = source.get_token();
    resources.threads = 1 + stop_at % 3;
    int calls = 0;
    resources.progress = [&](const char* stage, std::uint64_t, std::uint64_t) {
      if (std::string(stage) != "reading" && ++calls == stop_at) {
        source.request_stop();
      }
    };
    if (const auto code = interrupted.run(resources)) {
      EXPECT_EQ(*code, ErrorCode::cancelled);
      EXPECT_EQ(interrupted.folder().names(), std::vector<std::string>{".out.ptin.ptin-build"});
    }
    interrupted.expect_resumed_to_the_same_bytes();
  }
}

TEST(Resume, GivesTheSameBytesAfterSomeFailedCalls) {
  for (const int nth : {3, 31, 80, 201, 333}) {
    SCOPED_TRACE(nth);
    const InterruptibleBuild interrupted;
    test::FailingFiles files(nth);
    BuildResources resources = InterruptibleBuild::resources();
    resources.files = &files;
    EXPECT_NE(interrupted.run(resources), std::nullopt);
    interrupted.expect_resumed_to_the_same_bytes();
  }
}

TEST(Resume, IsOfferedAndRefusedAsItShould) {
  const InterruptibleBuild interrupted;
  test::FailingFiles files(250);
  BuildResources resources = InterruptibleBuild::resources();
  resources.files = &files;
  const auto code = interrupted.run(resources);
  EXPECT_TRUE(code == ErrorCode::resource_exhausted || code == ErrorCode::io_error);
  resources.files = nullptr;
  EXPECT_EQ(interrupted.run(resources), ErrorCode::invalid_argument) << "neither option was given";

  resources.unfinished = Unfinished::kDiscard;
  EXPECT_EQ(interrupted.run(resources), std::nullopt);
  EXPECT_EQ(interrupted.folder().names(), std::vector<std::string>{"out.ptin"});
}

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
