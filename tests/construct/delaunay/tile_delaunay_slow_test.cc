// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Delaunay stage on millions of points and on real scans.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/construct/delaunay/tiled_delaunay.h"
#include "tests/construct/point_sets.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

TEST(TileDelaunayOfMany, AMillionPointsAreOneTriangulation) {
  expect_one_triangulation(buckets_of(PointKind::kEven, 1'000'000, 1), 16);
}

TEST(TileDelaunayOfMany, EveryKindIsOneTriangulation) {
  for (const PointKind kind : kPointKinds) {
    SCOPED_TRACE(name_of(kind));
    expect_one_triangulation(
        buckets_of(kind, 200'000 / static_cast<std::size_t>(test::share_of_cases(4)), 2), 64);
  }
}

TEST(TileDelaunayOfMany, RealScansAreOneTriangulation) {
  const std::string data = PTIN_SHARED_DATA;
  for (const char* name :
       {"autzen_trim.las", "ign_lidarhd_0382_6565_crop.las", "isprs_fsite8.xyz.gz"}) {
    if (!std::filesystem::exists(data + "/" + name)) {
      GTEST_SKIP() << "needs " << name;
    }
    SCOPED_TRACE(name);
    expect_one_triangulation(read_buckets({data + "/" + name}), 64);
  }
}

}  // namespace
}  // namespace ptin
