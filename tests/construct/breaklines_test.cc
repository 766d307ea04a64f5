// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds over points with breaklines and a boundary: what the store promises of them.
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "storage/verify.h"
#include "tests/construct/line_sets.h"
#include "tests/construct/made_raster.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::ScratchFolder;

/// Places are rounded to 2^-22 of a grid unit, and beside a wall the surface is steep.
constexpr double kRounding = 1e-3;

std::string wkt_of(const char* type, const std::vector<TestLine>& parts) {
  std::string text = std::string("1,\"") + type + " Z (";
  const bool is_polygon = std::string(type) == "POLYGON";
  for (std::size_t i = 0; i < parts.size(); ++i) {
    text += is_polygon ? (i > 0 ? ",(" : "(") : "";
    for (std::size_t k = 0; k < parts[i].size(); ++k) {
      const TestVertex& v = parts[i][k];
      text += (k > 0 ? "," : "") + std::to_string(v.x) + " " + std::to_string(v.y) + " " +
              std::to_string(v.z);
    }
    text += is_polygon ? ")" : "";
  }
  return text + ")\"\n";
}

/// Points of rough hills, with dams and ditches across them that no point tells of.
class BreaklineBuild {
 public:
  explicit BreaklineBuild(bool with_boundary = false) : with_boundary_(with_boundary) {
    const auto line = [&](std::int64_t x, std::int64_t y, std::int64_t dx, std::int64_t dy,
                          std::int64_t above) {
      TestLine made;
      for (int i = 0; i <= 6; ++i) {
        made.push_back({x + i * dx, y + i * dy, ground(x + i * dx, y + i * dy) + above});
      }
      lines_.push_back(made);
    };
    line(100, 100, 70, 90, 30);    // a dam
    line(50, 770, 140, -17, -40);  // a ditch
    line(700, 200, 3, 60, 60);     // a wall
    lines_.push_back({{560, 500, 500},
                      {640, 500, 500},
                      {640, 580, 500},
                      {560, 580, 500},
                      {560, 500, 500}});                 // a pond
    lines_.push_back({{150, 60, 90}, {930, 180, 400}});  // one long piece over many tiles
    write_points();
    std::string wkt = "id,WKT\n";
    for (const TestLine& l : lines_) {
      wkt += wkt_of("LINESTRING", {l});
    }
    oracle::write_text(folder_.file("lines.csv"), wkt);
    const std::vector<TestLine> rings = {
        {{30, 20, 300},
         {970, 60, 310},
         {940, 960, 320},
         {500, 800, 200},
         {40, 970, 300},
         {30, 20, 300}},
        {{300, 600, 250}, {420, 610, 240}, {350, 720, 260}, {300, 600, 250}}};
    oracle::write_text(folder_.file("area.csv"), "id,WKT\n" + wkt_of("POLYGON", rings));
  }

  static std::int64_t ground(std::int64_t x, std::int64_t y) {
    return std::lround(300 +
                       50 * std::sin(0.01 * static_cast<double>(x)) *
                           std::cos(0.013 * static_cast<double>(y)) +
                       static_cast<double>((x * 7 + y * 3) % 5));
  }
  [[nodiscard]] std::string points() const { return folder_.file("points.xyz"); }
  [[nodiscard]] const std::vector<TestLine>& lines() const { return lines_; }
  [[nodiscard]] BuildOptions options(std::optional<std::int64_t> tile) const {
    BuildOptions options;
    options.tile = tile;
    options.breaklines = {folder_.file("lines.csv")};
    if (with_boundary_) {
      options.boundary = folder_.file("area.csv");
    }
    return options;
  }
  std::string run(const std::string& name, std::optional<std::int64_t> tile, int threads = 1) {
    const std::string output = folder_.file(name);
    BuildResources resources;
    resources.threads = threads;
    report = build({points()}, output, options(tile), resources);
    return output;
  }

  BuildReport report;

 private:
  /// None lies on a line: it would divide the line at its own height.
  void write_points() const {
    std::mt19937 random(5);
    std::string text;
    for (int i = 0; i < 2500; ++i) {
      const auto x = static_cast<std::int64_t>(random() % 1000);
      const auto y = static_cast<std::int64_t>(random() % 1000);
      const bool is_on_a_line = std::any_of(lines_.begin(), lines_.end(), [&](const TestLine& l) {
        bool is_on = false;
        for (std::size_t k = 1; k < l.size(); ++k) {
          is_on = is_on || (l[k].x - l[k - 1].x) * (y - l[k - 1].y) ==
                               (l[k].y - l[k - 1].y) * (x - l[k - 1].x);
        }
        return is_on;
      });
      if (!is_on_a_line) {
        text +=
            std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(ground(x, y)) + "\n";
      }
    }
    oracle::write_text(points(), text);
  }

  bool with_boundary_;
  ScratchFolder folder_;
  std::vector<TestLine> lines_;
};

/// The pieces of lines, each with the points on it at which it is asked.
std::vector<std::vector<LocatedPoint>> along(const Terrain& terrain,
                                             const std::vector<TestLine>& lines,
                                             const DetailRequest& detail,
                                             std::vector<std::vector<double>>& heights) {
  std::vector<std::vector<LocatedPoint>> all;
  constexpr int kSteps = 40;
  for (const TestLine& line : lines) {
    for (std::size_t k = 1; k < line.size(); ++k) {
      std::vector<MapPoint> points;
      heights.emplace_back();
      for (int i = 0; i <= kSteps; ++i) {
        const double t = i / static_cast<double>(kSteps);
        const auto mix = [&](std::int64_t a, std::int64_t b) {
          return static_cast<double>(a) + t * static_cast<double>(b - a);
        };
        points.push_back({mix(line[k - 1].x, line[k].x), mix(line[k - 1].y, line[k].y)});
        heights.back().push_back(mix(line[k - 1].z, line[k].z));
      }
      LocateRequest request;
      request.detail = detail;
      all.push_back(terrain.locate(points, request).points);
    }
  }
  return all;
}

/// The largest distance between the lines and the TIN of a level, where it is surface.
double worst_along(const Terrain& terrain, const std::vector<TestLine>& lines,
                   const DetailRequest& detail) {
  std::vector<std::vector<double>> heights;
  const auto found = along(terrain, lines, detail, heights);
  double worst = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t k = 0; k < found[i].size(); ++k) {
      if (found[i][k].state == PointState::kSurface) {
        worst = std::max(worst, std::abs(found[i][k].height - heights[i][k]));
      }
    }
  }
  return worst;
}

std::set<std::array<VertexKey, 3>> triangles_at(const Terrain& terrain) {
  const RefinedTin refined = terrain.refine({});
  std::set<std::array<VertexKey, 3>> all;
  for (TriangleId t = 0; t < refined.tin.triangles.size(); ++t) {
    const Triangle& triangle = refined.tin.triangles[t];
    if (refined.tin.is_alive(t) && refined.tin.classes[t] == TriangleClass::kSurface) {
      std::array<VertexKey, 3> keys{};
      for (std::size_t i = 0; i < 3; ++i) {
        keys[i] = key_of(refined.tin.position(triangle.v[i]));
      }
      std::sort(keys.begin(), keys.end());
      all.insert(keys);
    }
  }
  return all;
}

class EveryTile : public testing::TestWithParam<std::optional<std::int64_t>> {};

TEST_P(EveryTile, KeepsBreaklinesInTheFullTinAndWithinEveryError) {
  BreaklineBuild source;
  const Terrain terrain = Terrain::open(source.run("out.ptin", GetParam()));
  EXPECT_LT(worst_along(terrain, source.lines(), {}), kRounding);
  std::size_t left_out = 0;
  for (const double error : {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 40.0}) {
    DetailRequest detail;
    detail.tolerance = error;
    const double worst = worst_along(terrain, source.lines(), detail);
    EXPECT_LE(worst, error + kRounding) << error;
    left_out += worst > 0.1 ? 1 : 0;
  }
  EXPECT_GE(left_out, 3U);  // levels of detail do leave something out
}

INSTANTIATE_TEST_SUITE_P(Breaklines, EveryTile, testing::Values(std::nullopt, 24, 8),
                         [](const auto& tile) {
                           return tile.param ? "Tile" + std::to_string(*tile.param) : "OneTile";
                         });

TEST(Breaklines, TilesAndThreadsGiveOneTin) {
  for (const bool boundary : test::some_of({false, true})) {
    BreaklineBuild source(boundary);
    const std::string one = source.run("one.ptin", std::nullopt);
    const std::string many = source.run("many.ptin", 8);
    EXPECT_TRUE(triangles_at(Terrain::open(one)) == triangles_at(Terrain::open(many)));
    const std::string threads = source.run("threads.ptin", 8, 2);
    EXPECT_TRUE(oracle::bytes_of(many) == oracle::bytes_of(threads));
  }
}

TEST(Boundary, LeavesOutWhatLiesOutside) {
  BreaklineBuild plain, source(true);
  (void)plain.run("plain.ptin", 8);
  const Terrain terrain = Terrain::open(source.run("out.ptin", 8));
  EXPECT_GT(source.report.left_out.total(), 300U);
  EXPECT_EQ(source.report.lone_samples, 0U);
  const auto state = [&](double x, double y) {
    const std::vector<MapPoint> points = {{x, y}};
    return terrain.locate(points, {}).points[0].state;
  };
  EXPECT_EQ(state(500, 500), PointState::kSurface);
  EXPECT_EQ(state(355, 640), PointState::kVoid);     // in the hole
  EXPECT_EQ(state(500, 900), PointState::kVoid);     // in the notch of the outline
  EXPECT_EQ(state(500, 790), PointState::kSurface);  // below the notch
  EXPECT_EQ(state(5, 500), PointState::kOutside);
  for (const double error : {1.0, 10.0}) {
    DetailRequest detail;
    detail.tolerance = error;
    EXPECT_LE(worst_along(terrain, source.lines(), detail), error + kRounding);
  }
}

std::string refusal_of(const std::function<void()>& call, ErrorCode code) {
  try {
    call();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return "";
}

TEST(Breaklines, ThatTakeMoreThanTheirShareOfTheMemoryAreRefusedBeforeTheWork) {
  const ScratchFolder folder;
  oracle::write_text(folder.file("points.xyz"), "0 0 1\n100000 0 2\n0 100000 3\n");
  std::string wkt = "id,WKT\n1,\"LINESTRING Z (";
  for (int i = 0; i < 40000; ++i) {
    wkt += (i > 0 ? "," : "") + std::to_string(i) + " " + std::to_string(i / 2) + " 5";
  }
  oracle::write_text(folder.file("lines.csv"), wkt + ")\"\n");
  BuildOptions options;
  options.breaklines = {folder.file("lines.csv")};
  BuildResources resources;
  resources.memory_bytes = 40U << 20;
  const std::string message = refusal_of(
      [&] { build({folder.file("points.xyz")}, folder.file("out.ptin"), options, resources); },
      ErrorCode::resource_exhausted);
  EXPECT_NE(message.find("40000 vertices"), std::string::npos) << message;
  EXPECT_NE(message.find("--memory 49M"), std::string::npos) << message;
  EXPECT_EQ(folder.names().size(), 2U);
}

}  // namespace
}  // namespace ptin
