// SPDX-License-Identifier: GPL-3.0-or-later
//
// The engine's StreamReader behind functions of C, for WebAssembly: one reader a module instance. tools/viewer/build
// compiles it; src/decoder.ts is its only caller. questions.cc asks the mesh that it holds.
//
// Errors: this build has no exceptions to catch, so `throw` ends in __cxa_throw() below. That hands code and text to the
// host, whose function throws in its own language and so leaves the module for good. After that the host reads what is there
// (src/decoder.ts says what) and feeds nothing more; a new stream gets a new instance. A question that is refused leaves mesh and
// reader as they were, but what it had of the stack is lost: the host asks nothing that would be.
#include "tools/viewer/decoder/decoder.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>
#include <typeinfo>
#include <vector>

#include "engine/error.h"
#include "engine/query/terrain.h"

/// Throws in the host. `code`: place in ErrorCode.
extern "C" __attribute__((import_module("host"), import_name("fail"), noreturn)) void host_fail(
    std::uint32_t code, const char* text, std::size_t bytes);

namespace {

[[noreturn]] void fail(ptin::ErrorCode code, std::string_view text) {
  host_fail(static_cast<std::uint32_t>(code), text.data(), text.size());
}

/// What 32 bits of address leave for the mesh and a frame, beside the allocator's own.
constexpr std::uint64_t kMemoryBytes = std::uint64_t{3} << 30;

/// Facts in the order in which src/decoder.ts reads them.
struct PlainFacts {
  double origin_x, origin_y, step_x, step_y;
  double height_is_float, height_step, height_offset;
  double min_x, min_y, max_x, max_y;
  double min_height, max_height, base_error, base_deviation;
};

std::vector<std::byte>& input() {
  static std::vector<std::byte> bytes;
  return bytes;
}

}  // namespace

ptin::StreamReader& ptin::viewer::reader() {
  static ptin::StreamReader the_reader("the stream", {{kMemoryBytes, {}}});
  return the_reader;
}

using ptin::viewer::reader;

// NOLINTBEGIN(bugprone-reserved-identifier): the names that the compiler calls.
extern "C" void* __cxa_allocate_exception(std::size_t bytes) noexcept {
  if (void* memory = std::malloc(bytes)) return memory;
  fail(ptin::ErrorCode::resource_exhausted, "there is no memory left");
}

extern "C" [[noreturn]] void __cxa_throw(void* thrown, std::type_info* type, void (*)(void*)) {
  if (*type == typeid(ptin::Error)) {
    const auto* error = static_cast<const ptin::Error*>(thrown);
    fail(error->code(), error->what());
  }
  fail(ptin::ErrorCode::internal, "the decoder failed in a way that it does not know");
}
extern "C" [[noreturn]] void __cxa_pure_virtual() { __builtin_trap(); }

/// Debian's divisions of 128 bits (libclang-rt) are compiled to watch their stack by these.
extern "C" {
std::uintptr_t __stack_chk_guard = 0x5dec0de5;
[[noreturn]] void __stack_chk_fail() { __builtin_trap(); }
}
// NOLINTEND(bugprone-reserved-identifier)

void* operator new(std::size_t bytes) {
  if (void* memory = std::malloc(bytes == 0 ? 1 : bytes)) return memory;
  fail(ptin::ErrorCode::resource_exhausted,
       "the browser gives no more memory; open the stream at a larger error");
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

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
  const ptin::StoreFacts& f = reader().facts();
  plain = {f.map.origin_x,
           f.map.origin_y,
           f.map.step_x,
           f.map.step_y,
           f.heights.type == ptin::HeightType::float32 ? 1.0 : 0.0,
           f.heights.step,
           f.heights.offset,
           static_cast<double>(f.bounds.min_x),
           static_cast<double>(f.bounds.min_y),
           static_cast<double>(f.bounds.max_x),
           static_cast<double>(f.bounds.max_y),
           f.min_height,
           f.max_height,
           f.base_error,
           f.base_deviation};
  return &plain;
}
PTIN_EXPORT(metadata) const char* metadata() { return reader().metadata().data(); }
PTIN_EXPORT(metadataBytes) std::size_t metadata_bytes() { return reader().metadata().size(); }
