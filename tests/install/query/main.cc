// SPDX-License-Identifier: GPL-3.0-or-later
//
// Opens the store that is named and asks it; ends with exit status 0 when the answers go together.
#include <cstdio>

#include <engine/error.h>
#include <engine/query/refine/refine.h>
#include <engine/query/terrain.h>

int main(int count, char** arguments) {
  if (count != 2) return 2;
  try {
    const ptin::Terrain terrain = ptin::Terrain::open(arguments[1]);
    const auto all = terrain.refine({}).vertices;
    ptin::RefineRequest coarse;
    coarse.detail.tolerance = 5.0;
    return terrain.refine(coarse).vertices < all ? 0 : 1;
  } catch (const ptin::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
