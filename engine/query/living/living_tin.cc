// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/living_tin.h"

#include <algorithm>
#include <span>
#include <utility>

namespace ptin {

namespace {

/// Arrays double while they grow.
std::uint64_t bytes_of(std::uint64_t triangles, std::uint64_t vertices) noexcept {
  return 2 * (triangles * (sizeof(Triangle) + sizeof(TriangleClass)) +
              vertices * (sizeof(Vertex) + 1)) +
         KeyTable::bytes_for(2 * vertices);
}

}  // namespace

std::uint64_t LivingTin::bytes_for(std::uint64_t triangles) noexcept {
  return bytes_of(triangles, triangles / 2 + 3);
}

void LivingTin::clear() {
  tin_.vertices.clear();
  tin_.has_height.clear();
  tin_.triangles.clear();
  tin_.classes.clear();
  ids_.reset(room_);
  waiting_ = 0;
}

bool LivingTin::gather(const LivingPlace& place, std::uint64_t most_bytes, QueryContext& context) {
  clear();
  most_bytes_ = most_bytes;
  const std::uint64_t before = context.cost.examined();
  const bool fits = reader_.read(place, context, *this);
  add_waiting();
  if (const std::uint64_t records = context.cost.examined() - before; records > 0) {
    triangles_of_record_ =
        static_cast<double>(tin_.triangles.size()) / static_cast<double>(records);
  }
  if (!fits) {
    clear();
  }
  return fits;
}

bool LivingTin::expect(std::uint64_t records) {
  bytes_wanted_ =
      bytes_for(static_cast<std::uint64_t>(triangles_of_record_ * static_cast<double>(records)));
  return bytes_wanted_ <= 2 * most_bytes_;  // parts differ
}

bool LivingTin::begin(std::size_t most_triangles) {
  add_waiting();
  const std::size_t triangles = tin_.triangles.size() + most_triangles;
  // Triangles that lie apart have more vertices than those of a whole part.
  bytes_wanted_ = bytes_of(triangles, tin_.vertices.size() + most_triangles / 2 + 3);
  if (bytes_wanted_ > most_bytes_ || triangles >= kNone / 3) {
    return false;
  }
  const std::size_t vertices = tin_.vertices.size() + 3 * most_triangles;
  if (vertices > room_) {
    room_ = std::max(vertices, 2 * room_);
    ids_.reserve(room_);
  }
  return true;
}

void LivingTin::take(const LivingTriangle& t) {
  if (waiting_ == taken_.size()) {
    add_waiting();
  }
  for (const LivingTriangle::Corner& c : t.corner) {
    ids_.prefetch(key_of(c.position));
  }
  taken_[waiting_++] = t;
}

void LivingTin::add_waiting() {
  for (const LivingTriangle& t : std::span(taken_).first(std::exchange(waiting_, 0))) {
    tin_.triangles.push_back(
        {{id_of(t.corner[0]), id_of(t.corner[1]), id_of(t.corner[2])}, {kNone, kNone, kNone}});
    tin_.classes.push_back(t.is_void ? TriangleClass::kVoid : TriangleClass::kSurface);
  }
}

VertexId LivingTin::id_of(const LivingTriangle::Corner& corner) {
  const VertexKey key = key_of(corner.position);
  const auto next = static_cast<VertexId>(tin_.vertices.size());
  if (const VertexId id = ids_.find_or_insert(key, next); id != next) {
    return id;
  }
  tin_.vertices.push_back({corner.position, corner.height, kNone});
  tin_.has_height.push_back(corner.has_height ? 1 : 0);
  return next;
}

}  // namespace ptin
