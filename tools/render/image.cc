// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/image.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <cpl_vsi.h>
#include <gdal_priv.h>

#include "engine/error.h"
#include "tools/output/gdal_output.h"
#include "tools/output/output_file.h"

namespace ptin::tools {

namespace {

using DatasetPtr = std::unique_ptr<GDALDataset, decltype(&GDALClose)>;

DatasetPtr dataset_of(const Image& image) {
  DatasetPtr data(driver_named("MEM").Create("", image.width, image.height, 3, GDT_Byte, nullptr),
                  GDALClose);
  std::vector<std::uint8_t> row(static_cast<std::size_t>(image.width));
  for (int y = 0; data && y < image.height; ++y) {
    for (int band = 0; band < 3; ++band) {
      const Colour* from = &image.pixels[static_cast<std::size_t>(y) * row.size()];
      std::transform(from, from + image.width, row.begin(), [band](const Colour& c) {
        return static_cast<std::uint8_t>(
            std::lround(std::clamp(c[static_cast<std::size_t>(band)], 0.0F, 255.0F)));
      });
      if (data->GetRasterBand(band + 1)->RasterIO(GF_Write, 0, y, image.width, 1, row.data(),
                                                  image.width, 1, GDT_Byte, 0, 0,
                                                  nullptr) != CE_None) {
        throw Error(ErrorCode::internal, "GDAL refused a row of the picture");
      }
    }
  }
  return data;
}

}  // namespace

void write_png(const Image& image, const std::string& path, bool overwrite) {
  const DatasetPtr data = dataset_of(image);
  // The PNG is made in memory, so that its file is written and renamed as every output is.
  std::string name = "/vsimem/ptin_picture_";
  name.append(std::to_string(reinterpret_cast<std::uintptr_t>(&image)));
  const DatasetPtr png(
      data ? driver_named("PNG").CreateCopy(name.c_str(), data.get(), 0, nullptr, nullptr, nullptr)
           : nullptr,
      GDALClose);
  if (png) png->FlushCache();
  vsi_l_offset bytes = 0;
  const std::unique_ptr<GByte, decltype(&VSIFree)> content(
      VSIGetMemFileBuffer(name.c_str(), &bytes, 1), VSIFree);
  VSIUnlink(name.append(".aux.xml").c_str());
  if (!png || !content) throw Error(ErrorCode::internal, "GDAL made no PNG of the picture", path);
  OutputFile out(path, overwrite);
  out.write(content.get(), static_cast<std::size_t>(bytes));
  out.publish();
}

}  // namespace ptin::tools
