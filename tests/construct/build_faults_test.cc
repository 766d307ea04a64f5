// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds whose caller throws, and whose files cannot be looked at.
#include <cstdint>
#include <filesystem>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/scratch/workspace.h"
#include "tests/construct/resume_fixture.h"
#include "tests/construct/told_build.h"

namespace ptin {
namespace {

using test::InterruptibleBuild;
using test::SourceKind;

/// What comes of a build whose caller's progress throws in this stage.
template <class Exception>
std::optional<Error> error_of_throwing_in(const std::string& stage, const InterruptibleBuild& of,
                                          const Exception& exception) {
  BuildResources resources = InterruptibleBuild::resources();
  int calls = 0;
  oracle::ToldBuild told;
  resources.observer = &told;
  told.on_stage = [&](const char* name, std::uint64_t, std::uint64_t) {
    if (name == stage && ++calls == 2) {
      throw exception;
    }
  };
  try {
    build({of.input()}, of.output(), of.options(), resources);
  } catch (const Error& e) {
    return e;
  } catch (const std::exception& e) {
    ADD_FAILURE() << "not an Error: " << e.what();
  }
  return std::nullopt;
}

TEST(Build, KeepsWhatIsDoneWhateverIsThrown) {
  const auto expect_kept = [](ErrorCode code, const std::string& words, const auto& exception) {
    const InterruptibleBuild interrupted(SourceKind::kPoints);
    const auto error = error_of_throwing_in("collapsing", interrupted, exception);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), code);
    EXPECT_NE(error->message().find(words), std::string::npos) << error->message();
    EXPECT_NE(error->message().find("--resume"), std::string::npos) << error->message();
    interrupted.expect_resumed_to_the_same_bytes();
  };
  expect_kept(ErrorCode::resource_exhausted, "memory", std::bad_alloc());
  expect_kept(ErrorCode::io_error, "Read-only",
              std::filesystem::filesystem_error(
                  "rename", "/there", std::make_error_code(std::errc::read_only_file_system)));
  expect_kept(ErrorCode::internal, "no such luck", std::runtime_error("no such luck"));
}

TEST(Build, LeavesNothingWhereNothingIsDoneWhateverIsThrown) {
  const InterruptibleBuild interrupted(SourceKind::kTin);
  const auto error = error_of_throwing_in("sorting", interrupted, std::runtime_error("no luck"));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::internal);
  EXPECT_EQ(error->message().find("--resume"), std::string::npos) << error->message();
  EXPECT_EQ(interrupted.folder().names(), std::vector<std::string>{});
}

/// Names that no file can have, and links that lead nowhere, are errors of the system.
TEST(Build, SaysThatTheNameOfTheOutputCannotBe) {
  const InterruptibleBuild of;
  for (const Unfinished unfinished :
       {Unfinished::kRefuse, Unfinished::kResume, Unfinished::kDiscard}) {
    BuildResources resources = InterruptibleBuild::resources();
    resources.unfinished = unfinished;
    try {
      build({of.input()}, of.folder().file(std::string(300, 'a')), of.options(), resources);
      ADD_FAILURE() << "built";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::io_error) << e.what();
    }
    EXPECT_EQ(of.folder().names(), std::vector<std::string>{});
  }
}

TEST(Workspace, SaysThatItsManifestCannotBeLookedAt) {
  const InterruptibleBuild of;
  const std::string folder = Workspace::folder_of(of.output());
  std::filesystem::create_directory(folder);
  std::filesystem::create_symlink("manifest", folder + "/manifest");  // round and round
  for (const Unfinished unfinished :
       {Unfinished::kRefuse, Unfinished::kResume, Unfinished::kDiscard}) {
    BuildResources resources = InterruptibleBuild::resources();
    resources.unfinished = unfinished;
    EXPECT_EQ(of.run(resources), ErrorCode::io_error);
  }
}

TEST(Build, OfATinReportsSortingToItsEnd) {
  const InterruptibleBuild of(SourceKind::kTin);
  BuildResources resources = InterruptibleBuild::resources();
  std::pair<std::uint64_t, std::uint64_t> last{0, 1};
  oracle::ToldBuild told;
  resources.observer = &told;
  told.on_stage = [&](const std::string& stage, std::uint64_t done, std::uint64_t total) {
    last = stage == "sorting" ? std::pair(done, total) : last;
  };
  EXPECT_EQ(of.run(resources), std::nullopt);
  EXPECT_EQ(last.first, last.second);
}

}  // namespace
}  // namespace ptin
