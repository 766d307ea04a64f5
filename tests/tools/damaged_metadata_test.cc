// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stores and streams whose metadata is JSON that no build writes, every checksum right: a question
// says so and ends, however deep it is nested.
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/query/stream/stream_format.h"
#include "storage/sample_heights.h"
#include "storage/store_file.h"
#include "storage/store_writer.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::expect_done;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

/// So deep that a function that calls itself for each level has no stack for it.
constexpr int kDeep = 100000;
std::string deep_list() { return repeated("[", kDeep) + repeated("]", kDeep); }
std::string deep_crs() {
  return R"({"crs":)" + repeated(R"({"a":)", kDeep) + "1" + repeated("}", kDeep) + "}";
}

class DamagedMetadata : public ::testing::Test {
 protected:
  DamagedMetadata() {
    testing::make_raster(folder_.file("t.tif"), {});
    expect_done({"build", folder_.file("t.tif"), "-o", folder_.file("t.ptin"), "-q"});
  }
  /// The store with other metadata.
  void write_store(const std::string& metadata) const {
    std::filesystem::remove(bad_);
    const auto from = StoreFile::open(folder_.file("t.ptin"));
    StarredRecords records;
    IoCounters counters;
    SampleHeights samples;
    for (std::uint64_t i = 0; i < from->pages().page_count(); ++i)
      from->read_starred(PageId{i}, records, samples, counters);
    const auto writer = StoreWriter::create(bad_, {});
    const HeightEncoding& heights = from->facts().heights;
    writer->add_segment(pack_segment(records, heights, {}, from->facts().page_bytes), heights);
    writer->publish(from->facts(), from->t0(), metadata);
  }
  /// The stream with other metadata in its first frame.
  void write_stream(const std::string& metadata) const {
    const std::string sound = read_file(folder_.file("t.pts"));
    stream::FrameHead head{};
    std::memcpy(&head, sound.data() + sizeof(stream::Head), sizeof head);
    const std::size_t rest = sizeof(stream::Head) + sizeof head + head.bytes;
    std::string payload =
        sound.substr(sizeof(stream::Head) + sizeof head, sizeof(stream::Start)) + metadata;
    const std::uint64_t bytes = metadata.size();
    std::memcpy(payload.data() + offsetof(stream::Start, metadata_bytes), &bytes, sizeof bytes);
    head.bytes = static_cast<std::uint32_t>(payload.size());
    head.checksum = stream::checksum_of_frame(head, std::as_bytes(std::span(payload)));
    std::string frame(sizeof head, '\0');
    std::memcpy(frame.data(), &head, sizeof head);
    write_file(bad_, sound.substr(0, sizeof(stream::Head)) + frame + payload + sound.substr(rest));
  }
  void expect_corruption(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin() + 1, bad_);
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, 4) << arguments.front() << outcome.err;
    EXPECT_EQ(outcome.out, "") << arguments.front();
    EXPECT_EQ(testing::lines_in(outcome.err), 1U) << arguments.front() << outcome.err;
  }
  TestFolder folder_;
  std::string bad_ = folder_.file("bad");
};

TEST_F(DamagedMetadata, OfAStoreIsFoundByVerify) {
  for (const std::string& metadata : {std::string("[]"), deep_list(), deep_crs()}) {
    write_store(metadata);
    const Outcome outcome = run_ptin({"verify", bad_, "-q"});
    EXPECT_EQ(outcome.status, 1) << metadata.substr(0, 20) << outcome.err;
    EXPECT_NE(outcome.out.find("metadata"), std::string::npos) << outcome.out;
  }
}

TEST_F(DamagedMetadata, WithACrsThatNoOutputCanNameIsFoundByVerify) {
  const std::string sound(StoreFile::open(folder_.file("t.ptin"))->metadata_json());
  const std::string code = R"(,ID[\"EPSG\",)";
  ASSERT_NE(sound.find(code), std::string::npos) << sound;
  for (const bool is_damaged : {false, true}) {
    std::string metadata = sound;
    if (is_damaged) metadata[metadata.find(code) + 3] = ':';  // in the place of a bracket
    write_store(metadata);
    const Outcome outcome = run_ptin({"verify", bad_, "-q"});
    EXPECT_EQ(outcome.status, is_damaged ? 1 : 0) << outcome.out << outcome.err;
    EXPECT_EQ(outcome.out.find("CRS") != std::string::npos, is_damaged) << outcome.out;
  }
}

TEST_F(DamagedMetadata, OfAStoreNestedDeepIsACorruption) {
  for (const std::string& metadata : {deep_list(), deep_crs()}) {
    write_store(metadata);
    expect_corruption({"info", "--json"});
    expect_corruption({"locate", "500500", "3999500"});
    expect_corruption({"isoline", "--interval", "50", "-o", folder_.file("l.geojson")});
    expect_corruption({"stream", "-o", folder_.file("s.pts")});
  }
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"bad", "t.ptin", "t.tif"}));
}

TEST_F(DamagedMetadata, OfAStreamNestedDeepIsACorruption) {
  expect_done({"stream", folder_.file("t.ptin"), "-o", folder_.file("t.pts"), "-q"});
  write_stream(R"({"crs":null})");
  EXPECT_EQ(run_ptin({"unstream", bad_, "-q"}).status, 0) << "the frame is made as it should be";
  for (const std::string& metadata :
       {deep_list(), deep_crs(), R"({"request":)" + deep_list() + "}"}) {
    write_stream(metadata);
    expect_corruption({"unstream", "--json"});
    expect_corruption({"unstream", "-o", folder_.file("m.ply")});
  }
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"bad", "t.ptin", "t.pts", "t.tif"}));
}

nlohmann::json metadata_at(const std::string& path) {
  return nlohmann::json::parse(StoreFile::open(path)->metadata_json());
}

TEST_F(DamagedMetadata, QuestionsReadNoCrsWhereItsFactsStandInTheFile) {
  const std::string file = folder_.file("t.ptin");
  const std::string points = folder_.file("points.csv");
  const auto bounds = testing::answer_of({"info", file, "--json"}).at("bounds");
  const auto text = [](double v) { return std::to_string(v); };
  const std::string x =
      text((bounds.at("min_x").get<double>() + bounds.at("max_x").get<double>()) / 2);
  const std::string y =
      text((bounds.at("min_y").get<double>() + bounds.at("max_y").get<double>()) / 2);
  const std::string east = text(bounds.at("max_x").get<double>());
  write_file(points, "x,y\n" + x + "," + y + "\n");
  const std::vector<std::vector<std::string>> questions = {
      {"locate", file, x, y, "--json"},
      {"locate", file, "--points", points, "--json"},
      {"info", file, "--json"},
      {"highest", file, "--json"},
      {"refine", file, "--error", "1", "-o", folder_.file("a.ply"), "--overwrite", "--json"},
      {"sight", file, x, y, "2", east, y, "2", "--json"},
      {"isoline", file, "--interval", "5", "-o", folder_.file("a.geojson"), "--overwrite",
       "--json"},
      {"export", file, "-o", folder_.file("a.tif"), "--what", "slope", "--overwrite", "--json"}};
  std::vector<nlohmann::json> answers;
  const std::uint64_t before = crs_texts_read();
  for (const auto& question : questions) answers.push_back(testing::answer_of(question));
  EXPECT_EQ(crs_texts_read(), before);

  // An older file has the text alone, and gives the same answers.
  nlohmann::json metadata = metadata_at(file);
  ASSERT_EQ(metadata["crs"]["facts"]["code"], "EPSG:32611");
  metadata["crs"].erase("facts");
  write_store(metadata.dump());
  std::filesystem::rename(bad_, file);
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const nlohmann::json answer = testing::answer_of(questions[i]);
    for (const char* name : {"units", "crs", "points", "verdict", "height"}) {
      EXPECT_EQ(answer.value(name, nlohmann::json()), answers[i].value(name, nlohmann::json()))
          << questions[i][0];
    }
  }
  EXPECT_GT(crs_texts_read(), before);
}

TEST_F(DamagedMetadata, VerifyHoldsTheFactsOfTheCrsAgainstItsText) {
  nlohmann::json metadata = metadata_at(folder_.file("t.ptin"));
  expect_done({"verify", folder_.file("t.ptin")});
  metadata["crs"]["facts"]["ground"]["metres_per_map_unit"] = 0.3048;
  write_store(metadata.dump());
  const Outcome outcome = run_ptin({"verify", bad_});
  EXPECT_EQ(outcome.status, 1) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("the facts of its CRS are not those"), std::string::npos)
      << outcome.out;
}

}  // namespace
}  // namespace ptin::tools
