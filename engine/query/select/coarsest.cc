// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/select/coarsest.h"

#include <cstdint>

#include "engine/error.h"
#include "engine/mesh/link.h"
#include "engine/mesh/validate.h"

namespace ptin {

namespace {

[[noreturn]] void throw_invalid(const std::string& fault, const std::string& file) {
  throw Error(ErrorCode::corruption,
              "T0 is not a valid TIN: " + fault + "; run verify, and build the file again", file);
}

void copy_corners(const CoarsestTin& t0, const std::string& file, Tin& tin) {
  for (const CoarsestTin::V& v : t0.vertices) {
    tin.vertices.push_back({v.position, v.height, kNone});
    tin.has_height.push_back(v.has_height != 0 ? 1 : 0);
  }
  for (const CoarsestTin::T& t : t0.triangles) {
    for (const std::uint32_t v : t.v) {
      if (v >= t0.vertices.size()) {
        throw_invalid("a triangle names vertex " + std::to_string(v) + " of " +
                          std::to_string(t0.vertices.size()),
                      file);
      }
    }
    tin.triangles.push_back({{t.v[0], t.v[1], t.v[2]}, {kNone, kNone, kNone}});
    tin.classes.push_back(t.is_void != 0 ? TriangleClass::kVoid : TriangleClass::kSurface);
  }
}

}  // namespace

Tin mesh_of(const CoarsestTin& t0, const std::string& file) {
  Tin tin;
  copy_corners(t0, file, tin);
  link_tin(tin);
  for (const Vertex& v : tin.vertices) {
    if (v.triangle == kNone) {
      throw_invalid("a vertex is in no triangle", file);
    }
  }
  if (const std::string fault = validate(tin); !fault.empty()) {
    throw_invalid(fault, file);
  }
  return tin;
}

}  // namespace ptin
