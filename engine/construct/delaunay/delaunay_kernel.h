// SPDX-License-Identifier: GPL-3.0-or-later
//
// CGAL's Delaunay triangulations over grid points, and how they become a Tin. For the sources
// *delaunay*.cc alone: no others include CGAL.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include "engine/geometry/point.h"
#include "engine/mesh/tin.h"

namespace ptin::delaunay_internal {

using BaseKernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// CGAL's kernel with predicates of our own, for points whose coordinates are whole numbers from 0
/// to 2^30. Orientation is decided in 64 bits; the side of a circle in doubles, and where these do
/// not decide, in 128 bits. CGAL's own predicates would then use numbers of any length, and on
/// grids, where most points are cocircular, that is nearly always.
class GridKernel : public BaseKernel {
 public:
  using Point_2 = BaseKernel::Point_2;

  struct Orientation_2 {
    using result_type = CGAL::Orientation;
    CGAL::Orientation operator()(const Point_2& p, const Point_2& q, const Point_2& r) const {
      // Differences are at most 2^30, so products at most 2^60: 64 bits hold their difference.
      const auto qx = static_cast<std::int64_t>(q.x() - p.x());
      const auto qy = static_cast<std::int64_t>(q.y() - p.y());
      const auto rx = static_cast<std::int64_t>(r.x() - p.x());
      const auto ry = static_cast<std::int64_t>(r.y() - p.y());
      const std::int64_t left = qx * ry, right = qy * rx;
      return left > right ? CGAL::LEFT_TURN : (left < right ? CGAL::RIGHT_TURN : CGAL::COLLINEAR);
    }
  };

  struct Side_of_oriented_circle_2 {
    using result_type = CGAL::Oriented_side;
    CGAL::Oriented_side operator()(const Point_2& p, const Point_2& q, const Point_2& r,
                                   const Point_2& t) const {
      const double qpx = q.x() - p.x(), qpy = q.y() - p.y();
      const double rpx = r.x() - p.x(), rpy = r.y() - p.y();
      const double tpx = t.x() - p.x(), tpy = t.y() - p.y();
      const double tqx = t.x() - q.x(), tqy = t.y() - q.y();
      const double rqx = r.x() - q.x(), rqy = r.y() - q.y();
      const double a = qpx * tpy - qpy * tpx, b = tpx * tqx + tpy * tqy;
      const double c = qpx * rpy - qpy * rpx, d = rpx * rqx + rpy * rqy;
      const double determinant = a * d - b * c;
      // CGAL's bound for this formula (Filtered_kernel, static filters): differences are exact
      // here.
      const double width =
          std::max({std::abs(qpx), std::abs(rpx), std::abs(tpx), std::abs(tqx), std::abs(rqx)});
      const double height =
          std::max({std::abs(qpy), std::abs(rpy), std::abs(tpy), std::abs(tqy), std::abs(rqy)});
      const double larger = std::max(width, height), smaller = std::min(width, height);
      const double bound = 8.8878565762001373e-15 * larger * smaller * (larger * larger);
      if (determinant > bound) {
        return CGAL::ON_POSITIVE_SIDE;
      }
      if (determinant < -bound) {
        return CGAL::ON_NEGATIVE_SIDE;
      }
      // All four terms are at most 2^61: 128 bits hold the products.
      __extension__ using Int128 = __int128;
      const auto whole = [](double v) { return static_cast<std::int64_t>(v); };
      const std::int64_t ia = whole(qpx) * whole(tpy) - whole(qpy) * whole(tpx);
      const std::int64_t ib = whole(tpx) * whole(tqx) + whole(tpy) * whole(tqy);
      const std::int64_t ic = whole(qpx) * whole(rpy) - whole(qpy) * whole(rpx);
      const std::int64_t id = whole(rpx) * whole(rqx) + whole(rpy) * whole(rqy);
      const Int128 left = Int128{ia} * id, right = Int128{ib} * ic;
      return left > right   ? CGAL::ON_POSITIVE_SIDE
             : left < right ? CGAL::ON_NEGATIVE_SIDE
                            : CGAL::ON_ORIENTED_BOUNDARY;
    }
  };

  [[nodiscard]] Orientation_2 orientation_2_object() const { return {}; }
  [[nodiscard]] Side_of_oriented_circle_2 side_of_oriented_circle_2_object() const { return {}; }
};

using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<VertexId, GridKernel>;
/// The marks of constrained edges lie where the info of a face would be padded: they cost nothing.
using FaceBase = CGAL::Triangulation_face_base_with_info_2<
    TriangleId, GridKernel, CGAL::Constrained_triangulation_face_base_2<GridKernel>>;
using DataStructure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
/// What both kinds of triangulations are: all but how points are inserted.
using Triangulation = CGAL::Triangulation_2<GridKernel, DataStructure>;
using Delaunay = CGAL::Delaunay_triangulation_2<GridKernel, DataStructure>;
using Vertex_handle = Triangulation::Vertex_handle;
using Face_handle = Triangulation::Face_handle;

/// A constrained Delaunay triangulation that reports which vertices have new faces where an edge
/// was forced. Edges must not cross; they may go through vertices and lie on one another.
class ConstrainedDelaunay
    : public CGAL::Constrained_Delaunay_triangulation_2<
          GridKernel, DataStructure, CGAL::No_constraint_intersection_requiring_constructions_tag> {
 public:
  /// Forces the edge from a to b. Every face that comes of it lies in the hole of the faces that the
  /// edge crosses; the corners of these are appended to `changed`, some more than once.
  void force_edge(Vertex_handle a, Vertex_handle b, std::vector<VertexId>& changed) {
    changed_ = &changed;
    insert_constraint(a, b);
    changed_ = nullptr;
  }

 protected:
  using Base = CGAL::Constrained_Delaunay_triangulation_2<
      GridKernel, DataStructure, CGAL::No_constraint_intersection_requiring_constructions_tag>;
  void triangulate_hole(List_faces& crossed, List_edges& left, List_edges& right) override {
    for (const Face_handle& f : crossed) {
      for (int i = 0; i < 3; ++i) {
        if (!is_infinite(f->vertex(i))) {
          changed_->push_back(f->vertex(i)->info());
        }
      }
    }
    Base::triangulate_hole(crossed, left, right);
  }

 private:
  std::vector<VertexId>* changed_ = nullptr;
};

inline GridPoint position_of(const Vertex_handle& v) {
  return {static_cast<std::int32_t>(v->point().x()), static_cast<std::int32_t>(v->point().y())};
}

/// A face, seen from its corner with the smallest id: corner(0) is that corner, and corner(1) and
/// corner(2) follow counter-clockwise.
struct Oriented {
  Face_handle face;
  int first = 0;

  [[nodiscard]] int place(int i) const { return first + i > 2 ? first + i - 3 : first + i; }
  [[nodiscard]] VertexId corner(int i) const { return face->vertex(place(i))->info(); }
  [[nodiscard]] TriangleId neighbour(int i) const { return face->neighbor(place(i))->info(); }
  [[nodiscard]] bool is_fixed(int i) const { return face->is_constrained(place(i)); }
};

/// Sorts faces by corner(0), then corner(1), and sets the info of each to its place in that order.
/// REQUIRES: the infos of their vertices are ids below `vertices`; those of all other faces are
/// kNone.
inline std::vector<Oriented> number_faces(const std::vector<Face_handle>& faces,
                                          std::size_t vertices) {
  std::vector<std::uint32_t> start(vertices + 1, 0);
  std::vector<Oriented> oriented;
  oriented.reserve(faces.size());
  for (const Face_handle& f : faces) {
    Oriented face{f, 0};
    for (const int i : {1, 2}) {
      if (f->vertex(i)->info() < face.corner(0)) {
        face.first = i;
      }
    }
    ++start[face.corner(0) + 1];
    oriented.push_back(face);
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Oriented> sorted(faces.size());
  auto next = start;
  for (const Oriented& face : oriented) {
    sorted[next[face.corner(0)]++] = face;
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    std::sort(sorted.begin() + start[v], sorted.begin() + start[v + 1],
              [](const Oriented& a, const Oriented& b) { return a.corner(1) < b.corner(1); });
  }
  for (std::size_t t = 0; t < sorted.size(); ++t) {
    sorted[t].face->info() = static_cast<TriangleId>(t);
  }
  return sorted;
}

/// Adds numbered faces to a Tin that has its vertices, and gives each vertex a triangle: on the
/// border the triangle that has no neighbour clockwise around the vertex, inside its first one.
inline void add_faces(const std::vector<Oriented>& faces, Tin& tin) {
  tin.triangles.reserve(faces.size());
  for (const Oriented& f : faces) {
    tin.triangles.push_back({{f.corner(0), f.corner(1), f.corner(2)},
                             {f.neighbour(0), f.neighbour(1), f.neighbour(2)}});
  }
  tin.classes.assign(faces.size(), TriangleClass::kSurface);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      TriangleId& of_vertex = tin.vertices[tin.triangles[t].v[i]].triangle;
      if (of_vertex == kNone || tin.triangles[t].n[previous_corner(i)] == kNone) {
        of_vertex = t;
      }
    }
  }
}

}  // namespace ptin::delaunay_internal
