// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/tin_names.h"

#include "engine/construct/grid/source_point.h"
#include "engine/error.h"

namespace ptin {

namespace {

std::uint64_t triangle_of(const NamedCorner& c) { return c.place / 4; }

struct ById {
  bool operator()(const NamedVertex& a, const NamedVertex& b) const noexcept { return a.id < b.id; }
};
struct ByName {
  bool operator()(const NamedCorner& a, const NamedCorner& b) const noexcept {
    return a.id != b.id ? a.id < b.id : a.place < b.place;
  }
};
struct ByTriangle {
  bool operator()(const NamedCorner& a, const NamedCorner& b) const noexcept {
    return a.place < b.place;
  }
};

using VertexSorter = ExternalSorter<NamedVertex, ById>;
using NameSorter = ExternalSorter<NamedCorner, ByName>;
using NumberSorter = ExternalSorter<std::uint64_t, std::less<>>;

/// What the reader finds, to be sorted.
class NameSink final : public TinFileSink {
 public:
  NameSink(const ExternalMemory& memory, const std::stop_token& stop)
      : vertices(memory, "vertices", stop), corners(memory, "corners", stop) {}

  void add_vertex(std::int64_t id, const SourcePoint& p) override {
    vertices.add(NamedVertex(id, p));
  }
  void add_triangle(const std::array<std::int64_t, 3>& ids) override {
    for (std::size_t i = 0; i < 3; ++i) {
      corners.add({ids[i], 4 * triangles_ + i});
    }
    ++triangles_;
  }

  VertexSorter vertices;
  NameSorter corners;

 private:
  std::uint64_t triangles_ = 0;
};

class NameReader {
 public:
  NameReader(const std::string& path, const TinGridReading& reading, const ExternalMemory& memory)
      : path_(path),
        reading_(reading),
        memory_(memory),
        tin_{RecordFile<NamedVertex>(memory, "vertices"),
             RecordFile<NamedCorner>(memory, "corners"),
             {}},
        without_height_(memory, "triangles", reading.stop) {}

  NamedTin read() {
    match();
    if (without_height_.size() > 0) {
      leave_out_triangles();
      leave_out_vertices();
    }
    if (tin_.corners.size() == 0) {
      refuse("no triangle has a height", path_);
    }
    return std::move(tin_);
  }

 private:
  void match();
  void leave_out_triangles();
  void leave_out_vertices();
  [[nodiscard]] bool has_height(const NamedVertex& v) const {
    return !reading_.options.nodata || to_double(v.point().z) != *reading_.options.nodata;
  }

  const std::string& path_;
  const TinGridReading& reading_;
  const ExternalMemory& memory_;
  NamedTin tin_;
  NumberSorter without_height_;  ///< Triangles with a corner without a height, once for each.
};

/// Finds the vertex of every corner: both are sorted by id and merged. Keeps the vertices that a
/// corner names, and notes triangles with a corner without a height.
void NameReader::match() {
  NameSink file(memory_, reading_.stop);
  const auto progress = [&](std::uint64_t done, std::uint64_t total) {
    if (reading_.progress) {
      reading_.progress("reading", done, total);
    }
  };
  tin_.facts = read_tin_file(path_, {reading_.options.points.layer, reading_.stop, progress}, file);
  InOrder vertices = in_order(file.vertices, reading_.stop);
  InOrder corners = in_order(file.corners, reading_.stop);
  while (vertices.now() != nullptr) {
    const NamedVertex v = *vertices.now();
    vertices.next();
    if (vertices.now() != nullptr && vertices.now()->id == v.id) {
      refuse("two vertices have the id " + std::to_string(v.id), path_);
    }
    if (corners.now() != nullptr && corners.now()->id < v.id) {
      break;
    }
    bool is_used = false;
    for (; corners.now() != nullptr && corners.now()->id == v.id; corners.next()) {
      tin_.corners.add(*corners.now());
      if (!has_height(v)) {
        without_height_.add(triangle_of(*corners.now()));
      }
      is_used = true;
    }
    if (is_used) {
      tin_.vertices.add(v);
    } else {
      ++tin_.unused_vertices;
    }
  }
  if (const NamedCorner* left = corners.now()) {
    refuse("triangle " + std::to_string(triangle_of(*left)) + " names vertex " +
               std::to_string(left->id) + ", which is not there",
           path_);
  }
  tin_.vertices.finish();
  tin_.corners.finish();
}

/// Drops the corners of the triangles in without_height_.
void NameReader::leave_out_triangles() {
  ExternalSorter<NamedCorner, ByTriangle> by_triangle(memory_, "corners", reading_.stop);
  tin_.corners.visit([&](const NamedCorner& c) { by_triangle.add(c); }, reading_.stop);
  NameSorter kept(memory_, "corners", reading_.stop);
  InOrder out = in_order(without_height_, reading_.stop);
  const auto advance = [&](std::uint64_t to) {
    while (out.now() != nullptr && *out.now() < to) {
      out.next();
    }
  };
  by_triangle.merge(
      [&](std::span<const NamedCorner> batch) {
        for (const NamedCorner& c : batch) {
          advance(triangle_of(c));
          const bool is_out = out.now() != nullptr && *out.now() == triangle_of(c);
          if (!is_out) {
            kept.add(c);
          } else if (c.place % 4 == 0) {
            ++tin_.left_out_triangles;
          }
        }
      },
      reading_.stop);
  tin_.corners = RecordFile<NamedCorner>(memory_, "corners");
  kept.merge(
      [&](std::span<const NamedCorner> batch) {
        for (const NamedCorner& c : batch) {
          tin_.corners.add(c);
        }
      },
      reading_.stop);
  tin_.corners.finish();
}

/// Drops the vertices that only triangles without a height named.
void NameReader::leave_out_vertices() {
  RecordFile<NamedVertex> kept(memory_, "vertices");
  InOrder corners = in_order(tin_.corners, reading_.stop);
  tin_.vertices.visit(
      [&](const NamedVertex& v) {
        if (corners.now() == nullptr || corners.now()->id != v.id) {
          ++tin_.unused_vertices;
          return;
        }
        kept.add(v);
        while (corners.now() != nullptr && corners.now()->id == v.id) {
          corners.next();
        }
      },
      reading_.stop);
  kept.finish();
  tin_.vertices = std::move(kept);
}

}  // namespace

NamedTin read_named_tin(const std::string& path, const TinGridReading& reading,
                        const ExternalMemory& memory) {
  return NameReader(path, reading, memory).read();
}

}  // namespace ptin
