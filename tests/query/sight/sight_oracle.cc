// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/query/sight/sight_oracle.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "engine/construct/build.h"
#include "engine/query/questions.h"

namespace ptin::reference {

namespace {

std::string fresh_path(const char* extension) {
  static std::atomic<int> number{0};
  const std::string name =
      "ptin_sight_" + std::to_string(::getpid()) + "_" + std::to_string(number++) + extension;
  return (std::filesystem::temp_directory_path() / name).string();
}

int nasty_height(std::mt19937_64& random, int kind, int x, int y) {
  const auto noise = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  switch (kind) {
    case 0:
      return 7;  // flat
    case 1:
      return (x / 3 + y / 4) % 3;  // plateaus
    case 2:
      return random() % 20 == 0 ? 30 : noise(2);  // spikes
    case 3:
      return x;  // a plane
    case 4:
      return noise(12);
    default:
      return static_cast<int>(10 * std::sin(0.4 * x) * std::cos(0.3 * y)) + noise(3);
  }
}

void write_raster(std::mt19937_64& random, const std::string& path) {
  const int columns = 2 + static_cast<int>(random() % 12);
  const int rows = 2 + static_cast<int>(random() % 12);
  const int kind = static_cast<int>(random() % 6);
  const bool has_voids = random() % 3 == 0;
  std::ofstream out(path);
  out << "ncols " << columns << "\nnrows " << rows
      << "\nxllcorner -0.5\nyllcorner -0.5\ncellsize 1\nNODATA_value -9999\n";
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const bool is_void = has_voids && (random() % 12 == 0 || (x > 5 && x < 9 && y > 3 && y < 9));
      out << (is_void ? -9999 : nasty_height(random, kind, x, y)) << ' ';
    }
    out << '\n';
  }
}

void write_points(std::mt19937_64& random, const std::string& path) {
  const int kind = static_cast<int>(random() % 6);
  std::ofstream out(path);
  out << "x,y,z\n0,0,1\n40,0,2\n20,40,3\n";
  for (int i = 0; i < 10 + static_cast<int>(random() % 50); ++i) {
    const int y = static_cast<int>(random() % 40);
    const int x = y / 2 + static_cast<int>(random() % static_cast<unsigned>(41 - y));
    out << x << ',' << y << ',' << nasty_height(random, kind, x, y) << '\n';
  }
}

Rational clearance_at(const SmallTerrain& t, TriangleId triangle, const RationalPoint& at,
                      const Rational& line) {
  const HeightEncoding& h = t.terrain->store().facts().heights;
  return line - (Rational(h.offset) + Rational(h.step) * code_on(t.full, h, triangle, at));
}

PointState state_at(const Tin& tin, const RationalPoint& at) {
  const std::vector<TriangleId> triangles = triangles_at(tin, at);
  const bool surface = std::any_of(triangles.begin(), triangles.end(), [&](TriangleId t) {
    return tin.classes[t] == TriangleClass::kSurface;
  });
  return triangles.empty() ? PointState::kOutside
                           : (surface ? PointState::kSurface : PointState::kVoid);
}

/// The height of an end; none where it is above ground that is not there.
std::optional<Rational> end_height(const SmallTerrain& t, const RationalPoint& at, double height,
                                   bool absolute) {
  if (absolute) return Rational(height);
  for (const TriangleId triangle : triangles_at(t.full, at)) {
    if (t.full.classes[triangle] == TriangleClass::kSurface) {
      return Rational(height) - clearance_at(t, triangle, at, 0);
    }
  }
  return std::nullopt;
}

}  // namespace

SmallTerrain::SmallTerrain(std::uint64_t seed, double max_error) : path(fresh_path(".ptin")) {
  std::mt19937_64 random(seed);
  const bool raster = random() % 3 != 0;
  const std::string source = fresh_path(raster ? ".asc" : ".csv");
  raster ? write_raster(random, source) : write_points(random, source);
  BuildOptions options;
  options.max_error = max_error;
  if (!raster) options.resolution = 1.0;
  // Voids between points, of which the table of errors says nothing.
  if (!raster && random() % 2 == 0) options.max_edge = 8.0 + static_cast<double>(random() % 8);
  options.a_srs = "EPSG:32611";
  BuildResources resources;
  resources.overwrite = true;
  build({source}, path, options, resources);
  std::error_code ignored;
  std::filesystem::remove(source, ignored);
  terrain = std::make_unique<Terrain>(Terrain::open(path));
  full = terrain->refine({}).tin;
}

SmallTerrain::~SmallTerrain() {
  terrain.reset();
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

TrueSight true_sight(const SmallTerrain& t, Spot p, double height_p, Spot q, double height_q,
                     bool absolute, double bend) {
  const RationalPoint a = rational_of(p);
  const RationalPoint b = rational_of(q);
  const std::optional<Rational> za = end_height(t, a, height_p, absolute);
  const std::optional<Rational> zb = end_height(t, b, height_q, absolute);
  TrueSight truth;
  truth.state_p = state_at(t.full, a);
  truth.state_q = state_at(t.full, b);
  truth.defined = za && zb;
  if (!truth.defined) return truth;
  const Rational k(bend);
  const auto line = [&](const Rational& s) -> Rational {
    return *za * (1 - s) + *zb * s - k * s * (1 - s);
  };
  truth.first = 2.0;
  std::vector<std::pair<Rational, Rational>> over_surface;
  for (TriangleId triangle = 0; triangle < t.full.triangles.size(); ++triangle) {
    const std::optional<Shares> in = shares_in(t.full, triangle, a, b);
    if (!in || t.full.classes[triangle] != TriangleClass::kSurface) continue;
    const Rational c0 = clearance_at(t, triangle, along(a, b, in->from), line(in->from));
    const Rational c1 = clearance_at(t, triangle, along(a, b, in->to), line(in->to));
    Rational least = std::min(c0, c1);
    const bool point = in->from == in->to;
    if (!point && k > 0) {
      const Rational at = (in->from + in->to) / 2 - (c1 - c0) / (2 * k * (in->to - in->from));
      if (at > in->from && at < in->to) {
        least = std::min(least, Rational(c0 - k * (at - in->from) * (at - in->from)));
      }
    }
    if (!truth.clearance || least < *truth.clearance) truth.clearance = least;
    if (!point) over_surface.emplace_back(in->from, in->to);
    if (least >= 0 || (point && (in->from == 0 || in->from == 1))) continue;
    truth.hidden = true;
    double s = in->from.convert_to<double>();
    if (c0 > 0) {  // the first root, by halving on the falling part
      double low = s;
      double high = in->to.convert_to<double>();
      const double d0 = c0.convert_to<double>();
      const double d1 = c1.convert_to<double>();
      const double width = high - low;
      const auto clearance = [&](double at) {
        const double u = (at - s) / width;
        return d0 * (1 - u) + d1 * u - bend * (at - s) * (s + width - at);
      };
      if (bend > 0) {
        const double bottom = s + width / 2 - (d1 - d0) / (2 * bend * width);
        if (bottom > low && bottom < high) high = bottom;
      }
      for (int i = 0; i < 200; ++i) {
        const double middle = (low + high) / 2;
        (clearance(middle) >= 0 ? low : high) = middle;
      }
      s = low;
    }
    truth.first = std::min(truth.first, s);
  }
  const std::set<Rational> all = stops(t.full, a, b);
  double covered = 0.0;
  std::sort(over_surface.begin(), over_surface.end());
  Rational reached = 0;
  for (const auto& [from, to] : over_surface) {
    const Rational begin = std::max(from, reached);
    if (to > begin) {
      covered += Rational(to - begin).convert_to<double>();
      reached = to;
    }
  }
  if (all.size() == 1) truth.clearance.reset();  // a point of the border has no stretch
  if (!all.empty()) {
    truth.void_share = Rational(*all.rbegin() - *all.begin()).convert_to<double>() - covered;
  }
  return truth;
}

std::optional<Rational> least_clearance_near(const SmallTerrain& t, Spot p, double height_p, Spot q,
                                             double height_q, bool absolute, double bend,
                                             double share) {
  const RationalPoint a = rational_of(p);
  const RationalPoint b = rational_of(q);
  const Rational za = *end_height(t, a, height_p, absolute);
  const Rational zb = *end_height(t, b, height_q, absolute);
  const Rational reach = Rational(1) / (1 << 30);
  std::optional<Rational> least;
  for (TriangleId triangle = 0; triangle < t.full.triangles.size(); ++triangle) {
    const std::optional<Shares> in = shares_in(t.full, triangle, a, b);
    if (!in || t.full.classes[triangle] != TriangleClass::kSurface) continue;
    const Rational from = std::max(in->from, Rational(Rational(share) - reach));
    const Rational to = std::min(in->to, Rational(Rational(share) + reach));
    for (const Rational& s : {from, to}) {
      if (from > to) continue;
      const Rational line = za * (1 - s) + zb * s - Rational(bend) * s * (1 - s);
      const Rational clearance = clearance_at(t, triangle, along(a, b, s), line);
      if (!least || clearance < *least) least = clearance;
    }
  }
  return least;
}

namespace {

/// p + n/2 * (x, y).
Spot moved(Spot p, std::int64_t n, std::int64_t x, std::int64_t y) {
  return {p.x + n * x / 2, p.y + n * y / 2};
}

/// A vertex of the domain's border where that turns, mostly.
Spot nasty_corner(std::mt19937_64& random, const Tin& tin) {
  Spot corner = spot_of(tin.position(0));
  const auto x = static_cast<std::int64_t>(random() % 3) - 1;
  const auto y = static_cast<std::int64_t>(random() % 3) - 1;
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    const Spot s = spot_of(tin.position(v));
    if (s.x * x + s.y * y > corner.x * x + corner.y * y) corner = s;
  }
  return corner;
}

}  // namespace

std::pair<Spot, Spot> nasty_line(std::mt19937_64& random, const Tin& tin) {
  constexpr std::int64_t kUnit = std::int64_t{1} << kSpotBits;
  const auto below = [&](unsigned n) { return static_cast<std::int64_t>(random() % n); };
  const auto vertex = [&] {
    return spot_of(tin.position(static_cast<VertexId>(random() % tin.vertices.size())));
  };
  const Triangle& t = tin.triangles[random() % tin.triangles.size()];
  const int i = static_cast<int>(below(3));
  Spot at = vertex();
  std::int64_t x = (below(7) - 3) * kUnit;
  std::int64_t y = (below(7) - 3) * kUnit;
  switch (random() % 6) {
    case 0: {  // along an edge
      at = spot_of(tin.position(t.v[i]));
      const Spot to = spot_of(tin.position(t.v[next_corner(i)]));
      x = to.x - at.x;
      y = to.y - at.y;
      break;
    }
    case 1:  // along a row, a column or a diagonal
      x = (below(3) - 1) * kUnit;
      y = (below(3) - 1) * kUnit;
      break;
    case 2: {  // through two vertices
      const Spot to = vertex();
      x = to.x - at.x;
      y = to.y - at.y;
      break;
    }
    case 3:
      at = nasty_corner(random, tin);
      break;
    case 4:  // through any vertex
      break;
    default:
      return {nasty_spot(random, tin), nasty_spot(random, tin)};
  }
  return {moved(at, -below(9), x, y), moved(at, below(9), x, y)};
}

}  // namespace ptin::reference
