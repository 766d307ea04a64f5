// SPDX-License-Identifier: GPL-3.0-or-later
//
// The part of a TIN that meets a place, as a mesh: gathered from the triangles that live at a level
// of detail, without a split.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "engine/geometry/key_table.h"
#include "engine/mesh/tin.h"
#include "engine/query/living/living_place.h"

namespace ptin {

/// Gathers parts of the TIN of one level of detail, one after the other, in the same memory.
/// Threads: one owner.
class LivingTin : private LivingVisitor {
 public:
  /// @param terrain, detail  Borrowed for the life of this object.
  LivingTin(const OpenedTerrain& terrain, const Detail& detail) : reader_(terrain, detail) {}

  /// Gathers the triangles of a place: surface and void ones, each once, in the order of the file.
  /// False, and nothing is there, when that takes more than `most_bytes`. Found out before pages
  /// are read where the place gathered before lets expect so.
  /// @throws Error as LivingReader::read()
  /// Cost: that of LivingReader::read(), and a look-up by key for about each triangle.
  [[nodiscard]] bool gather(const LivingPlace& place, std::uint64_t most_bytes,
                            QueryContext& context);

  /// What was gathered: corners and classes. No neighbour is set, nor a vertex's triangle:
  /// link_tin() (mesh/link.h) sets them.
  [[nodiscard]] const Tin& tin() const noexcept { return tin_; }
  [[nodiscard]] Tin& tin() noexcept { return tin_; }
  [[nodiscard]] Tin release_tin() noexcept { return std::move(tin_); }

  /// What the last gather() that did not fit would have taken, as far as it came.
  [[nodiscard]] std::uint64_t bytes_wanted() const noexcept { return bytes_wanted_; }
  /// Bytes that the arrays of so many triangles take while they grow, where they make up a part
  /// without gaps.
  [[nodiscard]] static std::uint64_t bytes_for(std::uint64_t triangles) noexcept;

 private:
  bool expect(std::uint64_t records) override;
  bool begin(std::size_t most_triangles) override;
  void take(const LivingTriangle& t) override;

  void clear();
  void add_waiting();
  [[nodiscard]] VertexId id_of(const LivingTriangle::Corner& corner);

  LivingReader reader_;
  Tin tin_;
  KeyTable ids_;
  std::uint64_t most_bytes_ = 0;
  double triangles_of_record_ = 0.5;  ///< About, by what was gathered last.
  std::uint64_t bytes_wanted_ = 0;
  std::size_t room_ = 0;  ///< Vertices that the table has room for.
  /// Triangles whose corners are being fetched from the table: a look-up by key misses the caches.
  std::array<LivingTriangle, 32> taken_;
  std::size_t waiting_ = 0;
};

}  // namespace ptin
