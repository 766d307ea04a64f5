// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `ptin unstream` says of its answer: exact only where the streams hold all of it, and a
// warning where none does.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::expect_done;
using testing::Outcome;
using testing::run_ptin;
using testing::TestFolder;

/// Hills of 35 to 165.
class StreamCertificate : public ::testing::Test {
 protected:
  StreamCertificate() {
    testing::make_raster(folder_.file("t.tif"), {});
    expect_done({"build", folder_.file("t.tif"), "-o", folder_.file("t.ptin"), "-q"});
  }
  void stream(const std::vector<std::string>& what) const {
    std::vector<std::string> all = {"stream", folder_.file("t.ptin"), "-o", stream_, "-q"};
    all.insert(all.end(), what.begin(), what.end());
    expect_done(all);
  }
  [[nodiscard]] Outcome received(const std::vector<std::string>& more) const {
    std::vector<std::string> all = {"unstream", stream_, "--overwrite", "--json"};
    all.insert(all.end(), more.begin(), more.end());
    Outcome outcome = run_ptin(all);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome;
  }
  void expect_exact(const std::vector<std::string>& more, const json& certified_for) const {
    const Outcome outcome = received(more);
    const json answer = json::parse(outcome.out);
    EXPECT_EQ(answer.at("exact"), true);
    EXPECT_EQ(answer.at("certified_for"), certified_for);
    EXPECT_EQ(outcome.err.find("warning"), std::string::npos) << outcome.err;
  }
  void expect_warning(const std::vector<std::string>& more, const json& certified_for) const {
    const Outcome outcome = received(more);
    const json answer = json::parse(outcome.out);
    EXPECT_EQ(answer.at("exact"), false);
    EXPECT_EQ(answer.at("certified_for"), certified_for);
    EXPECT_NE(outcome.err.find("warning"), std::string::npos) << outcome.err;
  }
  TestFolder folder_;
  std::string stream_ = folder_.file("s.pts"), mesh_ = folder_.file("x.ply"),
              lines_ = folder_.file("l.geojson");
};

TEST_F(StreamCertificate, OfLevelsHoldsForTheirIsolinesAlone) {
  stream({"--level", "80", "120"});
  const json levels = {{"levels", {80.0, 120.0}}};
  expect_exact({"--level", "80", "-o", lines_}, levels);
  expect_exact({"--level", "80", "120", "-o", lines_}, levels);
  expect_warning({"--level", "100", "-o", lines_}, levels);
  expect_warning({"--level", "80", "100", "-o", lines_}, levels);
  expect_warning({"-o", mesh_}, levels);
  EXPECT_EQ(received({"-o", mesh_, "-q"}).err, "");
}

TEST_F(StreamCertificate, OfAWindowHoldsInItAlone) {
  const std::vector<std::string> window = {"500200", "3999300", "500600", "3999700"};
  stream({"--window", window[0], window[1], window[2], window[3]});
  const json certified = {{"window", {500200.0, 3999300.0, 500600.0, 3999700.0}}};
  expect_warning({"-o", mesh_}, certified);
  expect_exact(
      {"--level", "100", "-o", lines_, "--window", "500250", "3999350", "500550", "3999650"},
      certified);
  expect_warning(
      {"--level", "100", "-o", lines_, "--window", "500250", "3999350", "500650", "3999650"},
      certified);
}

TEST_F(StreamCertificate, OfAWholeTerrainHoldsEverywhere) {
  stream({});
  expect_exact({"-o", mesh_}, nullptr);
  expect_exact({"--level", "100", "-o", lines_}, nullptr);
}

TEST_F(StreamCertificate, OfAWindowAroundTheTerrainHoldsEverywhere) {
  stream({"--window", "0", "0", "1e6", "1e7"});
  const json certified = {{"window", {0.0, 0.0, 1e6, 1e7}}};
  expect_exact({"-o", mesh_}, certified);
  expect_exact({"--level", "100", "-o", lines_}, certified);
}

TEST_F(StreamCertificate, OfTwoStreamsHoldsForTheLevelsOfBoth) {
  stream({"--level", "80"});
  const std::string second = folder_.file("second.pts");
  expect_done({"stream", folder_.file("t.ptin"), "--level", "120", "--have-level", "80", "-o",
               second, "-q"});
  const Outcome outcome =
      run_ptin({"unstream", stream_, second, "--level", "80", "120", "-o", lines_, "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(json::parse(outcome.out).at("exact"), true);
  EXPECT_EQ(outcome.err.find("warning"), std::string::npos) << outcome.err;
}

TEST_F(StreamCertificate, SaysHowFarTheBorderOfVoidsMoved) {
  stream({"--error", "10"});
  const Outcome whole = received({"-o", mesh_});
  EXPECT_EQ(json::parse(whole.out).at("border_moved_at_most"), 0.0) << "a terrain without voids";

  testing::RasterRecipe holes;
  holes.value = [](int column, int row) { return column / 8 == 1 && row / 8 == 1 ? -9999.0 : row; };
  holes.nodata = -9999.0;
  testing::make_raster(folder_.file("h.tif"), holes);
  const std::string store = folder_.file("t.ptin");
  expect_done(
      {"build", folder_.file("h.tif"), "-o", store, "--void-slope", "0.25", "--overwrite", "-q"});
  expect_done({"stream", store, "-o", stream_, "--overwrite", "--error", "10", "-q"});
  const json sent = json::parse(
      run_ptin({"stream", store, "-o", folder_.file("u.pts"), "--error", "10", "--json"}).out);
  const json answer = json::parse(received({"-o", mesh_}).out);
  EXPECT_EQ(answer.at("border_moved_at_most"), sent.at("border_moved_at_most"));
  EXPECT_EQ(answer.at("border_moved_at_most"), answer.at("certified_error").get<double>() / 0.25);
}

// It holds everywhere, so nothing is to be warned of; it only is not the source.
TEST_F(StreamCertificate, OfACoarseTerrainIsNotExact) {
  stream({"--error", "10"});
  const Outcome outcome = received({"-o", mesh_});
  const json answer = json::parse(outcome.out);
  EXPECT_EQ(answer.at("exact"), false);
  EXPECT_TRUE(answer.at("certified_for").is_null());
  EXPECT_GT(answer.at("certified_error"), 0.0);
  EXPECT_EQ(outcome.err.find("warning"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace ptin::tools
