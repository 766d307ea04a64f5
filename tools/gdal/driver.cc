// SPDX-License-Identifier: GPL-3.0-or-later
//
// The driver PTIN: what GDAL calls when it has loaded gdal_PTIN.so.
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

#include <gdal_priv.h>

#include "engine/remote/remote_file.h"
#include "storage/layout.h"
#include "tools/gdal/guard.h"
#include "tools/gdal/open_options.h"
#include "tools/gdal/terrain_dataset.h"

namespace ptin::tools {

namespace {

/// True for a URL of a terrain by its name, which ends where a query or a fragment begins.
bool names_terrain(const std::string& url) {
  const std::string_view name = std::string_view(url).substr(0, url.find_first_of("?#"));
  constexpr std::string_view kEnd = ".ptin";
  return name.size() > kEnd.size() && name.find("://") != std::string_view::npos &&
         !name.starts_with("/vsi") && is_remote(url) &&
         EQUALN(name.data() + name.size() - kEnd.size(), kEnd.data(), kEnd.size());
}

/// A store by its first bytes; a URL, of which GDAL reads none, by its name.
int identify(GDALOpenInfo* info) {
  if (info->nHeaderBytes >= static_cast<int>(layout::kMagic.size())) {
    return static_cast<int>(
        std::memcmp(info->pabyHeader, layout::kMagic.data(), layout::kMagic.size()) == 0);
  }
  bool is_ours = false;
  static_cast<void>(guarded([&] { is_ours = names_terrain(info->pszFilename); }));
  return static_cast<int>(is_ours);
}

GDALDataset* open(GDALOpenInfo* info) {
  // OGR and QGIS try to open for writing first, and then for reading: a message would be seen twice.
  if (identify(info) == FALSE || info->eAccess == GA_Update) return nullptr;
  std::unique_ptr<TerrainDataset> dataset;
  static_cast<void>(guarded([&] { dataset = std::make_unique<TerrainDataset>(*info); }));
  return dataset.release();
}

}  // namespace

}  // namespace ptin::tools

/// The one function that the plugin shows; GDAL makes its name from that of the file.
extern "C" CPL_DLL void GDALRegister_PTIN();  // NOLINT(readability-identifier-naming)

void GDALRegister_PTIN() {
  if (!GDAL_CHECK_VERSION("PTIN driver") || GDALGetDriverByName("PTIN") != nullptr) return;
  auto driver = std::make_unique<GDALDriver>();
  driver->SetDescription("PTIN");
  driver->SetMetadataItem(GDAL_DMD_LONGNAME, "Progressive TIN");
  driver->SetMetadataItem(GDAL_DMD_EXTENSION, "ptin");
  driver->SetMetadataItem(GDAL_DMD_OPENOPTIONLIST, ptin::tools::kOpenOptionList);
  for (const char* const capability :
       {GDAL_DCAP_OPEN, GDAL_DCAP_RASTER, GDAL_DCAP_VECTOR, GDAL_DCAP_VIRTUALIO}) {
    driver->SetMetadataItem(capability, "YES");
  }
  driver->pfnIdentify = ptin::tools::identify;
  driver->pfnOpen = ptin::tools::open;
  GetGDALDriverManager()->RegisterDriver(driver.release());
}
