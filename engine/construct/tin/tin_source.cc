// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/tin_source.h"

#include <algorithm>
#include <utility>

#include "engine/construct/grid/area_of_use.h"
#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/grid_precision.h"
#include "engine/construct/grid/height_fit.h"
#include "engine/construct/grid/point_order.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/tin/hull_delaunay.h"
#include "engine/construct/tin/tin_border.h"
#include "engine/construct/tin/tin_mend.h"
#include "engine/construct/tin/tin_names.h"
#include "engine/construct/tin/void_sweep.h"
#include "engine/error.h"
#include "engine/mesh/link.h"

namespace ptin {

namespace {

template <class Record>
RecordFile<Record> new_file(const ExternalMemory& memory, const std::string& name) {
  return name.empty() ? RecordFile<Record>(memory, "tin")
                      : RecordFile<Record>(memory.files, name, ScratchFile::Kept::kNew);
}

/// The same records in a file called `name`; the given file where `name` is empty.
template <class Record>
RecordFile<Record> named(RecordFile<Record> file, const ExternalMemory& memory,
                         const std::string& name, const std::stop_token& stop) {
  if (name.empty()) {
    return file;
  }
  RecordFile<Record> to = new_file<Record>(memory, name);
  file.visit([&](const Record& record) { to.add(record); }, stop);
  to.finish();
  return to;
}

/// Writes the triangles along the curve, and mends their slivers.
/// @param kept_as  Name of the file in which they stay; "" for one without a name.
MeshOnDisk mesh_of(TinOnGrid& tin, const PointOrder& order, const ExternalMemory& memory,
                   const std::string& path, const std::string& kept_as, TinCounts& counts,
                   TinFaults& faults, const std::stop_token& stop) {
  // Triangles that are still to be mended are written again.
  const bool is_final = tin.faults.slivers.empty();
  MeshOnDisk mesh{new_file<GridTriangle>(memory, is_final ? kept_as : ""), std::move(*tin.places)};
  write_in_order(*tin.triangles, mesh.triangles, stop);
  tin.triangles.reset();
  std::vector<GridTriangle>& slivers = tin.faults.slivers;
  if (tin.faults.more_slivers > 0) {
    throw Error(ErrorCode::resource_exhausted,
                std::to_string(slivers.size() + tin.faults.more_slivers) +
                    " triangles are flattened by the grid, more than can be mended; give a finer "
                    "--resolution, or let --repair triangulate the points anew",
                path);
  }
  counts.mended_triangles = mend_slivers(mesh, slivers, order, memory, faults, path, stop);
  if (!is_final) {
    mesh.triangles = named(std::move(mesh.triangles), memory, kept_as, stop);
  }
  return mesh;
}

/// Makes a mesh convex.
class HullFiller {
 public:
  HullFiller(const PointOrder& order, const AffineMap& map, const ExternalMemory& memory,
             std::string path, TinFaults& faults, const std::stop_token& stop)
      : map_(map),
        memory_(memory),
        path_(std::move(path)),
        faults_(faults),
        stop_(stop),
        order_(order),
        border_(memory, "border"),
        voids_({memory.files, memory.folder, memory.bytes / 8}, "voids", stop) {}

  /// Writes to `to` the void triangles that fill the convex hull around and between `triangles`.
  /// Returns the hull.
  ConvexHull fill(const RecordFile<GridTriangle>& triangles, RecordFile<GridTriangle>& to) {
    find_border(triangles);
    if (border_.size() <= TinTriangles::kMostBorderInMemory) {
      fill_in_memory();
    } else {
      sweep_voids(
          border_, memory_, [&](const auto& corners) { add(corners); }, faults_, path_, stop_);
      faults_.refuse(map_, path_);
    }
    write_in_order(voids_, to, stop_);
    return hull_.hull();
  }

 private:
  void find_border(const RecordFile<GridTriangle>& triangles) {
    BorderFinder finder({memory_.files, memory_.folder, memory_.bytes / 4}, stop_);
    triangles.visit([&](const GridTriangle& t) { finder.add(t); }, stop_);
    finder.finish(
        faults_,
        [&](const GridEdge& e) {
          border_.add(e);
          hull_.add(e.from.position);
        },
        stop_);
    border_.finish();
    // Where triangles are wrong by themselves, faults of the border would say nothing more.
    faults_.refuse(map_, path_);
  }

  void fill_in_memory() {
    const std::uint64_t needed = border_.size() * TinTriangles::kBytesOfBorderEdge;
    if (needed > std::max<std::uint64_t>(memory_.bytes, 1U << 16)) {
      throw Error(
          ErrorCode::resource_exhausted,
          "the border of this TIN, with all its holes, has " + std::to_string(border_.size()) +
              " edges, which take " + std::to_string((needed >> 20) + 1) + "M of memory, and " +
              std::to_string(memory_.bytes >> 20) + "M are free for them; give more --memory",
          path_);
    }
    std::vector<GridEdge> edges;
    border_.take(0, border_.size(), edges);
    const TinBorder border = border_in_memory(edges);
    edges = std::vector<GridEdge>();  // {} would keep its memory
    check_border(border.positions, border.edges, faults_);
    faults_.refuse(map_, path_);
    const std::vector<Corners> filling = fill_hull(border.positions, border.edges, faults_, stop_);
    faults_.refuse(map_, path_);
    const auto vertex = [&](VertexId v) {
      return GridVertex{border.positions[v], border.heights[v]};
    };
    for (const Corners& t : filling) {
      add({vertex(t[0]), vertex(t[1]), vertex(t[2])});
    }
  }

  void add(const std::array<GridVertex, 3>& corners) { voids_.add(grid_triangle(corners, order_)); }

  const AffineMap& map_;
  const ExternalMemory& memory_;
  std::string path_;
  TinFaults& faults_;
  const std::stop_token& stop_;
  const PointOrder& order_;
  RecordFile<GridEdge> border_;
  ExternalSorter<GridTriangle> voids_;
  HullCollector hull_;
};

/// The index of the first triangle whose place is not before `place`.
std::uint64_t first_from(const RecordFile<GridTriangle>& triangles, std::uint64_t place) {
  std::uint64_t low = 0, high = triangles.size();
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (triangles.at(middle).place < place) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

}  // namespace

TinTriangles TinTriangles::read(const std::string& path, const SourceOptions& options,
                                const ExternalMemory& memory, const std::stop_token& stop,
                                const Progress& progress, const std::string& keep_as) {
  if (options.bbox) {
    throw Error(ErrorCode::invalid_argument,
                "a TIN is not cut by --bbox; build it whole, then refine or export a window", path);
  }
  TinOnGrid tin = read_on_grid(path, {options, memory, stop, progress});
  TinTriangles to;
  set_crs(to.frame_, resolve_source_crs({tin.crs, tin.vertical_crs}, options, path, tin.warnings));
  warn_of_no_crs(to.frame_, path, tin.warnings);
  set_units(to.frame_, tin.units, options.a_srs.empty(), path);
  to.frame_.map = tin.grid.map();
  require_resolvable(to.frame_.map, tin.grid.east - tin.grid.west, tin.grid.north - tin.grid.south,
                     "give a coarser --resolution", path);
  require_latitudes(to.frame_, tin.grid.north - tin.grid.south, path);
  require_longitudes(to.frame_, tin.grid.east - tin.grid.west, tin.grid.is_split, path);
  if (!options.resolution) {
    warn_of_shift(tin.largest_shift_plan, to.frame_, path, tin.warnings);
  }
  set_heights(to.frame_, tin.heights);
  to.codes_are_whole_ = tin.grid.whole;
  to.warnings_ = std::move(tin.warnings);
  if (are_axes_exchanged(to.frame_, tin.grid.east - tin.grid.west,
                         tin.grid.north - tin.grid.south)) {
    to.warnings_.add(
        {.kind = "exchanged_axes",
         .message =
             "the vertices lie outside of the area in which their CRS is used, and inside of "
             "it with x and y exchanged; where another order is written than the format "
             "has, exchange them first",
         .file = path});
  }
  if (tin.turned_triangles > 0) {
    to.warnings_.add({.kind = "turned_triangles",
                      .message = "triangles go another way round than most, and each was turned; "
                                 "look at them where the surface should be of one piece",
                      .file = path,
                      .count = tin.turned_triangles});
  }
  to.counts_.left_out_triangles = tin.left_out_triangles;
  to.counts_.unused_vertices = tin.unused_vertices;
  to.counts_.merged_vertices = tin.merged_vertices;
  to.counts_.largest_shift_plan = tin.largest_shift_plan;
  TinFaults faults;
  faults.no_area = tin.faults.no_area;
  faults.heights = tin.heights_differ;
  faults.turned_in_source = tin.turned_triangles;
  const PointOrder order(tin.grid.largest());
  const std::array<std::string, 3> names =
      keep_as.empty() ? std::array<std::string, 3>() : kept_files(keep_as);
  MeshOnDisk mesh = mesh_of(tin, order, memory, path, names[0], to.counts_, faults, stop);
  to.voids_ = std::make_unique<RecordFile<GridTriangle>>(new_file<GridTriangle>(memory, names[1]));
  to.hull_ =
      HullFiller(order, to.frame_.map, memory, path, faults, stop).fill(mesh.triangles, *to.voids_);
  to.surface_ = std::make_unique<RecordFile<GridTriangle>>(std::move(mesh.triangles));
  to.places_ = std::make_unique<RecordFile<std::uint64_t>>(
      named(std::move(mesh.places), memory, names[2], stop));
  to.counts_.vertices = to.places_->size();
  to.counts_.surface_triangles = to.surface_->size();
  to.counts_.void_triangles = to.voids_->size();
  return to;
}

SourceDisk TinTriangles::disk_of(std::uint64_t vertices) noexcept {
  // What is kept: for each vertex two triangles of 56 bytes and its place; and void triangles.
  // Tiles take what those of points take.
  return {.while_reading = vertices * 500,
          .kept = vertices * 130,
          .tiles_of_vertex = 79.0,
          .output_of_vertex = kPointOutputOfVertex};
}

/// Where part `i` begins along the curve.
std::uint64_t TinTriangles::place_of_part(std::uint64_t i, std::uint64_t n) const {
  __extension__ using Uint128 = unsigned __int128;
  const auto vertex = static_cast<std::uint64_t>(Uint128{places_->size()} * i / n);
  return vertex < places_->size() ? places_->at(vertex) : ~std::uint64_t{0};
}

void TinTriangles::take(const RecordFile<GridTriangle>& from, std::uint64_t begin,
                        std::uint64_t end, std::vector<GridTriangle>& triangles) const {
  const std::uint64_t first = first_from(from, begin);
  const std::uint64_t count = first_from(from, end) - first;
  if (count > kNone / 8) {
    throw Error(ErrorCode::resource_exhausted, "more triangles than one mesh in memory counts");
  }
  from.take(first, count, triangles);
}

Tin TinTriangles::part(std::uint64_t i, std::uint64_t n) const {
  const std::uint64_t begin = place_of_part(i, n), end = place_of_part(i + 1, n);
  std::vector<GridTriangle> triangles, voids;
  take(*surface_, begin, end, triangles);
  take(*voids_, begin, end, voids);
  const std::size_t surface = triangles.size();
  triangles.insert(triangles.end(), voids.begin(), voids.end());
  voids = std::vector<GridTriangle>();  // {} would keep its memory
  const std::vector<GridVertex> vertices = vertices_of(triangles);
  Tin tin;
  tin.vertices.reserve(vertices.size());
  for (const GridVertex& v : vertices) {
    tin.vertices.push_back(
        {v.position,
         codes_are_whole_ ? frame_.heights.bits(v.height) : encode_height(frame_.heights, v.height),
         kNone});
  }
  tin.has_height.assign(vertices.size(), 1);
  const auto number = [&](const GridVertex& v) {
    return vertex_number(vertices, key_of(v.position));
  };
  tin.triangles.reserve(triangles.size());
  for (const GridTriangle& t : triangles) {
    tin.triangles.push_back({{number(t.corners[0]), number(t.corners[1]), number(t.corners[2])},
                             {kNone, kNone, kNone}});
  }
  tin.classes.assign(triangles.size(), TriangleClass::kVoid);
  std::fill_n(tin.classes.begin(), surface, TriangleClass::kSurface);
  link_tin(tin);
  return tin;
}

}  // namespace ptin
