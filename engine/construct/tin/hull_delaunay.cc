// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/hull_delaunay.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/box_intersection_d.h>

#include "engine/geometry/box.h"
#include "engine/geometry/orient.h"
#include "engine/stop.h"

namespace ptin {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
/// How often the surface covers a face; kUnknown before it is reached.
using Winding = int;
constexpr Winding kUnknown = INT_MIN;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<VertexId, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<Winding, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;

bool is_before(const BorderEdge& a, const BorderEdge& b) {
  return a.from != b.from ? a.from < b.from : a.to < b.to;
}

/// The constrained Delaunay triangulation of the border's vertices, with its edges kept.
Cdt triangulate(std::span<const GridPoint> positions, std::span<const BorderEdge> border,
                const std::stop_token& stop) {
  std::vector<std::pair<Cdt::Point, VertexId>> points;
  std::vector<VertexId> ids;
  for (const BorderEdge& e : border) {
    ids.push_back(e.from);
    ids.push_back(e.to);
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  for (const VertexId v : ids) {
    points.emplace_back(Cdt::Point(positions[v].x, positions[v].y), v);
  }
  Cdt cdt;
  cdt.insert(points.begin(), points.end());
  std::vector<Cdt::Vertex_handle> handles(ids.size());
  for (auto v = cdt.finite_vertices_begin(); v != cdt.finite_vertices_end(); ++v) {
    const auto at = std::lower_bound(ids.begin(), ids.end(), v->info());
    handles[static_cast<std::size_t>(at - ids.begin())] = v;
  }
  const auto handle = [&](VertexId v) {
    return handles[static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), v) -
                                            ids.begin())];
  };
  for (std::size_t i = 0; i < border.size(); ++i) {
    if (i % kStopInterval == 0) {
      stop_if_asked(stop, "the triangulation");
    }
    cdt.insert_constraint(handle(border[i].from), handle(border[i].to));
  }
  return cdt;
}

/// Gives every face the number of times that the surface covers it, from outside inwards.
void wind(Cdt& cdt, std::span<const BorderEdge> border) {
  for (auto f = cdt.all_faces_begin(); f != cdt.all_faces_end(); ++f) {
    f->info() = kUnknown;
  }
  std::vector<Cdt::Face_handle> open = {cdt.infinite_face()};
  open.front()->info() = 0;
  while (!open.empty()) {
    const Cdt::Face_handle f = open.back();
    open.pop_back();
    for (int i = 0; i < 3; ++i) {
      const Cdt::Face_handle g = f->neighbor(i);
      if (g->info() != kUnknown) {
        continue;
      }
      g->info() = f->info();
      if (f->is_constrained(i)) {
        // The edge from ccw(i) to cw(i) has f on its left; the other way round it has g there.
        const BorderEdge from_g = {f->vertex(Cdt::cw(i))->info(), f->vertex(Cdt::ccw(i))->info()};
        const bool g_is_left = std::binary_search(border.begin(), border.end(), from_g, is_before);
        g->info() += g_is_left ? 1 : -1;
      }
      open.push_back(g);
    }
  }
}

// ---------------------------------------------------------------------------------------------------
// The border against itself.

struct EdgeBox : CGAL::Box_intersection_d::Box_d<double, 2> {
  EdgeBox(const GridBox& b, BorderEdge e)
      : Box_d(CGAL::Bbox_2(b.min_x, b.min_y, b.max_x, b.max_y)), edge(e) {}
  BorderEdge edge;
};

}  // namespace

std::vector<Corners> fill_hull(std::span<const GridPoint> positions,
                               std::span<const BorderEdge> border, TinFaults& faults,
                               const std::stop_token& stop) {
  Cdt cdt = triangulate(positions, border, stop);
  wind(cdt, border);
  std::vector<Corners> filling;
  for (auto f = cdt.finite_faces_begin(); f != cdt.finite_faces_end(); ++f) {
    if (f->info() == 0) {
      filling.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
    } else if (f->info() != 1) {
      faults.covered.add(positions[f->vertex(0)->info()]);
    }
  }
  // An order that does not depend on CGAL's: by corners, the smallest first.
  for (Corners& t : filling) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  }
  std::sort(filling.begin(), filling.end());
  return filling;
}

void check_border(std::span<const GridPoint> positions, std::span<const BorderEdge> border,
                  TinFaults& faults) {
  std::vector<EdgeBox> boxes;
  boxes.reserve(border.size());
  for (const BorderEdge& e : border) {
    boxes.emplace_back(united(box_of(positions[e.from]), positions[e.to]), e);
  }
  std::vector<VertexId> inside;
  const auto is_inside = [&](VertexId v, const BorderEdge& e) {
    if (v == e.from || v == e.to) {
      return false;
    }
    const GridPoint a = positions[e.from], b = positions[e.to], p = positions[v];
    return orient(a, b, p) == 0 && contains(united(box_of(a), b), p);
  };
  const auto compare = [&](const EdgeBox& one, const EdgeBox& other) {
    const BorderEdge& e = one.edge;
    const BorderEdge& f = other.edge;
    bool touches = false;
    for (const VertexId v : {f.from, f.to}) {
      if (is_inside(v, e)) {
        inside.push_back(v);
        touches = true;
      }
    }
    for (const VertexId v : {e.from, e.to}) {
      if (is_inside(v, f)) {
        inside.push_back(v);
        touches = true;
      }
    }
    if (touches || e.from == f.from || e.from == f.to || e.to == f.from || e.to == f.to) {
      return;
    }
    const GridPoint a = positions[e.from], b = positions[e.to];
    const GridPoint c = positions[f.from], d = positions[f.to];
    const bool f_is_split = (orient(a, b, c) > 0) != (orient(a, b, d) > 0);
    const bool e_is_split = (orient(c, d, a) > 0) != (orient(c, d, b) > 0);
    if (f_is_split && e_is_split) {
      faults.crossings.add(a);
    }
  };
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), compare);
  std::sort(inside.begin(), inside.end());
  inside.erase(std::unique(inside.begin(), inside.end()), inside.end());
  for (const VertexId v : inside) {
    faults.t_junctions.add(positions[v]);
  }
}

}  // namespace ptin
