// SPDX-License-Identifier: GPL-3.0-or-later
//
// `ptin verify` must find what is wrong: errors that were planted, and sources that are another
// terrain.
#include "storage/verify.h"

#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "storage/sample_heights.h"
#include "storage/store_file.h"
#include "storage/store_writer.h"
#include "tests/support/replayed_stars.h"
#include "tests/support/share_of_cases.h"
#include "tests/support/stored_floor.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::make_raster;
using testing::Outcome;
using testing::RasterRecipe;
using testing::run_ptin;
using testing::TestFolder;

/// Hills with two lakes without heights.
RasterRecipe hills_with_voids() {
  RasterRecipe recipe;
  recipe.width = 70;
  recipe.height = 50;
  recipe.nodata = -9999;
  recipe.value = [](int x, int y) {
    const bool in_lake = (x - 20) * (x - 20) + (y - 20) * (y - 20) < 60 || (x > 50 && y > 40);
    return in_lake ? -9999.0 : testing::hills(x, y);
  };
  return recipe;
}

std::string built_raster(const TestFolder& folder, const RasterRecipe& recipe) {
  make_raster(folder.file("source.tif"), recipe);
  const Outcome outcome =
      run_ptin({"build", folder.file("source.tif"), "-o", folder.file("store.ptin"), "-q"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return folder.file("store.ptin");
}

Outcome verified(const std::string& store, const std::string& source) {
  return run_ptin({"verify", store, "--against", source, "-q"});
}

/// Writes `store` again with every record changed by `change`: whole, but wrong in what it says.
/// Stars follow: corners have the heights of their vertices, deaths the errors of their records.
void plant(const std::string& store, const std::string& planted,
           const std::function<void(VertexSplit&, std::size_t)>& change, bool keeps_rules = true) {
  const auto from = StoreFile::open(store);
  StarredRecords sound;
  IoCounters counters;
  SampleHeights samples;
  for (std::uint64_t i = 0; i < from->pages().page_count(); ++i)
    from->read_starred(PageId{i}, sound, samples, counters);
  std::vector<VertexSplit> records = sound.splits;
  std::map<float, float> errors;
  std::map<VertexKey, HeightBits> heights;
  for (std::size_t i = 0; i < records.size(); ++i) {
    change(records[i], i);
    errors.emplace(sound.splits[i].error, shortened(records[i].error));
    heights[key_of(records[i].u)] = records[i].height;
  }
  for (RingCorner& c : sound.corners) {
    const auto vertex = heights.find(key_of(c.position));
    c.height = vertex != heights.end() ? vertex->second : c.height;
    c.death = c.death != kLivesOn ? errors.at(c.death) : kLivesOn;
  }
  CoarsestTin t0 = from->t0();
  for (CoarsestTin::T& t : t0.triangles) {
    t.death = t.death != kLivesOn ? errors.at(t.death) : kLivesOn;
  }
  const HeightEncoding& encoding = from->facts().heights;
  const auto writer = StoreWriter::create(planted, {});
  writer->add_segment(
      test::pack_unchecked(test::changed_stars(sound, records), encoding, from->facts().page_bytes),
      encoding);
  writer->publish(from->facts(), t0, std::string(from->metadata_json()));
  ASSERT_EQ(verify_store(planted).is_sound(), keeps_rules) << "rules of the format";
}

TEST(Verify, FindsAGoodFileGood) {
  const TestFolder folder;
  const std::string store = built_raster(folder, hills_with_voids());
  const Outcome outcome =
      run_ptin({"verify", store, "--against", folder.file("source.tif"), "--json", "-q"});
  EXPECT_EQ(outcome.status, 0) << outcome.out;
  const auto answer = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(answer.at("sound"), true);
  EXPECT_GE(answer.at("against").at("checks").size(), 4U);
  for (const auto& check : answer.at("against").at("checks")) {
    EXPECT_EQ(check.at("samples").get<int>() + check.at("void_samples").get<int>(), 70 * 50);
    EXPECT_LE(check.at("worst_error"), check.at("certified_error").get<double>() + 1e-9);
  }
}

TEST(Verify, ReadsRastersWhoseColumnsGoWest) {
  const TestFolder folder;
  RasterRecipe recipe = hills_with_voids();
  recipe.columns_go_west = true;
  const std::string store = built_raster(folder, recipe);
  const Outcome outcome = verified(store, folder.file("source.tif"));
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
}

// The value that the build was given takes the place of the band's own: -9999 is a height then.
TEST(Verify, KnowsNodataThatIsNoNumber) {
  const TestFolder folder;
  make_raster(folder.file("source.tif"), hills_with_voids());
  for (const std::string nodata : {"nan", "inf", "-inf", "-9999"}) {
    const std::string store = folder.file("store.ptin");
    const Outcome made = run_ptin({"build", folder.file("source.tif"), "-o", store, "-q",
                                   "--overwrite", "--nodata=" + nodata});
    ASSERT_EQ(made.status, 0) << nodata << made.err;
    const Outcome outcome = verified(store, folder.file("source.tif"));
    EXPECT_EQ(outcome.status, 0) << nodata << outcome.out << outcome.err;
    const auto info = nlohmann::json::parse(run_ptin({"info", store, "--json"}).out);
    EXPECT_EQ(info.at("free_of_voids"), nodata != "-9999");
  }
}

TEST(Verify, FindsErrorsThatAreTooSmall) {
  const TestFolder folder;
  const std::string store = built_raster(folder, hills_with_voids());
  plant(store, folder.file("planted.ptin"), [](VertexSplit& r, std::size_t) { r.error *= 0.7F; });
  const Outcome outcome = verified(folder.file("planted.ptin"), folder.file("source.tif"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.out.find("more than the certified"), std::string::npos) << outcome.out;
}

TEST(Verify, FindsDeviationsThatAreTooSmall) {
  const TestFolder folder;
  const std::string store = built_raster(folder, {});
  plant(store, folder.file("planted.ptin"),
        [](VertexSplit& r, std::size_t) { r.deviation = 0.0F; });
  const Outcome outcome = verified(folder.file("planted.ptin"), folder.file("source.tif"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.out.find("deviates"), std::string::npos) << outcome.out;
}

TEST(Verify, FindsOneWrongHeight) {
  const TestFolder folder;
  const std::string store = built_raster(folder, hills_with_voids());
  const HeightEncoding heights = StoreFile::open(store)->facts().heights;
  bool done = false;
  plant(store, folder.file("planted.ptin"), [&](VertexSplit& r, std::size_t) {
    const double low = heights.code(r.height_lo);
    if (done || (r.flags & VertexSplit::kVertexVoid) != 0 || heights.code(r.height) <= low) return;
    if (r.rank != 0) return;  // no record that needs it has the height in its interval
    r.height = r.height_lo;   // within its interval, so no rule of the format is broken
    done = true;
  });
  ASSERT_TRUE(done);
  const Outcome outcome = verified(folder.file("planted.ptin"), folder.file("source.tif"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.out.find("is off by"), std::string::npos) << outcome.out;
}

TEST(Verify, FindsOneWrongHeightOfALoneSample) {
  const TestFolder folder;
  RasterRecipe recipe = hills_with_voids();
  recipe.value = [value = recipe.value](int x, int y) {
    const bool is_around = std::abs(x - 40) < 4 && std::abs(y - 25) < 4 && (x != 40 || y != 25);
    return is_around ? -9999.0 : value(x, y);
  };
  const std::string store = built_raster(folder, recipe);
  const test::Bytes sound = test::bytes_of(testing::read_file(store));
  ASSERT_EQ(verified(store, folder.file("source.tif")).status, 0);
  test::StoredFloor floor = test::floor_of(*StoreFile::open(store));
  for (auto& [key, tile] : floor.tiles) {
    for (FloorTile::Lone& lone : tile.lone) lone.height += 1;
  }
  testing::write_file(store, test::text_of(test::with_floor(sound, test::sections_of(floor))));
  ASSERT_EQ(run_ptin({"verify", store, "-q"}).status, 0) << "no vertex has it";
  const Outcome outcome = verified(store, folder.file("source.tif"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.out.find("the lone sample at"), std::string::npos) << outcome.out;
}

TEST(Verify, FindsVoidsThatAreCheaperThanTheyMayBe) {
  const TestFolder folder;
  // On a plane nothing but class changes has an error.
  RasterRecipe flat = hills_with_voids();
  flat.value = [value = flat.value](int x, int y) { return value(x, y) < 0 ? -9999.0 : 5.0; };
  const std::string store = built_raster(folder, flat);
  plant(store, folder.file("planted.ptin"), [](VertexSplit& r, std::size_t) { r.error *= 0.25F; });
  EXPECT_EQ(verified(store, folder.file("source.tif")).status, 0);
  const Outcome outcome = verified(folder.file("planted.ptin"), folder.file("source.tif"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.out.find("the border of the source"), std::string::npos) << outcome.out;
}

/// A store of hills, and how one of its records is changed.
class VerifyRecords : public ::testing::Test {
 protected:
  /// Changes the first record for which `change` is true, and expects that verify names it or one
  /// that needs it, by page and vertex, with these words.
  void expect_found(const std::function<bool(VertexSplit&)>& change, const std::string& words) {
    const std::string planted = folder_.file("planted.ptin");
    std::filesystem::remove(planted);
    bool done = false;
    plant(store_, planted,
          [&](VertexSplit& r, std::size_t) { done = done || (r.rank >= 2 && change(r)); });
    ASSERT_TRUE(done) << words;
    const Outcome outcome = run_ptin({"verify", planted, "-q", "--json"});
    EXPECT_EQ(outcome.status, 1) << words << outcome.out << outcome.err;
    const auto answer = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(answer.at("sound"), false);
    const std::string where = answer.at("faults").at(0).at("where");
    EXPECT_EQ(where.substr(0, 5), "page ") << where;
    EXPECT_NE(where.find(", record of vertex ("), std::string::npos) << where;
    EXPECT_NE(answer.at("faults").dump().find(words), std::string::npos) << words << outcome.out;
    // What the file itself tells needs no source.
    EXPECT_FALSE(answer.contains("against"));
  }

  /// The same for a change that whoever reads the star sees, so that verify names the page.
  void expect_refused(const std::function<bool(VertexSplit&)>& change) {
    const std::string planted = folder_.file("planted.ptin");
    std::filesystem::remove(planted);
    bool done = false;
    plant(
        store_, planted,
        [&](VertexSplit& r, std::size_t) { done = done || (r.rank >= 2 && change(r)); }, false);
    ASSERT_TRUE(done);
    const Outcome outcome = run_ptin({"verify", planted, "-q"});
    EXPECT_EQ(outcome.status, 1) << outcome.out << outcome.err;
    EXPECT_NE(outcome.out.find("holds values that no program wrote"), std::string::npos)
        << outcome.out;
  }

  TestFolder folder_;
  std::string store_ = built_raster(folder_, hills_with_voids());
  StoreFacts facts_ = StoreFile::open(store_)->facts();
};

TEST_F(VerifyRecords, FindsRegionsOfInfluenceThatAreNotSaturated) {
  expect_found(
      [](VertexSplit& r) {
        const GridBox own = united(united(united(box_of(r.u), r.w), r.vl), r.vr);
        return !(std::exchange(r.roi, own) == own);
      },
      "region of influence");
  expect_found(
      [&](VertexSplit& r) { return half_perimeter(r.roi) < 30 && (r.roi = facts_.bounds, true); },
      "does not hold its own");
}

TEST_F(VerifyRecords, FindsHeightsThatAreNotSaturated) {
  const auto is_surface = [](const VertexSplit& r) {
    return (r.flags & VertexSplit::kAnyVoid) == 0 && r.height_lo != r.height_hi;
  };
  expect_refused([&](VertexSplit& r) {
    if (!is_surface(r)) return false;
    r.height_lo = r.height_hi = r.height;
    return true;
  });
  expect_found(
      [&](VertexSplit& r) {
        if (!is_surface(r) || half_perimeter(r.roi) > 30) return false;
        r.height_lo = facts_.heights.bits(facts_.min_height);  // float32: the code is the height
        r.height_hi = facts_.heights.bits(facts_.max_height);
        return true;
      },
      "do not hold its own");
}

TEST_F(VerifyRecords, FindsErrorsDeviationsAndRanksThatAreNotSaturated) {
  expect_found([](VertexSplit& r) { return std::exchange(r.error, 0.0F) > 0; },
               "whose error, 0, is below its own");
  expect_found([](VertexSplit& r) { return std::exchange(r.deviation, 0.0F) > 0; },
               "whose deviation, 0, is below its own");
  expect_found([](VertexSplit& r) { return (r.rank = 0, true); }, "by falling rank");
}

TEST_F(VerifyRecords, FindsStarsThatAreNone) {
  expect_refused([](VertexSplit& r) { return (std::swap(r.vl, r.vr), true); });
  expect_refused([](VertexSplit& r) { return (std::swap(r.w, r.vl), true); });
}

TEST(Verify, FindsStoresOfEveryKindOfSourceSound) {
  const TestFolder folder;
  make_raster(folder.file("voids.tif"), hills_with_voids());
  ASSERT_EQ(
      run_ptin({"build", folder.file("voids.tif"), "-o", folder.file("mesh.ptin"), "-q"}).status,
      0);
  ASSERT_EQ(run_ptin({"export", folder.file("mesh.ptin"), "--error", "2", "-o",
                      folder.file("mesh.ply"), "-q"})
                .status,
            0);
  const std::vector<std::vector<std::string>> sources = {
      {folder.file("voids.tif")},
      {testing::test_data("ground_points.csv"), "--max-edge", "9"},
      {folder.file("mesh.ply")}};
  const std::vector<std::vector<std::string>> ways = {
      {}, {"--tile", "16"}, {"--max-error", "1"}, {"--tile", "16", "--max-error", "1"}};
  for (const auto& source : sources) {
    for (const auto& way : test::some_of(ways)) {
      std::vector<std::string> arguments = {"build", "-q", "--overwrite", "-o",
                                            folder.file("s.ptin")};
      arguments.insert(arguments.end(), source.begin(), source.end());
      arguments.insert(arguments.end(), way.begin(), way.end());
      const Outcome built = run_ptin(arguments);
      ASSERT_EQ(built.status, 0) << built.err;
      for (const std::string memory : {"1G", "1M"}) {
        const Outcome outcome = run_ptin({"verify", folder.file("s.ptin"), "--memory", memory});
        EXPECT_EQ(outcome.status, 0) << source[0] << memory << outcome.out << outcome.err;
        EXPECT_NE(outcome.out.find("; splits applied in "), std::string::npos) << outcome.out;
      }
    }
  }
}

TEST(Verify, FindsAnotherSource) {
  const TestFolder folder;
  const std::string store = built_raster(folder, hills_with_voids());
  RasterRecipe higher = hills_with_voids();
  higher.value = [value = higher.value](int x, int y) {
    const double height = value(x, y);
    return height < 0 ? height : height + 0.1;
  };
  make_raster(folder.file("higher.tif"), higher);
  const Outcome outcome = verified(store, folder.file("higher.tif"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.out.find("is off by"), std::string::npos) << outcome.out;
  RasterRecipe filled = hills_with_voids();
  filled.value = [](int x, int y) { return testing::hills(x, y); };
  make_raster(folder.file("filled.tif"), filled);
  EXPECT_EQ(verified(store, folder.file("filled.tif")).status, 1);
}

void expect_not_the_source(const Outcome& outcome, const std::string& words) {
  EXPECT_EQ(outcome.status, 2) << outcome.out;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(testing::lines_in(outcome.err), 1U) << outcome.err;
  EXPECT_NE(outcome.err.find("not the source of this file"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
}

/// Before pages and splits are looked at, which takes minutes of a large file: the page that is damaged
/// here is not found.
TEST(Verify, RefusesTheSourceOfAnotherTerrainAtOnce) {
  const TestFolder folder;
  const std::string store = built_raster(folder, hills_with_voids());
  std::string bytes = testing::read_file(store);
  bytes[bytes.size() / 2] ^= 1;
  testing::write_file(store, bytes);
  RasterRecipe elsewhere = hills_with_voids();
  elsewhere.west += 300000;
  make_raster(folder.file("elsewhere.tif"), elsewhere);
  expect_not_the_source(verified(store, folder.file("elsewhere.tif")), "reach from");
  std::string points;
  for (int i = 0; i < 6000; ++i) points += std::to_string(i) + " " + std::to_string(i % 7) + " 1\n";
  testing::write_file(folder.file("far.xyz"), points);
  expect_not_the_source(verified(store, folder.file("far.xyz")), "reach from");
}

TEST(Verify, RefusesARasterThatLiesElsewhere) {
  const TestFolder folder;
  const std::string store = built_raster(folder, hills_with_voids());
  const struct {
    double east, north, pixel;
    const char* words;
  } cases[] = {{15, 0, 30, "stand on another grid, up to 0.5 grid units"},
               {0, 30, 30,
                "reach from 500015 3998545 to 502085 4000015, the terrain's from 500015 3998515 to "
                "502085 3999985"},
               {0, 0, 10, "stand on another grid"}};
  for (const auto& c : cases) {
    RasterRecipe recipe = hills_with_voids();
    recipe.west += c.east;
    recipe.north += c.north;
    recipe.pixel = c.pixel;
    make_raster(folder.file("other.tif"), recipe);
    expect_not_the_source(verified(store, folder.file("other.tif")), c.words);
  }
}

// A part of what a terrain was built from is no source of it, and the command that the build prints
// names all parts.
TEST(Verify, WantsEveryInputOfTheBuild) {
  const TestFolder folder;
  testing::write_file(folder.file("west half.csv"), "0,0,1\n0,9,2\n4,5,3\n");
  testing::write_file(folder.file("east.csv"), "9,0,1\n9,9,2\n5,4,3\n");
  const std::string store = folder.file("p.ptin"), west = folder.file("west half.csv"),
                    east = folder.file("east.csv");
  const Outcome made = run_ptin({"build", west, east, "-o", store});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_NE(made.out.find("ptin verify " + store + " --against '" + west + "' " + east + "\n"),
            std::string::npos)
      << made.out;
  expect_not_the_source(verified(store, west),
                        "reach from 0 0 to 4 9, the terrain's from 0 0 to 9 9");
  const Outcome whole = run_ptin({"verify", store, "--against", west, east});
  EXPECT_EQ(whole.status, 0) << whole.out << whole.err;
  EXPECT_NE(whole.out.find(west + " and 1 more input: 6 samples"), std::string::npos) << whole.out;
}

TEST(Verify, TakesASourceThatReachesFartherThanTheBuildsBox) {
  const TestFolder folder;
  testing::write_file(folder.file("a.csv"), "0,0,1\n0,9,2\n4,5,3\n9,0,1\n9,9,2\n5,4,3\n20,20,7\n");
  const std::string store = folder.file("p.ptin");
  testing::expect_done(
      {"build", folder.file("a.csv"), "-o", store, "-q", "--bbox", "0", "0", "10", "10"});
  EXPECT_EQ(verified(store, folder.file("a.csv")).status, 0);
  testing::write_file(folder.file("b.csv"), "0,0,1\n0,9,2\n4,5,3\n");
  expect_not_the_source(verified(store, folder.file("b.csv")), "reach from 0 0 to 4 9");
}

TEST(Verify, ChecksPointsToo) {
  const TestFolder folder;
  const std::string source = testing::test_data("ground_points.csv");
  ASSERT_EQ(run_ptin({"build", source, "-o", folder.file("p.ptin"), "-q"}).status, 0);
  EXPECT_EQ(verified(folder.file("p.ptin"), source).status, 0);
  std::string text = testing::read_file(source);
  const std::size_t line = text.find('\n', text.size() / 2) + 1;
  const std::size_t digit = text.find('\n', line) - 4;  // of the height: metres
  ASSERT_TRUE(std::isdigit(static_cast<unsigned char>(text[digit])) != 0) << text.substr(line, 40);
  text[digit] = text[digit] == '9' ? '0' : static_cast<char>(text[digit] + 1);
  testing::write_file(folder.file("other.csv"), text);
  const Outcome outcome = verified(folder.file("p.ptin"), folder.file("other.csv"));
  EXPECT_EQ(outcome.status, 1) << outcome.out;
}

// The system refuses to read the beginning of a process's memory.
TEST(Verify, SaysThatAnUnreadableSourceCannotBeRead) {
  const TestFolder folder;
  const std::string store = built_raster(folder, hills_with_voids());
  for (const char* name : {"a.tif", "a.xyz"}) {
    std::filesystem::create_symlink("/proc/self/mem", folder.file(name));
    const std::string source = folder.file(name);
    const std::vector<std::vector<std::string>> commands = {
        {"verify", store, "--against", source, "-q"},
        {"build", source, "-o", folder.file("none.ptin"), "-q"}};
    for (const std::vector<std::string>& command : commands) {
      const Outcome outcome = run_ptin(command);
      EXPECT_EQ(outcome.status, 6) << command[0] << " " << name;
      EXPECT_NE(outcome.err.find(source + ": cannot read"), std::string::npos) << outcome.err;
    }
  }
}

TEST(Verify, SaysNotFoundForAMissingSource) {
  const TestFolder folder;
  const std::string store = built_raster(folder, hills_with_voids());
  EXPECT_EQ(verified(store, folder.file("none.tif")).status, 3);
}

}  // namespace
}  // namespace ptin::tools
