// SPDX-License-Identifier: GPL-3.0-or-later
//
// Questions of a file that lies elsewhere: the same answers, few rounds, and a clear word where the
// server fails.
#include <filesystem>
#include <string>
#include <vector>

#include <cpl_conv.h>
#include <gtest/gtest.h>

#include "tests/support/range_server.h"
#include "tests/tools/program.h"
#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

using test::RangeServer;

class RemoteTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!RangeServer::is_possible()) return;
    folder_ = new TestFolder;
    local_ = built(*folder_, "mountains_257.tif", "m.ptin");
    static_cast<void>(built(*folder_, "coast_257.tif", "m.ptin.other"));
    server_ = new RangeServer(folder_->path().string());
    CPLSetConfigOption("GDAL_HTTP_RETRY_DELAY", "0.01");
  }
  static void TearDownTestSuite() {
    CPLSetConfigOption("GDAL_HTTP_RETRY_DELAY", nullptr);
    delete server_;
    delete folder_;
    server_ = nullptr;
    folder_ = nullptr;
  }
  void SetUp() override {
    if (server_ == nullptr) GTEST_SKIP() << RangeServer::kNeeded;
    server_->take_counts();
  }
  [[nodiscard]] static std::string url(const std::string& mode) {
    return server_->url(mode + "/m.ptin");
  }

  static TestFolder* folder_;
  static RangeServer* server_;
  static std::string local_;
};
TestFolder* RemoteTest::folder_ = nullptr;
RangeServer* RemoteTest::server_ = nullptr;
std::string RemoteTest::local_;

/// What a question costs is not of the answer, and the name of the file is another one.
nlohmann::json answer_alone(const Outcome& outcome, const std::string& file,
                            const std::string& output) {
  std::string text = outcome.out;
  for (const std::string& name : {file, output}) {
    for (std::size_t at = 0; (at = text.find(name, at)) != std::string::npos;) {
      text.replace(at, name.size(), "NAME");
    }
  }
  nlohmann::json answer = nlohmann::json::parse(text);
  for (const char* name : {"cost", "base_cost", "remote", "seconds"}) answer.erase(name);
  if (answer.contains("pairs")) {
    for (nlohmann::json& pair : answer["pairs"]) pair.erase("cost");
  }
  return answer;
}

struct Question {
  std::vector<std::string> words;
  std::string output;  ///< Its suffix; empty: the answer is what is printed.
};

TEST_F(RemoteTest, AnswersEachQuestionAsALocalFileDoes) {
  TestFolder out;
  write_file(out.file("points.csv"),
             "x,y\n378000,3803000\n379000.5,3805001\n381000,3802000\n1,1\n");
  const std::string line = "LINESTRING(376900 3801000, 383500 3807500)";
  const std::vector<std::string> window{"--window", "378000", "3802000", "380000", "3804000"};
  const std::vector<Question> questions{
      {{"info"}, ""},
      {{"locate", "--points", out.file("points.csv")}, ""},
      {{"locate", "--points", out.file("points.csv"), "--error", "5"}, ""},
      {{"locate", "--points", out.file("points.csv"), "--by", "splits"}, ""},
      {{"locate", "--points", out.file("points.csv"), "--vertices", "500"}, ""},
      {{"refine", "--error", "5"}, ".ply"},
      {{"refine", window[0], window[1], window[2], window[3], window[4], "--clip"}, ".ply"},
      {{"refine", "--vertices", "900"}, ".obj"},
      {{"isoline", "--interval", "100"}, ".geojson"},
      {{"isoline", "--interval", "50", "--error", "5"}, ".geojson"},
      {{"render", "--size", "100", "100"}, ".png"},
      {{"highest"}, ""},
      {{"highest", "--lowest", window[0], window[1], window[2], window[3], window[4]}, ""},
      {{"profile", "--line", line}, ""},
      {{"profile", "--line", line, "--error", "10", "--stations", "250"}, ""},
      {{"volume", "--level", "1000"}, ""},
      {{"volume", "--against", "SELF"}, ""},
      {{"viewshed", "381000", "3803000", "2", "--radius", "1500"}, ".tif"},
      {{"export", "--error", "2"}, ".ply"},
      {{"export", "--what", "slope"}, ".tif"},
      {{"stream", "--error", "20"}, ".ptins"},
  };
  int number = 0;
  for (const Question& q : questions) {
    std::vector<nlohmann::json> answers;
    std::vector<std::string> outputs;
    for (const std::string& file : {local_, url("plain")}) {
      std::vector<std::string> words = q.words;
      for (std::string& word : words) {
        if (word == "SELF") word = file;
      }
      words.insert(words.begin() + 1, file);
      words.push_back("--json");
      const std::string output = out.file("out" + std::to_string(number++) + q.output);
      if (!q.output.empty()) words.insert(words.end(), {"-o", output});
      const Outcome outcome = run_ptin(words);
      ASSERT_EQ(outcome.status, 0) << words[0] << ": " << outcome.err;
      answers.push_back(answer_alone(outcome, file, output));
      outputs.push_back(q.output.empty() ? "" : read_file(output));
    }
    EXPECT_EQ(answers[0], answers[1]) << q.words[0];
    EXPECT_TRUE(outputs[0] == outputs[1]) << q.words[0] << ": the outputs differ";
  }
  // Lines of sight take their ends behind the file.
  const std::vector<std::string> ends{"376904",  "3804594", "20",    "381569",
                                      "3802757", "20",      "--json"};
  std::vector<nlohmann::json> answers;
  for (const std::string& file : {local_, url("plain")}) {
    std::vector<std::string> words{"sight", file};
    words.insert(words.end(), ends.begin(), ends.end());
    answers.push_back(answer_alone(run_ptin(words), file, "-"));
  }
  EXPECT_EQ(answers[0], answers[1]);
}

/// The cost of an answer, and what the server counted: with the opening.
struct Cost {
  std::uint64_t rounds, requests, bytes;
};
Cost cost_of(const std::vector<std::string>& words) {
  const nlohmann::json cost = answer_of(words)["cost"];
  return {cost["remote_rounds"], cost["remote_requests"], cost["remote_bytes"]};
}

TEST_F(RemoteTest, AsksTheServerInFewRounds) {
  const nlohmann::json info = answer_of({"info", url("plain"), "--json"});
  EXPECT_EQ(info["remote"]["rounds"], 1);
  EXPECT_EQ(info["remote"]["requests"], 1);
  RangeServer::Counts counts = server_->take_counts();
  EXPECT_EQ(counts.requests, 1U);
  EXPECT_EQ(counts.bytes, info["remote"]["bytes"]);

  const std::vector<std::string> at{"--point", "379000", "3804000"};
  TestFolder out;
  write_file(out.file("point.csv"), "x,y\n379000,3804000\n");
  const Cost point = cost_of({"locate", url("plain"), "--points", out.file("point.csv"), "--json"});
  counts = server_->take_counts();
  EXPECT_EQ(counts.requests, point.requests + 1);
  EXPECT_EQ(counts.bytes, point.bytes + (std::uint64_t{64} << 10));
  // A page of heights: the root above them comes with the front.
  EXPECT_EQ(point.rounds, 1U);
  EXPECT_EQ(point.requests, 1U);
  EXPECT_EQ(point.bytes, std::uint64_t{4} << 10);
  // By stars the index of so small a file does, too.
  const Cost by_stars = cost_of(
      {"locate", url("plain"), "--points", out.file("point.csv"), "--json", "--by", "stars"});
  EXPECT_EQ(by_stars.rounds, 1U);
  EXPECT_LE(by_stars.requests, 8U);
  EXPECT_LE(by_stars.bytes, std::uint64_t{48} << 10);
  server_->take_counts();

  const Cost window = cost_of({"refine", url("plain"), "--window", "379000", "3803900", "379300",
                               "3804200", "--clip", "-o", out.file("w.ply"), "--json"});
  counts = server_->take_counts();
  EXPECT_EQ(counts.requests, window.requests + 1);
  EXPECT_EQ(window.rounds, 1U);
  EXPECT_LE(window.requests, 3U);
  EXPECT_LE(window.bytes, std::uint64_t{40} << 10);
}

TEST_F(RemoteTest, KeepsWhatWasReadInAFolder) {
  const TestFolder cache;
  const std::vector<std::string> words{"highest", url("plain"), "--cache-folder",
                                       cache.path().string(), "--json"};
  EXPECT_GT(cost_of(words).requests, 0U);
  EXPECT_EQ(cost_of(words).requests, 0U);
  ASSERT_EQ(cache.names().size(), 1U);
  // Another file under the same name has another cache: it is never out of date.
  std::vector<std::string> other = words;
  other[1] = server_->url("plain/m.ptin.other");
  EXPECT_GT(cost_of(other).requests, 0U);
  EXPECT_EQ(cache.names().size(), 2U);
}

TEST_F(RemoteTest, KeepsToTheMemoryOfItsCache) {
  TestFolder out;
  const nlohmann::json cost = answer_of(
      {"refine", url("plain"), "--remote-cache", "1M", "-o", out.file("a.ply"), "--json"})["cost"];
  EXPECT_GE(cost["remote_rounds"], 4) << "a quarter of the cache a round";
  EXPECT_TRUE(read_file(out.file("a.ply")) == [&] {
    expect_done({"refine", local_, "-o", out.file("b.ply")});
    return read_file(out.file("b.ply"));
  }());
}

TEST_F(RemoteTest, NeverMixesTwoObjects) {
  TestFolder out;
  for (const char* mode : {"replaced", "swapped", "weak", "shifted"}) {
    for (int from = 1; from < 4; ++from) {
      const std::string name = std::string(mode) + "-" + std::to_string(from);
      const Outcome outcome =
          run_ptin({"refine", url(name), "-o", out.file(name + ".ply"), "--remote-cache", "1M"});
      EXPECT_NE(outcome.status, 0) << name;
      EXPECT_NE(outcome.err.find(url(name)), std::string::npos) << outcome.err;
      EXPECT_FALSE(std::filesystem::exists(out.file(name + ".ply"))) << name;
      if (std::string(mode) == "shifted") break;
    }
  }
  expect_done({"refine", server_->url("replaced-0/m.ptin"), "-o", out.file("whole.ply")});
}

/// Where the server tells nothing, and both have one length, checksums tell.
TEST_F(RemoteTest, KnowsAnObjectByItsPages) {
  std::string bytes = read_file(local_);
  write_file(folder_->file("e.ptin"), bytes);
  for (std::size_t at = bytes.size() / 4; at < bytes.size(); at += 4096) bytes[at] ^= 1;
  write_file(folder_->file("e.ptin.other"), bytes);
  const TestFolder out;
  const Outcome outcome =
      run_ptin({"refine", server_->url("swapped-1/e.ptin"), "-o", out.file("e.ply")});
  EXPECT_EQ(outcome.status, 4);
  EXPECT_NE(outcome.err.find("does not match the checksum"), std::string::npos) << outcome.err;
}

TEST_F(RemoteTest, IsServed) {
  serve::ServeOptions options = serve_options(*folder_);
  options.files.push_back({"far", url("replaced-3")});
  options.offers_files = true;
  ServedTerrains service(options);
  const std::string place =
      "/position?coords=" + encoded("POINT(379010 3804020)") + "&crs=native&f=csv";
  const HttpAnswer near = service.get("/collections/mountains" + place);
  const HttpAnswer far = service.get("/collections/far" + place);
  EXPECT_EQ(near.status, 200) << near.body;
  EXPECT_EQ(far.status, 200) << far.body;
  EXPECT_EQ(near.body, far.body);
  EXPECT_NE(far.header("server-timing").find("remote_rounds=1 "), std::string::npos);
  EXPECT_EQ(service.get("/collections/far/file").status, 403);
  // The object is another one by now: the question that meets it fails, the next ones are of it.
  const auto extent_of = [&](const std::string& name) {
    return nlohmann::json::parse(service.get("/collections/" + name).body)["extent"];
  };
  EXPECT_EQ(extent_of("far"), extent_of("mountains"));
  int failed = 0;
  for (int i = 0; i < 6 && failed == 0; ++i) {
    const std::string at = "POINT(" + std::to_string(377500 + 900 * i) + " 3806000)";
    failed = service.get("/collections/far/position?coords=" + encoded(at) + "&crs=native").status;
    failed = failed == 200 ? 0 : failed;
  }
  EXPECT_EQ(failed, 500);
  EXPECT_EQ(extent_of("far"), extent_of("coast"));
}

TEST_F(RemoteTest, TellsWhatIsWrongWithAServer) {
  const auto words_of = [&](const std::string& mode) {
    const Outcome outcome = run_ptin({"info", url(mode)});
    EXPECT_NE(outcome.status, 0) << mode;
    return outcome.err;
  };
  EXPECT_NE(words_of("whole").find("no ranges"), std::string::npos);
  EXPECT_NE(words_of("missing").find("no such object"), std::string::npos);
  EXPECT_NE(words_of("down").find("503; 5 tries"), std::string::npos);
  EXPECT_EQ(run_ptin({"info", url("busy-2")}).status, 0);
  EXPECT_NE(run_ptin({"verify", url("plain")}).err.find("copy it"), std::string::npos);
}

}  // namespace
}  // namespace ptin::tools::testing
