// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/tin_names.h"

#include "engine/construct/grid/source_point.h"
#include "engine/error.h"

namespace ptin {

namespace {

std::uint64_t face_of(std::uint64_t place) { return place / 4; }

struct ByFace {
  bool operator()(const NamedCorner& a, const NamedCorner& b) const noexcept {
    return a.place < b.place;
  }
};

/// What the reader finds, to be sorted.
class NameSink final : public TinFileSink {
 public:
  NameSink(const ExternalMemory& memory, const std::stop_token& stop)
      : vertices(memory, "vertices", stop), corners(memory, "corners", stop) {}

  void add_vertex(std::int64_t id, const SourcePoint& p) override {
    vertices.add(NamedVertex(id, p));
  }
  void add_face(std::span<const std::int64_t> ids) override {
    for (std::size_t i = 0; i < ids.size(); ++i) {
      corners.add({ids[i], 4 * faces_ + i});
    }
    ++faces_;
  }

  ExternalSorter<NamedVertex> vertices;
  ExternalSorter<NamedCorner> corners;

 private:
  std::uint64_t faces_ = 0;
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
        without_height_(memory, "corners", reading.stop) {}

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
  ExternalSorter<std::uint64_t> without_height_;  ///< The places of corners without a height.
};

/// Finds the vertex of every corner: both are sorted by id and merged. Keeps the vertices that a
/// corner names, and notes corners without a height.
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
        without_height_.add(corners.now()->place);
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
    refuse("triangle " + std::to_string(face_of(left->place)) + " names vertex " +
               std::to_string(left->id) + ", which is not there",
           path_);
  }
  tin_.vertices.finish();
  tin_.corners.finish();
}

/// Drops the corners in without_height_, and faces that keep less than three.
void NameReader::leave_out_triangles() {
  ExternalSorter<NamedCorner, ByFace> by_face(memory_, "corners", reading_.stop);
  tin_.corners.visit([&](const NamedCorner& c) { by_face.add(c); }, reading_.stop);
  ExternalSorter<NamedCorner> kept(memory_, "corners", reading_.stop);
  InOrder out = in_order(without_height_, reading_.stop);
  std::vector<NamedCorner> face;  // that have heights
  std::size_t corners = 0;
  const auto end_face = [&] {
    const std::size_t stay = face.size() < 3 ? 0 : face.size() - 2;
    tin_.left_out_triangles += corners == 0 ? 0 : corners - 2 - stay;
    for (std::size_t i = 0; i < face.size() && stay > 0; ++i) {
      kept.add(face[i]);
    }
    face.clear();
    corners = 0;
  };
  std::uint64_t last = 0;
  by_face.merge(
      [&](std::span<const NamedCorner> batch) {
        for (const NamedCorner& c : batch) {
          if (face_of(c.place) != face_of(last)) {
            end_face();
          }
          last = c.place;
          ++corners;
          if (out.now() != nullptr && *out.now() == c.place) {
            out.next();
          } else {
            face.push_back(c);
          }
        }
      },
      reading_.stop);
  end_face();
  tin_.corners = RecordFile<NamedCorner>(memory_, "corners");
  write_in_order(kept, tin_.corners, reading_.stop);
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
