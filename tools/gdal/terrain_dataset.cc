// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/gdal/terrain_dataset.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/crs/border_move.h"
#include "engine/error.h"
#include "engine/remote/remote_file.h"
#include "tools/export/pixel_grid.h"
#include "tools/facts/source_count.h"
#include "tools/formats/number_text.h"
#include "tools/gdal/terrain_band.h"
#include "tools/gdal/terrain_layers.h"

namespace ptin::tools {

namespace {

Terrain opened(const std::string& name) {
  if (is_remote(name)) return Terrain(open_remote_store(name));
  return Terrain(name, PageAccess::kPread, ReplacedFile::kAnswers);
}

/// The number of the row 1, 2, 5, 10, 20 ... that a number > 0 is nearest to.
double rounded_to_125(double number) {
  const double ten = std::pow(10, std::floor(std::log10(number)));
  const double digits = number / ten;
  return (digits < 1.5 ? 1 : digits < 3.5 ? 2 : digits < 7.5 ? 5 : 10) * ten;
}

/// Width and height of a pixel, map units: of a raster its own, of points such that there are about
/// as many pixels as samples. (The grid of points is far finer than they are.)
std::array<double, 2> own_pixel_for(const StoreFile& store, const Window& bounds) {
  if (const auto own = own_pixel_of(store)) return {own->x, own->y};
  const double width = bounds.max_x - bounds.min_x;
  const double height = bounds.max_y - bounds.min_y;
  const auto samples =
      static_cast<double>(std::max<std::uint64_t>(store.facts().source_samples, 1));
  const double size = rounded_to_125(std::sqrt(width * height / samples));
  const double side = std::min({size, width, height});
  return {side, side};
}

RasterRequest pixels_of(const StoreFacts& facts, std::array<double, 2> own,
                        const OpenOptions& options) {
  if (!options.pixel_size) return pixels_in(std::nullopt, own, facts);
  const double size = *options.pixel_size;
  try {
    return pixels_in(std::nullopt, {size, size}, facts);
  } catch (const Error&) {
    refuse(
        "the raster has fewer than 2 or more than 2^31 - 1 columns or rows of pixels of this size",
        "PIXEL_SIZE");
  }
}

}  // namespace

TerrainDataset::TerrainDataset(const GDALOpenInfo& info)
    : terrain_(opened(info.pszFilename)),
      crs_(crs_facts(terrain_.store())),
      options_(open_options_of(info.papszOpenOptions)),
      own_pixel_(own_pixel_for(terrain_.store(), bounds())),
      border_reach_(border_reach(terrain_.store(), 1.0)),
      pixels_(pixels_of(facts(), own_pixel_, options_)),
      srs_(new OGRSpatialReference) {
  srs_->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (crs_.is_understood) srs_->importFromWkt(crs_.wkt.c_str());
  nRasterXSize = static_cast<int>(pixels_.pixels.width);
  nRasterYSize = static_cast<int>(pixels_.pixels.height);
  // The areas of pixels reach half a pixel beyond the samples: centres there lie on the border.
  pixels_.lattice.margin = {std::abs(pixels_.lattice.step_x) / 2,
                            std::abs(pixels_.lattice.step_y) / 2};
  pixels_.limits.memory_bytes = options_.memory_bytes;
  eAccess = GA_ReadOnly;
  SetDescription(info.pszFilename);
  SetMetadataItem("SAMPLES", std::to_string(facts().source_samples).c_str(), kOwnDomain);
  if ((info.nOpenFlags & GDAL_OF_RASTER) != 0) {
    SetMetadataItem(GDALMD_AREA_OR_POINT, GDALMD_AOP_POINT);
    SetBand(1, new TerrainBand(*this));
  }
  if ((info.nOpenFlags & GDAL_OF_VECTOR) == 0) return;
  layers_.push_back(std::make_unique<TriangleLayer>(*this));
  if (options_.interval) layers_.push_back(std::make_unique<IsolineLayer>(*this));
}

std::array<double, 6> TerrainDataset::geotransform() const { return geotransform_of(pixels_); }

OGRLayer* TerrainDataset::layer(int i) const {
  if (i < 0 || i >= layer_count()) return nullptr;
  return layers_[static_cast<std::size_t>(i)].get();
}

Window TerrainDataset::bounds() const noexcept {
  const GridBox& b = facts().bounds;
  const MapPoint low = facts().map.to_map(b.min_x, b.min_y);
  const MapPoint high = facts().map.to_map(b.max_x, b.max_y);
  return {low.x, low.y, high.x, high.y};
}

DetailRequest TerrainDataset::detail_for_pixels(double width, double height) const {
  DetailRequest detail;
  if (options_.error) {
    if (*options_.error > 0) detail.tolerance = options_.error;
    return detail;
  }
  const double samples = width * height / (own_pixel_[0] * own_pixel_[1]);  // of a pixel
  if (samples < 1 + 1e-9) return detail;
  // The index is not asked about the window of the whole terrain, for which this is exact.
  const double vertices = static_cast<double>(facts().source_samples) / samples;
  IoCounters io;
  return detail_for(terrain_.store(), static_cast<std::uint64_t>(vertices) + 1, bounds(), io,
                    most_error_for_pixels(border_reach_, width, height));
}

Certificate TerrainDataset::certificate_of(const DetailRequest& detail) const {
  return certify_below(terrain_.store(), detail.tolerance.value_or(-1.0));
}

void tell_certificate(const Certificate& certificate, GDALMajorObject& object) {
  const auto tell = [&](const char* name, double bound) {
    std::string text;
    append_number(text, bound);
    const char* const known = object.GDALMajorObject::GetMetadataItem(name, kOwnDomain);
    if (known == nullptr || text != known) object.SetMetadataItem(name, text.c_str(), kOwnDomain);
  };
  tell("CERTIFIED_ERROR", certificate.error);
  tell("CERTIFIED_DEVIATION", certificate.deviation);
}

}  // namespace ptin::tools
