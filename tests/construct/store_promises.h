// SPDX-License-Identifier: GPL-3.0-or-later
//
// The promises of engine/DESIGN.md, section 2.8, of a store that was built.
#pragma once

#include <string>

#include "engine/mesh/validate.h"
#include "engine/query/questions.h"
#include "tests/construct/surface_oracle.h"

namespace ptin::oracle {

/// The first promise that a store breaks, in words.
inline std::string check_store(const TestTerrain& terrain, const Terrain& tin) {
  if (!(named_triangles(tin.refine({}).tin) == named_triangles(terrain.full))) {
    return "P1: the full TIN is another one";
  }
  for (const double tolerance : {0.0, 0.3, 1.0, 4.0, 25.0, 1e9}) {
    RefineRequest request;
    request.detail.tolerance = tolerance;
    const RefinedTin refined = tin.refine(request);
    std::string fault = validate(refined.tin);
    fault = fault.empty() ? check_samples(terrain, refined.tin, tolerance) : fault;
    fault =
        fault.empty() ? check_deviation(terrain, refined.tin, refined.certified_deviation) : fault;
    if (!fault.empty()) {
      return "at " + std::to_string(tolerance) + ": " + fault;
    }
  }
  return {};
}

}  // namespace ptin::oracle
