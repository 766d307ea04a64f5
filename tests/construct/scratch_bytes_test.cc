// SPDX-License-Identifier: GPL-3.0-or-later
//
// Temporary files of builds of one source are the same bytes, whoever wrote them.
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <malloc.h>

#include "engine/construct/build.h"
#include "engine/construct/build_parts.h"
#include "engine/construct/scratch/plain_value.h"
#include "storage/file/file_layer.h"
#include "storage/star.h"
#include "tests/construct/resume_fixture.h"

namespace ptin {
namespace {

using test::InterruptibleBuild;
using test::SourceKind;

/// What files held when they were removed, by their names without the folder.
using Removed = std::map<std::string, std::set<std::string>>;

/// The system's files; keeps what is removed.
class KeepsRemoved final : public FileLayer {
 public:
  int unlink(const std::string& path) noexcept override {
    if (std::filesystem::exists(path)) {
      const std::lock_guard lock(mutex_);
      removed_[std::filesystem::path(path).filename()].insert(oracle::bytes_of(path));
    }
    return FileLayer::unlink(path);
  }
  /// Of tasks and of sorting. Without the manifest and what says whose a folder is: these tell when
  /// something was done, and where.
  [[nodiscard]] Removed of_tasks() const {
    Removed files = removed_;
    std::erase_if(files, [](const auto& file) {
      return file.first.starts_with("manifest") || file.first.starts_with("owner") ||
             file.first.starts_with("part");
    });
    return files;
  }

 private:
  std::mutex mutex_;
  Removed removed_;
};

/// Memory that is not written to holds this byte from now on, so that files with bytes that mean
/// nothing are others.
class Rubbish {
 public:
  explicit Rubbish(int byte) { ::mallopt(M_PERTURB, byte); }
  ~Rubbish() { ::mallopt(M_PERTURB, 0); }
};

Removed removed_by_build(const InterruptibleBuild& of, int threads) {
  KeepsRemoved files;
  BuildResources resources = InterruptibleBuild::resources();
  resources.threads = threads;
  resources.files = &files;
  resources.overwrite = true;
  EXPECT_EQ(of.run(resources), std::nullopt);
  return files.of_tasks();
}

Removed removed_by_parts(const InterruptibleBuild& of, int parts) {
  KeepsRemoved files;
  BuildResources resources = InterruptibleBuild::resources();
  resources.files = &files;
  resources.overwrite = true;
  const std::vector<std::string> inputs{of.input()};
  const std::string note = begin_parts(inputs, of.output(), of.options(), resources).note;
  for (const PartsPhase phase : {PartsPhase::kCollapse, PartsPhase::kJoin, PartsPhase::kTighten}) {
    for (int part = 0; part < (phase == PartsPhase::kJoin ? 1 : parts); ++part) {
      do_part(inputs, of.options(), resources, note, phase, part, parts);
    }
  }
  publish_parts(inputs, of.output(), of.options(), resources, parts);
  return files.of_tasks();
}

void expect_same(const Removed& files, const Removed& expected) {
  for (const auto& [name, contents] : expected) {
    ASSERT_TRUE(files.contains(name)) << name;
    EXPECT_EQ(contents.size(), 1U) << name;
    EXPECT_TRUE(files.at(name) == contents) << name << " has other bytes";
  }
  EXPECT_EQ(files.size(), expected.size());
}

class ScratchBytes : public testing::TestWithParam<SourceKind> {};

TEST_P(ScratchBytes, AreTheSameWhoeverDoesTheTasks) {
  const InterruptibleBuild of(GetParam());
  Removed expected;
  {
    const Rubbish rubbish(0x5a);
    expected = removed_by_build(of, 1);
  }
  EXPECT_GT(expected.size(), 20U);
  const Rubbish other(0xa5);
  for (const int threads : {1, 2}) {
    SCOPED_TRACE(std::to_string(threads) + " threads");
    expect_same(removed_by_build(of, threads), expected);
  }
  SCOPED_TRACE("in parts");
  expect_same(removed_by_parts(of, 3), expected);
}

std::string name_of(const testing::TestParamInfo<SourceKind>& kind) {
  static constexpr const char* kNames[] = {"Raster", "Points", "Lines", "Tin"};
  return kNames[static_cast<int>(kind.param)];
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, ScratchBytes,
                         testing::Values(SourceKind::kRaster, SourceKind::kPoints,
                                         SourceKind::kLines, SourceKind::kTin),
                         name_of);

struct WithPadding {
  float a;
  std::uint8_t b;
};
static_assert(!PlainValue<WithPadding>);
static_assert(!PlainValue<std::string>);
static_assert(PlainValue<RingCorner>);

}  // namespace
}  // namespace ptin
