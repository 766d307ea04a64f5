// SPDX-License-Identifier: GPL-3.0-or-later
//
// Writes a made terrain of any size as a tiled GeoTIFF, for benchmarks of builds that are larger
// than the real terrains at hand: fractal noise with the slopes of a mountain range, heights in
// decimetres (Int16), 30 m pixels; the same bytes whenever it runs.
//   make_terrain SIDE OUT.tif
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <gdal_priv.h>
#include <ogr_spatialref.h>

namespace {

constexpr int kBlock = 512;
constexpr int kOctaves = 11;

/// A number in [-1, 1] for each lattice point of an octave.
double lattice(std::uint32_t x, std::uint32_t y, std::uint32_t octave) {
  std::uint64_t h = (std::uint64_t{x} << 32 | y) + octave * 0x9e3779b97f4a7c15U;
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9U;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebU;
  return static_cast<double>(static_cast<std::int64_t>(h ^ (h >> 31)) >> 11) * 0x1p-52;
}

double smooth(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

double noise(double x, double y, std::uint32_t octave) {
  const auto ix = static_cast<std::uint32_t>(x);
  const auto iy = static_cast<std::uint32_t>(y);
  const double u = smooth(x - ix);
  const double v = smooth(y - iy);
  const double south = lattice(ix, iy, octave) * (1 - u) + lattice(ix + 1, iy, octave) * u;
  const double north = lattice(ix, iy + 1, octave) * (1 - u) + lattice(ix + 1, iy + 1, octave) * u;
  return south * (1 - v) + north * v;
}

/// Decimetres: octaves of 4096 pixels down to 4, each a little more than half as high as the last.
std::int16_t height(int x, int y) {
  double sum = 12000.0, size = 4096.0, amplitude = 9000.0;
  for (std::uint32_t octave = 0; octave < kOctaves; ++octave) {
    sum += amplitude * noise(x / size, y / size, octave);
    size /= 2;
    amplitude *= 0.52;
  }
  return static_cast<std::int16_t>(std::lround(std::fmin(std::fmax(sum, -32000.0), 32000.0)));
}

bool write(int side, const char* path) {
  GDALAllRegister();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  const char* const options[] = {"TILED=YES", "BLOCKXSIZE=512", "BLOCKYSIZE=512",
                                 "BIGTIFF=IF_SAFER", nullptr};
  const GDALDatasetUniquePtr file(GDALDataset::FromHandle(
      driver->Create(path, side, side, 1, GDT_Int16, const_cast<char**>(options))));
  if (!file) return false;
  double transform[6] = {300000.0, 30.0, 0.0, 5600000.0, 0.0, -30.0};
  file->SetGeoTransform(transform);
  OGRSpatialReference crs;
  crs.importFromEPSG(32633);
  file->SetSpatialRef(&crs);
  file->GetRasterBand(1)->SetScale(0.1);
  std::vector<std::int16_t> block(std::size_t{kBlock} * kBlock);
  for (int y = 0; y < side; y += kBlock) {
    for (int x = 0; x < side; x += kBlock) {
      const int w = std::min(kBlock, side - x), h = std::min(kBlock, side - y);
      for (int j = 0; j < h; ++j) {
        for (int i = 0; i < w; ++i) {
          block[static_cast<std::size_t>(j) * w + i] = height(x + i, y + j);
        }
      }
      if (file->GetRasterBand(1)->RasterIO(GF_Write, x, y, w, h, block.data(), w, h, GDT_Int16, 0,
                                           0, nullptr) != CE_None) {
        return false;
      }
    }
  }
  file->FlushCache();
  return CPLGetLastErrorType() != CE_Failure;
}

}  // namespace

int main(int argc, char** argv) {
  const int side = argc == 3 ? std::atoi(argv[1]) : 0;
  if (side < 2) {
    std::fprintf(stderr, "usage: make_terrain SIDE OUT.tif\n");
    return 2;
  }
  if (!write(side, argv[2])) {
    std::fprintf(stderr, "make_terrain: cannot write %s\n", argv[2]);
    return 6;
  }
  return 0;
}
