// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds whose temporary files are damaged between tasks: what wrote them is done again, and the
// output has the same bytes.
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "tests/construct/hierarchy_fixture.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/tile_tasks/damaging_driver.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using test::Damage;
using test::DamagingDriver;

/// Hills of 8 x 8 leaves: batches, four tiles of level 2, the root.
class SmallRaster {
 public:
  SmallRaster() : raster_(recipe()) {
    options_.tile = 8;
    const oracle::ScratchFolder folder;
    build({raster_.path()}, folder.file("a.ptin"), options_, {});
    expected_ = oracle::bytes_of(folder.file("a.ptin"));
  }
  /// Builds with this driver, and removes superfluous files as early as it can or as late.
  /// @return  What the build threw; none when it gave the bytes of an undisturbed one.
  [[nodiscard]] std::optional<Error> run(DamagingDriver& driver, bool early) {
    const oracle::ScratchFolder folder;
    test::UnsyncedFiles files;
    BuildResources resources;
    resources.files = &files;
    resources.driver = &driver;
    resources.checkpoint_interval = std::chrono::milliseconds(early ? 0 : 1000000);
    try {
      build({raster_.path()}, folder.file("a.ptin"), options_, resources);
    } catch (const Error& e) {
      return e;
    }
    EXPECT_TRUE(oracle::bytes_of(folder.file("a.ptin")) == expected_);
    return std::nullopt;
  }

 private:
  static oracle::RasterFile recipe() {
    oracle::RasterFile file;
    file.columns = file.rows = 65;
    file.value = [](int x, int y) {
      return 300.0 + 40.0 * std::sin(0.2 * x) * std::cos(0.13 * y) + (x * 7 + y * 5) % 11;
    };
    return file;
  }

  oracle::WrittenRaster raster_;
  BuildOptions options_;
  std::string expected_;
};

SmallRaster& small_raster() {
  static SmallRaster raster;
  return raster;
}

/// The first input of this kind that a task reads; descriptions are read when pages were placed.
std::optional<TileId> tile_read_by(const Task& task, TileFile file) {
  if (task.name.kind == TaskKind::kPlace && file == TileFile::kDescriptions) {
    return task.name.tile;
  }
  for (const InputFile& input : task.inputs) {
    if (input.file == file) {
      return input.tile;
    }
  }
  return std::nullopt;
}

/// Which file, how it is damaged, and whether the reader is of a tile above level 1.
using DamageCase = std::tuple<TileFile, Damage, bool>;
class DamagedTaskFile : public testing::TestWithParam<DamageCase> {};

TEST_P(DamagedTaskFile, IsWrittenAnewByItsTask) {
  const auto [file, how, is_above] = GetParam();
  for (const bool early : {false, true}) {
    std::optional<TaskName> writer;
    DamagingDriver driver([&](const Task& task, const std::string& folder) {
      const auto tile = tile_read_by(task, file);
      if (!writer && tile && (tile->level > 1) == is_above) {
        writer = producer_of(*tile, file);
        test::damage(folder + "/" + file_name(*tile, file), how);
      }
    });
    const auto error = small_raster().run(driver, early);
    EXPECT_FALSE(error) << error->what();
    ASSERT_TRUE(writer);
    EXPECT_EQ(driver.done[*writer], 2) << to_string(*writer);
    // Where files that nobody needed were there still, nothing else was done again but the reader.
    for (const auto& [name, times] : driver.done) {
      EXPECT_TRUE(early || times == 1 || name == *writer || name.kind == TaskKind::kPlace)
          << to_string(name) << " " << times;
    }
  }
}

std::vector<DamageCase> cases() {
  std::vector<DamageCase> all;
  for (const TileFile file : {TileFile::kPushed, TileFile::kSegment, TileFile::kBounds,
                              TileFile::kPages, TileFile::kDescriptions}) {
    for (const Damage how : {Damage::kFlipped, Damage::kCut, Damage::kRemoved}) {
      for (const bool is_above : {false, true}) {
        if (is_above || file != TileFile::kSegment) {  // batches have none
          all.emplace_back(file, how, is_above);
        }
      }
    }
  }
  return all;
}

std::string case_name(const testing::TestParamInfo<DamageCase>& of) {
  static constexpr const char* kFiles[] = {"Pushed", "Segment", "Bounds", "Pages", "Descriptions"};
  static constexpr const char* kHow[] = {"Flipped", "Cut", "Removed"};
  const auto [file, how, is_above] = of.param;
  return std::string(kFiles[static_cast<int>(file)]) + kHow[static_cast<int>(how)] +
         (is_above ? "Above" : "");
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, DamagedTaskFile, testing::ValuesIn(test::some_of(cases(), 4)),
                         case_name);

/// Every input of every task, but each once: the build mends itself however much is broken.
TEST(TaskDamage, OfManyFilesIsMended) {
  std::set<std::pair<TileId, TileFile>> damaged;
  int count = 0;
  DamagingDriver driver([&](const Task& task, const std::string& folder) {
    for (const InputFile& input : task.inputs) {
      const std::string path = folder + "/" + file_name(input.tile, input.file);
      if (++count % 7 == 0 && std::filesystem::exists(path) &&
          damaged.emplace(input.tile, input.file).second) {
        test::damage(path, count % 3 == 0 ? Damage::kCut : Damage::kFlipped);
      }
    }
  });
  const auto error = small_raster().run(driver, false);
  EXPECT_FALSE(error) << error->what();
  EXPECT_GT(damaged.size(), 10U);
}

TEST(TaskDamage, OfTheSameFileAgainAndAgainIsAnErrorThatSaysSo) {
  // Descriptions are read as soon as they were written anew.
  for (const TileFile file : {TileFile::kPushed, TileFile::kSegment, TileFile::kPages}) {
    std::optional<TileId> victim;
    DamagingDriver driver([&](const Task& task, const std::string& folder) {
      const auto tile = tile_read_by(task, file);
      victim = victim ? victim : tile;
      if (tile && tile == victim) {
        test::damage(folder + "/" + file_name(*tile, file), Damage::kCut);
      }
    });
    const auto error = small_raster().run(driver, false);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::corruption);
    EXPECT_NE(error->message().find("written anew, and is damaged again"), std::string::npos)
        << error->message();
  }
}

}  // namespace
}  // namespace ptin
