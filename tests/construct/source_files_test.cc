// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/source_files.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/construct/made_raster.h"

namespace ptin {
namespace {

bool names(const std::vector<std::string>& files, const std::string& file) {
  return std::find(files.begin(), files.end(), file) != files.end();
}

/// A raster of 4 x 4 samples as text, which needs no driver that writes.
void write_grid(const std::string& path, const std::string& corner) {
  oracle::write_text(path, "ncols 4\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 1\n" + corner +
                               " 2 3 4\n5 6 7 8\n9 10 11 12\n13 14 15 16\n");
}

void write_vrt(const std::string& path, const std::string& source) {
  oracle::write_text(
      path,
      "<VRTDataset rasterXSize=\"4\" rasterYSize=\"4\"><GeoTransform>0,1,0,4,0,-1</GeoTransform>"
      "<VRTRasterBand dataType=\"Int32\" band=\"1\"><SimpleSource>"
      "<SourceFilename relativeToVRT=\"0\">" +
          source +
          "</SourceFilename><SourceBand>1</SourceBand>"
          "<SrcRect xOff=\"0\" yOff=\"0\" xSize=\"4\" ySize=\"4\"/>"
          "<DstRect xOff=\"0\" yOff=\"0\" xSize=\"4\" ySize=\"4\"/>"
          "</SimpleSource></VRTRasterBand></VRTDataset>\n");
}

TEST(SourceFiles, AreThoseBehindAVrtOfAVrtAndBesideThem) {
  const oracle::ScratchFolder folder;
  const std::string grid = folder.file("grid.asc");
  write_grid(grid, "1");
  write_vrt(folder.file("inner.vrt"), grid);
  write_vrt(folder.file("outer.vrt"), folder.file("inner.vrt"));
  const auto files = [&] { return files_of_input(folder.file("outer.vrt")); };
  for (const char* name : {"outer.vrt", "inner.vrt", "grid.asc"}) {
    EXPECT_TRUE(names(files(), folder.file(name))) << name;
  }
  const auto before = input_fingerprint({folder.file("outer.vrt")});
  EXPECT_EQ(before, input_fingerprint({folder.file("outer.vrt")}));

  write_grid(grid, "1000");
  const auto after = input_fingerprint({folder.file("outer.vrt")});
  EXPECT_NE(before, after) << "a file behind the VRT has changed";

  oracle::write_text(grid + ".aux.xml",
                     "<PAMDataset><PAMRasterBand band=\"1\"><NoDataValue>5</NoDataValue>"
                     "</PAMRasterBand></PAMDataset>\n");
  EXPECT_TRUE(names(files(), grid + ".aux.xml"));
  EXPECT_NE(after, input_fingerprint({folder.file("outer.vrt")}));
}

TEST(SourceFiles, OfPointsAndOfWhatIsNoFileAreThemselves) {
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file("a.xyz"), "1 2 3\n");
  EXPECT_EQ(files_of_input(folder.file("a.xyz")), std::vector<std::string>{folder.file("a.xyz")});
  EXPECT_EQ(files_of_input("no such thing"), std::vector<std::string>{"no such thing"});
}

TEST(SourceFiles, OfAFolderHaveAnHonestSize) {
  const oracle::ScratchFolder folder;
  const std::string inner = folder.file("terrain.zarr");
  std::filesystem::create_directory(inner);
  const nlohmann::json fingerprint = input_fingerprint({inner});
  EXPECT_EQ(fingerprint[0][1][0][0], inner);
  EXPECT_LT(fingerprint[0][1][0][1], std::uint64_t{1} << 40) << fingerprint;
}

}  // namespace
}  // namespace ptin
