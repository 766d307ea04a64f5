// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/query/reference_hierarchy.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <unistd.h>

#include "engine/geometry/infinity.h"
#include "engine/geometry/orient.h"
#include "engine/mesh/collapse.h"
#include "engine/mesh/star.h"
#include "engine/query/select/coarsest.h"
#include "storage/short_float.h"
#include "storage/store_writer.h"
#include "tests/support/kept_interval.h"
#include "tests/support/replayed_stars.h"

namespace ptin::reference {

namespace {

constexpr HeightEncoding kHeights{HeightType::int32, 0.25, -3.0};

/// What a triangle carries of the record that created it.
struct Carried {
  GridBox roi;
  Interval heights;  // Codes.
  double error = 0.0;
  double deviation = 0.0;
  int rank = -1;
  std::vector<VertexId> samples;  // Vertices that went and lie in it.
};

float rounded_up(double v) {
  const auto f = static_cast<float>(v);
  return f < v ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

class Simplifier {
 public:
  Simplifier(Tin full, std::mt19937_64& random, const Options& options)
      : tin_(std::move(full)), carried_(tin_.triangles.size()), random_(random), options_(options) {
    result_.full = tin_;
  }

  Hierarchy run() {
    std::vector<VertexId> order(tin_.vertices.size());
    for (VertexId v = 0; v < order.size(); ++v) {
      order[v] = v;
    }
    const auto least = static_cast<std::size_t>(options_.left * static_cast<double>(order.size()));
    std::size_t alive = order.size();
    for (bool changed = true; changed && alive > least;) {
      changed = false;
      std::shuffle(order.begin(), order.end(), random_);
      for (const VertexId v : order) {
        if (alive > least && tin_.vertices[v].triangle != kNone && try_collapse(v)) {
          changed = true;
          --alive;
        }
      }
    }
    finish();
    return std::move(result_);
  }

 private:
  bool is_surface(TriangleId t) const { return tin_.classes[t] == TriangleClass::kSurface; }
  double code(VertexId v) const { return kHeights.code(tin_.vertices[v].height); }

  bool try_collapse(VertexId u) {
    walk_star(tin_, u, star_);
    std::vector<std::size_t> choices;
    for (std::size_t j = 0; j < star_.degree(); ++j) {
      if (can_collapse(tin_, star_, j) && classes_allow(j)) {
        choices.push_back(j);
      }
    }
    if (choices.empty()) {
      return false;
    }
    collapse_into(choices[random_() % choices.size()]);
    return true;
  }

  /// A surface triangle needs three heights; of the fan only w is new to its triangles.
  bool classes_allow(std::size_t j) const {
    const VertexId w = star_.link[j];
    return tin_.has_height[w] != 0 ||
           std::none_of(star_.triangles.begin(), star_.triangles.end(), [&](TriangleId t) {
             const Triangle& triangle = tin_.triangles[t];
             return is_surface(t) && triangle.v[0] != w && triangle.v[1] != w && triangle.v[2] != w;
           });
  }

  /// True when one of the triangles is a surface triangle around `v`.
  bool has_surface_at(const std::vector<TriangleId>& triangles, VertexId v) const {
    return std::any_of(triangles.begin(), triangles.end(), [&](TriangleId t) {
      const auto& corners = tin_.triangles[t].v;
      return tin_.is_alive(t) && is_surface(t) && std::find(corners, corners + 3, v) != corners + 3;
    });
  }

  void collapse_into(std::size_t j) {
    Carried own;
    const VertexId u = star_.center;
    std::vector<VertexId> ring = star_.link;
    ring.push_back(u);
    std::vector<VertexId> surface_before;
    for (const VertexId v : ring) {
      own.roi = united(own.roi, tin_.position(v));
      if (tin_.has_height[v] != 0) {
        own.heights = united(own.heights, code(v));
      }
      if (v != u && tin_.has_height[v] != 0 && has_surface_at(star_.triangles, v)) {
        surface_before.push_back(v);
      }
    }
    for (const TriangleId t : star_.triangles) {
      const Carried& c = carried_[t];
      own.roi = united(own.roi, c.roi);
      own.heights = united(own.heights, c.heights);
      own.error = std::max(own.error, c.error);
      own.deviation = std::max(own.deviation, c.deviation);
      own.rank = std::max(own.rank, c.rank);
      own.samples.insert(own.samples.end(), c.samples.begin(), c.samples.end());
    }
    ++own.rank;
    own.samples.push_back(u);
    VertexSplit r = split_of(j);
    collapse(tin_, star_, j);
    std::vector<TriangleId> fan;
    std::copy_if(star_.triangles.begin(), star_.triangles.end(), std::back_inserter(fan),
                 [&](TriangleId t) { return tin_.is_alive(t); });
    // A sample that loses its surface inside of this star is charged here, whatever lies around it
    // outside: a refinement may hold another state of that.
    for (const VertexId v : surface_before) {
      if (!has_surface_at(fan, v)) {
        own.error = kInfinity;
      }
    }
    hand_over(own, fan);
    complete(r, own);
    result_.records.push_back(r);
  }

  VertexSplit split_of(std::size_t j) const {
    const CollapseSite site = collapse_site(star_, j);
    VertexSplit r;
    r.u = tin_.position(site.u), r.w = tin_.position(site.w);
    r.vl = tin_.position(site.vl), r.vr = tin_.position(site.vr);
    const auto flag = [&](TriangleId t, int missing, int is_void) {
      r.flags |= static_cast<std::uint16_t>(t == kNone ? missing : (is_surface(t) ? 0 : is_void));
    };
    flag(site.left, VertexSplit::kNoLeft, VertexSplit::kLeftVoid);
    flag(site.right, VertexSplit::kNoRight, VertexSplit::kRightVoid);
    if (tin_.has_height[site.u] == 0) {
      r.flags |= VertexSplit::kVertexVoid;
    } else {
      r.height = tin_.vertices[site.u].height;
    }
    return r;
  }

  static void complete(VertexSplit& r, const Carried& own) {
    r.roi = own.roi;
    const bool empty = is_empty(own.heights);
    r.height_lo = kHeights.bits(empty ? 1.0 : own.heights.lo);
    r.height_hi = kHeights.bits(empty ? 0.0 : own.heights.hi);
    r.error = shortened(rounded_up(own.error));
    r.deviation = shortened(rounded_up(own.deviation));
    if (own.rank > 65535) {
      throw std::runtime_error("rank too large");
    }
    r.rank = static_cast<std::uint16_t>(own.rank);
  }

  /// Error of sample `s` in triangle `t` of the fan, or nothing when it lies outside of it.
  std::optional<double> residual(VertexId s, TriangleId t) const {
    const Triangle& triangle = tin_.triangles[t];
    const GridPoint p = tin_.position(s);
    double weighted = 0.0;
    std::int64_t area = 0;
    bool inside = true;
    bool open = true;
    for (int i = 0; i < 3; ++i) {
      const VertexId a = triangle.v[next_corner(i)];
      const VertexId b = triangle.v[previous_corner(i)];
      const std::int64_t part = orient(tin_.position(a), tin_.position(b), p);
      inside &= part >= 0;
      open &= part > 0;
      area += part;
      weighted += static_cast<double>(part) * code(triangle.v[i]);
    }
    if (!inside) {
      return std::nullopt;
    }
    if (tin_.has_height[s] == 0) {
      return is_surface(t) && open ? kInfinity : 0.0;
    }
    if (!is_surface(t)) {
      return kInfinity;
    }
    return std::abs(weighted / static_cast<double>(area) - code(s)) * kHeights.step;
  }

  /// The fan carries the record's attributes, and each sample goes to the triangle that suits it
  /// best.
  void hand_over(Carried& own, const std::vector<TriangleId>& fan) {
    std::vector<std::vector<VertexId>> lists(fan.size());
    for (const VertexId s : own.samples) {
      if (!options_.measured && s != star_.center) {
        continue;
      }
      double least = kInfinity;
      std::size_t home = fan.size();
      for (std::size_t i = 0; i < fan.size(); ++i) {
        const std::optional<double> r = residual(s, fan[i]);
        if (r && (home == fan.size() || *r < least)) {
          least = *r;
          home = i;
        }
      }
      if (home == fan.size()) {
        throw std::runtime_error("a sample lies outside of its fan");
      }
      own.error = std::max(own.error, least);
      lists[home].push_back(s);
    }
    own.deviation = std::max(own.deviation, 1.5 * own.error);
    own.samples.clear();
    for (std::size_t i = 0; i < fan.size(); ++i) {
      carried_[fan[i]] = own;
      if (options_.measured) {
        carried_[fan[i]].samples = std::move(lists[i]);
      }
    }
  }

  void finish() {
    result_.t0 = coarsest_of(tin_);
    for (VertexSplit& r : result_.records) test::keep_interval(r, kHeights.type);
    result_.stars =
        test::replayed_stars(mesh_of(result_.t0, "reference"), result_.t0, result_.records);
    StoreFacts& facts = result_.facts;
    facts.map = {1000.0, -500.0, 0.5, 0.5};
    facts.heights = kHeights;
    facts.min_height = kInfinity;
    facts.max_height = -kInfinity;
    for (VertexId v = 0; v < result_.full.vertices.size(); ++v) {
      facts.bounds = united(facts.bounds, result_.full.position(v));
      if (result_.full.has_height[v] != 0) {
        const double h = kHeights.height(result_.full.vertices[v].height);
        facts.min_height = std::min(facts.min_height, h);
        facts.max_height = std::max(facts.max_height, h);
        ++facts.source_samples;
      }
    }
  }

  Tin tin_;
  std::vector<Carried> carried_;
  std::mt19937_64& random_;
  Options options_;
  Star star_;
  Hierarchy result_;
};

std::uint32_t height_bits(double v) { return kHeights.bits(std::round(v)); }

}  // namespace

CoarsestTin coarsest_of(const Tin& tin) {
  CoarsestTin t0;
  std::vector<VertexId> number(tin.vertices.size(), kNone);
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    if (tin.vertices[v].triangle != kNone) {
      number[v] = static_cast<VertexId>(t0.vertices.size());
      t0.vertices.push_back({tin.position(v), tin.vertices[v].height, tin.has_height[v]});
    }
  }
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.is_alive(t)) {
      const Triangle& triangle = tin.triangles[t];
      t0.triangles.push_back({{number[triangle.v[0]], number[triangle.v[1]], number[triangle.v[2]]},
                              tin.classes[t] == TriangleClass::kVoid ? 1u : 0u});
    }
  }
  return t0;
}

Tin random_grid(std::mt19937_64& random, int width, int height, int spacing, double voids) {
  CoarsestTin t;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const double fx = 0.1 + unit(random) * 0.3;
  const double fy = 0.1 + unit(random) * 0.3;
  const double noise = unit(random) * 6.0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool is_void = unit(random) < voids;
      const double z = 40.0 * std::sin(fx * x) * std::cos(fy * y) + noise * unit(random);
      t.vertices.push_back(
          {{x * spacing, y * spacing}, is_void ? 0u : height_bits(z), is_void ? 0u : 1u});
    }
  }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const bool surface = t.vertices[a].has_height != 0 && t.vertices[b].has_height != 0 &&
                         t.vertices[c].has_height != 0;
    t.triangles.push_back({{a, b, c}, surface ? 0u : 1u});
  };
  for (int y = 0; y + 1 < height; ++y) {
    for (int x = 0; x + 1 < width; ++x) {
      const auto a = static_cast<std::uint32_t>(y * width + x);
      const std::uint32_t b = a + 1;
      const auto d = a + static_cast<std::uint32_t>(width);
      const std::uint32_t c = d + 1;
      if (random() % 2 == 0) {
        add(a, b, c);
        add(a, c, d);
      } else {
        add(a, b, d);
        add(b, c, d);
      }
    }
  }
  return mesh_of(t, "random grid");
}

Tin random_points(std::mt19937_64& random, int count, int side) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  CGAL::Delaunay_triangulation_2<Kernel> delaunay;
  for (const auto& [x, y] : {std::pair{0, 0}, {side, 0}, {side / 2, side}}) {
    delaunay.insert({static_cast<double>(x), static_cast<double>(y)});
  }
  for (int i = 0; i < count; ++i) {
    const auto coordinate = [&] {
      return static_cast<int>(random() % static_cast<std::uint64_t>(side + 1));
    };
    int x = coordinate();
    int y = random() % 8 == 0 ? 0 : coordinate();
    if (random() % 4 == 0) {
      x -= x % 10;
      y -= y % 10;
    }
    delaunay.insert({static_cast<double>(x), static_cast<double>(y)});
  }
  CoarsestTin t;
  std::map<VertexKey, std::uint32_t> number;
  const auto vertex = [&](const auto& handle) {
    const GridPoint p{static_cast<int>(handle->point().x()), static_cast<int>(handle->point().y())};
    const auto [it, added] =
        number.emplace(key_of(p), static_cast<std::uint32_t>(t.vertices.size()));
    if (added) {
      t.vertices.push_back(
          {p, height_bits(20.0 * std::sin(0.05 * p.x) + static_cast<double>(random() % 9)), 1});
    }
    return it->second;
  };
  for (auto f = delaunay.finite_faces_begin(); f != delaunay.finite_faces_end(); ++f) {
    t.triangles.push_back({{vertex(f->vertex(0)), vertex(f->vertex(1)), vertex(f->vertex(2))}, 0});
  }
  return mesh_of(t, "random points");
}

Hierarchy simplify(Tin full, std::mt19937_64& random, const Options& options) {
  return Simplifier(std::move(full), random, options).run();
}

Hierarchy random_hierarchy(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto size = [&] { return 2 + static_cast<int>(random() % 22); };
  const Options options{random() % 3 == 0 ? 0.2 : 0.0, true};
  switch (random() % 3) {
    case 0:
      return simplify(random_grid(random, size(), size(), 1 + static_cast<int>(random() % 5), 0.0),
                      random, options);
    case 1:
      return simplify(random_grid(random, size(), size(), 1, 0.15), random, options);
    default:
      return simplify(random_points(random, 20 + static_cast<int>(random() % 400), 100), random,
                      options);
  }
}

TemporaryStore::TemporaryStore(const Hierarchy& hierarchy, std::uint32_t page_bytes, int segments,
                               const DirectoryOptions& directory) {
  static std::atomic<int> number{0};
  path = (std::filesystem::temp_directory_path() /
          ("ptin_query_" + std::to_string(::getpid()) + "_" + std::to_string(number++) + ".ptin"))
             .string();
  StoreWriterOptions options;
  options.overwrite = true;
  options.page_bytes = page_bytes;
  options.directory = directory;
  const auto writer = StoreWriter::create(path, options);
  const StarredRecords records = test::changed_stars(hierarchy.stars, hierarchy.records);
  const std::size_t each = records.size() / static_cast<std::size_t>(segments) + 1;
  for (std::size_t begin = 0; begin < records.size(); begin += each) {
    writer->add_segment(
        test::pack_unchecked(test::part_of(records, begin, std::min(begin + each, records.size())),
                             hierarchy.facts.heights, page_bytes),
        hierarchy.facts.heights);
  }
  StoreFacts facts = hierarchy.facts;
  facts.page_bytes = page_bytes;
  facts.free_of_voids = std::find(hierarchy.full.classes.begin(), hierarchy.full.classes.end(),
                                  TriangleClass::kVoid) == hierarchy.full.classes.end();
  writer->publish(facts, hierarchy.t0, "{}");
}

TemporaryStore::~TemporaryStore() {
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

std::shared_ptr<const StoreFile> TemporaryStore::open(PageAccess access) const {
  return StoreFile::open(path, access);
}

Corners corners_of(const Tin& tin, TriangleId t) {
  const Triangle& triangle = tin.triangles[t];
  VertexKey k[3];
  for (int i = 0; i < 3; ++i) {
    k[i] = key_of(tin.position(triangle.v[i]));
  }
  const int first = static_cast<int>(std::min_element(k, k + 3) - k);
  return {k[first], k[next_corner(first)], k[previous_corner(first)], tin.classes[t]};
}

std::vector<Corners> canonical(const Tin& tin) {
  std::vector<Corners> all;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.is_alive(t)) {
      all.push_back(corners_of(tin, t));
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace ptin::reference
