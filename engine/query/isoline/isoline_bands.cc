// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_bands.h"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>

#include "engine/query/isoline/isoline_rings.h"
#include "engine/query/shape/clip.h"

namespace ptin {

namespace {

using Ring = std::vector<MapPoint>;

/// Twice the signed area of a ring, computed relative to its first point.
double twice_area(const Ring& ring) {
  double sum = 0;
  const MapPoint o = ring.front();
  for (std::size_t i = 0; i + 1 < ring.size(); ++i) sum += cross(o, ring[i], ring[i + 1]);
  return sum;
}

/// Takes a ring apart where it comes back to a vertex. A walk keeps its inside on the left and
/// never crosses itself, so each part is simple. Parts of fewer than three points go there and
/// back, and are dropped.
void split_at_repetitions(const std::vector<RingPoint>& ring, std::vector<Ring>& parts) {
  std::vector<RingPoint> path;
  std::unordered_map<VertexId, std::size_t> place;  // of a vertex in path
  const auto take_part = [&](std::size_t from) {
    Ring part;
    for (std::size_t i = from; i < path.size(); ++i) {
      if (part.empty() || part.back() != path[i].point) {
        part.push_back(path[i].point);
      }
    }
    while (part.size() > 1 && part.front() == part.back()) {
      part.pop_back();
    }
    if (part.size() > 2) {
      part.push_back(part.front());
      parts.push_back(std::move(part));
    }
  };
  for (const RingPoint& p : ring) {
    const auto found = p.vertex == kNone ? place.end() : place.find(p.vertex);
    if (found == place.end()) {
      if (p.vertex != kNone) {
        place.emplace(p.vertex, path.size());
      }
      path.push_back(p);
      continue;
    }
    const std::size_t at = found->second;
    take_part(at);
    for (std::size_t i = at + 1; i < path.size(); ++i) {
      place.erase(path[i].vertex);
    }
    path.resize(at + 1);
  }
  take_part(0);
}

enum class Side : std::uint8_t { kInside, kOutside, kBorder };

Side side_of(MapPoint p, const Ring& ring) {
  bool inside = false;
  for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
    const MapPoint a = ring[i];
    const MapPoint b = ring[i + 1];
    if (p == a) {
      return Side::kBorder;
    }
    if ((a.y <= p.y) == (b.y <= p.y)) {
      continue;
    }
    if ((cross(a, b, p) > 0) == (b.y > a.y)) {
      inside = !inside;
    }
  }
  return inside ? Side::kInside : Side::kOutside;
}

/// True when `hole`, which crosses no ring, lies in `shell`. They may share points.
bool holds(const Ring& shell, const Ring& hole) {
  for (const MapPoint p : hole) {
    const Side side = side_of(p, shell);
    if (side != Side::kBorder) {
      return side == Side::kInside;
    }
  }
  const MapPoint middle{(hole[0].x + hole[1].x) / 2, (hole[0].y + hole[1].y) / 2};
  return side_of(middle, shell) == Side::kInside;
}

struct Part {
  std::uint32_t band, component;
  double area;  ///< Twice the signed area.
  Ring ring;
};

/// Makes polygons of the rings of one component. The component has one shell, unless parts of it
/// hang together only by a vertex exactly at a level: then each of them has a shell.
void assemble(std::span<Part> parts, std::vector<BandPolygon>& polygons) {
  const std::size_t first = polygons.size();
  for (Part& part : parts) {
    if (part.area > 0) {
      polygons.push_back({part.band, {}});
      polygons.back().rings.push_back(std::move(part.ring));
    }
  }
  for (Part& part : parts) {
    if (!(part.area < 0)) {
      continue;
    }
    for (std::size_t p = first; p < polygons.size(); ++p) {
      if (polygons.size() - first == 1 || holds(polygons[p].rings.front(), part.ring)) {
        polygons[p].rings.push_back(std::move(part.ring));
        break;
      }
    }
  }
}

}  // namespace

std::vector<BandPolygon> band_polygons(const SurfaceArrays& surface, std::span<const double> levels,
                                       const QueryContext& context) {
  BandMesh mesh(surface, levels, context);
  std::vector<Part> parts;
  std::vector<Ring> rings;
  mesh.visit_rings(
      [&](std::uint32_t band, std::uint32_t component, const std::vector<RingPoint>& ring) {
        rings.clear();
        split_at_repetitions(ring, rings);
        for (Ring& r : rings) {
          const double area = twice_area(r);
          if (area != 0) {
            parts.push_back({band, component, area, std::move(r)});
          }
        }
      });
  std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
    return a.band != b.band ? a.band < b.band : a.component < b.component;
  });
  std::vector<BandPolygon> polygons;
  for (std::size_t begin = 0; begin < parts.size();) {
    context.check_stop();
    std::size_t end = begin;
    while (end < parts.size() && parts[end].band == parts[begin].band &&
           parts[end].component == parts[begin].component) {
      ++end;
    }
    assemble(std::span(parts).subspan(begin, end - begin), polygons);
    begin = end;
  }
  return polygons;
}

}  // namespace ptin
