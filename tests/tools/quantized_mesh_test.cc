// SPDX-License-Identifier: GPL-3.0-or-later
//
// What headers of quantized-mesh tell a viewer.
#include "tools/tiles/quantized_mesh.h"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/tiles_fixture.h"

namespace ptin::tools::testing {
namespace {

TEST(TerrainTiles, HeadersHoldTheirVertices) {
  const TestFolder folder;
  const Transformed to_space("EPSG:4979", "EPSG:4978");
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  for (const std::string& path : {built_in_feet(folder), built(folder, "coast_257.tif")}) {
    const Tiled tiled(path);
    for (int z = 0; z <= tiled.finest(); ++z) {
      for (const TileNumber& t : listed(tiled.tiles.layer_json("1"), z)) {
        const ReadTerrain tile = tiled.read(z, t.x, t.y);
        std::vector<Ecef> scaled;
        for (std::size_t i = 0; i < tile.u.size(); ++i) {
          const Ecef p = to_space({lon_of(t, tile.u[i]), lat_of(t, tile.v[i]), tile.height(i)});
          const double away = std::hypot(p[0] - tile.sphere_centre[0], p[1] - tile.sphere_centre[1],
                                         p[2] - tile.sphere_centre[2]);
          EXPECT_LE(away, tile.radius + 1e-6);
          EXPECT_LE(tile.height(i), tile.most);
          EXPECT_GE(tile.height(i), tile.least);
          scaled.push_back({p[0] / 6378137.0, p[1] / 6378137.0, p[2] / 6356752.3142451793});
        }
        // As Cesium tells whether a point is below the horizon of a viewer at `c`.
        const auto is_hidden = [](const Ecef& c, const Ecef& p) {
          const double horizon = c[0] * c[0] + c[1] * c[1] + c[2] * c[2] - 1;
          const Ecef to{p[0] - c[0], p[1] - c[1], p[2] - c[2]};
          const double along = -(to[0] * c[0] + to[1] * c[1] + to[2] * c[2]);
          const double square = to[0] * to[0] + to[1] * to[1] + to[2] * to[2];
          return along > horizon && along * along / square > horizon;
        };
        for (int viewer = 0; viewer < 40; ++viewer) {
          Ecef c{share(random), share(random), share(random)};
          const double distance = std::hypot(c[0], c[1], c[2]);
          const double wanted = 1.0 + std::abs(share(random)) * (viewer % 2 == 0 ? 0.01 : 3.0);
          for (double& v : c) v *= wanted / distance;
          if (!is_hidden(c, tile.horizon)) continue;
          for (const Ecef& p : scaled) {
            const double up = std::hypot(p[0], p[1], p[2]);
            EXPECT_TRUE(up < 1.0 || is_hidden(c, p)) << z << "/" << t.x << "/" << t.y;
          }
        }
      }
    }
  }
}

TEST(HorizonOcclusionPoint, OfOnePointIsAboveIt) {
  const Vec3 p{kSemiMajor + 1000.0, 0.0, 0.0};
  const Vec3 point = horizon_occlusion_point(p, std::vector<Vec3>{p});
  EXPECT_NEAR(point.x, 1.0 + 1000.0 / kSemiMajor, 1e-12);
}

}  // namespace
}  // namespace ptin::tools::testing
