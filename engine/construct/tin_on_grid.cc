// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin_on_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "engine/construct/height_finder_internal.h"
#include "engine/construct/point_order_internal.h"
#include "engine/construct/point_sorter.h"
#include "engine/construct/tin_digits.h"
#include "engine/construct/tin_soup.h"
#include "engine/error.h"
#include "engine/geometry/orient.h"

namespace ptin {

namespace {

/// Slivers that are mended at once; more are refused.
constexpr std::size_t kMostSlivers = 1 << 16;

[[noreturn]] void refuse(const std::string& path, const std::string& sentence) {
  throw Error(ErrorCode::invalid_argument, sentence, path);
}

/// As the file has it.
struct RawVertex {
  std::int64_t id = 0;
  std::array<std::int64_t, 3> mantissa{};
  std::array<std::int8_t, 3> decimals{};

  RawVertex() = default;
  RawVertex(std::int64_t number, const SourcePoint& p)
      : id(number),
        mantissa{p.x.mantissa, p.y.mantissa, p.z.mantissa},
        decimals{static_cast<std::int8_t>(p.x.decimals), static_cast<std::int8_t>(p.y.decimals),
                 static_cast<std::int8_t>(p.z.decimals)} {}
  [[nodiscard]] SourcePoint point() const noexcept {
    return {{mantissa[0], decimals[0]}, {mantissa[1], decimals[1]}, {mantissa[2], decimals[2]}};
  }
};

/// On the grid, and how far from its place in the file, grid units.
struct SnappedVertex {
  std::int64_t id = 0;
  GridVertex vertex;  ///< Height NaN: none.
  float off_x = 0.0F, off_y = 0.0F;
};
struct ById {
  bool operator()(const SnappedVertex& a, const SnappedVertex& b) const noexcept {
    return a.id < b.id;
  }
};

/// A corner of a triangle by the id of its vertex ...
struct NamedCorner {
  std::int64_t id = 0;
  std::uint64_t place = 0;  ///< Four times the triangle's number, and which corner it is.
};
struct ByName {
  bool operator()(const NamedCorner& a, const NamedCorner& b) const noexcept {
    return a.id != b.id ? a.id < b.id : a.place < b.place;
  }
};
/// ... and with the vertex itself.
struct JoinedCorner {
  std::uint64_t place = 0;
  GridVertex vertex;
  float off_x = 0.0F, off_y = 0.0F;
};
struct ByCorner {
  bool operator()(const JoinedCorner& a, const JoinedCorner& b) const noexcept {
    return a.place < b.place;
  }
};

using VertexSorter = ExternalSorter<SnappedVertex, ById>;
using NameSorter = ExternalSorter<NamedCorner, ByName>;
using CornerSorter = ExternalSorter<JoinedCorner, ByCorner>;

/// One record after the other of what is sorted.
template <class Record, class Before>
class Sorted {
 public:
  Sorted(ExternalSorter<Record, Before>& sorter, const std::stop_token& stop)
      : sorter_(sorter), stop_(stop) {
    next();
  }
  [[nodiscard]] const Record* now() const noexcept {
    return at_ < batch_.size() ? &batch_[at_] : nullptr;
  }
  void next() {
    if (++at_ >= batch_.size()) {
      at_ = 0;
      static_cast<void>(sorter_.take(batch_, stop_));
    }
  }

 private:
  ExternalSorter<Record, Before>& sorter_;
  const std::stop_token& stop_;
  std::vector<Record> batch_;
  std::size_t at_ = 0;
};

/// The file on disk: vertices in their order, corners to be sorted by name.
class FileOnDisk final : public TinSink {
 public:
  explicit FileOnDisk(const ExternalMemory& memory)
      : vertices(memory, "vertices"), corners(memory, "corners") {}

  void add_vertex(std::int64_t id, const SourcePoint& p) override {
    digits.add(p);
    vertices.add(RawVertex(id, p));
  }
  void add_triangle(const std::array<std::int64_t, 3>& ids) override {
    for (std::size_t i = 0; i < 3; ++i) {
      corners.add({ids[i], 4 * triangles_ + i});
    }
    ++triangles_;
  }

  RecordFile<RawVertex> vertices;
  NameSorter corners;
  TinDigits digits;

 private:
  std::uint64_t triangles_ = 0;
};

/// Twice the area of a triangle of the file; its sign is right but for the flattest of all.
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

/// What is wrong with triangles, while it is not known which way round is right.
class Orientations {
 public:
  void add(const GridTriangle& t, int in_file) {
    const int on_grid = sign_of(static_cast<long double>(t.area()));
    excess_ += on_grid;
    for (const int upright : {1, -1}) {
      OrientationFaults& faults = faults_[upright > 0 ? 0 : 1];
      if (on_grid == upright) {
        continue;
      }
      if (in_file == upright) {
        if (faults.slivers.size() < kMostSlivers) {
          faults.slivers.push_back(t);
        } else {
          ++faults.more_slivers;
        }
      } else {
        (on_grid == 0 ? faults.no_area : faults.turned_over).add(t.corners[0].position);
      }
    }
  }
  [[nodiscard]] bool is_clockwise() const noexcept { return excess_ < 0; }
  [[nodiscard]] OrientationFaults take() { return std::move(faults_[excess_ < 0 ? 1 : 0]); }

 private:
  std::int64_t excess_ = 0;
  std::array<OrientationFaults, 2> faults_;
};

/// One file on its way.
class GridReader {
 public:
  GridReader(const std::string& path, const TinGridReading& reading)
      : path_(path), reading_(reading), memory_(reading.memory) {
    memory_.bytes /= kSorters;
  }

  TinOnGrid read();

 private:
  static constexpr std::uint64_t kSorters = 5;  ///< That hold memory at the same time.

  void read_file();
  void choose_grid();
  void snap();
  void join();
  void assemble();
  void number_vertices();
  void report(std::uint64_t done) const {
    if (reading_.progress) {
      reading_.progress("sorting", done, kSteps);
    }
  }
  [[nodiscard]] bool is_given(Decimal z) const {
    return !reading_.options.nodata || to_double(z) != *reading_.options.nodata;
  }
  static constexpr std::uint64_t kSteps = 5;

  const std::string& path_;
  const TinGridReading& reading_;
  ExternalMemory memory_;
  TinOnGrid tin_;
  int decimals_ = 0;
  std::optional<PointOrder> order_;
  std::unique_ptr<FileOnDisk> file_;
  std::unique_ptr<VertexSorter> vertices_;
  std::unique_ptr<CornerSorter> corners_;
  std::unique_ptr<PointSorter> points_;       ///< Vertices that a triangle names.
  std::unique_ptr<PointSorter> kept_points_;  ///< Of those of kept triangles, where some may go.
};

void GridReader::read_file() {
  file_ = std::make_unique<FileOnDisk>(memory_);
  const auto progress = [&](std::uint64_t done, std::uint64_t total) {
    if (reading_.progress) {
      reading_.progress("reading", done, total);
    }
  };
  const TinFileFacts facts =
      read_tin_file(path_, {reading_.options.points.layer, reading_.stop, progress}, *file_);
  file_->vertices.finish();
  tin_.crs = facts.crs;
  tin_.vertical_crs = facts.vertical_crs;
  tin_.left_out_triangles = facts.hidden_triangles;
}

void GridReader::choose_grid() {
  decimals_ = file_->digits.kept();
  PointGridScan scan(reading_.options.resolution, path_);
  scan.add_source({});
  file_->vertices.visit([&](const RawVertex& v) {
    SourcePoint p = v.point();
    static_cast<void>(drop_digits(p, decimals_));
    scan.add(p);
  });
  tin_.grid = scan.grid();
  order_.emplace(tin_.grid.largest());
}

void GridReader::snap() {
  vertices_ = std::make_unique<VertexSorter>(memory_, "vertices");
  const PointGrid& grid = tin_.grid;
  const AffineMap map = grid.map();
  file_->vertices.visit([&](const RawVertex& v) {
    SourcePoint p = v.point();
    const DroppedDigits dropped = drop_digits(p, decimals_);
    SnappedVertex snapped;
    snapped.id = v.id;
    snapped.vertex.position = grid.position(p);
    snapped.vertex.height =
        is_given(p.z) ? grid.height(p.z) : std::numeric_limits<double>::quiet_NaN();
    double x = dropped.x, y = dropped.y;
    if (!grid.x.is_exact()) {
      x += to_double(p.x) - grid.x.coordinate(grid.west + snapped.vertex.position.x);
      y += to_double(p.y) - grid.y.coordinate(grid.south + snapped.vertex.position.y);
    }
    snapped.off_x = static_cast<float>(x / map.step_x);
    snapped.off_y = static_cast<float>(y / map.step_y);
    tin_.largest_shift_plan = std::max(tin_.largest_shift_plan, std::sqrt(x * x + y * y));
    vertices_->add(snapped);
  });
}

/// Gives every corner its vertex.
void GridReader::join() {
  corners_ = std::make_unique<CornerSorter>(memory_, "corners");
  points_ = std::make_unique<PointSorter>(memory_, "points");
  Sorted vertices(*vertices_, reading_.stop);
  Sorted names(file_->corners, reading_.stop);
  while (const SnappedVertex* found = vertices.now()) {
    const SnappedVertex v = *found;
    vertices.next();
    if (vertices.now() != nullptr && vertices.now()->id == v.id) {
      refuse(path_, "two vertices have the id " + std::to_string(v.id));
    }
    if (names.now() != nullptr && names.now()->id < v.id) {
      break;
    }
    bool is_used = false;
    for (; names.now() != nullptr && names.now()->id == v.id; names.next()) {
      corners_->add({names.now()->place, v.vertex, v.off_x, v.off_y});
      is_used = true;
    }
    if (is_used && !std::isnan(v.vertex.height)) {
      points_->add({order_->key(v.vertex.position), v.vertex.height});
    } else {
      ++tin_.unused_vertices;
    }
  }
  if (const NamedCorner* left = names.now()) {
    refuse(path_, "triangle " + std::to_string(left->place / 4) + " names vertex " +
                      std::to_string(left->id) + ", which is not there");
  }
  vertices_.reset();
  file_.reset();
}

/// Puts corners together to triangles.
void GridReader::assemble() {
  tin_.triangles = std::make_unique<TriangleSorter>(memory_, "triangles");
  if (reading_.options.nodata) {
    kept_points_ = std::make_unique<PointSorter>(memory_, "points");
  }
  Orientations orientations;
  std::array<JoinedCorner, 3> corners;
  corners_->merge(
      [&](std::span<const JoinedCorner> batch) {
        for (const JoinedCorner& corner : batch) {
          corners[corner.place % 4] = corner;
          if (corner.place % 4 != 2) {
            continue;
          }
          const std::array<GridVertex, 3> v{corners[0].vertex, corners[1].vertex,
                                            corners[2].vertex};
          if (std::isnan(v[0].height) || std::isnan(v[1].height) || std::isnan(v[2].height)) {
            ++tin_.left_out_triangles;
            continue;
          }
          const GridTriangle t = grid_triangle(v, *order_);
          orientations.add(t, sign_of(source_area(corners)));
          tin_.triangles->add(t);
          for (std::size_t i = 0; kept_points_ && i < 3; ++i) {
            kept_points_->add({order_->key(v[i].position), v[i].height});
          }
        }
      },
      reading_.stop);
  corners_.reset();
  if (tin_.triangles->size() == 0) {
    refuse(path_, "no triangle has a height");
  }
  tin_.is_clockwise = orientations.is_clockwise();
  tin_.faults = orientations.take();
}

/// Distinct positions along the curve, and what their heights are.
void GridReader::number_vertices() {
  tin_.places = std::make_unique<RecordFile<std::uint64_t>>(memory_, "places");
  HeightFinder heights(tin_.grid.whole, tin_.grid.heights.unit());
  const auto add = [&](PointSorter& points) {
    std::optional<KeyedHeight> last;
    bool has_conflict = false;
    std::uint64_t distinct = 0;
    points.merge(
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
            ++distinct;
            if (&points == kept_points_.get() || !kept_points_) {
              tin_.places->add(p.key);
              heights.add(p.height);
            }
          }
        },
        reading_.stop);
    return distinct;
  };
  const std::uint64_t named = points_->size();
  const std::uint64_t distinct = add(*points_);
  tin_.merged_vertices = named - distinct;
  if (kept_points_) {
    tin_.heights_differ = {};
    tin_.unused_vertices += distinct - add(*kept_points_);
  }
  tin_.places->finish();
  tin_.heights = heights.fit();
}

TinOnGrid GridReader::read() {
  read_file();
  report(0);
  choose_grid();
  snap();
  report(1);
  join();
  report(2);
  assemble();
  report(3);
  number_vertices();
  report(4);
  return std::move(tin_);
}

}  // namespace

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

bool ByPlace::operator()(const GridTriangle& a, const GridTriangle& b) const noexcept {
  const auto key = [](const GridTriangle& t, std::size_t i) {
    return key_of(t.corners[i].position);
  };
  return a.place != b.place       ? a.place < b.place
         : key(a, 1) != key(b, 1) ? key(a, 1) < key(b, 1)
                                  : key(a, 2) < key(b, 2);
}

TinOnGrid read_on_grid(const std::string& path, const TinGridReading& reading) {
  return GridReader(path, reading).read();
}

}  // namespace ptin
