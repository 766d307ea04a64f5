// SPDX-License-Identifier: GPL-3.0-or-later
//
// LAZ is read as LAS is: the same points, choices, warnings and CRS, and the same file is built.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "engine/construct/grid/crs.h"
#include "engine/construct/points/open_points.h"
#include "engine/construct/points/point_portions.h"
#include "engine/construct/read/las_reader.h"
#include "engine/error.h"
#include "tests/construct/laz/laz_file.h"
#include "tests/construct/laz/made_las.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/memory_file.h"
#include "tests/support/las_file.h"

namespace ptin {
namespace {

using oracle::made_las;

/// What a reader gives: points, counts and warnings, in words.
std::string told_by(const std::string& bytes, const PointChoice& choice = {}) {
  const MemoryFile file("told.las", bytes);
  LasReader reader(file.path(), choice);
  std::string told;
  std::vector<SourcePoint> batch;
  while (reader.next(batch)) {
    for (const SourcePoint& p : batch) {
      for (const Decimal& d : {p.x, p.y, p.z}) {
        told += std::to_string(d.mantissa) + "e-" + std::to_string(d.decimals) + " ";
      }
    }
  }
  told += "left " + std::to_string(reader.left_out().of(LeftOutReason::kWithheld)) + " " +
          std::to_string(reader.left_out().total()) + " classes " + reader.classes().names() +
          " overlap " + std::to_string(reader.classes().overlap);
  const SourceWarnings warnings = reader.warnings();
  for (const SourceWarning& w : warnings.all()) {
    told += "\n" + w.kind + " " + std::to_string(w.count);
  }
  EXPECT_EQ(reader.done(), reader.total());
  return told;
}

LazOptions options_for(int format) {
  LazOptions options;
  options.compressor = format < 6 ? 2 : 3;
  options.chunk_records = 350;
  return options;
}

TEST(LazReader, ReadsWhatLasHolds) {
  for (const int format : {0, 3, 5, 6, 8, 10}) {
    const std::string las = made_las(format, 1, 1500, 3), laz = laz_of(las, options_for(format));
    EXPECT_EQ(told_by(laz), told_by(las)) << format;
    PointChoice choice;
    choice.classes = {1, 2, 3, 4, 5, 12};
    choice.returns = ReturnChoice::kLast;
    EXPECT_EQ(told_by(laz, choice), told_by(las, choice)) << format;
  }
}

/// Points of LAS 1.4 as LASzip writes them for programs of LAS 1.2: what these do not know is in extra bytes,
/// behind one that is the file's own.
std::string las_of_compatibility(std::vector<LasPoint> points) {
  LasFileMaker las;
  las.format = 3;
  las.extra_bytes = 6;
  const std::pair<const char*, char> extras[] = {{"own", '\x01'},
                                                 {"LAS 1.4 scan angle", '\x04'},
                                                 {"LAS 1.4 extended returns", '\x01'},
                                                 {"LAS 1.4 classification", '\x01'},
                                                 {"LAS 1.4 flags and channel", '\x01'}};
  std::string descriptions;
  for (const auto& [name, type] : extras) {
    std::string description(192, '\0');
    description[2] = type;
    description.replace(4, std::strlen(name), name);
    descriptions += description;
  }
  las.records = {{22204, std::string(156, '\0'), false, "lascompatible"},
                 {4, descriptions, false, "LASF_Spec"}};
  std::string hidden;
  for (LasPoint& p : points) {
    const LasPoint all = p;
    p.cls = all.cls > 31 ? 0 : all.cls;
    p.number = std::min(all.number, 7);
    p.returns = std::min(all.returns, 7);
    hidden += {static_cast<char>((all.number - p.number) << 4 | (all.returns - p.returns)),
               static_cast<char>(all.cls - p.cls), '\x03'};
  }
  las.points = points;
  std::string file = las.bytes();
  const std::size_t record = 34 + 6, first = file.size() - points.size() * record;
  for (std::size_t i = 0; i < points.size(); ++i) {
    file.replace(first + i * record + 34 + 3, 3, hidden, 3 * i, 3);
  }
  return file;
}

TEST(LazReader, FindsWhatLas14HidesInExtraBytes) {
  LasFileMaker native;
  native.format = 7;
  native.minor = 4;
  for (int i = 0; i < 900; ++i) {
    const int returns = 1 + i % 15;
    native.points.push_back(
        {7 * i, i * i, 3 * i, i % 256, i % 11 == 0, 1 + (i / 15) % returns, returns});
  }
  const std::string las = las_of_compatibility(native.points);
  for (const ReturnChoice returns :
       {ReturnChoice::kAll, ReturnChoice::kFirst, ReturnChoice::kLast}) {
    PointChoice choice;
    choice.returns = returns;
    const std::string wanted = told_by(native.bytes(), choice);
    EXPECT_EQ(told_by(las, choice), wanted);
    EXPECT_EQ(told_by(laz_of(las, options_for(3)), choice), wanted);
    choice.classes = {2, 65, 200};
    EXPECT_EQ(told_by(laz_of(las, options_for(3)), choice), told_by(native.bytes(), choice));
  }
  std::string nameless = las;
  nameless[nameless.find("LAS 1.4 class")] = 'X';
  EXPECT_THROW(told_by(nameless), Error);
}

/// With an extended record behind all that is there.
std::string with_record_behind(std::string laz, const std::string& content) {
  const std::uint64_t at = laz.size(), bytes = content.size();
  const std::uint32_t count = 1;
  std::string head(60, '\0');
  std::memcpy(head.data() + 20, &bytes, sizeof bytes);
  std::memcpy(laz.data() + 235, &at, sizeof at);
  std::memcpy(laz.data() + 243, &count, sizeof count);
  return laz + head + content;
}

TEST(LazReader, FindsTheTableOfAStreamedFileBeforeTheRecordsBehindIt) {
  for (const int format : {1, 6}) {
    std::string las = made_las(format, 1, 900, 5);
    LazOptions options = options_for(format);
    options.table_place_at_end = true;
    if (format < 6) {  // records behind the points came with LAS 1.4
      LasFileMaker maker;
      maker.minor = 4;
      maker.format = 1;
      for (int i = 0; i < 900; ++i) maker.points.push_back({3 * i, i * i, i});
      las = maker.bytes();
    }
    const std::string laz = laz_of(las, options);
    EXPECT_EQ(told_by(laz), told_by(las)) << format;
    for (const std::string& content :
         {std::string("a record"), std::string(40, '\0'), std::string()}) {
      EXPECT_EQ(told_by(with_record_behind(laz, content)), told_by(las)) << format;
    }
    const std::string cut = laz.substr(0, laz.size() - 8);
    try {
      told_by(with_record_behind(cut, "a record"));
      ADD_FAILURE() << "nobody says where the table is";
    } catch (const Error& e) {
      EXPECT_NE(e.message().find("cannot go back"), std::string::npos) << e.message();
    }
  }
}

TEST(LazReader, RefusesWhatExperimentsBeforeLasZipMarkedAsCompressed) {
  std::string laz = laz_of(made_las(1, 0, 20, 5), options_for(1));
  laz[104] = static_cast<char>(laz[104] | 0x40);
  try {
    told_by(laz);
    ADD_FAILURE() << "such points are not read";
  } catch (const Error& e) {
    EXPECT_NE(e.message().find("before LASzip 1.0"), std::string::npos) << e.message();
  }
}

TEST(LazReader, TakesTheCrsFromRecords) {
  LasFileMaker las;
  las.minor = 4;
  las.format = 6;
  las.wkt_bit = true;
  las.points = {{1, 2, 3}, {4, 5, 6}};
  const std::string wkt = resolve_crs("EPSG:2154", "", "").wkt;
  las.records = {{2112, wkt}};
  const MemoryFile file("crs.laz", laz_of(las.bytes(), options_for(6)));
  EXPECT_EQ(LasReader(file.path(), {}).facts().crs, wkt);
}

TEST(LazReader, WarnsOfChunksBeyondItsHeader) {
  std::string laz = laz_of(made_las(1, 0, 800, 3), options_for(1));
  const std::uint32_t points = 350;
  std::memcpy(laz.data() + 107, &points, sizeof points);
  EXPECT_NE(told_by(laz).find("\nlas_counts 0"), std::string::npos);
}

TEST(LazReader, RefusesWhatIsDamaged) {
  const std::string good = laz_of(made_las(3, 0, 400, 3), options_for(3));
  const auto refusal = [](const std::string& bytes) {
    const MemoryFile file("bad.laz", bytes);
    try {
      LasReader reader(file.path(), {});
      std::vector<SourcePoint> batch;
      while (reader.next(batch)) continue;
    } catch (const Error& e) {
      EXPECT_EQ(e.context(), file.path());
      return std::string(e.message());
    }
    return std::string();
  };
  EXPECT_EQ(refusal(good), "");
  for (std::size_t bytes = 4; bytes < good.size(); bytes += 97) {
    EXPECT_NE(refusal(good.substr(0, bytes)), "") << bytes;
  }
  std::string flipped = good;
  flipped[good.size() / 2] ^= 0x10;
  EXPECT_NE(refusal(flipped).find("the chunk of the points from "), std::string::npos);
  const auto changed = [&](std::size_t at, char to) {
    std::string bytes = good;
    bytes[at] = to;
    return refusal(bytes);
  };
  const std::size_t record = 235, content = record + 54;
  const std::pair<std::string, const char*> told[] = {
      {changed(record + 2, 'L'), "how the points are compressed is not there"},
      {changed(content, 0), "names no compressor"},
      {changed(content + 32, 0), "its parts make 0 bytes of a point, and the header says 34"},
      {changed(content + 34 + 2, 19), "a part of kind 6 of 19 bytes"},
      {changed(107, 'z'), "the header's number of points is wrong"}};
  for (const auto& [said, wanted] : told) EXPECT_NE(said.find(wanted), std::string::npos) << said;
}

TEST(LazReader, IsReadInPortionsOfWholeChunks) {
  const MemoryFile file("portions.laz", laz_of(made_las(1, 0, 2000, 3), options_for(1)));
  PortionSizes sizes;
  sizes.laz_records = 800;
  const auto portions = cut_into_portions({file.path()}, {}, sizes);
  ASSERT_EQ(portions.size(), 3U);
  std::uint64_t points = 0;
  for (const PointPortion& portion : portions) {
    const auto stream = open_point_stream(file.path(), {}, {}, {}, portion.part);
    EXPECT_TRUE(stream->total() % 350 == 0 || portion.part.end > 2000);
    points += stream->total();
  }
  EXPECT_EQ(points, 2000U);
}

/// Portions take memory, and nothing holds the header's number of points against the file's bytes.
TEST(LazReader, ThatCountsPointsWithoutEndIsCutIntoItsChunks) {
  LazOptions options;
  for (const int compressor : {1, 2}) {
    options.compressor = compressor;
    options.chunk_records = 0xFFFFFFFE;
    std::string laz = laz_of(made_las(1, 0, 1000, 3), options);
    const std::uint32_t points = 0xFFFFFFF0;
    std::memcpy(laz.data() + 107, &points, sizeof points);
    const MemoryFile file("endless.laz", laz);
    EXPECT_EQ(cut_into_portions({file.path()}, {}).size(), 1U) << compressor;
  }
}

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What is built from points in a file of this name.
std::string built(const oracle::ScratchFolder& folder, const std::string& bytes, int threads) {
  const std::string path = folder.file("scan.las");
  std::ofstream(path, std::ios::binary) << bytes;
  BuildOptions options;
  options.classes = {2};
  BuildResources resources;
  resources.overwrite = true;
  resources.threads = threads;
  std::ignore = build({path}, folder.file("scan.ptin"), options, resources);
  return content_of(folder.file("scan.ptin"));
}

TEST(LazReader, MakesTheFileThatLasMakes) {
  LasFileMaker las;
  las.minor = 4;
  las.format = 7;
  std::mt19937 random(1);
  for (int i = 0; i < 5000; ++i) {
    las.points.push_back({static_cast<std::int32_t>(random() % 100000),
                          static_cast<std::int32_t>(random() % 100000),
                          static_cast<std::int32_t>(random() % 5000), i % 3 == 0 ? 2 : 5});
  }
  const oracle::ScratchFolder folder(oracle::ScratchFolder::Size::kSmall);
  const std::string expected = built(folder, las.bytes(), 1);
  for (const int threads : {1, 2}) {
    EXPECT_EQ(built(folder, laz_of(las.bytes(), options_for(7)), threads), expected);
  }
}

TEST(LazReaderOnRealTerrain, ReadsWhatLasHolds) {
  const std::string shared = PTIN_SHARED_DATA;
  for (const auto& [laz, las] :
       {std::pair{"laz/autzen_trim.laz", "autzen_trim.las"},
        {"laz/ign_lidarhd_0382_6565_crop.laz", "ign_lidarhd_0382_6565_crop.las"},
        {"laz/extrabytes.laz", "laz/extrabytes.las"},
        {"laz/point-color-time.las.laz", "laz/point-color-time.las"},
        {"laz/point10-1.0.laz", "laz/point10-1.0.las"}}) {
    if (!std::filesystem::exists(shared + "/" + laz)) {
      GTEST_SKIP() << "needs " << laz;
    }
    EXPECT_TRUE(told_by(content_of(shared + "/" + laz)) == told_by(content_of(shared + "/" + las)))
        << laz;
  }
}

}  // namespace
}  // namespace ptin
