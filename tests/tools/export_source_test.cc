// SPDX-License-Identifier: GPL-3.0-or-later
//
// The raster that a terrain was built from, written again: bit for bit, or not at all.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogr_spatialref.h>

#include "storage/floor.h"
#include "storage/store_file.h"
#include "tests/support/stored_floor.h"
#include "tests/tools/program.h"
#include "tests/tools/refusal.h"
#include "tests/tools/whole_raster.h"

namespace ptin::tools {
namespace {

using testing::answer_of;
using testing::expect_done;
using testing::expect_refusal;
using testing::expect_same_raster;
using testing::hills;
using testing::Outcome;
using testing::read_file;
using testing::read_whole;
using testing::run_ptin;
using testing::TestFolder;
using testing::Whole;
using testing::write_file;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A GeoTIFF to be written.
struct Recipe {
  std::string type = "Int16";
  int width = 90, height = 70;
  std::optional<double> nodata;
  double high = 30000;  ///< More than heights: a value of the type.
  std::optional<std::array<double, 6>> place =
      std::array<double, 6>{500000.1, 30, 0, 4000000.2, 0, -30};
  bool is_point = false;
  double scale = 1.0, offset = 0.0;
  std::vector<std::string> creation;
  std::function<double(int, int)> value = [](int x, int y) { return std::floor(hills(x, y)); };
};

void make(const std::string& path, const Recipe& r) {
  GDALAllRegister();
  CPLStringList creation;
  for (const std::string& option : r.creation) creation.AddString(option.c_str());
  const GDALDatasetUniquePtr data(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      path.c_str(), r.width, r.height, 1, GDALGetDataTypeByName(r.type.c_str()), creation.List()));
  if (!data) throw std::runtime_error("cannot create " + path);
  if (r.is_point) data->SetMetadataItem(GDALMD_AREA_OR_POINT, GDALMD_AOP_POINT);
  if (r.place) {
    auto place = *r.place;
    data->SetGeoTransform(place.data());
    OGRSpatialReference srs;
    srs.importFromEPSG(32611);
    data->SetSpatialRef(&srs);
  }
  GDALRasterBand& band = *data->GetRasterBand(1);
  if (r.nodata) band.SetNoDataValue(*r.nodata);
  if (r.scale != 1.0) band.SetScale(r.scale);
  if (r.offset != 0.0) band.SetOffset(r.offset);
  std::vector<double> row(static_cast<std::size_t>(r.width));
  for (int y = 0; y < r.height; ++y) {
    for (int x = 0; x < r.width; ++x) row[static_cast<std::size_t>(x)] = r.value(x, y);
    ASSERT_EQ(band.RasterIO(GF_Write, 0, y, r.width, 1, row.data(), r.width, 1, GDT_Float64, 0, 0,
                            nullptr),
              CE_None);
  }
}

class ExportSource : public ::testing::Test {
 protected:
  void build(const std::vector<std::string>& more = {}) {
    std::vector<std::string> all = {"build", source_, "-o", store_, "--overwrite", "-q"};
    all.insert(all.end(), more.begin(), more.end());
    expect_done(all);
  }
  void expect_back(const Recipe& recipe) {
    make(source_, recipe);
    build();
    expect_done({"export", store_, "--source", "-o", made_, "--overwrite", "-q"});
    expect_same_raster(made_, source_);
  }
  /// What is in the file says so, and the refusal tells what is lost.
  void expect_lost(const std::string& what) {
    const auto file = StoreFile::open(store_);
    EXPECT_FALSE(file->floor() != nullptr && file->floor()->facts().is_exact);
    const auto before = folder_.names();
    const Outcome outcome = run_ptin({"export", store_, "--source", "-o", folder_.file("no.tif")});
    expect_refusal(outcome, 2, what);
    EXPECT_NE(outcome.err.find("without --source"), std::string::npos) << outcome.err;
    EXPECT_EQ(folder_.names(), before);
  }
  TestFolder folder_;
  std::string source_ = folder_.file("s.tif"), store_ = folder_.file("s.ptin"),
              made_ = folder_.file("made.tif");
};

/// Hills with voids, and samples that touch no triangle among them.
double with_voids(int x, int y, double void_value) {
  const bool is_void = x > 20 && x < 60 && y > 10 && y < 50;
  const bool is_lone = is_void && x % 7 == 0 && y % 5 == 0;
  return is_void && !is_lone ? void_value : std::floor(hills(x, y));
}

TEST_F(ExportSource, GivesEveryTypeBack) {
  for (const char* type : {"UInt16", "Int16", "UInt32", "Int32", "Float32", "Float64"}) {
    Recipe recipe;
    recipe.type = type;
    expect_back(recipe);
    recipe.nodata = 65000.0;
    if (recipe.type == "Int16") recipe.nodata = -32768.0;
    recipe.value = [&](int x, int y) { return with_voids(x, y, *recipe.nodata); };
    expect_back(recipe);
    EXPECT_GT(answer_of({"info", store_, "--json"}).at("metadata").at("source").at("lone_samples"),
              10);
  }
}

TEST_F(ExportSource, GivesBytesOfEitherSignBack) {
  Recipe recipe;
  recipe.type = "Byte";
  recipe.nodata = 255.0;
  recipe.value = [](int x, int y) { return x == 5 && y > 3 ? 255.0 : (x * 3 + y) % 200; };
  expect_back(recipe);
#if GDAL_VERSION_NUM < GDAL_COMPUTE_VERSION(3, 7, 0)
  recipe.creation = {"PIXELTYPE=SIGNEDBYTE"};
  recipe.nodata = -7.0;
  recipe.value = [](int x, int y) { return x == 5 && y > 3 ? 249.0 : (x * 3 + y) % 240; };
  expect_back(recipe);
#endif
}

TEST_F(ExportSource, GivesNumbersBackThatAreNoWholeOnes) {
  Recipe recipe;
  for (const char* type : {"Float32", "Float64"}) {
    recipe.type = type;
    // Float32 of steps, of none, and NaN for voids, declared or not.
    recipe.value = [](int x, int y) { return static_cast<float>(hills(x, y) / 10); };
    expect_back(recipe);
    recipe.value = [](int x, int y) { return static_cast<float>(std::sin(x * 0.1) * (y + 0.3)); };
    expect_back(recipe);
    recipe.value = [](int x, int y) { return with_voids(x, y, kNaN); };
    expect_back(recipe);
    recipe.nodata = kNaN;
    expect_back(recipe);
    recipe.nodata = std::numeric_limits<float>::lowest();
    recipe.value = [&](int x, int y) { return with_voids(x, y, *recipe.nodata); };
    expect_back(recipe);
    recipe.nodata.reset();
  }
}

TEST_F(ExportSource, LiesWhereTheSourceLay) {
  Recipe recipe;
  recipe.is_point = true;
  expect_back(recipe);
  recipe.place =
      std::array<double, 6>{-122.00041666666667, 1.0 / 1200, 0, 47.000416666666666, 0, -1.0 / 1200};
  expect_back(recipe);
  recipe.is_point = false;
  recipe.place = std::array<double, 6>{500000.1, 30, 0, 3990000.2, 0, 30};  // rows from the south
  expect_back(recipe);
  recipe.place = std::array<double, 6>{509000.1, -30, 0, 3990000.2, 0, 20};  // and from the east
  expect_back(recipe);
  recipe.place.reset();
  expect_back(recipe);
}

TEST_F(ExportSource, KeepsTheScaleOfIntegers) {
  Recipe recipe;
  recipe.scale = 0.1;
  recipe.offset = -100.0;
  recipe.nodata = 0.0;
  recipe.value = [](int x, int y) { return with_voids(x, y, 0.0); };
  expect_back(recipe);
}

// GDAL works the numbers of such a VRT out in the type that is asked for, and neither rounds nor clamps them
// to the VRT's own then.
TEST_F(ExportSource, GivesTheNumbersOfAVrtBackAsItsOwnTypeHasThem) {
  make(folder_.file("s.tif"), {});
  source_ = folder_.file("s.vrt");
  for (const auto& [type, ratio] : std::vector<std::pair<std::string, std::string>>{
           {"Byte", "0.75"}, {"Int16", "97.25"}, {"UInt32", "0.71"}, {"Float32", "0.71"}}) {
    SCOPED_TRACE(type);
    write_file(source_,
               R"(<VRTDataset rasterXSize="90" rasterYSize="70"><SRS>EPSG:32611</SRS>)"
               "<GeoTransform>500000.1, 30, 0, 4000000.2, 0, -30</GeoTransform>"
               R"(<VRTRasterBand dataType=")" +
                   type +
                   R"(" band="1"><ComplexSource><SourceFilename relativeToVRT="1">s.tif)"
                   "</SourceFilename><SourceBand>1</SourceBand><ScaleOffset>0.25</ScaleOffset>"
                   "<ScaleRatio>" +
                   ratio + "</ScaleRatio></ComplexSource></VRTRasterBand></VRTDataset>");
    build();
    expect_done({"verify", store_, "--against", source_, "-q"});
    expect_done({"export", store_, "--source", "-o", made_, "--overwrite", "-q"});
    const Whole made = read_whole(made_), source = read_whole(source_);
    EXPECT_EQ(made.type, type);
    EXPECT_TRUE(made.samples == source.samples);
  }
}

// Where a source of a VRT covers nothing GDAL hands out the nodata value, and a zero where there is none.
TEST_F(ExportSource, GivesAVrtBackWhereGdalTellsWhatItDoesNotCover) {
  Recipe recipe;
  recipe.type = "Float32";
  make(folder_.file("s.tif"), recipe);
  source_ = folder_.file("s.vrt");
  for (const bool is_told : {true, false}) {
    write_file(source_,
               R"(<VRTDataset rasterXSize="100" rasterYSize="70"><SRS>EPSG:32611</SRS>)"
               "<GeoTransform>500000.1, 30, 0, 4000000.2, 0, -30</GeoTransform>"
               R"(<VRTRasterBand dataType="Float32" band="1">)" +
                   std::string(is_told ? "<NoDataValue>-9999</NoDataValue>" : "") +
                   R"(<SimpleSource><SourceFilename relativeToVRT="1">s.tif</SourceFilename>)"
                   R"(<SourceBand>1</SourceBand><SrcRect xOff="0" yOff="0" xSize="90" ySize="70"/>)"
                   R"(<DstRect xOff="10" yOff="0" xSize="90" ySize="70"/></SimpleSource>)"
                   "</VRTRasterBand></VRTDataset>");
    build();
    if (!is_told) {
      expect_lost("what stood in each of the samples");
      continue;
    }
    expect_done({"export", store_, "--source", "-o", made_, "--overwrite", "-q"});
    EXPECT_TRUE(read_whole(made_).samples == read_whole(source_).samples);
  }
}

TEST_F(ExportSource, TellsWhatItWrote) {
  make(source_, {});
  build();
  const nlohmann::json answer = answer_of({"export", store_, "--source", "-o", made_, "--json"});
  EXPECT_EQ(answer.at("width"), 90);
  EXPECT_EQ(answer.at("height"), 70);
  EXPECT_EQ(answer.at("exact"), true);
  EXPECT_EQ(answer.at("certified_error"), 0.0);
  EXPECT_EQ(answer.at("lone_samples"), 0);
  expect_done({"export", store_, "--source", "--of", "COG", "-o", made_, "--overwrite", "-q"});
  expect_same_raster(made_, source_);
  const Outcome told = run_ptin({"export", store_, "--source", "-o", made_, "--overwrite"});
  EXPECT_NE(told.out.find("the source raster bit for bit"), std::string::npos) << told.out;
}

TEST_F(ExportSource, RefusesWhatItDoesNotGiveBack) {
  Recipe recipe;
  recipe.type = "Float32";
  recipe.nodata = -9999.0;
  recipe.value = [](int x, int y) { return x == 9 ? kNaN : with_voids(x, y, -9999.0); };
  make(source_, recipe);
  build();
  expect_lost("samples without a height");  // NaN, and the nodata value
  recipe.value = [](int x, int y) { return x == 9 ? -0.0 : hills(x, y) + 0.01 * x * y; };
  make(source_, recipe);
  build();
  expect_lost("zero");
  recipe.scale = 0.5;
  make(source_, recipe);
  build();
  expect_lost("scale");
  recipe = {};
  make(source_, recipe);
  build({"--nodata", "100"});
  expect_lost("--nodata");
  build({"--bbox", "500500", "3998500", "501500", "3999500"});
  expect_lost("--bbox");
  recipe.place = std::array<double, 6>{502700.1, 30, 0, 4000000.2, 0, -30};
  make(folder_.file("east.tif"), recipe);
  build({folder_.file("east.tif")});
  expect_lost("rasters");
}

TEST_F(ExportSource, RefusesMasks) {
  Recipe recipe;
  make(source_, recipe);
  {
    const GDALDatasetUniquePtr data(GDALDataset::Open(source_.c_str(), GDAL_OF_UPDATE));
    ASSERT_EQ(data->CreateMaskBand(GMF_PER_DATASET), CE_None);
    ASSERT_EQ(data->GetRasterBand(1)->GetMaskBand()->Fill(255), CE_None);
  }
  build();
  expect_lost("mask");
}

TEST_F(ExportSource, RefusesTerrainsWithoutSamples) {
  make(source_, {});
  build({"--max-error", "2"});
  expect_lost("--max-error");
  expect_done(
      {"build", testing::test_data("ground_points.csv"), "-o", store_, "--overwrite", "-q"});
  expect_lost("points");
}

TEST_F(ExportSource, LeavesNoChoice) {
  make(source_, {});
  build();
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--error", "3"},
        {"--vertices", "30"},
        {"--window", "500000", "3999000", "501000", "4000000"},
        {"--pixel-size", "30"},
        {"--nodata", "3"},
        {"--type", "Int16"},
        {"--what", "slope"}}) {
    std::vector<std::string> all = {"export", store_, "--source", "-o", made_};
    all.insert(all.end(), more.begin(), more.end());
    expect_refusal(run_ptin(all), 2, "--source");
  }
  expect_refusal(run_ptin({"export", store_, "--source", "-o", folder_.file("a.ply")}), 2,
                 "--source");
}

TEST_F(ExportSource, OfDamagedHeightsLeavesNothing) {
  make(source_, {});
  build();
  std::string bytes = read_file(store_);
  bytes[bytes.size() - 2000] = static_cast<char>(bytes[bytes.size() - 2000] ^ 0x10);
  write_file(folder_.file("bad.ptin"), bytes);
  const auto before = folder_.names();
  for (const std::vector<std::string>& how : {std::vector<std::string>{"--source"}, {}}) {
    std::vector<std::string> all = {"export", folder_.file("bad.ptin"), "-o", made_, "-q"};
    all.insert(all.end(), how.begin(), how.end());
    expect_refusal(run_ptin(all), 4, "bad.ptin");
    EXPECT_EQ(folder_.names(), before);
  }
}

TEST_F(ExportSource, DoesNotBelieveADescriptionThatCannotBe) {
  Recipe recipe;
  recipe.value = [](int x, int y) { return 1000 + std::floor(hills(x, y)); };
  make(source_, recipe);
  build();
  const test::Bytes sound = test::bytes_of(read_file(store_));
  const auto expect_damaged = [&](const std::string& what, const test::Bytes& bytes) {
    write_file(folder_.file("bad.ptin"), test::text_of(bytes));
    expect_refusal(run_ptin({"export", folder_.file("bad.ptin"), "--source", "-o", made_, "-q"}), 4,
                   what);
  };
  test::FloorSections floor = test::floor_sections_of(sound);
  floor.root.source_type = static_cast<std::uint32_t>(SourceNumber::kUInt8);
  expect_damaged("no number of the source's type", test::with_floor(sound, floor));
  const auto with_text = [&](std::string_view old, std::string_view other) {
    test::Bytes bytes = sound;
    const auto place =
        std::ranges::search(bytes, old, {}, [](std::byte b) { return static_cast<char>(b); });
    if (place.empty() || old.size() != other.size()) throw std::runtime_error("no such text");
    std::ranges::transform(other, place.begin(), [](char c) { return std::byte(c); });
    test::seal(bytes);
    return bytes;
  };
  const std::string means_nothing = "what means nothing";
  expect_damaged(means_nothing, with_text("500000.1,", "500001.1,"));
  expect_damaged(means_nothing, with_text("-30.0]", "-31.0]"));
  expect_damaged(means_nothing, with_text("\"areas\"", "\"acres\""));
  expect_damaged(means_nothing, with_text("\"lost\":null", "\"lost\":true"));
}

using ExportType = ExportSource;

TEST_F(ExportType, RoundsHeightsToIt) {
  Recipe recipe;
  recipe.type = "Float64";
  recipe.value = [](int x, int y) {
    return x == 7 && y == 9 ? 40000.0 : std::floor(hills(x, y) * 4) / 4;
  };
  make(source_, recipe);
  build();
  const auto exported = [&](const std::string& type, const std::vector<std::string>& more) {
    std::vector<std::string> all = {"export", store_, "-o",     made_,
                                    "--type", type,   "--json", "--overwrite"};
    all.insert(all.end(), more.begin(), more.end());
    return answer_of(all);
  };
  const nlohmann::json answer = exported("Int32", {});
  EXPECT_EQ(answer.at("certified_error"), 0.5);
  EXPECT_EQ(answer.at("exact"), false);
  const Whole whole = read_whole(made_);
  EXPECT_EQ(whole.type, "Int32");
  EXPECT_EQ(whole.nodata, -9999.0);
  std::int32_t first = 0;
  std::memcpy(&first, whole.samples.data(), sizeof first);
  EXPECT_EQ(first, std::lround(std::floor(hills(0, 0) * 4) / 4));
  EXPECT_EQ(exported("Float64", {}).at("exact"), true);
  const auto before = folder_.names();
  expect_refusal(
      run_ptin({"export", store_, "-o", folder_.file("no.tif"), "--type", "Int16", "-q"}), 2,
      "40000");
  EXPECT_EQ(folder_.names(), before);
  EXPECT_EQ(exported("Int16", {"--window", "501000", "3998500", "502000", "3999500"}).at("exact"),
            false);
  EXPECT_EQ(read_whole(made_).type, "Int16");
}

TEST_F(ExportType, ChoosesANodataThatNoHeightIsRoundedTo) {
  Recipe recipe;
  recipe.type = "Float32";
  recipe.value = [](int x, int y) { return x == 7 && y == 9 ? -9998.75 : std::floor(hills(x, y)); };
  make(source_, recipe);
  build();
  expect_done({"export", store_, "-o", made_, "--type", "Int16", "-q"});
  EXPECT_EQ(read_whole(made_).nodata, -32768.0);
  expect_done({"export", store_, "-o", made_, "--type", "Float64", "-q", "--overwrite"});
  EXPECT_EQ(read_whole(made_).nodata, -9999.0);
}

TEST_F(ExportType, LeavesNoVoidAHeightNorAHeightAVoid) {
  Recipe recipe;
  recipe.type = "Float32";
  recipe.nodata = 5.0;
  const auto exported = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = {"export", store_,  "-o",          made_,
                                    "--type", "Int16", "--overwrite", "-q"};
    all.insert(all.end(), more.begin(), more.end());
    return run_ptin(all);
  };
  // -9998.7 would be rounded to -9999; heights from -32768 up leave the largest number alone.
  for (const auto& [least, nodata] :
       std::vector<std::pair<double, double>>{{-9000, -9999}, {-9998.7, -32768}, {-32768, 32767}}) {
    recipe.value = [least = least](int x, int y) {
      return x > 3 && x < 9 && y < 9 ? 5.0 : least + (x + y) % 9 * (x == 50 ? 3000 : 1);
    };
    make(source_, recipe);
    build();
    EXPECT_EQ(exported({}).status, 0);
    EXPECT_EQ(read_whole(made_).nodata, nodata);
  }
  for (const char* none : {"nan", "1e30", "-9999.5", "-32769"}) {
    expect_refusal(exported({"--nodata", none}), 2, "no Int16 is");
  }
  EXPECT_EQ(exported({"--nodata", "77"}).status, 0);
  std::filesystem::remove(made_);
  // A height that were told as none would be lost.
  expect_refusal(exported({"--nodata", "-32767"}), 2, "a pixel has the height -32767,");
  EXPECT_FALSE(std::filesystem::exists(made_));
  recipe.value = [](int x, int y) { return x == 0 ? (y == 0 ? -32768 : 32767) : 5.5 + x; };
  make(source_, recipe);
  build();
  expect_refusal(exported({}), 2, "take up all of Int16");
}

}  // namespace
}  // namespace ptin::tools
