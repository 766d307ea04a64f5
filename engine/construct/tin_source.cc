// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin_source.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/construct/crs.h"
#include "engine/construct/height_fit_internal.h"
#include "engine/construct/hull_delaunay.h"
#include "engine/construct/point_grid.h"
#include "engine/construct/sliver_flips.h"
#include "engine/construct/tin_faults.h"
#include "engine/construct/tin_link.h"
#include "engine/construct/tin_soup.h"
#include "engine/error.h"
#include "engine/geometry/orient.h"

namespace ptin {

namespace {

// ---------------------------------------------------------------------------------------------------
// The soup made smaller.

/// Leaves out triangles with a corner of the height that means nothing.
std::uint64_t drop_without_height(TinSoup& soup, const std::optional<double>& nodata) {
  if (!nodata) {
    return 0;
  }
  const auto end = std::remove_if(soup.triangles.begin(), soup.triangles.end(),
                                  [&](const std::array<std::uint32_t, 3>& t) {
                                    return std::any_of(t.begin(), t.end(), [&](std::uint32_t v) {
                                      return to_double(soup.vertices[v].z) == *nodata;
                                    });
                                  });
  const auto dropped = static_cast<std::uint64_t>(soup.triangles.end() - end);
  soup.triangles.erase(end, soup.triangles.end());
  return dropped;
}

/// Keeps the vertices of triangles alone; returns how many went.
std::uint64_t drop_unused(TinSoup& soup) {
  std::vector<std::uint32_t> number(soup.vertices.size(), 0);
  for (const auto& t : soup.triangles) {
    for (const std::uint32_t v : t) {
      number[v] = 1;
    }
  }
  std::uint32_t kept = 0;
  for (std::uint32_t v = 0; v < number.size(); ++v) {
    if (number[v] != 0) {
      soup.vertices[kept] = soup.vertices[v];
      number[v] = kept++;
    }
  }
  const std::uint64_t dropped = soup.vertices.size() - kept;
  soup.vertices.resize(kept);
  for (auto& t : soup.triangles) {
    for (std::uint32_t& v : t) {
      v = number[v];
    }
  }
  return dropped;
}

// ---------------------------------------------------------------------------------------------------
// The grid.

/// How many digits behind the point the grid can keep of these coordinates, of those they have.
int decimals_kept(const std::vector<SourcePoint>& points) {
  constexpr double kRoom = 4.0;  // so that rounding cannot exceed the grid
  int decimals = 0;
  double extent = 0.0, farthest = 0.0;
  for (Decimal SourcePoint::*axis : {&SourcePoint::x, &SourcePoint::y}) {
    double low = INFINITY, high = -INFINITY;
    for (const SourcePoint& p : points) {
      const double value = to_double(p.*axis);
      low = std::min(low, value);
      high = std::max(high, value);
      decimals = std::max(decimals, static_cast<int>((p.*axis).decimals));
    }
    extent = std::max(extent, high - low);
    farthest = std::max({farthest, std::abs(low), std::abs(high)});
  }
  const auto fits = [&](int d) {
    const double step = decimal_step(d);
    return extent / step <= kGridMax - kRoom && farthest / step < 0x1p62;
  };
  while (decimals > 0 && !fits(decimals)) {
    --decimals;
  }
  return decimals;
}

/// Rounds to so many digits, half away from zero. Returns how far the number moved.
double round_to(Decimal& value, int decimals) {
  const double before = to_double(value);
  if (value.decimals <= decimals) {
    return 0.0;
  }
  for (; value.decimals > decimals + 1; --value.decimals) {
    value.mantissa /= 10;
  }
  const std::int64_t last = value.mantissa % 10;
  value.mantissa = value.mantissa / 10 + (last >= 5 ? 1 : (last <= -5 ? -1 : 0));
  --value.decimals;
  for (; value.decimals > 0 && value.mantissa % 10 == 0; --value.decimals) {
    value.mantissa /= 10;
  }
  return std::abs(to_double(value) - before);
}

/// Drops the digits that the grid cannot keep. Returns how far a vertex moved at most.
double drop_digits(std::vector<SourcePoint>& points) {
  const int decimals = decimals_kept(points);
  double shift = 0.0;
  for (SourcePoint& p : points) {
    const double dx = round_to(p.x, decimals);
    const double dy = round_to(p.y, decimals);
    shift = std::max(shift, std::sqrt(dx * dx + dy * dy));
  }
  return shift;
}

PointGrid grid_of(const std::vector<SourcePoint>& points, const SourceOptions& options,
                  const std::string& path) {
  PointGridScan scan(options.resolution, path);
  scan.add_source({});
  for (const SourcePoint& p : points) {
    scan.add(p);
  }
  return scan.grid();
}

// ---------------------------------------------------------------------------------------------------
// Vertices on the grid.

/// Distinct positions in the order of their keys, with heights as PointGrid::height() has them.
struct SnappedMesh {
  std::vector<GridPoint> positions;
  std::vector<double> heights;
  std::vector<Corners> triangles;
};

SnappedMesh snap(const TinSoup& soup, const PointGrid& grid, TinTerrain& terrain,
                 TinFaults& faults) {
  const std::size_t n = soup.vertices.size();
  std::vector<VertexKey> keys(n);
  std::vector<double> heights(n);
  for (std::size_t i = 0; i < n; ++i) {
    keys[i] = key_of(grid.position(soup.vertices[i]));
    heights[i] = grid.height(soup.vertices[i].z);
    terrain.largest_shift_plan = std::max(terrain.largest_shift_plan, grid.shift(soup.vertices[i]));
  }
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return keys[a] != keys[b] ? keys[a] < keys[b] : heights[a] < heights[b];
  });
  SnappedMesh mesh;
  std::vector<VertexId> number(n);
  bool has_conflict = false;  // of the position before
  for (const std::uint32_t i : order) {
    const GridPoint p = point_of(keys[i]);
    if (mesh.positions.empty() || mesh.positions.back() != p) {
      mesh.positions.push_back(p);
      mesh.heights.push_back(heights[i]);
      has_conflict = false;
    } else {
      ++terrain.merged_vertices;
      if (mesh.heights.back() != heights[i] && !has_conflict) {
        faults.heights.add(p);
        has_conflict = true;
      }
    }
    number[i] = static_cast<VertexId>(mesh.positions.size() - 1);
  }
  mesh.triangles.reserve(soup.triangles.size());
  for (const auto& t : soup.triangles) {
    mesh.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  }
  return mesh;
}

// ---------------------------------------------------------------------------------------------------
// What is wrong, in words.

class FaultReport {
 public:
  FaultReport(const PointGrid& grid, std::string path) : map_(grid.map()), path_(std::move(path)) {}

  void add(const TinFault& fault, const char* one, const char* many) {
    if (fault.count == 0) {
      return;
    }
    const MapPoint at = map_.to_map(fault.first.x, fault.first.y);
    char place[80];
    std::snprintf(place, sizeof place, " (%s at %.10g %.10g)", fault.count > 1 ? "first" : "it is",
                  at.x, at.y);
    text_ += (text_.empty() ? "" : "; ") + std::to_string(fault.count) + " " +
             (fault.count == 1 ? one : many) + place;
  }
  void throw_if_any() const {
    if (!text_.empty()) {
      throw Error(ErrorCode::invalid_argument,
                  "these triangles are no terrain: " + text_ +
                      "; mend the file, or let --repair triangulate its points anew",
                  path_);
    }
  }

 private:
  AffineMap map_;
  std::string path_;
  std::string text_;
};

void refuse_faults(const TinFaults& f, const PointGrid& grid, const std::string& path) {
  FaultReport report(grid, path);
  report.add(f.no_area, "triangle has no area", "triangles have no area");
  report.add(f.turned_over, "triangle is turned over", "triangles are turned over");
  report.add(f.heights, "position has several heights", "positions have several heights");
  report.add(f.shared_edges, "edge has two triangles on one side",
             "edges have two triangles on one side");
  report.add(f.t_junctions, "vertex lies inside of an edge (T-junction)",
             "vertices lie inside of an edge (T-junctions)");
  report.add(f.crossings, "pair of border edges crosses", "pairs of border edges cross");
  report.add(f.covered, "piece is covered more than once", "pieces are covered more than once");
  report.throw_if_any();
}

// ---------------------------------------------------------------------------------------------------
// Slivers.

/// Twice the area of a triangle of the file; its sign is right but for the flattest of all.
long double source_area(const TinSoup& soup, const std::array<std::uint32_t, 3>& t) {
  const auto value = [](Decimal d) {
    return static_cast<long double>(d.mantissa) * std::pow(10.0L, -d.decimals);
  };
  const SourcePoint& a = soup.vertices[t[0]];
  const SourcePoint& b = soup.vertices[t[1]];
  const SourcePoint& c = soup.vertices[t[2]];
  return (value(b.x) - value(a.x)) * (value(c.y) - value(a.y)) -
         (value(b.y) - value(a.y)) * (value(c.x) - value(a.x));
}

/// Which way round the triangles of the file are: 1 counter-clockwise, -1 clockwise, 0 flat.
std::vector<std::int8_t> source_signs(const TinSoup& soup) {
  std::vector<std::int8_t> signs;
  signs.reserve(soup.triangles.size());
  for (const auto& t : soup.triangles) {
    const long double area = source_area(soup, t);
    signs.push_back(area > 0 ? 1 : (area < 0 ? -1 : 0));
  }
  return signs;
}

/// Turns the mesh upright, then flips away what only snapping has spoiled. Returns the number.
std::uint64_t straighten(const std::vector<std::int8_t>& signs, SnappedMesh& mesh) {
  const std::int8_t upright = turn_majority(mesh.positions, mesh.triangles) ? -1 : 1;
  std::vector<std::uint32_t> slivers;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners& c = mesh.triangles[t];
    if (signs[t] == upright &&
        orient(mesh.positions[c[0]], mesh.positions[c[1]], mesh.positions[c[2]]) <= 0) {
      slivers.push_back(t);
    }
  }
  return flip_slivers(mesh.positions, mesh.triangles, std::move(slivers));
}

/// Checks everything; returns the triangles that fill the hull.
std::vector<Corners> check_and_fill(const SnappedMesh& mesh, const PointGrid& grid,
                                    const std::string& path, TinFaults& faults,
                                    const std::stop_token& stop) {
  check_orientation(mesh.positions, mesh.triangles, faults);
  const std::vector<BorderEdge> border = border_of(mesh.positions, mesh.triangles, faults);
  // Of triangles that are wrong one by one, the border says nothing more.
  refuse_faults(faults, grid, path);
  check_border(mesh.positions, border, faults);
  refuse_faults(faults, grid, path);
  std::vector<Corners> filling = fill_hull(mesh.positions, border, faults, stop);
  refuse_faults(faults, grid, path);
  return filling;
}

HeightFit fit_of(const std::vector<double>& heights, const PointGrid& grid) {
  if (!grid.whole) {
    HeightScan scan(HeightScan::Given::kFloat64);
    for (const double height : heights) {
      scan.add(height);
    }
    return scan.fit();
  }
  HeightFit fit;
  fit.encoding = {HeightType::int32, grid.heights.unit(), 0.0};
  fit.quantum = grid.heights.unit();
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  fit.min_height = fit.encoding.height_of_code(*low);
  fit.max_height = fit.encoding.height_of_code(*high);
  return fit;
}

void fill_tin(const SnappedMesh& mesh, const std::vector<Corners>& filling, bool whole,
              TinTerrain& terrain) {
  Tin& tin = terrain.tin;
  const HeightEncoding& encoding = terrain.frame.heights;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const HeightBits bits =
        whole ? encoding.bits(mesh.heights[i]) : encode_height(encoding, mesh.heights[i]);
    tin.vertices.push_back({mesh.positions[i], bits, kNone});
  }
  tin.has_height.assign(tin.vertices.size(), 1);
  for (const std::vector<Corners>* part : {&mesh.triangles, &filling}) {
    for (const Corners& t : *part) {
      tin.triangles.push_back({{t[0], t[1], t[2]}, {kNone, kNone, kNone}});
    }
  }
  tin.classes.assign(tin.triangles.size(), TriangleClass::kVoid);
  std::fill_n(tin.classes.begin(), mesh.triangles.size(), TriangleClass::kSurface);
  link_tin(tin);
}

TinReading reading_of(const PointChoice& choice, std::uint64_t memory_bytes,
                      const std::stop_token& stop,
                      const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  return {choice.layer, memory_bytes, stop, progress};
}

}  // namespace

TinTerrain read_tin(const std::string& path, const SourceOptions& options,
                    std::uint64_t memory_bytes, const std::stop_token& stop,
                    const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  if (options.bbox) {
    throw Error(ErrorCode::invalid_argument,
                "a TIN is not cut by --bbox; build it whole, then refine or export a window", path);
  }
  TinSoup soup = read_tin_soup(path, reading_of(options.points, memory_bytes, stop, progress));
  TinTerrain terrain;
  terrain.left_out_triangles = soup.hidden_triangles + drop_without_height(soup, options.nodata);
  if (soup.triangles.empty()) {
    throw Error(ErrorCode::invalid_argument, "no triangle has a height", path);
  }
  terrain.unused_vertices = drop_unused(soup);
  set_crs(terrain.frame,
          resolve_crs(soup.crs, options.a_srs,
                      options.vertical_crs.empty() ? soup.vertical_crs : options.vertical_crs));
  const std::vector<std::int8_t> signs = source_signs(soup);
  const double dropped = drop_digits(soup.vertices);
  const PointGrid grid = grid_of(soup.vertices, options, path);
  terrain.frame.map = grid.map();
  TinFaults faults;
  SnappedMesh mesh = snap(soup, grid, terrain, faults);
  terrain.largest_shift_plan += dropped;
  soup = {};
  terrain.mended_triangles = straighten(signs, mesh);
  terrain.surface_triangles = mesh.triangles.size();
  const std::vector<Corners> filling = check_and_fill(mesh, grid, path, faults, stop);
  set_heights(terrain.frame, fit_of(mesh.heights, grid));
  fill_tin(mesh, filling, grid.whole, terrain);
  return terrain;
}

TinVertices::TinVertices(const std::string& path, const PointChoice& choice) {
  TinSoup soup = read_tin_soup(path, reading_of(choice, UINT64_MAX, {}, {}));
  left_out_ = drop_unused(soup);
  facts_.crs = soup.crs;
  static_cast<void>(drop_digits(soup.vertices));
  points_ = std::move(soup.vertices);
}

bool TinVertices::next(std::vector<SourcePoint>& batch) {
  constexpr std::size_t kBatchPoints = 4096;
  const std::size_t end = std::min<std::size_t>(points_.size(), next_ + kBatchPoints);
  batch.assign(points_.begin() + static_cast<std::ptrdiff_t>(next_),
               points_.begin() + static_cast<std::ptrdiff_t>(end));
  next_ = end;
  return !batch.empty();
}

}  // namespace ptin
