// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/ogr_points.h"

#include <tuple>

#include <gtest/gtest.h>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/points/open_points.h"
#include "engine/construct/read/input_kind.h"
#include "engine/error.h"
#include "tests/construct/memory_file.h"
#include "tests/construct/point_source.h"

namespace ptin {
namespace {

std::string feature(const std::string& geometry, const std::string& properties = "") {
  return R"({"type":"Feature","properties":{)" + properties + R"(},"geometry":)" + geometry + "}";
}

std::string point(const std::string& coordinates) {
  return R"({"type":"Point","coordinates":[)" + coordinates + "]}";
}

std::string collection(const std::vector<std::string>& features) {
  std::string text =
      R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:2154"}},"features":[)";
  for (std::size_t i = 0; i < features.size(); ++i) {
    text += (i == 0 ? "" : ",") + features[i];
  }
  return text + "]}";
}

PointSet read(const std::vector<std::string>& features, const PointChoice& choice = {}) {
  const MemoryFile file("points.geojson", collection(features));
  SourceOptions options;
  options.points = choice;
  return read_points({file.path()}, options);
}

void expect_layer_refused(const std::vector<std::string>& features, const std::string& word,
                          const PointChoice& choice = {}) {
  try {
    std::ignore = read(features, choice);
    FAIL() << "accepted; " << word;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_NE(e.message().find(word), std::string::npos) << e.what();
  }
}

TEST(OgrPoints, TakesHeightsFromTheGeometry) {
  const PointSet set = read(
      {feature(point("100.25,7,1.5")), feature(point("101,7,2")),
       feature(R"({"type":"MultiPoint","coordinates":[[100,8,3],[101,8,4]]})"), feature("null")});
  EXPECT_EQ(set.source_points, 4U);
  EXPECT_EQ(set.left_out_points, 1U);
  EXPECT_EQ(set.frame.map, (AffineMap{100, 7, 0.01, 0.01}));
  EXPECT_EQ(set.frame.horizontal_unit, "metre");
  EXPECT_EQ(set.frame.heights, (HeightEncoding{HeightType::int32, 0.1, 0}));
}

TEST(OgrPoints, TakesHeightsFromAnAttribute) {
  PointChoice choice;
  choice.z_field = "alt";
  const PointSet set =
      read({feature(point("0,0"), R"("alt":1.5,"name":"a")"), feature(point("1,0"), R"("alt":2)"),
            feature(point("0,1,99"), R"("alt":3)"), feature(point("5,5"), R"("alt":null)")},
           choice);
  EXPECT_EQ(set.source_points, 3U);
  EXPECT_EQ(set.left_out_points, 1U);
  EXPECT_EQ(set.frame.max_height, 3);
  choice.z_field = "height";
  expect_layer_refused({feature(point("0,0"), R"("alt":1.5,"name":"a")")}, "numbers are in 'alt'",
                       choice);
  choice.z_field = "name";
  expect_layer_refused({feature(point("0,0"), R"("alt":1.5,"name":"a")")}, "holds no numbers",
                       choice);
}

TEST(OgrPoints, RefusesLayersThatHoldNoPointsWithHeights) {
  expect_layer_refused({feature(point("0,0")), feature(point("1,0")), feature(point("0,1"))},
                       "--z-field");
  expect_layer_refused({feature(R"({"type":"LineString","coordinates":[[0,0,1],[1,1,1]]})")},
                       "not points");
  expect_layer_refused({feature(point("0,0,1")),
                        feature(R"({"type":"LineString","coordinates":[[0,0,1],[1,1,1]]})")},
                       "not a point");
  PointChoice choice;
  choice.layer = "elsewhere";
  expect_layer_refused({feature(point("0,0,1"))}, "there is no layer 'elsewhere'", choice);
  choice.layer.clear();
  choice.classes = {2};
  expect_layer_refused({feature(point("0,0,1"))}, "only LAS has classes", choice);
}

// A GPX has five layers, whatever was recorded.
TEST(OgrPoints, TakesTheOnlyLayerThatHasPoints) {
  const auto points = [](const std::string& content) {
    const MemoryFile file("a.gpx", R"(<?xml version="1.0"?><gpx version="1.1" creator="test" )"
                                   R"(xmlns="http://www.topografix.com/GPX/1/1">)" +
                                       content + "</gpx>");
    SourceOptions options;
    options.points.z_field = "ele";
    return read_points({file.path()}, options).source_points;
  };
  const auto point = [](const std::string& element, const std::string& place) {
    return "<" + element + " " + place + "><ele>5</ele></" + element + ">";
  };
  std::string waypoints, track;
  for (const char* place :
       {R"(lat="46.5" lon="7")", R"(lat="46" lon="7.5")", R"(lat="46" lon="7")"}) {
    waypoints += point("wpt", place);
    track += point("trkpt", place);
  }
  track = "<trk><trkseg>" + track + "</trkseg></trk>";
  EXPECT_EQ(points(waypoints), 3U);
  EXPECT_EQ(points(track), 3U);
  try {
    points(waypoints + track);
    FAIL() << "took one of two";
  } catch (const Error& e) {
    EXPECT_NE(e.message().find("'waypoints' (Point), 'track_points' (Point); name one"),
              std::string::npos)
        << e.what();
  }
}

TEST(OgrPoints, IsKnownByItsContent) {
  const MemoryFile file("points.geojson", collection({feature(point("0,0,1"))}));
  const MemoryFile other("points.bin", "rubbish");
  EXPECT_EQ(kind_of_input(file.path(), {}), InputKind::kPoints);
  EXPECT_EQ(kind_of_input(other.path(), {}), InputKind::kRaster);
  EXPECT_EQ(kind_of_input(std::string(PTIN_TEST_DATA) + "/coast_257.tif", {}), InputKind::kRaster);
  EXPECT_THROW(std::ignore = open_point_stream("/vsimem/none.gpkg", {}), Error);
}

TEST(OgrPoints, GivesTheSamePointsAsText) {
  const MemoryFile text("same.xyz",
                        "635619.85 848899.7 1.25\n635620.1 848899.7 2\n635620 848901 3\n");
  const PointSet a = read_points({text.path()}, {});
  const PointSet b =
      read({feature(point("635619.85,848899.7,1.25")), feature(point("635620.1,848899.7,2")),
            feature(point("635620,848901,3"))});
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.heights, b.heights);
  EXPECT_EQ(a.frame.map, b.frame.map);
}

}  // namespace
}  // namespace ptin
