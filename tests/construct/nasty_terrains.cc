// SPDX-License-Identifier: GPL-3.0-or-later
//
// The terrains by name.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/construct/test_terrain.h"

namespace ptin::oracle {

namespace {

using Make = std::function<TestTerrain()>;
using CodeAt = std::function<double(int, int)>;
using ValidAt = std::function<bool(int, int)>;

constexpr HeightEncoding kCentimetres{HeightType::int32, 0.01, -50.0};

double hills(int x, int y) {
  return 60.0 * std::sin(0.31 * x) * std::cos(0.23 * y) + (x * 7 + y * 13) % 5;
}

/// A number from a position that is the same everywhere.
std::uint32_t noise(int x, int y) {
  auto h =
      static_cast<std::uint32_t>(x) * 0x9E3779B1U ^ static_cast<std::uint32_t>(y) * 0x85EBCA77U;
  h ^= h >> 15;
  h *= 0x2C1B3C6DU;
  return h ^ (h >> 13);
}

/// True on the arms of a square spiral, two samples wide.
bool spiral(int x, int y, int side) {
  const int ring = std::min({x, y, side - 1 - x, side - 1 - y}) / 2;
  return ring % 2 == 0 ? !(x / 2 == ring && y / 2 == ring + 1)
                       : (x / 2 == ring && y / 2 == ring + 1);
}

Make raster(std::string name, int width, int height, CodeAt code, ValidAt valid = {},
            HeightEncoding heights = {HeightType::int32, 1.0, 0.0}, GridPoint origin = {}) {
  return [=] { return make_raster({name, width, height, code, valid, heights, origin, 0.1}); };
}

void add_plain(std::vector<Make>& all) {
  const auto zero = [](int, int) { return 0.0; };
  all.push_back(raster("2 x 2", 2, 2, hills));
  all.push_back(raster("2 x N", 2, 40, hills));
  all.push_back(raster("N x 2", 40, 2, hills));
  all.push_back(raster("3 x 3", 3, 3, hills));
  all.push_back(raster("flat", 18, 18, zero));
  all.push_back(raster("tilted", 16, 17, [](int x, int y) { return 3.0 * x - 5.0 * y; }));
  all.push_back(
      raster("one spike", 17, 17, [](int x, int y) { return x == 8 && y == 8 ? 1e6 : 0.0; }));
  all.push_back(raster("spike in the corner", 9, 9,
                       [](int x, int y) { return x == 0 && y == 8 ? -1e6 : 0.0; }));
  all.push_back(raster("plateaus and lakes", 20, 20, [](int x, int y) {
    return 40.0 * std::floor(std::sin(0.4 * x) + std::cos(0.5 * y)) + (y > 14 ? 7.0 : 0.0);
  }));
  all.push_back(raster("hills", 21, 19, hills));
  all.push_back(raster("noise", 16, 16,
                       [](int x, int y) { return static_cast<double>(noise(x, y) % 1000); }));
  all.push_back(raster("the range of int32", 12, 12, [](int x, int y) {
    return static_cast<double>(noise(x, y)) - 2147483648.0;
  }));
  all.push_back(raster("centimetres", 16, 16, hills, {}, kCentimetres));
  all.push_back(raster(
      "floats", 16, 16, [](int x, int y) { return hills(x, y) / 7.0; }, {}, kFloat));
  all.push_back(raster(
      "a tilted plane of floats", 14, 14, [](int x, int y) { return 0.125 * x - 0.375 * y; }, {},
      kFloat));
  all.push_back(raster(
      "large and small floats", 12, 12,
      [](int x, int y) {
        return std::ldexp(1.0 + noise(x, y) % 8, static_cast<int>(noise(y, x) % 80) - 40);
      },
      {}, kFloat));
  all.push_back(raster("at the end of the grid", 15, 13, hills, {}, {HeightType::int32, 1.0, 0.0},
                       {kGridMax - 14, kGridMax - 12}));
}

void add_masks(std::vector<Make>& all) {
  all.push_back(raster("all void", 12, 12, hills, [](int, int) { return false; }));
  all.push_back(
      raster("one void pixel", 13, 13, hills, [](int x, int y) { return x != 6 || y != 6; }));
  all.push_back(
      raster("one void corner", 9, 9, hills, [](int x, int y) { return x != 0 || y != 0; }));
  all.push_back(
      raster("one data pixel", 9, 9, hills, [](int x, int y) { return x == 4 && y == 4; }));
  all.push_back(raster("one data triangle", 9, 9, hills, [](int x, int y) {
    return (x == 4 || x == 5) && y >= 4 && x + y < 10 && y < 6;
  }));
  all.push_back(
      raster("islands", 24, 24, hills, [](int x, int y) { return x % 8 < 4 && y % 8 < 5; }));
  all.push_back(raster("a coast", 22, 22, hills, [](int x, int y) {
    return y < 11 + 5 * std::sin(0.6 * x) + noise(x, y) % 3;
  }));
  all.push_back(
      raster("checkerboard", 14, 14, hills, [](int x, int y) { return (x + y) % 2 == 0; }));
  all.push_back(raster("checkerboard of three", 18, 18, hills,
                       [](int x, int y) { return (x / 3 + y / 3) % 2 == 0; }));
  all.push_back(raster("stripes", 16, 16, hills, [](int x, int) { return x % 4 < 2; }));
  all.push_back(raster("spiral", 24, 24, hills, [](int x, int y) { return spiral(x, y, 24); }));
  all.push_back(
      raster("half at random", 16, 16, hills, [](int x, int y) { return noise(x, y) % 2 == 0; }));
  all.push_back(raster("a tenth at random", 18, 18, hills,
                       [](int x, int y) { return noise(x, y) % 10 != 0; }));
  all.push_back(raster("nine tenths at random", 18, 18, hills,
                       [](int x, int y) { return noise(x, y) % 10 == 0; }));
  all.push_back(raster(
      "floats beside void", 14, 14, [](int x, int y) { return 0.1 * hills(x, y); },
      [](int x, int y) { return x + y < 15; }, kFloat));
  all.push_back(raster("2 x N with gaps", 2, 30, hills, [](int, int y) { return y % 5 != 0; }));
}

/// Large enough that flat and void samples join into blocks (sample_blocks.h).
void add_lakes(std::vector<Make>& all) {
  const auto in_lake = [](int x, int y) { return (x - 21) * (x - 21) + (y - 19) * (y - 19) < 300; };
  const auto lake = [=](int x, int y) { return in_lake(x, y) ? 9.0 : 20.0 + hills(x, y) / 4; };
  const auto dry = [=](int x, int y) { return !in_lake(x, y); };
  const auto sea = [](int x, int y) { return y < 18 + x % 7 ? 0.0 : 12.0 + hills(x, y) / 6; };
  all.push_back(raster("a lake in hills", 44, 40, lake));
  all.push_back(raster("a void lake in hills", 44, 40, lake, dry));
  all.push_back(raster("a sea beside void", 40, 40, sea,
                       [](int x, int y) { return x < 24 + y % 5 && (x != 11 || y != 7); }));
  all.push_back(raster(
      "terraces of floats beside void", 40, 38,
      [](int x, int y) { return 0.7 * (x / 19) + 1.3 * (y / 18); },
      [](int x, int y) { return x + 2 * y > 30; }, kFloat));
}

Make points(std::string name, std::vector<GridPoint> positions,
            std::function<double(GridPoint)> code,
            HeightEncoding heights = {HeightType::int32, 1.0, 0.0}) {
  return [=] { return make_points({name, positions, code, heights}); };
}

double hills_at(GridPoint p) { return hills(p.x % 4096, p.y % 4096); }

std::vector<GridPoint> scattered(int count, std::int64_t side, std::uint32_t seed) {
  std::mt19937_64 random(seed);
  std::vector<GridPoint> p;
  for (int i = 0; i < count; ++i) {
    p.push_back({static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(side + 1)),
                 static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(side + 1))});
  }
  return p;
}

}  // namespace

std::vector<Make> nasty_rasters() {
  std::vector<Make> all;
  add_plain(all);
  add_masks(all);
  return all;
}

std::vector<Make> lakes() {
  std::vector<Make> all;
  add_lakes(all);
  return all;
}

std::vector<Make> nasty_points() {
  std::vector<Make> all;
  all.push_back(points("a triangle", {{0, 0}, {9, 0}, {0, 9}}, hills_at));
  all.push_back(points("scattered", scattered(250, 1000, 1), hills_at));
  all.push_back(points("crowded, with duplicates", scattered(400, 18, 2), hills_at));
  all.push_back(points(
      "floats", scattered(200, 500, 3), [](GridPoint p) { return 0.01 * hills_at(p); }, kFloat));
  all.push_back(points("over the whole grid", scattered(250, kGridMax, 4),
                       [](GridPoint p) { return static_cast<double>(noise(p.x, p.y) % 5000); }));
  all.push_back(points(
      "floats over the whole grid", scattered(200, kGridMax, 5),
      [](GridPoint p) { return 1e-3 * (noise(p.x, p.y) % 5000); }, kFloat));
  all.push_back(points("a plane over the whole grid", scattered(150, kGridMax, 6),
                       [](GridPoint p) { return std::floor(p.x / 2.0) - std::floor(p.y / 2.0); }));
  std::vector<GridPoint> grid, collinear, circle;
  for (int i = 0; i < 15; ++i) {
    for (int j = 0; j < 15; ++j) {
      grid.push_back({i * 8, j * 8});
    }
  }
  for (int i = 0; i < 120; ++i) {
    collinear.push_back({i, 2 * i});
    collinear.push_back({i, i % 10 == 0 ? 300 - i : 2 * i});
  }
  for (const auto& [x, y] : {std::pair{25, 0}, {24, 7}, {20, 15}, {15, 20}, {7, 24}, {0, 25}}) {
    for (const int sx : {-1, 1}) {
      for (const int sy : {-1, 1}) {
        circle.push_back({100 + sx * x, 100 + sy * y});
        circle.push_back({100 + 3 * sx * x, 100 + 3 * sy * y});
      }
    }
  }
  all.push_back(points("a cocircular grid", grid, hills_at));
  all.push_back(points("a flat grid", grid, [](GridPoint) { return 4.0; }));
  all.push_back(points("mostly collinear", collinear, hills_at));
  all.push_back(points("two circles", circle, hills_at));
  std::vector<GridPoint> wide_grid;
  for (const GridPoint p : grid) {
    wide_grid.push_back({p.x * (kGridMax / 112), p.y * (kGridMax / 112)});
  }
  all.push_back(points("a cocircular grid over the whole grid", wide_grid,
                       [](GridPoint p) { return static_cast<double>(noise(p.x, p.y) % 300); }));
  return all;
}

TestTerrain random_terrain(std::uint64_t seed, int size) {
  std::mt19937_64 random(seed);
  const auto less_than = [&](std::uint64_t n) { return static_cast<int>(random() % n); };
  const int side = std::max(2, static_cast<int>(std::sqrt(size)));
  const double rough = less_than(60);
  const int steps = 1 + less_than(12);
  const auto salt = static_cast<int>(random() % 1000);
  const auto code = [=](int x, int y) {
    const double z = rough * std::sin(0.2 * x + salt) * std::cos(0.3 * y) + noise(x + salt, y) % 8;
    return std::floor(z / steps) * steps;
  };
  const HeightEncoding encodings[] = {{HeightType::int32, 1.0, 0.0}, kCentimetres, kFloat};
  const HeightEncoding heights = encodings[random() % 3];
  const std::string name = "random terrain " + std::to_string(seed);
  if (random() % 3 == 0) {
    const std::int64_t extents[] = {30, 1000, kGridMax};
    return make_points({name,
                        scattered(size, extents[random() % 3], static_cast<std::uint32_t>(seed)),
                        [=](GridPoint p) { return code(p.x % 997, p.y % 997); }, heights});
  }
  const int width = 2 + less_than(2 * side), height = std::max(2, size / width);
  const std::uint32_t voids[] = {0, 0, 3, 20, 50, 90};
  const std::uint32_t share = voids[random() % 6];
  const int block = 1 + less_than(5);
  return make_raster(
      {name,
       width,
       height,
       code,
       [=](int x, int y) { return noise(x / block + salt, y / block) % 100 >= share; },
       heights,
       {less_than(5), less_than(5)},
       random() % 2 == 0 ? 0.1 : 3.0});
}

}  // namespace ptin::oracle
