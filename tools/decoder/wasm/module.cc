// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/decoder/wasm/module.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>
#include <typeinfo>

#include "engine/error.h"

/// Throws in the host. `code`: place in ErrorCode.
extern "C" __attribute__((import_module("host"), import_name("fail"), noreturn)) void host_fail(
    std::uint32_t code, const char* text, std::size_t bytes);

namespace {

[[noreturn]] void fail(ptin::ErrorCode code, std::string_view text) {
  host_fail(static_cast<std::uint32_t>(code), text.data(), text.size());
}

}  // namespace

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

/// The mesh and its facts. src/mesh.ts reads them, and src/questions.ts fills those of the questions.
PTIN_EXPORT(vertexCount) std::size_t vertex_count() { return ptin::viewer::tin().vertices.size(); }
PTIN_EXPORT(vertices) const void* vertices() { return ptin::viewer::tin().vertices.data(); }
PTIN_EXPORT(hasHeight) const void* has_height() { return ptin::viewer::tin().has_height.data(); }
PTIN_EXPORT(triangleCount) std::size_t triangle_count() {
  return ptin::viewer::tin().triangles.size();
}
PTIN_EXPORT(triangles) const void* triangles() { return ptin::viewer::tin().triangles.data(); }
PTIN_EXPORT(classes) const void* classes() { return ptin::viewer::tin().classes.data(); }
PTIN_EXPORT(storeFacts) const void* store_facts() { return &ptin::viewer::facts(); }
PTIN_EXPORT(storeFactsBytes) std::size_t store_facts_bytes() { return sizeof(ptin::StoreFacts); }
static_assert(sizeof(ptin::Vertex) == 16 && offsetof(ptin::Vertex, height) == 8 &&
              sizeof(ptin::Triangle) == 24 && sizeof(ptin::TriangleClass) == 1);

void* operator new(std::size_t bytes) {
  if (void* memory = std::malloc(bytes == 0 ? 1 : bytes)) return memory;
  fail(ptin::ErrorCode::resource_exhausted,
       "the browser gives no more memory; open the stream at a larger error");
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
