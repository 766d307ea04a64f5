// SPDX-License-Identifier: GPL-3.0-or-later
//
// A Delaunay triangulation around the points of a tile, which grows until the faces of the tile are
// faces of the triangulation of all points. For delaunay/tile_delaunay.cc.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <unordered_set>
#include <vector>

#include "engine/construct/delaunay/bucket_cache.h"
#include "engine/construct/delaunay/delaunay_kernel.h"
#include "engine/construct/lines/fixed_edges.h"
#include "engine/construct/points/point_buckets.h"
#include "engine/geometry/circumdisc.h"
#include "engine/mesh/tin.h"

namespace ptin::delaunay_internal {

class Part;
class UnseenRegion;

/// The *own* points of one tile, triangulated with as many others around them as decide the tile's
/// triangles. A face is *final* when no point that was not inserted lies where it would change the
/// face (delaunay/unseen_region.h), and no fixed edge that was not forced meets that region.
/// Vertices are numbered in the order in which points are inserted.
class GrowingDelaunay {
 public:
  /// @param buckets       Must live as long as this.
  /// @param first, count  The own points: first .. first + count - 1 in the order of the buckets.
  /// @param cache_bytes   Memory for points that were looked at and not inserted.
  GrowingDelaunay(const PointBuckets& buckets, std::uint64_t first, std::uint64_t count,
                  std::size_t cache_bytes, const std::stop_token& stop);

  /// Inserts the own points and those of a margin. To be called once, before all else.
  /// @throws Error io_error, cancelled
  void triangulate();
  /// Inserts points until every face at the given vertices, and at own vertices beside new ones, is
  /// final.  @throws Error io_error, cancelled
  void settle(std::vector<VertexId> vertices);
  /// The own vertices at which a face may not be final: its disc leaves the box.
  [[nodiscard]] std::vector<VertexId> own_vertices_to_settle();

  /// True when all points are own points: all faces are final.
  [[nodiscard]] bool holds_everything() const noexcept {
    return first_ == 0 && end_ == buckets_.size();
  }
  [[nodiscard]] bool has_fixed_edges() const noexcept { return !fixed_.is_empty(); }
  [[nodiscard]] std::uint64_t own_points() const noexcept { return end_ - first_; }
  /// Points inserted so far, and so the number of vertices.
  [[nodiscard]] std::size_t points() const noexcept { return handles_.size(); }
  [[nodiscard]] bool is_own(VertexId v) const noexcept { return own_[v] != 0; }
  [[nodiscard]] HeightBits height(VertexId v) const noexcept { return heights_[v]; }
  [[nodiscard]] Vertex_handle handle(VertexId v) const noexcept { return handles_[v]; }
  [[nodiscard]] Triangulation& delaunay() noexcept { return delaunay_; }
  [[nodiscard]] const Triangulation& delaunay() const noexcept { return delaunay_; }

 private:
  void choose_box(const std::vector<BucketPoint>& own);
  struct NewPoint {
    BucketPoint point;
    bool own;
  };
  void insert(const BucketPoint& p, bool own);
  void insert_all(const std::vector<NewPoint>& points);
  void span_area();
  /// Inserts the vertex of a fixed edge, which may be in already.
  [[nodiscard]] Vertex_handle insert_fixed(std::uint32_t vertex);
  /// Forces the fixed edges with meets(box) that are not in yet. True when there were any.
  template <class Meets>
  bool force_edges(const Meets& meets);
  [[nodiscard]] std::uint64_t bucket_of(std::uint64_t point) const noexcept {
    return buckets_.bucket_of(point);
  }
  [[nodiscard]] bool settle_star(VertexId v);
  [[nodiscard]] bool is_final(const Face_handle& face);
  [[nodiscard]] std::vector<Part> visible_parts(const Face_handle& face,
                                                const Circumdisc& disc) const;
  [[nodiscard]] bool take_from(BucketCache::Bucket& loaded, const UnseenRegion& region);
  [[nodiscard]] bool see(const UnseenRegion& region, GridPoint near);

  const PointBuckets& buckets_;
  std::uint64_t first_, end_;
  std::stop_token stop_;
  GridBox box_;  ///< All points inside of it are inserted.
  const FixedEdges& fixed_;
  // The one of the two that the points need; delaunay_ is what they have in common.
  std::unique_ptr<Delaunay> plain_;
  std::unique_ptr<ConstrainedDelaunay> constrained_;
  Triangulation& delaunay_;
  Face_handle hint_;
  std::vector<Vertex_handle> handles_;
  std::vector<HeightBits> heights_;
  std::vector<std::uint8_t> own_;
  BucketCache cache_;               ///< Buckets that reach beyond the box.
  std::vector<VertexId> inserted_;  ///< Vertices inserted since this was last cleared.
  std::vector<VertexId> changed_;   ///< Likewise, those with new faces beside forced edges.
  std::unordered_set<std::uint32_t> forced_;  ///< Fixed edges that are in.
  /// A face, from its smallest corner on; an infinite face by the ends of its edge and kNone.
  struct Corners {
    std::array<VertexId, 3> v;
    friend bool operator==(const Corners&, const Corners&) = default;
  };
  struct HashCorners {
    std::size_t operator()(const Corners& c) const noexcept {
      std::uint64_t h = 0;
      for (const VertexId v : c.v) {
        h = (h ^ v) * 0x9e3779b97f4a7c15U;
        h ^= h >> 29;
      }
      return h;
    }
  };
  std::unordered_set<Corners, HashCorners>
      final_;  ///< Those final faces whose circumdiscs leave the box.
};

}  // namespace ptin::delaunay_internal
