// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/program.h"
#include "tools/verify/lone_points.h"

namespace ptin::tools {
namespace {

using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

std::vector<SourceSample> samples_at(const std::vector<GridPoint>& places) {
  std::vector<SourceSample> samples;
  for (const GridPoint p : places) {
    SourceSample s{};
    s.x = p.x;
    s.y = p.y;
    samples.push_back(s);
  }
  return samples;
}

TEST(IsLonePoint, LooksForATriangleWithShortSides) {
  const auto longer_than = [](double most) {
    return [most](GridPoint a, GridPoint b) {
      return std::hypot(double(a.x) - b.x, double(a.y) - b.y) > most;
    };
  };
  const auto square = samples_at({{0, 0}, {10, 0}, {0, 10}, {11, 11}});
  EXPECT_FALSE(is_lone_point({0, 0}, square, longer_than(15)));
  EXPECT_TRUE(is_lone_point({0, 0}, square, longer_than(12)));  // the diagonal is too long
  // Two points near each other, and far from all others.
  const auto pair = samples_at({{0, 0}, {3, 1}, {100, 0}, {0, 100}, {-100, -90}});
  EXPECT_TRUE(is_lone_point({0, 0}, pair, longer_than(50)));
  // A triangle of short sides that is none of Delaunay's: another point lies in its circle.
  const auto flat = samples_at({{0, 0}, {20, 0}, {10, 1}, {10, -3}, {10, 3}});
  EXPECT_FALSE(is_lone_point({0, 0}, flat, longer_than(20)));
  const auto hidden = samples_at({{0, 0}, {20, 0}, {10, 9}, {10, 2}});
  EXPECT_FALSE(is_lone_point({10, 2}, hidden, longer_than(21)));
}

TEST(VerifyPoints, PassesLonePointsThatAFileLeftOut) {
  const TestFolder folder;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> at(0.0, 100.0), height(0.0, 5.0);
  std::string text = "x,y,z\n";
  for (int i = 0; i < 200; ++i) {
    text += std::to_string(at(random)) + "," + std::to_string(at(random)) + "," +
            std::to_string(height(random)) + "\n";
  }
  const std::string points = folder.file("points.csv"), terrain = folder.file("t.ptin");
  write_file(points, text);
  for (const char* max_edge : {"5", "10"}) {
    const auto built = run_ptin({"build", points, "--max-edge", max_edge, "--max-error", "0.5",
                                 "-o", terrain, "-q", "--overwrite"});
    ASSERT_EQ(built.status, 0) << built.err;
    const auto verified = run_ptin({"verify", terrain, "--against", points});
    EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
  }
}

}  // namespace
}  // namespace ptin::tools
