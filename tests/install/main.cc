// SPDX-License-Identifier: GPL-3.0-or-later
//
// Uses the installed headers and library as another project would: builds a small terrain, asks it,
// and ends with exit status 0 when everything is as it should be.
#include <cstdio>
#include <fstream>
#include <string>

#include <engine/construct/build.h>
#include <engine/error.h>
#include <engine/geometry/orient.h>
#include <engine/query/questions.h>
#include <engine/remote/remote_file.h>

namespace {

int failures = 0;

void expect(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "not so: %s\n", what);
    ++failures;
  }
}

/// A hill of 41 x 41 points.
void write_points(const std::string& path) {
  std::ofstream out(path);
  for (int y = 0; y <= 40; ++y) {
    for (int x = 0; x <= 40; ++x) {
      out << x << ' ' << y << ' ' << (400 - (x - 20) * (x - 20) - (y - 20) * (y - 20)) / 4 << '\n';
    }
  }
}

void build_and_ask() {
  write_points("hill.xyz");
  ptin::BuildResources resources;
  resources.overwrite = true;
  const ptin::BuildReport report = ptin::build({"hill.xyz"}, "hill.ptin", {}, resources);
  expect(report.vertices == 41 * 41, "every point is a vertex");

  const ptin::Terrain terrain = ptin::Terrain::open("hill.ptin");
  expect(terrain.refine({}).vertices == report.vertices, "without a tolerance all come back");
  ptin::RefineRequest coarse;
  coarse.detail.tolerance = 5.0;
  const ptin::RefinedTin refined = terrain.refine(coarse);
  expect(refined.vertices < report.vertices / 4, "a tolerance needs few vertices");
  expect(refined.certified_error <= 5.0, "and keeps its promise");

  std::uint64_t cells = 0;
  ptin::TinParts parts = terrain.parts({});
  ptin::walk_cells(parts, [&](const ptin::GridCell&, const ptin::Tin&, double) { ++cells; });
  expect(cells == 1, "a small terrain is one cell");
  const ptin::Terrain far(ptin::open_remote_store("/vsisubfile/0,hill.ptin"));
  expect(far.refine({}).vertices == report.vertices, "a file elsewhere is the same");
  try {
    static_cast<void>(ptin::Terrain::open("hill.xyz"));
    expect(false, "points are no store");
  } catch (const ptin::Error& e) {
    expect(e.code() == ptin::ErrorCode::invalid_argument, "points are another file");
  }
}

}  // namespace

int main() {
  const ptin::GridPoint a{0, 0};
  const ptin::GridPoint b{4, 0};
  const ptin::GridPoint c{0, 3};
  expect(ptin::orient(a, b, c) == 12 && ptin::orient(a, c, b) == -12, "orient is exact");
  build_and_ask();
  return failures == 0 ? 0 : 1;
}
