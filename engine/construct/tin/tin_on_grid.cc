// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/tin_on_grid.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/construct/grid/height_finder.h"
#include "engine/construct/grid/point_order.h"
#include "engine/construct/grid/point_sorter.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/tin/tin_names.h"
#include "engine/geometry/orient.h"

namespace ptin {

namespace {

/// Slivers that are mended at once; more are refused.
constexpr std::size_t kMostSlivers = 1 << 16;

/// A corner of a triangle with its vertex.
struct JoinedCorner {
  std::uint64_t place = 0;  ///< As NamedCorner::place.
  GridVertex vertex;
  float off_x = 0.0F, off_y = 0.0F;  ///< Its place in the file less that on the grid, grid units.

  friend bool operator<(const JoinedCorner& a, const JoinedCorner& b) noexcept {
    return a.place < b.place;
  }
};

/// Twice the area that a triangle has in the file, in grid units. Its sign is right but for the
/// flattest of triangles.
long double source_area(const std::array<JoinedCorner, 3>& c) {
  const auto whole = [&](auto axis, std::size_t i) {
    return static_cast<long double>(c[i].vertex.position.*axis) - c[0].vertex.position.*axis;
  };
  const long double bx = whole(&GridPoint::x, 1), by = whole(&GridPoint::y, 1);
  const long double cx = whole(&GridPoint::x, 2), cy = whole(&GridPoint::y, 2);
  const long double obx = c[1].off_x - c[0].off_x, oby = c[1].off_y - c[0].off_y;
  const long double ocx = c[2].off_x - c[0].off_x, ocy = c[2].off_y - c[0].off_y;
  const auto on_grid = static_cast<long double>(
      orient(c[0].vertex.position, c[1].vertex.position, c[2].vertex.position));
  return on_grid + (bx * ocy + obx * cy + obx * ocy - by * ocx - oby * cx - oby * ocx);
}

int sign_of(long double v) { return v > 0 ? 1 : (v < 0 ? -1 : 0); }

using Quad = std::array<JoinedCorner, 4>;

/// True where the diagonal from corner `i` (0 or 1) cuts the quad into two triangles that go the same
/// way round: it lies inside.
template <class SignOfArea>
bool is_inside(const Quad& quad, std::size_t i, const SignOfArea& sign) {
  const int first = sign({quad[i], quad[i + 1], quad[i + 2]});
  return first != 0 && first == sign({quad[i], quad[i + 2], quad[(i + 3) % 4]});
}

/// The corner, 0 or 1, from which a quad is cut into two triangles. A quad that is not convex has
/// one diagonal inside only. Else it is the one whose ends differ less in height, as of a raster's
/// cells, else the shorter one, else the one from the corner with the smallest key.
std::size_t begin_of_cut(const Quad& quad) {
  const auto on_grid = [](const std::array<JoinedCorner, 3>& c) {
    return sign_of(static_cast<long double>(
        orient(c[0].vertex.position, c[1].vertex.position, c[2].vertex.position)));
  };
  const auto in_file = [](const std::array<JoinedCorner, 3>& c) { return sign_of(source_area(c)); };
  bool first = is_inside(quad, 0, on_grid), second = is_inside(quad, 1, on_grid);
  if (!first && !second) {  // spoiled by the grid, or no quad at all
    first = is_inside(quad, 0, in_file);
    second = is_inside(quad, 1, in_file);
  }
  if (first != second) {
    return first ? 0 : 1;
  }
  const auto rise = [&](std::size_t i) {
    return std::abs(quad[i].vertex.height - quad[i + 2].vertex.height);
  };
  const auto length = [&](std::size_t i) {
    const GridPoint a = quad[i].vertex.position, b = quad[i + 2].vertex.position;
    const std::int64_t x = std::int64_t{a.x} - b.x, y = std::int64_t{a.y} - b.y;
    return x * x + y * y;
  };
  const auto least_key = [&](std::size_t i) {
    return std::min(key_of(quad[i].vertex.position), key_of(quad[i + 2].vertex.position));
  };
  if (rise(0) != rise(1)) {
    return rise(0) < rise(1) ? 0 : 1;
  }
  if (length(0) != length(1)) {
    return length(0) < length(1) ? 0 : 1;
  }
  return least_key(0) < least_key(1) ? 0 : 1;
}

/// Turns triangles that are clockwise in their file, and collects what is wrong with them. Programs
/// write some triangles the one way round and some the other; what comes out is a terrain where they
/// lie beside one another, and the border shows where they do not.
class Orientations {
 public:
  /// Returns `t` as it is to be.
  /// @param in_file  The sign of the triangle's area in the file.
  GridTriangle upright(GridTriangle t, int in_file) {
    const int on_grid = sign_of(static_cast<long double>(t.area()));
    const int way = in_file != 0 ? in_file : on_grid;
    if (way < 0) {
      std::swap(t.corners[1], t.corners[2]);
    }
    ++(way < 0 ? clockwise_ : others_);
    if (way == 0) {
      faults_.no_area.add(t.corners[0].position);
    } else if (on_grid != way && faults_.slivers.size() < kMostSlivers) {
      faults_.slivers.push_back(t);
    } else if (on_grid != way) {
      ++faults_.more_slivers;
    }
    return t;
  }
  /// Triangles that go another way round than most.
  [[nodiscard]] std::uint64_t minority() const noexcept { return std::min(clockwise_, others_); }
  [[nodiscard]] OrientationFaults take() { return std::move(faults_); }

 private:
  std::uint64_t clockwise_ = 0, others_ = 0;
  OrientationFaults faults_;
};

/// Puts one file on the grid.
class GridReader {
 public:
  GridReader(const std::string& path, const TinGridReading& reading)
      : path_(path), reading_(reading), memory_(reading.memory) {
    memory_.bytes /= kSorters;
  }

  TinOnGrid read();

 private:
  static constexpr std::uint64_t kSorters = 5;  ///< Most that hold memory at the same time.

  void choose_grid();
  void join();
  [[nodiscard]] JoinedCorner snapped(const NamedVertex& v);
  void assemble();
  void number_vertices();
  void report(std::uint64_t done) const {
    if (reading_.progress) {
      reading_.progress("sorting", done, kSteps);
    }
  }
  static constexpr std::uint64_t kSteps = 4;

  const std::string& path_;
  const TinGridReading& reading_;
  ExternalMemory memory_;
  TinOnGrid tin_;
  std::optional<PointOrder> order_;
  std::optional<NamedTin> named_;
  std::unique_ptr<ExternalSorter<JoinedCorner>> corners_;
  std::unique_ptr<ExternalSorter<KeyedHeight>> points_;  ///< The vertices.
};

void GridReader::choose_grid() {
  PointGridScan scan(reading_.options.resolution, path_);
  scan.add_source({});
  named_->vertices.visit([&](const NamedVertex& v) { scan.add(v.point()); }, reading_.stop);
  tin_.grid = scan.grid();
  tin_.warnings.join(scan.warnings({path_}, true));
  order_.emplace(tin_.grid.largest());
}

JoinedCorner GridReader::snapped(const NamedVertex& v) {
  const PointGrid& grid = tin_.grid;
  const AffineMap map = grid.map();
  const SourcePoint p = v.point();
  JoinedCorner corner;
  corner.vertex = {grid.position(p), grid.height(p.z)};
  const double x = grid.x.rest(p.x), y = grid.y.rest(p.y);
  corner.off_x = static_cast<float>(x / map.step_x);
  corner.off_y = static_cast<float>(y / map.step_y);
  tin_.largest_shift_plan = std::max(tin_.largest_shift_plan, std::sqrt(x * x + y * y));
  return corner;
}

/// Gives every corner its vertex.
void GridReader::join() {
  corners_ = std::make_unique<ExternalSorter<JoinedCorner>>(memory_, "corners", reading_.stop);
  points_ = std::make_unique<ExternalSorter<KeyedHeight>>(memory_, "points", reading_.stop);
  InOrder names = in_order(named_->corners, reading_.stop);
  named_->vertices.visit(
      [&](const NamedVertex& v) {
        JoinedCorner corner = snapped(v);
        points_->add({order_->key(corner.vertex.position), corner.vertex.height});
        for (; names.now() != nullptr && names.now()->id == v.id; names.next()) {
          corner.place = names.now()->place;
          corners_->add(corner);
        }
      },
      reading_.stop);
  named_.reset();
}

/// Puts corners together to triangles, and cuts quads.
void GridReader::assemble() {
  tin_.triangles =
      std::make_unique<ExternalSorter<GridTriangle>>(memory_, "triangles", reading_.stop);
  Orientations orientations;
  std::vector<JoinedCorner> face;
  const auto add = [&](const std::array<JoinedCorner, 3>& c) {
    const GridTriangle t = grid_triangle({c[0].vertex, c[1].vertex, c[2].vertex}, *order_);
    tin_.triangles->add(orientations.upright(t, sign_of(source_area(c))));
  };
  const auto end_face = [&] {
    if (face.size() == 3) {
      add({face[0], face[1], face[2]});
    } else if (face.size() == 4) {
      const std::size_t from = begin_of_cut({face[0], face[1], face[2], face[3]});
      add({face[from], face[from + 1], face[from + 2]});
      add({face[from], face[from + 2], face[(from + 3) % 4]});
    }
    face.clear();
  };
  corners_->merge(
      [&](std::span<const JoinedCorner> batch) {
        for (const JoinedCorner& corner : batch) {
          if (!face.empty() && face.back().place / 4 != corner.place / 4) {
            end_face();
          }
          face.push_back(corner);
        }
      },
      reading_.stop);
  end_face();
  corners_.reset();
  tin_.turned_triangles = orientations.minority();
  tin_.faults = orientations.take();
}

/// Writes the distinct positions along the curve, finds the height encoding, and counts positions
/// with several heights.
void GridReader::number_vertices() {
  tin_.places = std::make_unique<RecordFile<std::uint64_t>>(memory_, "places");
  HeightFinder heights(tin_.grid.whole, tin_.grid.heights.unit());
  std::optional<KeyedHeight> last;
  bool has_conflict = false;
  const std::uint64_t named = points_->size();
  points_->merge(
      [&](std::span<const KeyedHeight> batch) {
        for (const KeyedHeight& p : batch) {
          if (last && last->key == p.key) {
            if (last->height != p.height && !has_conflict) {
              tin_.heights_differ.add(order_->point(p.key));
              has_conflict = true;
            }
            continue;
          }
          last = p;
          has_conflict = false;
          tin_.places->add(p.key);
          heights.add(p.height);
        }
      },
      reading_.stop);
  tin_.places->finish();
  tin_.merged_vertices = named - tin_.places->size();
  tin_.heights = heights.fit();
}

TinOnGrid GridReader::read() {
  named_.emplace(read_named_tin(path_, reading_, memory_));
  tin_.crs = named_->facts.crs;
  tin_.vertical_crs = named_->facts.vertical_crs;
  tin_.units = named_->facts.units;
  tin_.warnings = named_->facts.warnings;
  tin_.left_out_triangles = named_->facts.hidden_triangles + named_->left_out_triangles;
  tin_.unused_vertices = named_->unused_vertices;
  report(1);
  choose_grid();
  join();
  report(2);
  assemble();
  report(3);
  number_vertices();
  report(4);
  return std::move(tin_);
}

}  // namespace

VertexId vertex_number(std::span<const GridVertex> vertices, VertexKey key) noexcept {
  const auto at =
      std::lower_bound(vertices.begin(), vertices.end(), key,
                       [](const GridVertex& v, VertexKey k) { return key_of(v.position) < k; });
  return static_cast<VertexId>(at - vertices.begin());
}

std::int64_t GridTriangle::area() const noexcept {
  return orient(corners[0].position, corners[1].position, corners[2].position);
}

GridTriangle grid_triangle(const std::array<GridVertex, 3>& corners,
                           const PointOrder& order) noexcept {
  GridTriangle t{0, corners};
  const auto first = std::min_element(t.corners.begin(), t.corners.end(),
                                      [](const GridVertex& a, const GridVertex& b) {
                                        return key_of(a.position) < key_of(b.position);
                                      });
  std::rotate(t.corners.begin(), first, t.corners.end());
  t.place = order.key(t.corners[0].position);
  return t;
}

bool operator<(const GridTriangle& a, const GridTriangle& b) noexcept {
  const auto key = [](const GridTriangle& t, std::size_t i) {
    return key_of(t.corners[i].position);
  };
  return a.place != b.place       ? a.place < b.place
         : key(a, 1) != key(b, 1) ? key(a, 1) < key(b, 1)
                                  : key(a, 2) < key(b, 2);
}

std::vector<GridVertex> vertices_of(std::span<const GridTriangle> triangles) {
  std::vector<GridVertex> vertices;
  vertices.reserve(3 * triangles.size());
  for (const GridTriangle& t : triangles) {
    vertices.insert(vertices.end(), t.corners.begin(), t.corners.end());
  }
  const auto key = [](const GridVertex& v) { return key_of(v.position); };
  std::sort(vertices.begin(), vertices.end(),
            [&](const GridVertex& a, const GridVertex& b) { return key(a) < key(b); });
  vertices.erase(
      std::unique(vertices.begin(), vertices.end(),
                  [&](const GridVertex& a, const GridVertex& b) { return key(a) == key(b); }),
      vertices.end());
  return vertices;
}

TinOnGrid read_on_grid(const std::string& path, const TinGridReading& reading) {
  return GridReader(path, reading).read();
}

}  // namespace ptin
