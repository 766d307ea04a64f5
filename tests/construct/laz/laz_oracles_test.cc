// SPDX-License-Identifier: GPL-3.0-or-later
//
// Two decoders of LAZ by others, which npm has, read the same records as ours.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/laz/compressed_records.h"
#include "tests/construct/laz/laz_file.h"
#include "tests/construct/laz/laz_points.h"
#include "tests/construct/laz/made_las.h"
#include "tests/construct/made_raster.h"

namespace ptin::laz {
namespace {

namespace fs = std::filesystem;

const fs::path kHere = fs::path(PTIN_TEST_DATA).parent_path() / "construct" / "laz";

std::string content_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Writes a file, and beside it what is read of it. Returns its path.
std::string written(const oracle::ScratchFolder& folder, const std::string& name,
                    const std::string& laz) {
  const std::vector<unsigned char> records = oracle::records_of(laz);
  std::ofstream(folder.file(name), std::ios::binary) << laz;
  std::ofstream(folder.file(name + ".bin"), std::ios::binary)
      .write(reinterpret_cast<const char*>(records.data()),
             static_cast<std::streamsize>(records.size()));
  return folder.file(name);
}

/// Files of the formats that both decoders know.
std::vector<std::string> made_files(const oracle::ScratchFolder& folder) {
  std::vector<std::string> files;
  for (const int format : {0, 1, 2, 3, 6, 7, 8}) {
    const std::string las = oracle::made_las(format, format % 2 * 3, 3000, 11);
    LazOptions options;
    options.compressor = format < 6 ? 2 : 3;
    options.chunk_records = 700;
    files.push_back(written(folder, std::to_string(format) + ".laz", laz_of(las, options)));
    options.chunks = {1, 1200, 2, 800, 997};
    files.push_back(written(folder, std::to_string(format) + "_varies.laz", laz_of(las, options)));
  }
  return files;
}

TEST(LazOracles, ReadTheSameRecords) {
  if (std::system("command -v node > /dev/null") != 0 || !fs::exists(kHere / "node_modules")) {
    GTEST_SKIP() << "needs node, and npm ci in tests/construct/laz";
  }
  const oracle::ScratchFolder folder(oracle::ScratchFolder::Size::kSmall);
  std::vector<std::string> files = made_files(folder);
  const fs::path shared = fs::path(PTIN_SHARED_DATA) / "laz";
  if (fs::exists(shared)) {
    for (const auto& entry : fs::directory_iterator(shared)) {
      if (entry.path().extension() == ".laz" && entry.path().stem() != "no-points-1.3") {
        files.push_back(
            written(folder, "real_" + entry.path().filename().string(), content_of(entry.path())));
      }
    }
  }
  std::string command = "node '" + (kHere / "oracles.mjs").string() + "'";
  for (const std::string& file : files) command += " '" + file + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

}  // namespace
}  // namespace ptin::laz
