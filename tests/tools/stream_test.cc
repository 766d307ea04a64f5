// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin stream and unstream, end to end on small real terrains.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/query/stream/stream_writer.h"
#include "tests/support/share_of_cases.h"
#include "tests/tools/mesh_reader.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::Outcome;
using testing::read_file;
using testing::ReadMesh;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

class StreamCli : public ::testing::Test {
 protected:
  void build(const std::string& name) { (void)testing::built(folder, name, "t.ptin"); }
  [[nodiscard]] std::string file(const std::string& name) const { return folder.file(name); }
  json answer(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out, nullptr, false);
  }
  /// Triangles by their corners' coordinates, sorted.
  std::vector<std::array<double, 9>> triangles(const std::string& name) {
    const ReadMesh mesh = testing::read_ply(read_file(file(name)));
    std::vector<std::array<double, 9>> all;
    for (const auto& t : mesh.triangles) {
      std::array<std::array<double, 3>, 3> c{};
      for (std::size_t i = 0; i < 3; ++i) c[i] = mesh.vertices[t[i]];
      std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
      all.push_back(
          {c[0][0], c[0][1], c[0][2], c[1][0], c[1][1], c[1][2], c[2][0], c[2][1], c[2][2]});
    }
    std::sort(all.begin(), all.end());
    return all;
  }
  TestFolder folder;
};

TEST_F(StreamCli, BringsTheSameMeshAsRefineInFewBytes) {
  for (const char* name : {"mountains_257.tif", "coast_257.tif"}) {
    build(name);
    const json sent = answer({"stream", file("t.ptin"), "--error", "2", "-o", file("s.pts")});
    EXPECT_EQ(sent.at("bytes"), std::filesystem::file_size(file("s.pts")));
    EXPECT_LE(sent.at("bytes").get<double>(), 6.0 * sent.at("splits").get<double>());
    const json got = answer({"unstream", file("s.pts"), "-o", file("s.ply")});
    EXPECT_TRUE(got.at("complete"));
    EXPECT_EQ(got.at("splits"), sent.at("splits"));
    const json refined = answer({"refine", file("t.ptin"), "--error", "2", "-o", file("r.ply")});
    EXPECT_EQ(got.at("vertices"), refined.at("vertices"));
    EXPECT_EQ(got.at("certified_error"), refined.at("certified_error"));
    EXPECT_EQ(triangles("s.ply"), triangles("r.ply")) << name;
    EXPECT_EQ(testing::read_ply(read_file(file("s.ply"))).header,
              testing::read_ply(read_file(file("r.ply"))).header);
    for (const char* made : {"t.ptin", "s.pts", "s.ply", "r.ply"})
      std::filesystem::remove(file(made));
  }
}

/// Files without a name take what does not fit the memory.
TEST_F(StreamCli, IsTheSameInAnyMemory) {
  build("coast_257.tif");
  const std::string t = file("t.ptin");
  answer({"stream", t, "--have-error", "50", "-o", file("all.pts")});
  for (const char* threads : {"1", "2"}) {
    const Outcome small = run_ptin({"stream", t, "--have-error", "50", "-o", "-", "--memory", "4M",
                                    "--threads", threads, "--tmp", folder.file("")});
    EXPECT_EQ(small.status, 0) << small.err;
    EXPECT_TRUE(small.out == read_file(file("all.pts"))) << threads;
  }
  const Outcome lost =
      run_ptin({"stream", t, "-o", file("lost.pts"), "--memory", "4M", "--tmp", file("nowhere")});
  EXPECT_EQ(lost.status, 3) << lost.err;
  EXPECT_NE(lost.err.find("nowhere"), std::string::npos) << lost.err;
  EXPECT_FALSE(std::filesystem::exists(file("lost.pts")));
}

TEST_F(StreamCli, ACutStreamIsAMeshAndSaysHowToGetTheRest) {
  build("mountains_257.tif");
  const json sent = answer({"stream", file("t.ptin"), "--error", "1", "-o", file("s.pts")});
  write_file(file("cut.pts"), read_file(file("s.pts")).substr(0, 20000));
  const json cut = answer({"unstream", file("cut.pts"), "-o", file("cut.ply")});
  EXPECT_FALSE(cut.at("complete"));
  EXPECT_GT(cut.at("splits"), 1000);
  EXPECT_GT(cut.at("certified_error"), sent.at("certified_error"));
  const json same = answer(
      {"refine", file("t.ptin"), "--vertices", cut.at("vertices").dump(), "-o", file("same.ply")});
  EXPECT_EQ(triangles("cut.ply"), triangles("same.ply"));
  EXPECT_EQ(cut.at("certified_error"), same.at("certified_error"));

  const json rest = answer({"stream", file("t.ptin"), "--error", "1", "--have",
                            cut.at("have").dump(), "-o", file("rest.pts")});
  EXPECT_EQ(rest.at("splits").get<int>() + cut.at("splits").get<int>(),
            sent.at("splits").get<int>());
  const json whole = answer({"unstream", file("cut.pts"), file("rest.pts"), "-o", file("w.ply")});
  EXPECT_TRUE(whole.at("complete"));
  EXPECT_EQ(whole.at("certified_error"), sent.at("certified_error"));
  answer({"unstream", file("s.pts"), "-o", file("s.ply")});
  EXPECT_EQ(triangles("w.ply"), triangles("s.ply"));
  const Outcome told = run_ptin({"unstream", file("cut.pts")});
  EXPECT_NE(told.err.find("--have '"), std::string::npos) << told.err;
}

TEST_F(StreamCli, GoesOnFromWhatAReceiverHas) {
  build("mountains_257.tif");
  answer({"stream", file("t.ptin"), "--error", "20", "-o", file("a.pts")});
  const json info = answer({"info", file("t.ptin")});
  const json b = info.at("bounds");
  const double x = b.at("min_x"), y = b.at("min_y"), w = b.at("max_x").get<double>() - x;
  const std::vector<std::string> window = {std::to_string(x), std::to_string(y),
                                           std::to_string(x + w / 3), std::to_string(y + w / 3)};
  std::vector<std::string> more = {"stream", file("t.ptin"), "--have-error", "20",
                                   "-o",     file("b.pts"),  "--window"};
  more.insert(more.end(), window.begin(), window.end());
  const json sent = answer(more);
  const json all = answer({"unstream", file("a.pts"), file("b.pts"), "-o", file("ab.ply")});
  EXPECT_EQ(all.at("have").size(), 2u);
  EXPECT_EQ(all.at("splits"), sent.at("splits"));
  // Both in one pipe, and again: nothing is missing then.
  write_file(file("ab.pts"), read_file(file("a.pts")) + read_file(file("b.pts")));
  EXPECT_EQ(answer({"unstream", file("ab.pts")}).at("vertices"), all.at("vertices"));
  const json none = answer({"stream", file("t.ptin"), "--error", "20", "--have",
                            all.at("have").dump(), "-o", file("c.pts")});
  EXPECT_EQ(none.at("splits"), 0);
  EXPECT_TRUE(answer({"unstream", file("ab.pts"), file("c.pts")}).at("complete"));
}

TEST_F(StreamCli, WritesToStdoutAndReadsLevels) {
  build("mountains_257.tif");
  const Outcome piped =
      run_ptin({"stream", file("t.ptin"), "--level", "1200", "--error", "5", "-o", "-"});
  EXPECT_EQ(piped.status, 0) << piped.err;
  answer({"stream", file("t.ptin"), "--level", "1200", "--error", "5", "-o", file("s.pts")});
  EXPECT_EQ(piped.out, read_file(file("s.pts")));
  EXPECT_LT(answer({"unstream", file("s.pts")}).at("vertices"),
            answer({"refine", file("t.ptin"), "--error", "5", "-o", file("r.ply")}).at("vertices"));
}

TEST_F(StreamCli, TakesUpADeltaThatWasCut) {
  build("mountains_257.tif");
  const std::string t = file("t.ptin");
  const json all = answer({"stream", t, "-o", file("all.pts")});
  answer({"stream", t, "--error", "5", "-o", file("a.pts")});
  answer({"stream", t, "--error", "1", "--have-error", "5", "-o", file("b.pts")});
  const std::string delta = read_file(file("b.pts"));
  for (const std::size_t cut : test::some_of({std::size_t{0}, std::size_t{7}, delta.size() / 2})) {
    write_file(file("cut.pts"), delta.substr(0, cut));
    const json part = answer({"unstream", file("a.pts"), file("cut.pts")});
    answer({"stream", t, "--have", part.at("have").dump(), "-o", file("rest.pts"), "--overwrite"});
    const json whole = answer({"unstream", file("a.pts"), file("cut.pts"), file("rest.pts")});
    EXPECT_TRUE(whole.at("complete")) << cut;
    EXPECT_EQ(whole.at("vertices"), answer({"unstream", file("all.pts")}).at("vertices")) << cut;
  }
  EXPECT_GT(all.at("splits"), 1000);
}

TEST_F(StreamCli, RejectsARequestThatNobodyCanHaveMade) {
  build("mountains_257.tif");
  for (const char* metadata :
       {R"({"request":5})", R"({"request":null})", R"({"request":{"window":[1]}})",
        R"({"request":{"splits":"x"}})", R"({"request":[{},{}]})", "[]", "{"}) {
    StreamRequest request;
    request.wanted = error_above(20.0);
    request.metadata = metadata;
    std::string bytes;
    write_stream(OpenedTerrain(file("t.ptin")), request, [&](std::span<const std::byte> piece) {
      bytes.append(reinterpret_cast<const char*>(piece.data()), piece.size());
    });
    for (const std::size_t size : {bytes.size(), bytes.size() - 1}) {
      write_file(file("s.pts"), bytes.substr(0, size));
      const Outcome outcome = run_ptin({"unstream", file("s.pts")});
      EXPECT_EQ(outcome.status, 4) << metadata << ": " << outcome.err;
    }
  }
}

TEST_F(StreamCli, SaysWhatIsWrong) {
  build("mountains_257.tif");
  answer({"stream", file("t.ptin"), "--error", "5", "-o", file("s.pts")});
  answer({"stream", file("t.ptin"), "--have-error", "9", "-o", file("delta.pts")});
  const auto refused = [&](const std::vector<std::string>& arguments, int status,
                           const char* word) {
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, status) << outcome.err;
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
  };
  const std::string t = file("t.ptin");
  refused({"stream", t, "-o", file("s.pts")}, 2, "--overwrite");
  refused({"stream", t, "-o", "-", "--json"}, 2, "--json");
  refused({"stream", t, "--error", "-1", "-o", file("x.pts")}, 2, "--error: must be a number >= 0");
  refused({"stream", t, "--window", "9", "9", "1", "1", "-o", file("x.pts")}, 2, "inverted");
  refused({"stream", t, "--have", "{]", "-o", file("x.pts")}, 2, "JSON");
  refused({"stream", t, "--have", "[{\"windows\":1}]", "-o", file("x.pts")}, 2, "windows");
  refused({"stream", t, "--memory", "100K", "-o", file("x.pts")}, 7, "limit");
  refused({"unstream", file("nothing.pts")}, 3, "nothing.pts");
  refused({"unstream", t}, 2, "t.ptin: this is a store, not a stream");
  refused({"unstream", file("s.pts"), t}, 2, "this is a store, not a stream");
  for (const char* command : {"info", "verify", "highest"}) {
    refused({command, file("s.pts")}, 2, "s.pts: this is a stream, not a store");
  }
  write_file(file("prose.pts"), "It was a dark and stormy night.");
  refused({"unstream", file("prose.pts")}, 2, "not a stream of ptin: it begins like a text");
  write_file(file("nothing.bin"), "");
  refused({"unstream", file("nothing.bin")}, 2, "not a stream of ptin: it is empty");
  refused({"unstream", PTIN_TEST_DATA "/mountains_257.tif"}, 2, "it begins like a TIFF");
  std::string headless = read_file(file("s.pts"));
  headless[3] ^= 1;
  write_file(file("headless.pts"), headless);
  refused({"unstream", file("headless.pts")}, 4, "it is damaged");
  write_file(file("behind.pts"), read_file(file("s.pts")) + "It was a dark and stormy night.");
  refused({"unstream", file("behind.pts")}, 4, "it is damaged");
  refused({"unstream", file("delta.pts")}, 4, "goes on from another");
  refused({"unstream", file("s.pts"), file("s.pts")}, 4, "begins anew");
  refused({"unstream", file("s.pts"), file("delta.pts")}, 4, "another mesh");
  refused({"unstream", file("s.pts"), "-o", file("x.xyz")}, 2, "xyz");
  write_file(file("short.pts"), read_file(file("s.pts")).substr(0, 100));
  refused({"unstream", file("short.pts")}, 4, "before T0");
  std::string bytes = read_file(file("s.pts"));
  bytes[bytes.size() / 2] ^= 1;
  write_file(file("bad.pts"), bytes);
  refused({"unstream", file("bad.pts")}, 4, "checksum");
  EXPECT_FALSE(std::filesystem::exists(file("x.pts")));
}

}  // namespace
}  // namespace ptin::tools
