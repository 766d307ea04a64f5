// SPDX-License-Identifier: GPL-3.0-or-later
//
// The engine's StreamReader behind functions of C, for WebAssembly: one reader a module instance. tools/viewer/build
// compiles it; src/decoder.ts is its only caller. The questions of its mesh are a module of their own (questions.cc).
//
// Errors: what is refused leaves the module for good (module.h). After that the host reads what is there (src/decoder.ts says
// what) and feeds nothing more; a new stream gets a new instance.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/questions.h"
#include "tools/decoder/wasm/ground.h"
#include "tools/decoder/wasm/module.h"

namespace {

/// Bytes that 32 bits of address leave for the mesh and a frame, beside the allocator's own.
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

/// Valid until the next call of feed().
const ptin::Tin& ptin::viewer::tin() { return reader().tin(); }
const ptin::StoreFacts& ptin::viewer::facts() { return reader().facts(); }

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
PTIN_EXPORT(certifiedError) double certified_error() { return reader().certificate().error; }
PTIN_EXPORT(certifiedDeviation) double certified_deviation() {
  return reader().certificate().deviation;
}

/// Facts in the order in which src/decoder.ts reads them. Valid until the next call.
PTIN_EXPORT(facts) const double* facts() {
  static std::array<double, 15> numbers;
  const ptin::StoreFacts& f = reader().facts();
  const auto number = [](auto value) { return static_cast<double>(value); };
  numbers = {f.map.origin_x,
             f.map.origin_y,
             f.map.step_x,
             f.map.step_y,
             number(f.heights.type == ptin::HeightType::float32),
             f.heights.step,
             f.heights.offset,
             number(f.bounds.min_x),
             number(f.bounds.min_y),
             number(f.bounds.max_x),
             number(f.bounds.max_y),
             f.min_height,
             f.max_height,
             f.base_error,
             f.base_deviation};
  return numbers.data();
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

/// Numbers that lines of sight are drawn with, in the unit of heights: how much lower what lies at distance 1 looks, and how far light
/// goes in a second.
PTIN_EXPORT(curvature) double curvature() {
  ptin::Curvature curvature;
  curvature.earth_diameter = ptin::viewer::ground().earth_diameter;
  return curvature.drop_at(1.0);
}
PTIN_EXPORT(lightSpeed) double light_speed() {
  return ptin::viewer::kSpeedOfLight / ptin::viewer::ground().metres_per_height;
}
