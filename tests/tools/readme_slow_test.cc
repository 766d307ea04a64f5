// SPDX-License-Identifier: GPL-3.0-or-later
//
// The commands that README.md and tools/API.md show, on a small terrain: they must do what stands
// there.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::spawn_ptin;
using testing::spawn_ptin_until;
using testing::TestFolder;

/// The words of the document's lines that begin "$ ptin", without comments; quotes are not used in
/// what is run.
std::vector<std::vector<std::string>> commands_of(const std::string& document) {
  std::ifstream text(PTIN_TEST_DATA "/../../" + document);
  std::vector<std::vector<std::string>> commands;
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with("$ ptin ")) continue;
    std::istringstream command(line.substr(7, line.find('#') - 7));
    std::vector<std::string> words;
    for (std::string word; command >> word;) words.push_back(word);
    commands.push_back(words);
  }
  return commands;
}

bool has_url(const std::vector<std::string>& words) {
  return std::any_of(words.begin(), words.end(),
                     [](const std::string& word) { return word.find("://") != std::string::npos; });
}

bool has_word(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

TEST(Readme, CommandsRun) {
  const TestFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::copy_file(testing::test_data("mountains_257.tif"), folder.file("dem.tif"));
  testing::write_file(folder.file("wells.csv"), "x,y\n381000,3803000\n382000,3802500\n");
  testing::write_file(
      folder.file("road.geojson"),
      R"({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name":
          "urn:ogc:def:crs:EPSG::32611"}}, "features": [{"type": "Feature", "properties": {},
          "geometry": {"type": "LineString", "coordinates": [[381000, 3803000], [382000, 3803500]]}}]})");
  std::filesystem::current_path(folder.path());
  std::vector<std::vector<std::string>> commands = commands_of("README.md");
  EXPECT_EQ(commands.size(), 3U);
  const auto questions = commands_of("tools/API.md");
  commands.insert(commands.end(), questions.begin(), questions.end());
  int run = 0;
  for (std::vector<std::string> words : commands) {
    // Pipes over ssh, a mosaic of hundreds of files, a layer and web servers are not here.
    if (has_word(words, "|") || has_word(words, "huge.vrt") || has_word(words, "wells.gpkg") ||
        has_url(words))
      continue;
    if (words[0] == "bench") words.insert(words.end(), {"--count", "1", "--seconds", "2"});
    std::string line;
    for (const std::string& word : words) line += word + " ";
    const bool is_service = words[0] == "serve";  // runs until it is told to end
    if (is_service) words.insert(words.end(), {"--listen", "127.0.0.1:0"});
    const auto outcome =
        is_service ? spawn_ptin_until("SIGTERM ends it", SIGTERM, words) : spawn_ptin(words);
    EXPECT_EQ(outcome.status, 0) << line << "\n" << outcome.err;
    EXPECT_EQ(outcome.err.find("warning"), std::string::npos) << line << outcome.err;
    ++run;
  }
  std::filesystem::current_path(before);
  EXPECT_GE(run, 21);
}

}  // namespace
}  // namespace ptin::tools
