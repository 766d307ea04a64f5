// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds that are interrupted: whenever that happens, the output is absent, and a resumed build
// gives the bytes of one that was not.
#include <cerrno>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/construct/scratch/workspace.h"
#include "tests/construct/hierarchy_fixture.h"
#include "tests/construct/memory_file.h"
#include "tests/construct/resume_fixture.h"
#include "tests/construct/tile_tasks/damaging_driver.h"
#include "tests/construct/told_build.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::ScratchFolder;
using test::InterruptibleBuild;

using test::damage;
using test::Damage;
using test::SourceKind;

class Resumed : public testing::TestWithParam<SourceKind> {};

TEST_P(Resumed, GivesTheSameBytesWhereverTheBuildWasStopped) {
  std::vector<int> stops;
  for (int stop_at = 1; stop_at < 60; stop_at += 4) {
    stops.push_back(stop_at);
  }
  bool has_kept_work = false;
  for (const int stop_at : test::some_of(stops, 4)) {
    SCOPED_TRACE(stop_at);
    const InterruptibleBuild interrupted(GetParam());
    std::stop_source source;
    BuildResources resources = InterruptibleBuild::resources();
    resources.stop = source.get_token();
    resources.threads = 1 + stop_at % 3;
    int calls = 0;
    oracle::ToldBuild told;
    resources.observer = &told;
    told.on_stage = [&](const char* stage, std::uint64_t, std::uint64_t) {
      const bool counts = GetParam() != SourceKind::kRaster || std::string(stage) != "reading";
      if (counts && ++calls == stop_at) {
        source.request_stop();
      }
    };
    if (const auto code = interrupted.run(resources)) {
      EXPECT_EQ(*code, ErrorCode::cancelled);
      std::vector<std::string> names = interrupted.folder().names();
      has_kept_work = has_kept_work || !names.empty();
      std::erase(names, ".out.ptin.ptin-build");  // kept only with work in it
      EXPECT_EQ(names, std::vector<std::string>{});
    }
    interrupted.expect_resumed_to_the_same_bytes();
  }
  EXPECT_TRUE(has_kept_work);
}

TEST_P(Resumed, GivesTheSameBytesAfterSomeFailedCalls) {
  for (const int nth : test::some_of({3, 8, 13, 31, 80, 201, 250})) {
    SCOPED_TRACE(nth);
    const InterruptibleBuild interrupted(GetParam());
    test::FailingFiles files(nth);
    BuildResources resources = InterruptibleBuild::resources();
    resources.files = &files;
    EXPECT_NE(interrupted.run(resources), std::nullopt);
    interrupted.expect_resumed_to_the_same_bytes();
  }
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, Resumed,
                         testing::Values(SourceKind::kRaster, SourceKind::kPoints,
                                         SourceKind::kLines),
                         [](const auto& kind) {
                           return kind.param == SourceKind::kRaster   ? "Raster"
                                  : kind.param == SourceKind::kPoints ? "Points"
                                                                      : "Lines";
                         });

/// Stops a build when it reports this stage for the second time.
void stop_in(const InterruptibleBuild& interrupted, const std::string& stage) {
  std::stop_source source;
  BuildResources resources = InterruptibleBuild::resources();
  resources.stop = source.get_token();
  int calls = 0;
  oracle::ToldBuild told;
  resources.observer = &told;
  told.on_stage = [&](const char* name, std::uint64_t, std::uint64_t) {
    if (name == stage && ++calls == 2) {
      source.request_stop();
    }
  };
  ASSERT_EQ(interrupted.run(resources), ErrorCode::cancelled);
}

class NoRename final : public FileLayer {
 public:
  int rename(const std::string&, const std::string&, bool) noexcept override { return EIO; }
};

/// Builds by files that fail somewhere.
void fail_by(FileLayer& files, const InterruptibleBuild& interrupted) {
  BuildResources resources = InterruptibleBuild::resources();
  resources.files = &files;
  EXPECT_EQ(interrupted.run(resources), ErrorCode::io_error);
}

BuildResources resuming() {
  BuildResources resources = InterruptibleBuild::resources();
  resources.unfinished = Unfinished::kResume;
  resources.overwrite = true;
  return resources;
}

TEST(Resume, ReadsPointsAndTrianglesNoMoreOnceTheyAreSorted) {
  for (const SourceKind kind : {SourceKind::kPoints, SourceKind::kTin}) {
    const InterruptibleBuild interrupted(kind);
    stop_in(interrupted, "collapsing");
    BuildResources resources = resuming();
    std::map<std::string, int> stages;
    oracle::ToldBuild told;
    resources.observer = &told;
    told.on_stage = [&](const char* name, std::uint64_t, std::uint64_t) { ++stages[name]; };
    EXPECT_EQ(interrupted.run(resources), std::nullopt);
    EXPECT_EQ(stages["reading"], 0);
    EXPECT_EQ(stages["sorting"], 0);
    interrupted.expect_resumed_to_the_same_bytes();
  }
}

/// The error of a build that goes on with this one; "" where it ends well.
std::string told_of_resuming(const InterruptibleBuild& interrupted) {
  try {
    build({interrupted.input()}, interrupted.output(), interrupted.options(), resuming());
    return {};
  } catch (const Error& e) {
    EXPECT_TRUE(e.code() == ErrorCode::corruption || e.code() == ErrorCode::not_found) << e.what();
    return e.message();
  }
}

/// Damage that is seen when a build goes on is mended at once; a changed bucket is met later.
TEST(Resume, SortsPointsAndTrianglesAgainThatAreDamagedOrGone) {
  std::vector<std::pair<std::string, Damage>> cases;
  std::size_t number = 0;  // Each file is damaged in another way.
  for (const char* name :
       {"points-0", "points.index", "tin.surface", "tin.voids", "tin.places", "tin.index"}) {
    for (const Damage how :
         test::some_of({Damage::kFlipped, Damage::kCut, Damage::kRemoved}, 3, number++)) {
      cases.emplace_back(name, how);
    }
  }
  for (const auto& [name, how] : cases) {
    SCOPED_TRACE(name + " " + std::to_string(static_cast<int>(how)));
    const InterruptibleBuild interrupted(name.starts_with("tin") ? SourceKind::kTin
                                                                 : SourceKind::kPoints);
    stop_in(interrupted, "collapsing");
    damage(interrupted.folder().file(".out.ptin.ptin-build/") + name, how);
    const std::string told = told_of_resuming(interrupted);
    EXPECT_EQ(told.empty(), how != Damage::kFlipped || name.ends_with("index")) << told;
    EXPECT_EQ(told.empty(), told.find("go on by --resume, which reads") == std::string::npos);
    EXPECT_EQ(told.find("start again"), std::string::npos) << "two advices: " << told;
    interrupted.expect_resumed_to_the_same_bytes();
  }
}

/// A source of which nothing but the content tells that it is another one.
TEST(Resume, SaysThatASourceThatIsSortedAgainIsAnotherOne) {
  const InterruptibleBuild interrupted(SourceKind::kPoints);
  stop_in(interrupted, "collapsing");
  damage(interrupted.folder().file(".out.ptin.ptin-build/points.index"), Damage::kRemoved);
  const auto time = std::filesystem::last_write_time(interrupted.input());
  std::string text = oracle::bytes_of(interrupted.input());
  const std::size_t digit = text.find_last_of("0123456789");
  text[digit] = text[digit] == '1' ? '2' : '1';
  oracle::write_text(interrupted.input(), text);
  std::filesystem::last_write_time(interrupted.input(), time);
  const std::string told = told_of_resuming(interrupted);
  EXPECT_NE(told.find("reads otherwise"), std::string::npos) << told;
  EXPECT_NE(told.find("start again after --discard"), std::string::npos) << told;
}

/// Pages are of work whose files are gone by then.
TEST(Resume, SaysThatPagesThatAreDamagedCannotBeGoneOnWith) {
  const InterruptibleBuild interrupted;
  NoRename files;
  fail_by(files, interrupted);
  const std::string pages = interrupted.folder().file(".out.ptin.ptin-build/pages");
  std::string bytes = oracle::bytes_of(pages);
  for (std::size_t i = 0; i < bytes.size(); i += 512) {
    bytes[i] ^= 1;
  }
  oracle::write_text(pages, bytes);
  const std::string told = told_of_resuming(interrupted);
  EXPECT_NE(told.find("start again after --discard"), std::string::npos) << told;
  EXPECT_EQ(told.find("--resume"), std::string::npos) << "two advices: " << told;
}

TEST(Resume, RefusesAnInputThatHasChanged) {
  const InterruptibleBuild interrupted(SourceKind::kPoints);
  stop_in(interrupted, "collapsing");
  const std::string text = oracle::bytes_of(interrupted.input());
  oracle::write_text(interrupted.input(), text + "5000 5000 1\n");
  EXPECT_EQ(interrupted.run(resuming()), ErrorCode::invalid_argument);
}

/// Builds, makes the input another file once it is being read, and stops later on.
void change_while_reading(const std::string& input, const std::string& output,
                          const BuildOptions& options) {
  std::stop_source source;
  BuildResources resources = InterruptibleBuild::resources();
  resources.stop = source.get_token();
  bool has_changed = false;
  int calls = 0;
  oracle::ToldBuild told;
  resources.observer = &told;
  told.on_stage = [&](const char* name, std::uint64_t, std::uint64_t) {
    if (!has_changed) {
      has_changed = true;
      std::filesystem::last_write_time(
          input, std::filesystem::last_write_time(input) - std::chrono::hours(1));
    }
    if (std::string(name) == "tightening" && ++calls == 1) {  // some work is noted by then
      source.request_stop();
    }
  };
  EXPECT_THROW(build({input}, output, options, resources), Error);
  ASSERT_TRUE(std::filesystem::exists(Workspace::folder_of(output)));
}

void expect_resume_refused(const std::string& input, const std::string& output,
                           const BuildOptions& options) {
  try {
    build({input}, output, options, resuming());
    ADD_FAILURE() << "went on";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
  }
}

/// A raster of 33 x 33 samples, as a file.
std::string written_raster(const ScratchFolder& folder) {
  std::string text = "ncols 33\nnrows 33\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
  for (int i = 0; i < 33 * 33; ++i) {
    text += std::to_string(i * i % 13) + (i % 33 == 32 ? "\n" : " ");
  }
  oracle::write_text(folder.file("in.asc"), text);
  return folder.file("in.asc");
}

BuildOptions in_small_tiles() {
  BuildOptions options;
  options.tile = 8;
  return options;
}

TEST(Resume, RefusesARasterThatWasReplacedWhileItWasRead) {
  const ScratchFolder folder;
  const std::string input = written_raster(folder), output = folder.file("out.ptin");
  change_while_reading(input, output, in_small_tiles());
  expect_resume_refused(input, output, in_small_tiles());
}

/// Builds to the end, and makes the input another file when the last tiles are in work.
void expect_not_published(const std::string& input, const std::string& output,
                          const BuildOptions& options) {
  BuildResources resources = InterruptibleBuild::resources();
  oracle::ToldBuild told;
  resources.observer = &told;
  bool has_changed = false;
  told.on_stage = [&](const char* name, std::uint64_t, std::uint64_t) {
    if (std::string(name) == "tightening" && !std::exchange(has_changed, true)) {
      std::filesystem::last_write_time(
          input, std::filesystem::last_write_time(input) - std::chrono::hours(1));
    }
  };
  try {
    build({input}, output, options, resources);
    ADD_FAILURE() << "published";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument) << e.what();
    EXPECT_EQ(e.context(), input);
    EXPECT_NE(e.message().find("this file changed"), std::string::npos) << e.what();
    EXPECT_NE(e.message().find("start again after --discard"), std::string::npos) << e.what();
  }
  EXPECT_FALSE(std::filesystem::exists(output));
}

TEST(Build, OfAnInputThatChangesMeanwhileIsNotPublished) {
  const ScratchFolder folder;
  expect_not_published(written_raster(folder), folder.file("out.ptin"), in_small_tiles());
  for (const SourceKind kind : {SourceKind::kPoints, SourceKind::kTin}) {
    const InterruptibleBuild changing(kind);
    expect_not_published(changing.input(), changing.output(), changing.options());
  }
}

/// A look at a raster with another program may leave its statistics there: hours of work are not lost.
TEST(Build, OfAnInputWithANewFileBesideItGoesOnWhenThatIsGone) {
  const ScratchFolder folder;
  const std::string input = written_raster(folder), output = folder.file("out.ptin");
  const std::string statistics = input + ".aux.xml";
  BuildResources resources = InterruptibleBuild::resources();
  oracle::ToldBuild told;
  resources.observer = &told;
  told.on_stage = [&](const char* name, std::uint64_t, std::uint64_t) {
    if (std::string(name) == "tightening") {
      oracle::write_text(statistics, "<PAMDataset></PAMDataset>");
    }
  };
  try {
    build({input}, output, in_small_tiles(), resources);
    ADD_FAILURE() << "published";
  } catch (const Error& e) {
    EXPECT_EQ(e.context(), statistics);
    EXPECT_NE(e.message().find("go on by --resume"), std::string::npos) << e.what();
  }
  std::filesystem::remove(statistics);
  build({input}, output, in_small_tiles(), resuming());
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"in.asc", "out.ptin"}));
}

/// A grid of 24 x 24 vertices as a TIN.
std::string grid_tin() {
  std::string text;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      text += "v " + std::to_string(x) + " " + std::to_string(y) + " " +
              std::to_string((x * x + 7 * y) % 13) + "\n";
    }
  }
  const auto face = [&](int a, int b, int c) {
    text += "f " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  };
  for (int v = 1; v <= 23 * 24; ++v) {
    if (v % 24 != 0) {
      face(v, v + 1, v + 25);
      face(v, v + 25, v + 24);
    }
  }
  return text;
}

TEST(Resume, RefusesATinThatWasReplacedWhileItWasRead) {
  const ScratchFolder folder;
  const std::string input = folder.file("in.obj"), output = folder.file("out.ptin");
  oracle::write_text(input, grid_tin());
  BuildOptions options;
  options.tile = 8;
  change_while_reading(input, output, options);
  expect_resume_refused(input, output, options);
}

TEST(Build, OfATinSaysBeforeItReadsThatAnUnfinishedOneIsThere) {
  const ScratchFolder folder;
  const std::string input = folder.file("in.obj"), output = folder.file("out.ptin");
  oracle::write_text(input, grid_tin());
  BuildOptions options;
  options.tile = 8;
  change_while_reading(input, output, options);
  BuildResources resources;
  int calls = 0;
  oracle::ToldBuild told;
  resources.observer = &told;
  told.on_stage = [&](const char*, std::uint64_t, std::uint64_t) { ++calls; };
  EXPECT_THROW(build({input}, output, options, resources), Error);
  EXPECT_EQ(calls, 0);
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

/// Rename without replacing by two steps, of which the second does not happen.
class KilledBetweenLinkAndUnlink final : public FileLayer {
 public:
  int rename(const std::string& from, const std::string& to, bool) noexcept override {
    return ::link(from.c_str(), to.c_str()) == 0 ? EIO : errno;
  }
};

class NothingIsWritten final : public FileLayer {
 public:
  int write_at(int, std::span<const std::byte>, std::uint64_t, std::size_t&) noexcept override {
    return ENOSPC;
  }
};

TEST(Resume, SeesThatTheOutputIsPublishedThoughItsPagesHaveTheirNameStill) {
  const InterruptibleBuild interrupted;
  KilledBetweenLinkAndUnlink files;
  fail_by(files, interrupted);
  const std::string published = oracle::bytes_of(interrupted.output());
  NothingIsWritten untouched;  // the pages are the output: who writes them damages it
  BuildResources resources = resuming();
  resources.files = &untouched;
  EXPECT_EQ(interrupted.run(resources), std::nullopt);
  EXPECT_TRUE(oracle::bytes_of(interrupted.output()) == published);
  EXPECT_EQ(interrupted.folder().names(), std::vector<std::string>{"out.ptin"});
}

/// Killed while it removed what it needed no more.
TEST(Resume, OfACompleteOutputWantsNoSource) {
  for (const SourceKind kind : {SourceKind::kPoints, SourceKind::kTin}) {
    const InterruptibleBuild interrupted(kind);
    KilledBetweenLinkAndUnlink files;
    fail_by(files, interrupted);
    for (const std::string name : {"pages", "points-0", "tin.surface"}) {
      std::filesystem::remove(interrupted.folder().file(".out.ptin.ptin-build/" + name));
    }
    const BuildReport report =
        build({interrupted.input()}, interrupted.output(), interrupted.options(), resuming());
    EXPECT_GT(report.source_samples, 1000U);
    EXPECT_EQ(report.vertices, report.records + report.t0_vertices);
    interrupted.expect_resumed_to_the_same_bytes();
  }
}

TEST(Resume, TakesNoOlderOutputForTheNewOne) {
  const InterruptibleBuild interrupted;
  BuildOptions coarser = interrupted.options();
  coarser.max_error = 5.0;
  build({interrupted.input()}, interrupted.output(), coarser, {});
  const std::string older = oracle::bytes_of(interrupted.output());
  NoRename files;
  BuildResources resources = InterruptibleBuild::resources();
  resources.files = &files;
  resources.overwrite = true;
  EXPECT_EQ(interrupted.run(resources), ErrorCode::io_error);
  // As --discard leaves it when it is killed: the manifest goes last.
  std::filesystem::remove(interrupted.folder().file(".out.ptin.ptin-build/pages"));
  EXPECT_NE(interrupted.run(resuming()), std::nullopt) << "the pages are gone";
  EXPECT_TRUE(oracle::bytes_of(interrupted.output()) == older);
}

class NoFolderIsRemoved final : public FileLayer {
 public:
  int remove_folder(const std::string&) noexcept override { return EBUSY; }
};

TEST(Build, IsDoneThoughItsFolderCannotBeRemovedAndSaysSo) {
  const InterruptibleBuild build_it;
  NoFolderIsRemoved files;
  BuildResources resources = InterruptibleBuild::resources();
  resources.files = &files;
  const BuildReport report =
      build({build_it.input()}, build_it.output(), build_it.options(), resources);
  EXPECT_NE(report.left_behind.find(".out.ptin.ptin-build"), std::string::npos)
      << report.left_behind;
  EXPECT_TRUE(std::filesystem::exists(build_it.output()));
}

TEST(Build, SaysWhatWentWrongThoughItsFolderCannotBeRemoved) {
  const ScratchFolder folder;
  const std::string input = folder.file("in.obj");
  oracle::write_text(input, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  NoFolderIsRemoved files;
  BuildResources resources;
  resources.files = &files;
  try {
    build({input}, folder.file("out.ptin"), {}, resources);
    ADD_FAILURE() << "built";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_NE(e.message().find("which is not there; and "), std::string::npos) << e.message();
    EXPECT_NE(e.message().find(".out.ptin.ptin-build"), std::string::npos) << e.message();
    EXPECT_EQ(e.context(), input);
  }
}

/// What begins a build anew leaves nothing to go on with.
TEST(Build, OfATinThatIsRefusedLeavesNoFolder) {
  const ScratchFolder folder;
  const std::string input = folder.file("in.obj");
  oracle::write_text(input, grid_tin());
  BuildResources resources;
  std::stop_source source;
  source.request_stop();
  resources.stop = source.get_token();
  EXPECT_THROW(build({input}, folder.file("out.ptin"), {}, resources), Error);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"in.obj"});
}

/// Nothing is there to go on with before a source is sorted, whatever went wrong.
TEST(Build, OfASourceThatCannotBeReadToItsEndLeavesNoFolder) {
  const ScratchFolder folder;
  const std::string input = folder.file("in.xyz.gz");
  const std::string text =
      packed(oracle::bytes_of(InterruptibleBuild(SourceKind::kPoints).input()));
  oracle::write_text(input, text.substr(0, text.size() - 20));
  for (const bool tmp : {false, true}) {
    const ScratchFolder other;
    BuildResources resources;
    resources.tmp = tmp ? other.path() : "";
    try {
      build({input}, folder.file("out.ptin"), {}, resources);
      ADD_FAILURE() << "built";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::io_error) << e.what();
      EXPECT_EQ(e.message().find("--resume"), std::string::npos) << e.message();
    }
    EXPECT_EQ(folder.names(), std::vector<std::string>{"in.xyz.gz"});
    EXPECT_TRUE(other.names().empty());
  }
}

}  // namespace
}  // namespace ptin
