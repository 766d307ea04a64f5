// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mesh of the sender of a stream while it goes on from what the receiver has.
#pragma once

#include <cstdint>

#include "engine/geometry/key_table.h"
#include "engine/large_array.h"
#include "engine/mesh/split.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/refine/split_site.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/retrieval.h"

namespace ptin {

/// A mesh that grows split by split, and the place of each vertex. Threads: one owner.
class GrowingMesh {
 public:
  GrowingMesh(const Tin& base, std::uint64_t splits) {
    const auto copy = [](const auto& from, auto& to, std::uint64_t more) {
      reserve_large(to, from.size() + more);
      to.insert(to.end(), from.begin(), from.end());
    };
    copy(base.vertices, tin_.vertices, splits);
    copy(base.has_height, tin_.has_height, splits);
    copy(base.triangles, tin_.triangles, 2 * splits);
    copy(base.classes, tin_.classes, 2 * splits);
    ids_.reserve(base.vertices.size() + splits);
    for (VertexId v = 0; v < base.vertices.size(); ++v) {
      ids_.insert(key_of(base.position(v)), v);
    }
  }
  [[nodiscard]] const Tin& tin() const noexcept { return tin_; }
  [[nodiscard]] VertexId find(VertexKey key) const noexcept { return ids_.find(key); }
  /// Id of the vertex that the next split makes.
  [[nodiscard]] VertexId next() const noexcept {
    return static_cast<VertexId>(tin_.vertices.size());
  }

  /// Bytes of a mesh of so many vertices.
  [[nodiscard]] static std::uint64_t bytes_of(std::uint64_t vertices) noexcept {
    constexpr std::uint64_t kVertexBytes = sizeof(Vertex) + sizeof(std::uint8_t);
    constexpr std::uint64_t kTriangleBytes = sizeof(Triangle) + sizeof(TriangleClass);
    return vertices * (kVertexBytes + 2 * kTriangleBytes) + KeyTable::bytes_for(vertices);
  }

  /// Where a split takes place.
  /// @throws Error corruption  it names a vertex that is not there
  [[nodiscard]] SplitSite site(const PendingSplit& s, const QueryContext& context) const {
    const VertexId w = ids_.find(s.w);
    const VertexId vl = ids_.find(s.vl);
    const VertexId vr = ids_.find(s.vr);
    if (w == KeyTable::kAbsent || vl == KeyTable::kAbsent || vr == KeyTable::kAbsent) {
      throw_refused(s, "it names a vertex that no record before it makes", context);
    }
    return site_of(next(), w, vl, vr, s.flags);
  }
  /// @param site  site(s, context).
  /// @throws Error corruption  the split does not fit
  SplitResult apply(const PendingSplit& s, const SplitSite& site, const QueryContext& context) {
    if (!ids_.insert(s.u, site.u)) {
      throw_refused(s, "its vertex is in the mesh already", context);
    }
    tin_.vertices.push_back({point_of(s.u), s.height, kNone});
    tin_.has_height.push_back((s.flags & VertexSplit::kVertexVoid) == 0 ? 1 : 0);
    const SplitResult made = split(tin_, site);
    if (!made.applied) {
      throw_refused(s, "it does not fit the mesh", context);
    }
    return made;
  }

 private:
  Tin tin_;
  KeyTable ids_;
};

}  // namespace ptin
