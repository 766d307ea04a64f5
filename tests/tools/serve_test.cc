// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every question of the service against the library's own answer, and the service's manners.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/crs/ground.h"
#include "engine/query/terrain.h"
#include "tests/tools/serve_fixture.h"
#include "tools/facts/answers.h"
#include "tools/serve/config_file.h"
#include "tools/serve/limit_table.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

/// One service for all tests of this file: building takes longer than asking.
class Serve : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TestFolder>();
    serve::ServeOptions options = serve_options(*folder_);
    options.offers_files = true;
    options.cors_origin = "*";
    files_ = options.files;
    served_ = std::make_unique<ServedTerrains>(options);
    mountains_ = std::make_unique<Terrain>(files_[0].path);
    coast_ = std::make_unique<Terrain>(files_[1].path);
  }
  static void TearDownTestSuite() {
    coast_.reset();
    mountains_.reset();
    served_.reset();
    folder_.reset();
  }

  static Window bounds_of(const Terrain& terrain) {
    const StoreFacts& facts = terrain.store().facts();
    const MapPoint a = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
    const MapPoint b = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)};
  }
  /// Somewhere in a terrain, or just beside it.
  static MapPoint some_place(const Terrain& terrain, std::mt19937_64& random) {
    const Window w = bounds_of(terrain);
    std::uniform_real_distribution<double> share(-0.02, 1.02);
    return {w.min_x + share(random) * (w.max_x - w.min_x),
            w.min_y + share(random) * (w.max_y - w.min_y)};
  }
  static std::string text_of(const MapPoint& p) {
    return json(p.x).dump() + " " + json(p.y).dump();
  }
  static std::string window_text(const Window& w) {
    return json(w.min_x).dump() + "," + json(w.min_y).dump() + "," + json(w.max_x).dump() + "," +
           json(w.max_y).dump();
  }
  static Window middle_of_bounds(const Terrain& terrain, double share) {
    const Window w = bounds_of(terrain);
    const double x = (w.min_x + w.max_x) / 2, y = (w.min_y + w.max_y) / 2;
    return {x, y, x + share * (w.max_x - w.min_x), y + share * (w.max_y - w.min_y)};
  }
  static std::string in(const std::string& id, const std::string& what) {
    return "/collections/" + id + "/" + what;
  }
  static HttpAnswer get(const std::string& target, const std::string& headers = {}) {
    return served_->get(target, headers);
  }

  static std::unique_ptr<TestFolder> folder_;
  static std::vector<serve::ServedFile> files_;
  static std::unique_ptr<ServedTerrains> served_;
  static std::unique_ptr<Terrain> mountains_, coast_;
};

std::unique_ptr<TestFolder> Serve::folder_;
std::vector<serve::ServedFile> Serve::files_;
std::unique_ptr<ServedTerrains> Serve::served_;
std::unique_ptr<Terrain> Serve::mountains_, Serve::coast_;

void expect_number(const json& told, double number) {
  if (std::isnan(number)) {
    EXPECT_TRUE(told.is_null()) << told;
  } else {
    EXPECT_EQ(told.get<double>(), number);
  }
}

TEST_F(Serve, TellsHeightsAsTheLibraryDoes) {
  std::mt19937_64 random(20261123);
  for (const auto& [id, terrain] :
       {std::pair{"mountains", mountains_.get()}, {"coast", coast_.get()}}) {
    for (const char* level : {"", "&error=5", "&vertices=500"}) {
      std::vector<MapPoint> places;
      std::string wkt = "MULTIPOINT(";
      for (int i = 0; i < 40; ++i) {
        places.push_back(some_place(*terrain, random));
        wkt += (i == 0 ? "(" : ",(") + text_of(places.back()) + ")";
      }
      LocateRequest request;
      if (std::string(level) == "&error=5") request.detail.tolerance = 5.0;
      if (std::string(level) == "&vertices=500") request.detail.vertices = 500;
      const LocateResult expected = terrain->locate(places, request);
      const HttpAnswer answer =
          get(in(id, "position?crs=native&f=json&coords=" + encoded(wkt + ")") + level));
      ASSERT_EQ(answer.status, 200) << answer.body;
      const json told = answer.json();
      EXPECT_EQ(told["exact"], expected.exact);
      expect_number(told["certified_error"], expected.certified_error);
      for (std::size_t i = 0; i < places.size(); ++i) {
        const json& p = told["points"][i];
        EXPECT_EQ(p["state"], name_of(expected.points[i].state));
        expect_number(p["height"], expected.points[i].height);
        expect_number(p["height_min"], expected.points[i].height_min);
        expect_number(p["height_max"], expected.points[i].height_max);
      }
    }
  }
}

TEST_F(Serve, TakesLongitudeBeforeLatitudeInWktAndAfterItInLocations) {
  const json collection = get("/collections/mountains").json();
  const json box = collection["extent"]["spatial"]["bbox"][0];
  const double lon = (box[0].get<double>() + box[2].get<double>()) / 2;
  const double lat = (box[1].get<double>() + box[3].get<double>()) / 2;
  const std::string x = json(lon).dump(), y = json(lat).dump();
  const json point =
      get(in("mountains", "position?f=json&coords=" + encoded("POINT(" + x + " " + y + ")")))
          .json();
  const json elevation = get("/v1/mountains?locations=" + y + "," + x).json();
  EXPECT_EQ(point["points"][0]["state"], "surface");
  EXPECT_EQ(elevation["status"], "OK");
  EXPECT_EQ(elevation["results"][0]["location"]["lat"], lat);
  EXPECT_EQ(elevation["results"][0]["location"]["lng"], lon);
  EXPECT_EQ(elevation["results"][0]["elevation"], point["points"][0]["height"]);
  const json swapped = get("/v1/mountains?locations=" + x + "," + y).json();
  EXPECT_EQ(swapped["status"], "INVALID_REQUEST");
}

TEST_F(Serve, AnswersElevationsToClientsOfOthers) {
  const json collection = get("/collections/mountains").json();
  const json box = collection["extent"]["spatial"]["bbox"][0];
  const double lon = (box[0].get<double>() + box[2].get<double>()) / 2;
  const double lat = (box[1].get<double>() + box[3].get<double>()) / 2;
  const std::string a = json(lat).dump() + "," + json(lon).dump();
  const std::string b = json(lat + 0.01).dump() + "," + json(lon + 0.01).dump();
  const json two =
      get("/v1/mountains?locations=" + a + encoded("|") + b + "&interpolation=cubic").json();
  ASSERT_EQ(two["results"].size(), 2U);
  const json posted = served_->post("/v1/mountains", {{"locations", a + "|" + b}}).json();
  EXPECT_EQ(posted, two);
  const json form =
      served_
          ->ask("POST", "/v1/mountains", "Content-Type: application/x-www-form-urlencoded\r\n",
                "locations=" + encoded(a + "|" + b))
          .json();
  EXPECT_EQ(form, two);
  const json path =
      get("/v1/mountains?path=" + a + encoded("|") + b + "&samples=3&key=secret").json();
  ASSERT_EQ(path["results"].size(), 3U);
  EXPECT_EQ(path["results"][0], two["results"][0]);
  EXPECT_EQ(path["results"][2], two["results"][1]);
  // Outside of every collection: null by default, and what was asked for.
  const json outside = get("/v1/mountains,coast?locations=10,10").json();
  EXPECT_TRUE(outside["results"][0]["elevation"].is_null());
  EXPECT_EQ(outside["results"][0]["state"], "outside");
  EXPECT_EQ(
      get("/v1/mountains?locations=10,10&nodata_value=-9999").json()["results"][0]["elevation"],
      -9999.0);
  // The first one that has surface there answers.
  EXPECT_EQ(get("/v1/coast,mountains?locations=" + a).json()["results"][0]["dataset"], "mountains");
  // 38.5,-120.2 | 40.7,-120.95 | 43.252,-126.453: the example of the format's description.
  const json line =
      get("/v1/mountains?locations=" + encoded("enc:_p~iF~ps|U_ulLnnqC_mqNvxq`@")).json();
  ASSERT_EQ(line["results"].size(), 3U);
  EXPECT_NEAR(line["results"][2]["location"]["lat"].get<double>(), 43.252, 1e-9);
  EXPECT_NEAR(line["results"][2]["location"]["lng"].get<double>(), -126.453, 1e-9);
  EXPECT_EQ(get("/v1/mountains?locations=34.3").json()["status"], "INVALID_REQUEST");
  EXPECT_EQ(get("/v1/nobody?locations=34.3,1").json()["status"], "INVALID_REQUEST");
}

TEST_F(Serve, GivesCoveragesWithOneMeaningOfNull) {
  const Window w = bounds_of(*coast_);
  const std::string ring = "POLYGON((" + text_of({w.min_x, w.min_y}) + "," +
                           text_of({w.max_x, w.min_y}) + "," + text_of({w.max_x, w.max_y}) + "," +
                           text_of({w.min_x, w.min_y}) + "))";
  const HttpAnswer answer =
      get(in("coast", "area?crs=native&resolution-x=20&resolution-y=10&coords=" + encoded(ring)));
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(answer.header("content-type"), "application/prs.coverage+json");
  const json coverage = answer.json();
  const json& heights = coverage["ranges"]["height"];
  const json& states = coverage["ranges"]["state"]["values"];
  EXPECT_EQ(heights["shape"], (json{11, 21}));
  EXPECT_EQ(heights["values"].size(), 231U);
  EXPECT_EQ(coverage["domain"]["axes"]["x"]["num"], 21);
  std::set<int> seen;
  for (std::size_t i = 0; i < states.size(); ++i) {
    EXPECT_EQ(heights["values"][i].is_null(), states[i] != 0) << i;
    seen.insert(states[i].get<int>());
  }
  EXPECT_TRUE(seen.count(0) != 0 && seen.count(3) != 0);
  // A height of the grid is the height at that position.
  const double x = w.min_x + (w.max_x - w.min_x) * 18 / 20,
               y = w.min_y + (w.max_y - w.min_y) * 1 / 10;
  const json point = get(in("coast", "position?crs=native&f=json&coords=" +
                                         encoded("POINT(" + text_of({x, y}) + ")")))
                         .json();
  EXPECT_EQ(heights["values"][1 * 21 + 18], point["points"][0]["height"]);
}

TEST_F(Serve, WalksLinesAsTheLibraryDoes) {
  const Window w = bounds_of(*mountains_);
  const std::vector<MapPoint> line = {{w.min_x + 100, w.min_y + 100},
                                      {w.max_x - 77, w.max_y - 333}};
  ProfileRequest request;
  request.ground_distance = ground_of(crs_facts(mountains_->store())).distance;
  request.station_step = 500;
  request.detail.tolerance = 10;
  const ProfileResult expected = mountains_->profile(line, request);
  const std::string coords =
      encoded("LINESTRING(" + text_of(line[0]) + "," + text_of(line[1]) + ")");
  const json told =
      get(in("mountains", "profile?crs=native&stations=500&error=10&coords=" + coords)).json();
  ASSERT_EQ(told["points"].size(), expected.points.size());
  for (std::size_t i = 0; i < expected.points.size(); ++i) {
    expect_number(told["points"][i]["distance"], expected.points[i].distance);
    expect_number(told["points"][i]["height"], expected.points[i].height);
    EXPECT_EQ(told["points"][i]["station"], expected.points[i].is_station);
  }
  const json coverage =
      get(in("mountains", "trajectory?crs=native&error=10&coords=" + coords)).json();
  EXPECT_EQ(coverage["domain"]["domainType"], "MultiPoint");
  const std::string csv = get(in("mountains", "profile?crs=native&f=csv&coords=" + coords)).body;
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "line,distance,x,y,height,state,station");
}

TEST_F(Serve, DecidesLinesOfSightAsTheLibraryDoes) {
  std::mt19937_64 random(7);
  const Ground ground = ground_of(crs_facts(mountains_->store()));
  SightRequest request;
  request.curvature = {Curvature{}.coefficient, ground.earth_diameter};
  request.ground_distance = ground.distance;
  json pairs = json::array();
  std::vector<SightPair> all;
  for (int i = 0; i < 50; ++i) {
    const MapPoint a = some_place(*mountains_, random), b = some_place(*mountains_, random);
    all.push_back({a, 2.0, b, 30.0});
    pairs.push_back({a.x, a.y, 2.0, b.x, b.y, 30.0});
  }
  const json told =
      served_->post(in("mountains", "sight"), {{"crs", "native"}, {"pairs", pairs}}).json();
  ASSERT_EQ(told["pairs"].size(), all.size()) << told;
  SightSolver solver = mountains_->sight_lines(request);
  std::set<std::string> verdicts;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const SightResult expected = solver.solve(all[i]);
    // As the command line: null where an end has no ground that it is above.
    const bool is_defined = expected.verdict != SightVerdict::kUndefined;
    EXPECT_EQ(told["pairs"][i]["verdict"], is_defined ? json(name_of(expected.verdict)) : json());
    verdicts.insert(name_of(expected.verdict));
    if (expected.clearance_at) {
      expect_number(told["pairs"][i]["clearance"]["min"], expected.clearance_min);
    }
  }
  EXPECT_GE(verdicts.size(), 2U);
}

TEST_F(Serve, DrawsIsolinesAsTheLibraryDoes) {
  const Window w = middle_of_bounds(*mountains_, 0.3);
  IsolineRequest request;
  request.levels = {800, 1000};
  request.window = w;
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

TEST_F(Serve, RefusesWhatAReceiverHadOfAnotherFile) {
  const HttpAnswer answer = served_->post(
      in("mountains", "stream"),
      {{"have", {{{"error", 5.0}, {"splits", 10}}}}, {"fingerprint", "0123456789abcdef"}});
  EXPECT_EQ(answer.status, 409);
  EXPECT_EQ(answer.json()["parameter"], "have");
}

TEST_F(Serve, FindsTheHighestPointAndWhatIsSeenFromIt) {
  const HighestResult expected = mountains_->highest({});
  const json told = get(in("mountains", "highest?crs=native&listed=3")).json();
  EXPECT_EQ(told["features"].size(), 3U);
  const json& top = told["features"][0];
  expect_number(top["properties"]["height"], expected.point.height);
  const MapPoint eye{top["geometry"]["coordinates"][0].get<double>(),
                     top["geometry"]["coordinates"][1].get<double>()};
  const std::string coords = encoded("POINT(" + text_of(eye) + ")");
  const HttpAnswer png = get(in("mountains", "viewshed?crs=native&radius=1500&coords=" + coords));
  EXPECT_EQ(png.header("content-type"), "image/png");
  EXPECT_EQ(png.body.substr(1, 3), "PNG");
  ViewshedRequest request;
  request.eye = eye;
  request.eye_height = 2.0;
  request.radius = 1500;
  request.curvature = {Curvature{}.coefficient,
                       ground_of(crs_facts(mountains_->store())).earth_diameter};
  const Viewshed seen = mountains_->viewshed(request);
  const json points =
      get(in("mountains", "viewshed?crs=native&f=geojson&radius=1500&coords=" + coords)).json();
  EXPECT_EQ(points["visible"], seen.visible_vertices);
  EXPECT_EQ(points["features"].size(), seen.vertices.size());
}

TEST_F(Serve, GivesOutItsFilesByRanges) {
  const std::string file = read_file(files_[0].path);
  EXPECT_EQ(get(in("mountains", "file")).body, file);
  const HttpAnswer part = get(in("mountains", "file"), "Range: bytes=100-299\r\n");
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.body, file.substr(100, 200));
  EXPECT_EQ(part.header("content-range"), "bytes 100-299/" + std::to_string(file.size()));
  EXPECT_EQ(get(in("mountains", "file"), "Range: bytes=-50\r\n").body,
            file.substr(file.size() - 50));
  EXPECT_EQ(get(in("mountains", "file"), "Range: bytes=0-9,20-29\r\n").status, 416);
  EXPECT_EQ(get(in("mountains", "file"), "Range: bytes=999999999-\r\n").status, 416);
  EXPECT_EQ(get(in("mountains", "file"), "Range: lines=1-2\r\n").status, 200);
  EXPECT_EQ(get(in("mountains", "file"), "Range: bytes=0-9\r\nIf-Range: \"old\"\r\n").status, 200);
  EXPECT_EQ(get(in("mountains", "file"), "If-None-Match: " + part.header("etag") + "\r\n").status,
            304);
}

TEST_F(Serve, ValidatesWhatClientsKeep) {
  const std::string target = in("mountains", "isolines?interval=100&error=5");
  const HttpAnswer first = get(target);
  const std::string etag = first.header("etag");
  ASSERT_FALSE(etag.empty());
  const HttpAnswer again = get(target, "If-None-Match: " + etag + "\r\n");
  EXPECT_EQ(again.status, 304);
  EXPECT_EQ(again.body, "");
  // The same question written otherwise has the same tag, another one has another.
  EXPECT_EQ(get(in("mountains", "isolines?error=5&interval=100")).header("etag"), etag);
  EXPECT_NE(get(in("mountains", "isolines?error=5&interval=200")).header("etag"), etag);
  EXPECT_NE(get(in("coast", "isolines?error=5&interval=100")).header("etag"), etag);
  const HttpAnswer packed = get(target, "Accept-Encoding: gzip\r\n");
  EXPECT_EQ(packed.header("content-encoding"), "gzip");
  EXPECT_NE(packed.header("etag"), etag);
  EXPECT_LT(packed.body.size(), first.body.size() / 2);
  EXPECT_EQ(get(target, "If-None-Match: " + packed.header("etag") + "\r\n").status, 304);
  const HttpAnswer kept = get(target, "Accept-Encoding: gzip;q=0\r\n");
  EXPECT_EQ(kept.body, first.body);
  EXPECT_EQ(kept.header("server-timing"), "cache;desc=\"hit\"");
  EXPECT_NE(first.header("server-timing").find("pages="), std::string::npos);
  EXPECT_EQ(kept.header("ptin-certified-error"), "5");
}

TEST_F(Serve, NamesTheParameterAtFault) {
  const struct {
    const char* target;
    int status;
    const char* parameter;
  } all[] = {
      {"position", 400, "coords"},
      {"position?coords=POINT(nan%201)", 400, "coords"},
      {"position?coords=LINESTRING(0%200,1%201)", 400, "coords"},
      {"position?coords=POINT(0%200)&crs=EPSG:99999999", 400, "crs"},
      {"position?coords=POINT(0%200)&error=-1", 400, "error"},
      {"position?coords=POINT(0%200)&error=inf", 400, "error"},
      {"position?coords=POINT(0%200)&error=1&vertices=9", 400, "vertices"},
      {"position?coords=POINT(0%200)&colour=red", 400, "colour"},
      {"position?coords=POINT(0%200)&f=xml", 400, "f"},
      {"position?coords=POINT(0%200)&coords=POINT(0%200)", 400, "coords"},
      {"isolines", 400, "interval"},
      {"isolines?interval=0", 400, "interval"},
      {"isolines?interval=0.0001", 413, "interval"},
      {"isolines?interval=100&bbox=1,2,3", 400, "bbox"},
      {"isolines?interval=100&bbox=3,2,1,4", 400, "bbox"},
      {"mesh?vertices=9999999", 413, "vertices"},
      {"viewshed?coords=POINT(-118.3%2034.34)", 400, "radius"},
      {"sight", 400, "coords"},
      {"sight?coords=LINESTRING(0%200,1%201)&heights=1", 400, "heights"},
      {"sight?pairs=[[1,2]]", 400, "pairs"},
      {"stream?max_bytes=99999999", 413, "max_bytes"},
      {"stream?error=1&fingerprint=0", 409, "fingerprint"},
      {"mesh?bbox=1,2,3,4", 400, "bbox"},
      {"mesh?vertices=1", 400, "vertices"},
      {"viewshed?coords=POINT(-118.3%2034.34)&radius=0", 400, "radius"},
      {"viewshed?coords=POINT(-110%2034.34)&radius=500", 400, "coords"},
      {"mesh?bbox=10,2,-10,4&crs=native", 400, "bbox"},
      {"mesh?bbox=100,2,-100,4&crs=native", 400, "bbox"},
      {"position?coords=POINT(-118.3%2034.34)garbage", 400, "coords"},
      {"position?coords=POINT(-118.3%2034.34)&parameter-name=height,foo", 400, "parameter-name"},
      {"area?coords=POLYGON((0%200,1%200,1%201,0%200))&parameter-name=foo", 400, "parameter-name"},
      {"profile?coords=LINESTRING(0%200,0%200)", 400, "coords"},
      {"profile?coords=LINESTRING(-118.3%2034.34,-118.29%2034.35)&stations=1e-9", 413, "stations"},
      {"stream?have=5", 400, "have"},
      {"highest?listed=-1", 400, "listed"},
  };
  for (const auto& one : all) {
    const HttpAnswer answer = get(in("mountains", one.target));
    EXPECT_EQ(answer.status, one.status) << one.target << "\n" << answer.body;
    EXPECT_EQ(answer.header("content-type"), "application/problem+json") << one.target;
    EXPECT_EQ(answer.json().value("parameter", ""), one.parameter) << one.target << answer.body;
    EXPECT_FALSE(answer.json()["detail"].get<std::string>().empty());
  }
  EXPECT_EQ(get("/nothing").status, 404);
  EXPECT_EQ(get("/collections/nobody/position?coords=POINT(0%200)").json()["parameter"], "id");
  EXPECT_EQ(served_->ask("DELETE", "/collections", "", "").status, 405);
  EXPECT_EQ(served_->ask("POST", in("mountains", "mesh"), "", "{}").status, 405);
  EXPECT_EQ(served_->ask("POST", in("mountains", "position"), "Content-Type: text/xml\r\n", "<a/>")
                .status,
            415);
  const std::string deep(40, '[');
  const json too_deep = served_
                            ->ask("POST", in("mountains", "stream"), "",
                                  "{\"have\":" + deep + std::string(40, ']') + "}")
                            .json();
  EXPECT_EQ(too_deep["status"], 400);
  EXPECT_EQ(too_deep["parameter"], "body");
  EXPECT_NE(too_deep["detail"].get<std::string>().find("deeper than 16"), std::string::npos);
  EXPECT_FALSE(too_deep.contains("limit"));  // It is no option.
}

TEST_F(Serve, DescribesItselfAsOpenApi) {
  const json api = get("/api").json();
  EXPECT_EQ(api["openapi"], "3.0.3");
  std::set<std::string> ids;
  std::size_t operations = 0;
  for (const auto& [path, methods] : api["paths"].items()) {
    for (const auto& [method, operation] : methods.items()) {
      SCOPED_TRACE(method + " " + path);
      ++operations;
      ids.insert(operation["operationId"].get<std::string>());
      EXPECT_TRUE(operation["responses"].contains("200"));
      EXPECT_TRUE(operation["responses"].contains("4XX"));
      EXPECT_EQ(operation["responses"]["default"]["$ref"], "#/components/responses/Problem");
      std::string in_path;
      std::set<std::string> names;
      for (const json& parameter : operation["parameters"]) {
        const std::string type = parameter["schema"]["type"];
        if (parameter.contains("example")) {
          const json& example = parameter["example"];
          EXPECT_TRUE(type == "integer"   ? example.is_number_integer()
                      : type == "number"  ? example.is_number()
                      : type == "boolean" ? example.is_boolean()
                                          : example.is_string())
              << parameter;
        }
        EXPECT_TRUE(names
                        .insert(parameter["in"].get<std::string>() + " " +
                                parameter["name"].get<std::string>())
                        .second);
        if (parameter["in"] == "path") in_path += "{" + parameter["name"].get<std::string>() + "}";
      }
      std::string braces;
      for (std::size_t at = 0; (at = path.find('{', at)) != std::string::npos; ++at) {
        braces += path.substr(at, path.find('}', at) + 1 - at);
      }
      EXPECT_EQ(in_path, braces);
    }
  }
  EXPECT_EQ(ids.size(), operations);
  EXPECT_TRUE(api["components"]["responses"]["Problem"].contains("content"));
  EXPECT_TRUE(api["paths"].contains("/collections/{id}/position"));
  EXPECT_TRUE(api["paths"]["/collections/{id}/sight"]["post"]["requestBody"]["content"].contains(
      "application/x-www-form-urlencoded"));
  EXPECT_FALSE(api["servers"].empty());
  EXPECT_EQ(api["security"], json::array());  // This service wants no token.
}

/// Path, query of all examples but for `f`, and the media of the answer to a GET.
struct ListedQuestion {
  std::string target;
  json content;
};

std::vector<ListedQuestion> listed_questions(const json& api) {
  std::vector<ListedQuestion> all;
  for (const auto& [path, methods] : api["paths"].items()) {
    if (path.find("{path}") != std::string::npos && path != "/v1/{path}") continue;  // Tiles.
    std::string target = path;
    for (const std::string mark : {"{id}", "{path}"}) {
      const std::size_t at = target.find(mark);
      if (at != std::string::npos) target.replace(at, mark.size(), "mountains");
    }
    char before = '?';
    for (const json& parameter : methods["get"]["parameters"]) {
      if (parameter["in"] != "query" || !parameter.contains("example")) continue;
      const bool is_alternative =
          parameter["description"].get<std::string>().find("instead of") != std::string::npos;
      if (parameter["name"] == "f" || is_alternative) continue;
      const json& value = parameter["example"];
      target += before + parameter["name"].get<std::string>() + "=" +
                encoded(value.is_string() ? value.get<std::string>() : value.dump());
      before = '&';
    }
    all.push_back({target, methods["get"]["responses"]["200"]["content"]});
  }
  return all;
}

TEST_F(Serve, AnswersItsExamplesInTheMediaThatItLists) {
  const std::vector<ListedQuestion> all = listed_questions(get("/api").json());
  EXPECT_GE(all.size(), 15U);
  for (const ListedQuestion& question : all) {
    for (const auto& [media, unused] : question.content.items()) {
      const bool is_features_of_v1 =  // Others' clients ask for them by `format`.
          question.target.starts_with("/v1") && media == "application/geo+json";
      if (is_features_of_v1) continue;
      SCOPED_TRACE(question.target + " as " + media);
      const HttpAnswer answer = get(question.target, "Accept: " + media + "\r\n");
      EXPECT_EQ(answer.status, 200) << answer.body;
      EXPECT_TRUE(answer.header("content-type").starts_with(media))
          << answer.header("content-type");
    }
  }
}

TEST_F(Serve, ChoosesAFormatByWhatAcceptLikesBest) {
  const std::string position = in("mountains", "position?coords=POINT(-118.3%2034.34)");
  const struct {
    std::string target;
    const char* accept;
    const char* type;
  } all[] = {
      {position, "application/prs.coverage+json;q=0, application/geo+json", "application/geo+json"},
      {position, "text/csv;q=0.4, application/geo+json; q=0.9", "application/geo+json"},
      {position, "*/*", "application/prs.coverage+json"},
      {position, "Text/*", "text/csv; charset=utf-8"},
      {position, "application/geo+json, */*", "application/geo+json"},
      {position, "*/*;q=0.1, text/csv;q=0.2", "text/csv; charset=utf-8"},
      {position, "image/png", "application/prs.coverage+json"},
      {"/", "text/html, application/json;q=0.5", "text/html; charset=utf-8"},
      {"/", "", "application/json"},
  };
  for (const auto& one : all) {
    const HttpAnswer answer = get(one.target, "Accept: " + std::string(one.accept) + "\r\n");
    EXPECT_EQ(answer.header("content-type"), one.type) << one.target << " " << one.accept;
  }
  // Caches are told. (A picture is not packed, which would vary the answer too.)
  const std::string seen = in("mountains", "viewshed?radius=500&coords=POINT(-118.3%2034.34)");
  EXPECT_EQ(get(seen).header("vary"), "Accept");
  EXPECT_EQ(get(seen + "&f=png").header("vary"), "");
  for (const char* page : {"/", "/collections", "/collections/mountains", "/conformance", "/api"}) {
    EXPECT_EQ(get(std::string(page) + "?f=json").status, 200) << page;
    EXPECT_EQ(get(std::string(page) + "?f=xml").json()["parameter"], "f") << page;
  }
}

TEST_F(Serve, TakesWhatOgcAndOthersClientsSend) {
  const std::string at = "POINT(-118.3%2034.34)";
  const json plain = get(in("mountains", "position?coords=" + at)).json();
  EXPECT_EQ(get(in("mountains", "position?datetime=2026-01-01&z=5&coords=" + at)).json(), plain);
  for (const char* wkt : {"POINTZ(-118.3 34.34 7)", "PointZM (-118.3 34.34 7 1)",
                          "POINT Z(-118.3 34.34 7)", "  point(-118.3 34.34) "}) {
    EXPECT_EQ(get(in("mountains", "position?coords=" + encoded(wkt))).json(), plain) << wkt;
  }
  EXPECT_EQ(get(in("mountains", "profile?coords=" +
                                    encoded("LINESTRINGZM(-118.3 34.34 1 2, -118.29 34.35 1 2)")))
                .status,
            200);
  const json two = get(in("mountains", "position?parameter-name=state,height&coords=" + at)).json();
  EXPECT_EQ(two["ranges"].size(), 2U);
  EXPECT_EQ(two["ranges"]["height"], plain["ranges"]["height"]);
  EXPECT_EQ(two["parameters"].size(), 2U);
  const json ids = plain["parameters"]["state"]["observedProperty"]["categories"];
  EXPECT_EQ(ids[2]["id"], name_of(PointState::kOutside));
  // The area's positions alone, as a position question has them.
  const std::string ring =
      encoded("POLYGON((-118.31 34.34,-118.3 34.34,-118.3 34.35,-118.31 34.34))");
  const std::string area = in("mountains", "area?resolution-x=4&resolution-y=4&coords=" + ring);
  const json features = get(area + "&f=geojson").json()["features"];
  const json coverage = get(area).json();
  std::size_t inner = 0;
  for (const json& state : coverage["ranges"]["state"]["values"]) inner += state == 3 ? 0 : 1;
  ASSERT_EQ(features.size(), inner);
  ASSERT_GT(inner, 3U);
  const json& first = features[0];
  const json& xy = first["geometry"]["coordinates"];
  const json same =
      get(in("mountains", "position?f=geojson&coords=" +
                              encoded("POINT(" + xy[0].dump() + " " + xy[1].dump() + ")")))
          .json();
  EXPECT_EQ(same["features"][0]["properties"], first["properties"]);
  const std::string csv = get(area + "&f=csv").body;
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), inner + 1);
  EXPECT_EQ(get("/collections/mountains").json()["parameter_names"].size(), 4U);
}

TEST_F(Serve, AnswersOthersClientsInTheirForm) {
  const std::string at = "locations=34.34,-118.3";
  EXPECT_EQ(get("/v1/mountains?sensor=false&language=de&region=at&" + at).json()["status"], "OK");
  const HttpAnswer unknown = get("/v1/mountains,foo?" + at);
  EXPECT_EQ(unknown.status, 404);
  EXPECT_EQ(unknown.json()["status"], "INVALID_REQUEST");
  EXPECT_TRUE(get("/v1/mountains?locations=10,10&nodata_value=NaN")
                  .json()["results"][0]["elevation"]
                  .is_null());
  // -118.3 and 34.34 as differences of 1e-5 degrees: to the bit what they are as text.
  std::string line;
  for (const int value : {3434000, -11830000}) {
    auto left = static_cast<unsigned>(value < 0 ? ~(value * 2) : value * 2);
    for (; left >= 32; left /= 32) line += static_cast<char>(63 + 32 + left % 32);
    line += static_cast<char>(63 + left);
  }
  const json location =
      get("/v1/mountains?locations=" + encoded("enc:" + line)).json()["results"][0]["location"];
  EXPECT_EQ(location["lat"], 34.34);
  EXPECT_EQ(location["lng"], -118.3);
}

TEST_F(Serve, TellsHowCertainLinesOfSightAre) {
  const std::string ends =
      "coords=" + encoded("LINESTRING(-118.3 34.34, -118.29 34.35)") + "&heights=2,2";
  const HttpAnswer exact = get(in("mountains", "sight?" + ends));
  EXPECT_EQ(exact.header("ptin-certified-error"), "0");
  EXPECT_EQ(exact.json()["certified_error"], 0.0);
  const HttpAnswer coarse = get(in("mountains", "sight?error=5&" + ends));
  EXPECT_EQ(coarse.header("ptin-certified-error"), "5");
  EXPECT_EQ(coarse.json()["certified_error"], 5.0);
  EXPECT_EQ(coarse.json()["exact"].dump(), coarse.header("ptin-exact"));
}

TEST_F(Serve, RefusesMembersThatComeTwice) {
  const HttpAnswer answer =
      served_->ask("POST", in("mountains", "position"), "Content-Type: application/json\r\n",
                   R"json({"coords":"POINT(-118.3 34.34)","coords":"POINT(0 0)"})json");
  EXPECT_EQ(answer.status, 400);
  EXPECT_NE(answer.body.find("twice"), std::string::npos) << answer.body;
}

/// A terrain across the antimeridian, in degrees and in metres; one that has northings first; and
/// one whose heights are in feet.
class ServeElsewhere : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TestFolder>();
    serve::ServeOptions options;
    options.version = "test";
    options.question.question_memory = 4 << 20;
    const auto add = [&](const std::string& id, int epsg, double west, double north, double pixel) {
      RasterRecipe recipe;
      recipe.value = hills;
      recipe.epsg = epsg;
      recipe.west = west;
      recipe.north = north;
      recipe.pixel = pixel;
      recipe.unit = id == "metres" ? "m" : "ft";
      const std::string name = folder_->file(id);
      make_raster(name + ".tif", recipe);
      expect_done({"build", name + ".tif", "-o", name + ".ptin", "-q"});
      options.files.push_back({id, name + ".ptin"});
    };
    add("feet", 32611, 600000, 4000000, 30);
    add("degrees", 4326, 179.95, 10.05, 0.1 / 33);
    add("metres", 32601, 166100, 1110000, 300);
    add("austria", 31287, 400000, 400000, 300);
    files_ = options.files;
    served_ = std::make_unique<ServedTerrains>(options);
  }
  static void TearDownTestSuite() {
    served_.reset();
    folder_.reset();
  }
  static HttpAnswer get(const std::string& target) {
    return served_->get("/collections/" + target);
  }

  static std::unique_ptr<TestFolder> folder_;
  static std::vector<serve::ServedFile> files_;
  static std::unique_ptr<ServedTerrains> served_;
};

std::unique_ptr<TestFolder> ServeElsewhere::folder_;
std::vector<serve::ServedFile> ServeElsewhere::files_;
std::unique_ptr<ServedTerrains> ServeElsewhere::served_;

TEST_F(ServeElsewhere, ReachesAcrossTheAntimeridian) {
  for (const std::string id : {"degrees", "metres"}) {
    const json box = get(id).json()["extent"]["spatial"]["bbox"][0];
    EXPECT_GT(box[0].get<double>(), 179.9) << box;
    EXPECT_LT(box[2].get<double>(), -179.9) << box;
    const json east = get(id + "/position?f=json&coords=POINT(-179.99%2010)").json();
    EXPECT_EQ(east["points"][0]["state"], "surface") << id;
    EXPECT_EQ(east["points"][0]["x"], -179.99);
    EXPECT_EQ(served_->get("/v1/" + id + "?locations=10,-179.99").json()["results"][0]["state"],
              "surface");
    const json top = get(id + "/highest?bbox=179.98,9.96,-179.98,10").json();
    const json whole = get(id + "/highest?bbox=179.98,9.96,180.02,10").json();
    EXPECT_EQ(top, whole);
    EXPECT_FALSE(top["features"].empty()) << top;
  }
  const json beyond = get("degrees/position?f=json&coords=POINT(180.01%2010)").json();
  const json turned = get("degrees/position?f=json&coords=POINT(-179.99%2010)").json();
  EXPECT_EQ(beyond["points"][0]["height"], turned["points"][0]["height"]);
  // From east to west across it: the same line as the one that does not turn.
  const std::string line = "degrees/profile?f=csv&coords=";
  EXPECT_EQ(get(line + encoded("LINESTRING(179.98 10,-179.98 10)")).body,
            get(line + encoded("LINESTRING(179.98 10,180.02 10)")).body);
  // Positions come back from -180 to 180, and those of a line without a jump.
  for (const std::string id : {"degrees", "metres"}) {
    const json points =
        get(id + "/profile?coords=" + encoded("LINESTRING(-179.98 9.98,179.98 9.98)"))
            .json()["points"];
    EXPECT_NEAR(points.front()["x"].get<double>(), -179.98, 1e-9);
    EXPECT_NEAR(points.back()["x"].get<double>(), -180.02, 1e-9);
  }
  EXPECT_EQ(get("degrees/highest?bbox=20,9.96,10,10").json()["parameter"], "bbox");
  EXPECT_EQ(get("metres/mesh?crs=native&bbox=170000,0,10,10").json()["parameter"], "bbox");
}

TEST_F(ServeElsewhere, NamesAxesInTheOrderOfTheAuthority) {
  const json swapped = {"y", "x"}, plain = {"x", "y"};
  const auto axes = [](const std::string& target) {
    return get(target).json()["domain"]["referencing"][0]["coordinates"];
  };
  const std::string at = "/position?coords=POINT(1%202)";
  EXPECT_EQ(axes("degrees" + at + "&crs=native"), swapped);
  EXPECT_EQ(axes("austria" + at + "&crs=native"), swapped);
  EXPECT_EQ(axes("degrees" + at + "&crs=EPSG:4326"), swapped);
  EXPECT_EQ(axes("degrees" + at), plain);
  EXPECT_EQ(axes("metres" + at + "&crs=native"), plain);
}

TEST_F(ServeElsewhere, MeasuresAsTheCommandLineDoes) {
  const std::string feet = "LINESTRING(600100 3999900, 600700 3999400)";
  const std::string degrees = "LINESTRING(179.96 10.04, 180.04 9.96)";
  for (const auto& [file, line] : {std::pair{files_[0], feet}, {files_[1], degrees}}) {
    const json expected =
        answer_of({"profile", file.path, "--line", line, "--stations", "100", "--json"});
    const json told =
        get(file.id + "/profile?crs=native&stations=100&coords=" + encoded(line)).json();
    EXPECT_EQ(told["points"], expected["points"]);
    EXPECT_EQ(told["length_unit"], expected["units"]["length"]);
    EXPECT_EQ(told["unit"], "foot");
  }
  // Metres in and out, where the file has feet.
  const json box = get("feet").json()["extent"]["spatial"]["bbox"][0];
  const std::string at = json((box[1].get<double>() + box[3].get<double>()) / 2).dump() + "," +
                         json((box[0].get<double>() + box[2].get<double>()) / 2).dump();
  const HttpAnswer told = served_->get("/v1/feet?error=1&locations=" + at);
  EXPECT_EQ(told.status, 200) << told.body;
  EXPECT_NEAR(std::stod(told.header("ptin-certified-error")), 1.0, 1e-9);
  EXPECT_NEAR(told.json()["certified_error"].get<double>(), 1.0, 1e-9);
}

/// What an action says when it refuses; nothing where it does not.
template <typename Action>
std::string refusal_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(ServeSettings, AreBoundOnBothSides) {
  serve::ServeOptions options;
  serve::set_limit(options, "cache_bytes", "0");
  EXPECT_EQ(options.cache_bytes, 0U);
  const struct {
    const char* name;
    const char* value;
    const char* says;
  } all[] = {{"body_bytes", "2G", "1073741824 at most"},
             {"header_bytes", "3G", "1073741824 at most"},
             {"request_line_bytes", "3G", "1073741824 at most"},
             {"points", "9999999999999", "at most"},
             {"points", "0", "1 at least"},
             {"body_bytes", "0", "256 at least"}};
  for (const auto& one : all) {
    const std::string says = refusal_of([&] { serve::set_limit(options, one.name, one.value); });
    EXPECT_NE(says.find(one.says), std::string::npos) << one.name << ": " << says;
  }
  TestFolder folder;
  const std::string config = folder.file("serve.toml");
  write_file(config, "threads = 100000\n");
  EXPECT_NE(refusal_of([&] { serve::read_config(config, options); }).find("1 to 1024"),
            std::string::npos);
}

TEST(ServeSettings, HoldNothingThatBreaksAHeader) {
  EXPECT_EQ(serve::checked_origin("https://example.org", ""), "https://example.org");
  for (const char* origin : {"https://a\r\nSet-Cookie: b", "a\tb", "a b", "a\x7f"}) {
    EXPECT_THROW(static_cast<void>(serve::checked_origin(origin, "")), Error) << origin;
  }
  TestFolder folder;
  for (const char* text : {"secret \r\n", "secret", "secret\t\nmore"}) {
    const std::string file = folder.file(std::to_string(std::string(text).size()));
    write_file(file, text);
    std::filesystem::permissions(file, std::filesystem::perms::owner_read);
    EXPECT_EQ(serve::read_token(file), "secret");
  }
}

/// Answers that take more than a small question's memory are refused, and the service goes on.
TEST(ServeSmall, KeepsMeshesAndListsWithinTheMemoryOfAQuestion) {
  TestFolder folder;
  serve::ServeOptions options = serve_options(folder);
  options.question.question_memory = 8 << 20;
  ServedTerrains served(options);
  const std::string mountains = "/collections/mountains/";
  for (const char* question :
       {"mesh", "mesh?f=ply", "viewshed?f=geojson&radius=5000&coords=POINT(-118.3%2034.34)"}) {
    const HttpAnswer answer = served.get(mountains + question);
    EXPECT_EQ(answer.status, 413) << question << " " << answer.body.size();
    EXPECT_EQ(answer.json().value("limit", ""), "question_memory") << question;
  }
  EXPECT_EQ(served.get(mountains + "mesh?error=20").status, 200);
}

TEST_F(ServeElsewhere, KeepsLongAnswersWithinTheMemoryOfAQuestion) {
  std::string line = "LINESTRING(";
  for (int i = 0; i < 300; ++i) {
    line += i == 0 ? "" : ",";
    line += std::to_string(400000 + 30 * i) + " " + std::to_string(i % 2 == 0 ? 399900 : 390600);
  }
  const std::string target =
      "austria/profile?crs=native&stations=200&coords=" + encoded(line + ")");
  for (const char* format : {"&f=json", "&f=geojson", "&f=csv"}) {
    const HttpAnswer answer = get(target + format);
    EXPECT_EQ(answer.status, 413) << format << " " << answer.body.size();
    EXPECT_EQ(answer.json()["limit"], "question_memory");
  }
  std::string ring = "POLYGON((";
  for (int i = 0; i < 10001; ++i) ring += std::to_string(i % 2) + " " + std::to_string(i % 3) + ",";
  const HttpAnswer corners =
      served_->post("/collections/austria/area", {{"coords", ring + "0 0))"}, {"crs", "native"}});
  EXPECT_EQ(corners.status, 413);
  EXPECT_EQ(corners.json()["limit"], "points");
}

TEST_F(Serve, ListsItsCollectionsAndItsLoad) {
  const json collections = get("/collections").json();
  ASSERT_EQ(collections["collections"].size(), 2U);
  EXPECT_EQ(collections["collections"][0]["id"], "coast");
  EXPECT_TRUE(collections["collections"][0]["links"].is_array());
  EXPECT_EQ(get("/healthz").body, "alive\n");
  EXPECT_EQ(get("/readyz").body, "ready\n");
  const std::string metrics = get("/metrics").body;
  EXPECT_NE(metrics.find("ptin_requests_total{question=\"collections\",status=\"200\"}"),
            std::string::npos);
  EXPECT_NE(metrics.find("# TYPE ptin_compute_seconds histogram"), std::string::npos);
  EXPECT_EQ(metrics.find("coords"), std::string::npos);
  const HttpAnswer cross =
      served_->ask("OPTIONS", in("mountains", "stream"),
                   "Origin: http://a\r\nAccess-Control-Request-Method: POST\r\n", "");
  EXPECT_EQ(cross.status, 204);
  EXPECT_EQ(cross.header("access-control-allow-origin"), "*");
}

}  // namespace
}  // namespace ptin::tools::testing
