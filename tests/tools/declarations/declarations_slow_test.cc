// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tables of tools/API.md, "What a source declares", against the program: each row has a source
// with the declaration and one without it, and says truly whether it is used, warned of or refused.
#include <map>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/declarations/declaration.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::Declaration;
using testing::Outcome;
using testing::run_ptin;
using testing::TestFolder;

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? ""
                                    : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

/// The tables' word for each declaration: `used`, `warned` or `refused`. A row is
/// "| `key` | what is declared | used: in words |".
std::map<std::string, std::string> documented() {
  std::istringstream text(testing::read_file(PTIN_TEST_DATA "/../../tools/API.md"));
  std::map<std::string, std::string> rows;
  bool within = false;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("## ")) within = line == "## What a source declares";
    if (!within || !line.starts_with("| `")) continue;
    const std::string key = line.substr(3, line.find('`', 3) - 3);
    const std::string last = trimmed(line.substr(line.rfind(" | ") + 3));
    EXPECT_FALSE(rows.contains(key)) << key << " has two rows";
    rows[key] = last.substr(0, last.find_first_of(": |"));
  }
  return rows;
}

std::vector<Declaration> all_declarations() {
  std::vector<Declaration> all;
  for (auto list : {testing::raster_declarations(), testing::las_declarations(),
                    testing::text_declarations(), testing::layer_declarations(),
                    testing::mesh_declarations(), testing::raster_format_declarations(),
                    testing::hidden_declarations(), testing::companion_declarations(),
                    testing::crs_declarations(), testing::depth_declarations()}) {
    all.insert(all.end(), list.begin(), list.end());
  }
  return all;
}

struct Built {
  Outcome build;
  json info;  ///< Facts of the terrain, less what is the file's own; null where there is none.
};

Built build_of(const Declaration& declaration, bool is_declared) {
  const TestFolder folder;
  std::vector<std::string> arguments = {"build"};
  for (std::string& a : declaration.write(folder, is_declared)) arguments.push_back(std::move(a));
  const std::string store = folder.file("built.ptin");
  arguments.insert(arguments.end(), {"-o", store});
  Built built{run_ptin(arguments), {}};
  if (built.build.status != 0) return built;
  built.info = json::parse(run_ptin({"info", store, "--json"}).out);
  for (const char* own : {"file", "bytes", "sections", "metadata"}) built.info.erase(own);
  return built;
}

void expect_used(const Built& without, const Built& with) {
  ASSERT_EQ(with.build.status, 0) << with.build.err;
  EXPECT_NE(with.info, without.info) << "what `ptin info` prints is the same";
}

/// The lines that warn of something else than that no CRS is declared, which most sources here lack.
std::string warnings_in(const std::string& err) {
  std::istringstream lines(err);
  std::string all;
  for (std::string line; std::getline(lines, line);) {
    const bool is_one = line.find("warning: ") != std::string::npos &&
                        line.find("no CRS is declared") == std::string::npos;
    all += is_one ? line + "\n" : "";
  }
  return all;
}

void expect_warned(const Built& without, const Built& with) {
  ASSERT_EQ(with.build.status, 0) << with.build.err;
  EXPECT_NE(warnings_in(with.build.err), "") << with.build.err;
  EXPECT_EQ(warnings_in(without.build.err), "");
}

void expect_refused(const Built& with) {
  EXPECT_EQ(with.build.status, 2) << with.build.err;
  EXPECT_NE(with.build.err.find("source."), std::string::npos)
      << "the file is not named: " << with.build.err;
}

// Each `write` names its file "source." with an extension, which a refusal has to tell.
TEST(SourceDeclarations, AreUsedWarnedOfOrRefusedAsTheTablesSay) {
  const auto rows = documented();
  for (const Declaration& declaration : all_declarations()) {
    SCOPED_TRACE(declaration.key);
    const auto row = rows.find(declaration.key);
    ASSERT_NE(row, rows.end()) << "tools/API.md has no row of it";
    const Built without = build_of(declaration, false);
    const Built with = build_of(declaration, true);
    EXPECT_EQ(without.build.status, 0) << without.build.err;
    if (row->second == "used") {
      expect_used(without, with);
    } else if (row->second == "warned") {
      expect_warned(without, with);
    } else if (row->second == "refused") {
      expect_refused(with);
    } else {
      ADD_FAILURE() << "neither used, warned nor refused: " << row->second;
    }
  }
}

TEST(SourceDeclarations, HaveACaseForEachRow) {
  std::set<std::string> cases;
  for (const Declaration& declaration : all_declarations()) {
    EXPECT_TRUE(cases.insert(declaration.key).second) << declaration.key << " has two cases";
  }
  for (const auto& [key, how] : documented()) {
    EXPECT_TRUE(cases.contains(key)) << "nothing tries " << key;
  }
}

}  // namespace
}  // namespace ptin::tools
