// SPDX-License-Identifier: GPL-3.0-or-later
//
// The engine's StreamReader behind functions of C, for WebAssembly: one reader a module instance. tools/viewer/build
// compiles it; src/decoder.ts is its only caller. The questions of its mesh are a module of their own (questions.cc).
//
// Errors: what is refused leaves the module for good (module.h). After that the host reads what is there (src/decoder.ts says
// what) and feeds nothing more; a new stream gets a new instance.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/questions.h"
#include "tools/viewer/decoder/ground.h"
#include "tools/viewer/decoder/module.h"

namespace {

using ptin::viewer::PlainFacts;

/// What 32 bits of address leave for the mesh and a frame, beside the allocator's own.
constexpr std::uint64_t kMemoryBytes = std::uint64_t{3} << 30;

ptin::StreamReader& reader() {
  static ptin::StreamReader the_reader("the stream", {{kMemoryBytes, {}}});
  return the_reader;
}

std::vector<std::byte>& input() {
  static std::vector<std::byte> bytes;
  return bytes;
}

}  // namespace

/// Room for the bytes that are fed next. Valid until the next call.
PTIN_EXPORT(room) std::byte* room(std::size_t bytes) {
  input().resize(bytes);
  return input().data();
}

/// As StreamReader::feed(), or feed_frame(), with the first `bytes` of room().
PTIN_EXPORT(feed) std::size_t feed(std::size_t bytes, bool one_frame) {
  const std::span<const std::byte> given = std::span(input()).first(bytes);
  return one_frame ? reader().feed_frame(given) : reader().feed(given);
}
PTIN_EXPORT(beginNext) void begin_next() { reader().begin_next(); }

PTIN_EXPORT(hasMesh) bool has_mesh() { return reader().has_mesh(); }
PTIN_EXPORT(isComplete) bool is_complete() { return reader().is_complete(); }
PTIN_EXPORT(numbering) double numbering() { return static_cast<double>(reader().numbering()); }
PTIN_EXPORT(splits) double splits() { return static_cast<double>(reader().splits()); }
PTIN_EXPORT(splitsInAll) double splits_in_all() {
  return static_cast<double>(reader().splits_in_all());
}
PTIN_EXPORT(bytesUsed) double bytes_used() { return static_cast<double>(reader().bytes_used()); }
PTIN_EXPORT(certifiedError) double certified_error() { return reader().certificate().error; }
PTIN_EXPORT(certifiedDeviation) double certified_deviation() {
  return reader().certificate().deviation;
}
/// Facts that hold of any mesh of the terrain.
PTIN_EXPORT(reliefError) double relief_error() {
  return ptin::certificate_by_relief(reader().facts()).error;
}
PTIN_EXPORT(reliefDeviation) double relief_deviation() {
  return ptin::certificate_by_relief(reader().facts()).deviation;
}

/// The mesh, as engine/mesh/tin.h has it in memory. Valid until the next call of feed().
PTIN_EXPORT(vertexCount) std::size_t vertex_count() { return reader().tin().vertices.size(); }
PTIN_EXPORT(vertices) const ptin::Vertex* vertices() { return reader().tin().vertices.data(); }
PTIN_EXPORT(hasHeight) const std::uint8_t* has_height() { return reader().tin().has_height.data(); }
PTIN_EXPORT(triangleCount) std::size_t triangle_count() { return reader().tin().triangles.size(); }
PTIN_EXPORT(triangles) const ptin::Triangle* triangles() { return reader().tin().triangles.data(); }
PTIN_EXPORT(classes) const ptin::TriangleClass* classes() { return reader().tin().classes.data(); }
static_assert(sizeof(ptin::Vertex) == 16 && offsetof(ptin::Vertex, height) == 8 &&
              sizeof(ptin::Triangle) == 24 && sizeof(ptin::TriangleClass) == 1);

PTIN_EXPORT(facts) const PlainFacts* facts() {
  static PlainFacts plain;
  plain = ptin::viewer::plain(reader().facts());
  return &plain;
}
PTIN_EXPORT(metadata) const char* metadata() { return reader().metadata().data(); }
PTIN_EXPORT(metadataBytes) std::size_t metadata_bytes() { return reader().metadata().size(); }

/// Metres over ground between two map positions; not a number where that is not known.
PTIN_EXPORT(metresBetween) double metres_between(double ax, double ay, double bx, double by) {
  const ptin::Ground on = ptin::viewer::ground();
  return on.distance({ax, ay}, {bx, by}) * on.metres_per_height;
}

/// Metres over ground of one map unit along x and of one along y, at a position. Valid until the next call.
PTIN_EXPORT(metresPerMapUnit) const ptin::MapPoint* metres_per_map_unit(double x, double y) {
  static ptin::MapPoint metres;
  const ptin::Ground on = ptin::viewer::ground();
  const ptin::MapPoint per_unit = on.per_map_unit({x, y});
  metres = {per_unit.x * on.metres_per_height, per_unit.y * on.metres_per_height};
  return &metres;
}
