// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines, meshes, and streams that come in pieces.
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/query/questions.h"
#include "tests/tools/program.h"
#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

TEST_F(Serve, DrawsIsolinesAsTheLibraryDoes) {
  const Window w = middle_of_bounds(*mountains_, 0.3);
  IsolineRequest request;
  request.levels = {800, 1000};
  request.region = w;
  request.detail.tolerance = 2;
  const Isolines expected = mountains_->isolines(request);
  const json told =
      get(in("mountains", "isolines?crs=native&level=800,1000&error=2&bbox=" + window_text(w)))
          .json();
  ASSERT_EQ(told["features"].size(), expected.size());
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Isoline line = expected.line(i, points);
    const json& feature = told["features"][i];
    expect_number(feature["properties"]["elev"], expected.levels()[line.level]);
    ASSERT_EQ(feature["geometry"]["coordinates"].size(), line.points.size());
    for (std::size_t j = 0; j < line.points.size(); ++j) {
      expect_number(feature["geometry"]["coordinates"][j][0], line.points[j].x);
      expect_number(feature["geometry"]["coordinates"][j][1], line.points[j].y);
    }
  }
}

TEST_F(Serve, HasNoLinesAtNoLevels) {
  for (const std::string none : {"", "[]"}) {
    const HttpAnswer answer = get(in("mountains", "isolines?level=" + none));
    EXPECT_EQ(answer.status, 200) << answer.body;
    EXPECT_EQ(answer.json()["features"], json::array());
  }
}

TEST_F(Serve, GivesMeshesAndStreamsAsTheProgramDoes) {
  const Window w = middle_of_bounds(*mountains_, 0.25);
  const std::string window = window_text(w);
  const std::string file = folder_->file("mesh.ply");
  const auto number = [](double v) { return json(v).dump(); };
  expect_done({"refine", files_[0].path, "--window", number(w.min_x), number(w.min_y),
               number(w.max_x), number(w.max_y), "--clip", "--error", "3", "-o", file});
  const HttpAnswer ply = get(in("mountains", "mesh?crs=native&f=ply&error=3&bbox=" + window));
  EXPECT_EQ(ply.body, read_file(file));
  EXPECT_EQ(ply.header("ptin-certified-error"), "3");
  const HttpAnswer glb = get(in("mountains", "mesh?error=20"));
  EXPECT_EQ(glb.header("content-type"), "model/gltf-binary");
  EXPECT_EQ(glb.body.substr(0, 4), "glTF");

  const std::string whole = folder_->file("whole.pts");
  expect_done({"stream", files_[0].path, "--error", "3", "-o", whole});
  EXPECT_EQ(get(in("mountains", "stream?error=3&max_bytes=4000000")).body, read_file(whole));
}

TEST_F(Serve, SendsStreamsInPiecesThatGoOn) {
  const Terrain& terrain = *mountains_;
  StreamReader reader("stream");
  json have = json::array();
  int pieces = 0;
  const auto take = [&](const HttpAnswer& answer) {
    ASSERT_EQ(answer.status, 200) << answer.body;
    EXPECT_LE(answer.body.size(), 30000U);
    std::size_t at = 0;
    const auto bytes = std::as_bytes(std::span(answer.body));
    while (at < bytes.size()) at += reader.feed(bytes.subspan(at));
    EXPECT_EQ(answer.header("ptin-splits"), std::to_string(reader.splits()));
    EXPECT_EQ(json::parse(answer.header("ptin-certified-error")).get<double>(),
              reader.certificate().error);
    have.push_back({{"error", 1.0}, {"splits", reader.splits()}});
    ++pieces;
  };
  take(get(in("mountains", "stream?error=1&max_bytes=30000")));
  for (; !reader.is_complete() && pieces < 30 && !HasFatalFailure();) {
    reader.begin_next();
    take(served_->post(in("mountains", "stream"),
                       {{"error", 1.0}, {"max_bytes", 30000}, {"have", have}}));
  }
  EXPECT_GT(pieces, 1);
  ASSERT_TRUE(reader.is_complete());
  RefineRequest request;
  request.detail.tolerance = 1.0;
  const RefinedTin expected = terrain.refine(request);
  EXPECT_EQ(reader.tin().vertices.size(), expected.vertices);
  EXPECT_EQ(reader.tin().triangles.size(), expected.triangles);
}

/// Not refused, as it was: how long a piece is, the service decides.
TEST(ServeSmall, SendsShorterPiecesWhereMemoryIsShort) {
  TestFolder folder;
  serve::ServeOptions options = serve_options(folder);
  options.question.question_memory = 16 << 20;
  ServedTerrains served(options);
  const std::string stream = "/collections/mountains/stream";
  StreamReader reader("stream");
  json have = json::array();
  for (const int most_bytes : {30000, 256000}) {
    const HttpAnswer answer =
        served.post(stream, {{"error", 0.5}, {"have", have}, {"max_bytes", most_bytes}});
    ASSERT_EQ(answer.status, 200) << answer.body;
    const auto bytes = std::as_bytes(std::span(answer.body));
    for (std::size_t at = 0; at < bytes.size();) at += reader.feed(bytes.subspan(at));
    have.push_back({{"error", 0.5}, {"splits", reader.splits()}});
    EXPECT_GT(reader.splits(), 1000U);
    EXPECT_GT(reader.certificate().error, 0.5);  // There is more to ask for.
    if (!reader.is_complete()) reader.begin_next();
  }
}

/// The mesh that is held and the one that is sent are there together: 210 bytes a vertex.
TEST(ServeSmall, SendsPiecesUntilMemoryIsFull) {
  TestFolder folder;
  serve::ServeOptions options = serve_options(folder);
  options.question.question_memory = 20 << 20;
  ServedTerrains served(options);
  json have = json::array();
  double error = 1.0;
  for (int pieces = 0; error > 0 && pieces < 40; ++pieces) {
    const HttpAnswer answer = served.post("/collections/mountains/stream", {{"have", have}});
    ASSERT_EQ(answer.status, 200) << answer.body << have;
    const json splits = json::parse(answer.header("ptin-splits"));
    ASSERT_GT(splits, 0);
    have.push_back({{"splits", splits}});
    error = json::parse(answer.header("ptin-certified-error")).get<double>();
  }
  EXPECT_EQ(error, 0.0);
}

/// The number that it tells is what it keeps to, and no less than that.
TEST(ServeSmall, GoesOnFromAsManyVerticesAsItTells) {
  TestFolder folder;
  serve::ServeOptions options = serve_options(folder);
  options.question.question_memory = 8 << 20;
  ServedTerrains served(options);
  const std::string mountains = "/collections/mountains";
  const auto told = served.get(mountains).json()["limits"]["held_vertices"].get<std::size_t>();
  json have = json::array();
  std::size_t held = 0;
  HttpAnswer answer = served.post(mountains + "/stream", {{"have", have}});
  for (; answer.status == 200; answer = served.post(mountains + "/stream", {{"have", have}})) {
    const json splits = json::parse(answer.header("ptin-splits"));
    ASSERT_GT(splits, 0) << "all of the terrain fits: the memory is too large for this test";
    have.push_back({{"splits", splits}});
    held += splits.get<std::size_t>();
  }
  EXPECT_EQ(answer.status, 413);
  EXPECT_EQ(answer.json()["limit"], "question_memory");
  EXPECT_GT(held, told);
  EXPECT_LT(held, told + told / 10);
}

TEST_F(Serve, RefusesWhatAReceiverHadOfAnotherFile) {
  const HttpAnswer answer = served_->post(
      in("mountains", "stream"),
      {{"have", {{{"error", 5.0}, {"splits", 10}}}}, {"fingerprint", "0123456789abcdef"}});
  EXPECT_EQ(answer.status, 409);
  EXPECT_EQ(answer.json()["parameter"], "have");
}

}  // namespace
}  // namespace ptin::tools::testing
