// SPDX-License-Identifier: GPL-3.0-or-later
//
// The figures 4 and 5 of the paper: what a window and a point retrieve, on random and real TINs, as
// lines of CSV.
//
//   windows  of 1/25 and 1/4 of the area at 50 x 50 regular places: splits retrieved over vertices
//            in the window
//   points   at 50 x 50 regular places: splits retrieved; and splits whose own polygon P(u) holds
//            the point
//
// Random TINs are uniform points in the unit square under Delaunay; real ones take the 10 000 or
// 20 000 most important vertices of a built store as points. "Retrieved" is what our engine
// retrieves and applies: records whose saturated box meets the query, so that the mesh stays valid
// everywhere. The paper counts the splits performed for its own box and its own collapse, and says
// that a point never needs more than 70; that is the number of those retrieved here, which is larger.
// Own polygons are another number: the splits that change the surface over
// the point. Everything is counted here in memory by brute force; for one size the store is
// written, opened and asked the same, and the program fails when the answers differ.
//
// usage: paper_figures [OUT.csv] [LARGEST]
// sizes above LARGEST (default 50 000; 1 000 000 gives all) are left out
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "bench/support/scratch.h"
#include "bench/support/terrain.h"
#include "engine/construct/build.h"
#include "engine/construct/collapse/simplify.h"
#include "engine/construct/store_output.h"
#include "engine/geometry/orient.h"
#include "engine/mesh/split.h"
#include "engine/mesh/star.h"
#include "engine/query/questions.h"

namespace {

using namespace ptin;
using namespace ptin::bench;

constexpr int kPlaces = 50;  ///< In a row: 2500 in all.

struct MeanAndWorst {
  double sum = 0, worst = 0;
  int count = 0;
  void add(double v) {
    sum += v;
    worst = std::max(worst, v);
    ++count;
  }
  [[nodiscard]] double mean() const { return count == 0 ? 0 : sum / count; }
};

/// Boxes by coordinate, so that counting those that meet a box is a loop that the compiler turns
/// into vector code.
class Boxes {
 public:
  void add(const GridBox& b) {
    min_x_.push_back(b.min_x);
    min_y_.push_back(b.min_y);
    max_x_.push_back(b.max_x);
    max_y_.push_back(b.max_y);
  }
  [[nodiscard]] std::uint32_t meeting(const GridBox& q) const {
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < min_x_.size(); ++i) {
      count += static_cast<std::uint32_t>((min_x_[i] <= q.max_x) & (q.min_x <= max_x_[i]) &
                                          (min_y_[i] <= q.max_y) & (q.min_y <= max_y_[i]));
    }
    return count;
  }

 private:
  std::vector<std::int32_t> min_x_, min_y_, max_x_, max_y_;
};

GridBox bounds_of(const Tin& tin) {
  GridBox bounds;
  for (const Vertex& v : tin.vertices) bounds = united(bounds, v.position);
  return bounds;
}

/// The window of 1 / denominator of the area at place (i, j).
GridBox window_at(const GridBox& bounds, int denominator, int i, int j) {
  const double share = 1 / std::sqrt(denominator);
  const double width = double(bounds.max_x) - bounds.min_x;
  const double height = double(bounds.max_y) - bounds.min_y;
  const double x = bounds.min_x + width * (1 - share) * i / (kPlaces - 1);
  const double y = bounds.min_y + height * (1 - share) * j / (kPlaces - 1);
  return {static_cast<std::int32_t>(std::ceil(x)), static_cast<std::int32_t>(std::ceil(y)),
          static_cast<std::int32_t>(std::floor(x + width * share)),
          static_cast<std::int32_t>(std::floor(y + height * share))};
}

GridPoint point_at(const GridBox& bounds, int i, int j) {
  const auto place = [](std::int32_t low, std::int32_t high, int k) {
    return static_cast<std::int32_t>(low + std::floor((double(high) - low) * (k + 0.5) / kPlaces));
  };
  return {place(bounds.min_x, bounds.max_x, i), place(bounds.min_y, bounds.max_y, j)};
}

/// A simplified terrain, and what is counted over it.
class Counted {
 public:
  Counted(MadeTerrain& terrain, CostModel cost) : bounds_(bounds_of(terrain.started.tile.tin)) {
    for (const Vertex& v : terrain.started.tile.tin.vertices) vertices_.add(box_of(v.position));
    SimplifyOptions options;
    options.cost = cost;
    options.compact_above = SIZE_MAX;  // OwnPolygons goes by the ids of the full TIN
    simplify(terrain.started.tile, *terrain.started.full, options);
    for (const VertexSplit& r : terrain.started.tile.records) boxes_.add(r.roi);
  }
  [[nodiscard]] const GridBox& bounds() const { return bounds_; }
  [[nodiscard]] std::uint32_t retrieved(const GridBox& q) const { return boxes_.meeting(q); }
  [[nodiscard]] std::uint32_t vertices(const GridBox& q) const { return vertices_.meeting(q); }

  void add_window_ratios(int denominator, MeanAndWorst& ratios) const {
    for (int i = 0; i < kPlaces * kPlaces; ++i) {
      const GridBox q = window_at(bounds_, denominator, i % kPlaces, i / kPlaces);
      ratios.add(double(retrieved(q)) / std::max(1U, vertices(q)));
    }
  }
  void add_point_splits(MeanAndWorst& splits) const {
    for (int i = 0; i < kPlaces * kPlaces; ++i) {
      splits.add(retrieved(box_of(point_at(bounds_, i % kPlaces, i / kPlaces))));
    }
  }

 private:
  GridBox bounds_;
  Boxes vertices_, boxes_;
};

bool holds(const Tin& tin, const Star& star, GridPoint p) {
  return std::any_of(star.triangles.begin(), star.triangles.end(), [&](TriangleId t) {
    const auto& v = tin.triangles[t].v;
    return orient(tin.position(v[0]), tin.position(v[1]), p) >= 0 &&
           orient(tin.position(v[1]), tin.position(v[2]), p) >= 0 &&
           orient(tin.position(v[2]), tin.position(v[0]), p) >= 0;
  });
}

/// For each place, the records whose own polygon P(u), closed, holds it: the star of u right after
/// its split. Splits the tile back to its full TIN.
class OwnPolygons {
 public:
  OwnPolygons(Tile& tile, const GridBox& bounds) : tin_(tile.tin), bounds_(bounds) {
    for (std::size_t i = tile.records.size(); i-- > 0;) {
      const VertexSplit& r = tile.records[i];
      const auto flag = [&](VertexSplit::Flag f) { return (r.flags & f) != 0; };
      SplitSite site = {id_of(r.u), id_of(r.w), id_of(r.vl), id_of(r.vr)};
      site.has_left = !flag(VertexSplit::kNoLeft);
      site.has_right = !flag(VertexSplit::kNoRight);
      if (!split(tin_, site).applied) {
        std::fprintf(stderr, "record %zu does not split back\n", i);
        std::exit(70);
      }
      count(site.u);
    }
  }
  void add_to(MeanAndWorst& splits) const {
    for (const int held : held_) splits.add(held);
  }

 private:
  /// Points come in order of their keys (delaunay.h), and ids are places in that order.
  [[nodiscard]] VertexId id_of(GridPoint p) const {
    const auto at =
        std::lower_bound(tin_.vertices.begin(), tin_.vertices.end(), key_of(p),
                         [](const Vertex& v, VertexKey key) { return key_of(v.position) < key; });
    return static_cast<VertexId>(at - tin_.vertices.begin());
  }
  void count(VertexId u) {
    walk_star(tin_, u, star_);
    GridBox box = box_of(tin_.position(u));
    for (const VertexId v : star_.link) box = united(box, tin_.position(v));
    const auto first = [](std::int32_t low, std::int32_t high,
                          std::int32_t c) {  // a place before, or at, c
      return std::clamp(static_cast<int>(kPlaces * (double(c) - low) / (double(high) - low)) - 1, 0,
                        kPlaces - 1);
    };
    const auto begin_i = first(bounds_.min_x, bounds_.max_x, box.min_x);
    for (int j = first(bounds_.min_y, bounds_.max_y, box.min_y); j < kPlaces; ++j) {
      if (point_at(bounds_, 0, j).y > box.max_y) break;
      for (int i = begin_i; i < kPlaces && point_at(bounds_, i, j).x <= box.max_x; ++i) {
        held_[j * kPlaces + i] += holds(tin_, star_, point_at(bounds_, i, j)) ? 1 : 0;
      }
    }
  }

  Tin& tin_;
  GridBox bounds_;
  std::array<int, kPlaces * kPlaces> held_{};
  Star star_;
};

/// Writes the records as a store and asks it for every 50th window and point.
void check_against_store(const MadeTerrain& terrain, const Counted& counted) {
  const ScratchFolder folder;
  const std::string path = folder.file("check.ptin");
  const Tile& tile = terrain.started.tile;
  StarredRecords records = starred_records(std::vector(tile.records), 0, RecordStars(tile.stars));
  BuildReport report;
  std::filesystem::create_directory(folder.file("work"));
  StoreOutput output(path, {}, false, terrain.frame, false, FileLayer::system(),
                     folder.file("work"));
  const PreparedSegment segment = output.packer().prepare(records);
  output.packer().place(segment.pages, output.page_bytes());
  output.add(segment);
  output.publish(tile.tin, deaths_of(tile), {"random"}, report);
  const Terrain tin = Terrain::open(path);
  int differences = 0;
  for (int i = 0; i < kPlaces * kPlaces; i += 49) {
    for (const int denominator : {25, 4, 0}) {
      const GridBox q = denominator == 0
                            ? box_of(point_at(counted.bounds(), i % kPlaces, i / kPlaces))
                            : window_at(counted.bounds(), denominator, i % kPlaces, i / kPlaces);
      RefineRequest request;
      request.region = Window{double(q.min_x), double(q.min_y), double(q.max_x), double(q.max_y)};
      const RefinedTin refined = tin.refine(request);
      const auto inside = std::count_if(refined.tin.vertices.begin(), refined.tin.vertices.end(),
                                        [&](const Vertex& v) { return contains(q, v.position); });
      differences += refined.cost.records_applied != counted.retrieved(q) ? 1 : 0;
      differences += inside != static_cast<std::ptrdiff_t>(counted.vertices(q)) ? 1 : 0;
    }
  }
  std::fprintf(stderr, "store path: 52 places, 3 queries each, %d differences\n", differences);
  if (differences != 0) std::exit(70);
}

/// The `count` most important vertices of a real terrain, triangulated as points.
MadeTerrain real_terrain(const std::string& store, std::uint64_t count) {
  const Terrain tin = Terrain::open(store);
  RefineRequest request;
  request.detail.vertices = count;
  const RefinedTin refined = tin.refine(request);
  std::vector<std::pair<VertexKey, HeightBits>> vertices;
  for (const Vertex& v : refined.tin.vertices) vertices.emplace_back(key_of(v.position), v.height);
  std::sort(vertices.begin(), vertices.end());
  GridPoints points;
  for (const auto& [key, height] : vertices) {
    points.positions.push_back(point_of(key));
    points.heights.push_back(height);
  }
  TerrainFrame frame;
  frame.heights = tin.store().facts().heights;
  frame.height_quantum = frame.heights.step;
  return terrain_of(points, frame);
}

/// One line of the CSV: a kind and size of terrain under one cost, over one or several seeds.
struct Line {
  MeanAndWorst t0, rank, small, large, point, own;

  void add(MadeTerrain terrain, CostModel cost, bool check) {
    const std::size_t vertices = terrain.started.tile.tin.vertices.size();
    const Counted counted(terrain, cost);
    Tile& tile = terrain.started.tile;
    if (check) check_against_store(terrain, counted);
    t0.add(double(vertices - tile.records.size()));
    int largest_rank = 0;
    for (const VertexSplit& r : tile.records) largest_rank = std::max<int>(largest_rank, r.rank);
    rank.add(largest_rank);
    counted.add_window_ratios(25, small);
    counted.add_window_ratios(4, large);
    counted.add_point_splits(point);
    OwnPolygons(tile, counted.bounds()).add_to(own);
  }
  void print(std::FILE* csv, const char* name, std::size_t vertices, CostModel cost) const {
    std::fprintf(csv, "%s,%zu,%s,%d,%.0f,%.0f", name, vertices,
                 cost == CostModel::kError ? "error" : "roi", t0.count, t0.worst, rank.worst);
    std::fprintf(csv, ",%.4f,%.4f,%.4f,%.4f", small.mean(), small.worst, large.mean(), large.worst);
    std::fprintf(csv, ",%.2f,%.0f,%.2f,%.0f\n", point.mean(), point.worst, own.mean(), own.worst);
    std::fflush(csv);
  }
};

void measure_random(std::FILE* csv, const char* name, std::size_t vertices, CostModel cost,
                    Relief relief) {
  Line line;
  const std::uint64_t seeds = vertices > 50000 ? 1 : 5;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    line.add(random_terrain(vertices, seed, relief), cost, vertices == 20000 && seed == 1);
  }
  line.print(csv, name, vertices, cost);
}

void measure_real(std::FILE* csv, const std::string& store, CostModel cost) {
  for (const std::size_t vertices : {10000, 20000}) {
    Line line;
    line.add(real_terrain(store, vertices), cost, false);
    line.print(csv, "real", vertices, cost);
  }
}

void measure_all(std::FILE* csv, std::size_t largest) {
  std::fputs(
      "terrain,vertices,cost,seeds,t0,rank,ratio25_mean,ratio25_worst,ratio4_mean,ratio4_worst,"
      "point_mean,point_worst,polygon_mean,polygon_worst\n",
      csv);
  const std::string raster = shared_terrain("srtm1_bigtujunga_utm_1197x643.tif");
  const ScratchFolder folder;
  if (raster.empty()) {
    std::fputs("real TINs left out: they need srtm1_bigtujunga in PTIN_SHARED_DATA\n", stderr);
  } else {
    build({raster}, folder.file("real.ptin"), {}, {});
  }
  for (const CostModel cost : {CostModel::kError, CostModel::kRoi}) {
    for (const std::size_t n : {1000, 2000, 5000, 10000, 20000, 50000, 1000000}) {
      if (n <= largest) measure_random(csv, "random", n, cost, Relief::kHills);
    }
    measure_random(csv, "random_noise", 20000, cost, Relief::kNoise);
    measure_random(csv, "random_flat", 20000, cost, Relief::kFlat);
    if (!raster.empty()) measure_real(csv, folder.file("real.ptin"), cost);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && argv[1][0] == '-') {
    std::fprintf(stderr, "usage: paper_figures [FILE.csv [LARGEST_RANDOM_TIN]]\n");
    return 2;
  }
  std::FILE* csv = argc > 1 ? std::fopen(argv[1], "w") : stdout;
  if (csv == nullptr) {
    std::perror(argv[1]);
    return 6;
  }
  try {
    measure_all(csv, argc > 2 ? std::stoul(argv[2]) : 50000);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "paper_figures: %s\n", e.what());
    return 70;
  }
  return std::fclose(csv) == 0 ? 0 : 6;
}
