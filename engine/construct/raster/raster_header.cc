// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_header.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>

#include "engine/construct/grid/gdal_session.h"
#include "engine/error.h"

namespace ptin {
namespace {

/// The first `most` bytes of a file in small letters; "" where it cannot be read.
std::string begin_of(const std::string& path, std::size_t most) {
  std::string text = beginning_of_file(path, most).value_or("");
  std::transform(text.begin(), text.end(), text.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return text;
}

/// The value of a line "key = value" of a header; "" where there is none.
std::string value_of(const std::string& header, std::string_view key) {
  constexpr std::string_view kBlanks = " \t\r\"";
  for (std::size_t at = 0; at < header.size();) {
    const std::size_t end = std::min(header.find('\n', at), header.size());
    const std::string_view line = std::string_view(header).substr(at, end - at);
    const std::size_t mark = line.find('=');
    const std::size_t begin = line.find_first_not_of(kBlanks);
    if (mark != std::string_view::npos && begin < mark &&
        line.substr(begin, line.find_last_not_of(kBlanks, mark - 1) + 1 - begin) == key) {
      const std::string_view value = line.substr(mark + 1);
      const std::size_t first = value.find_first_not_of(kBlanks);
      return first == std::string_view::npos
                 ? ""
                 : std::string(value.substr(first, value.find_last_not_of(kBlanks) + 1 - first));
    }
    at = end + 1;
  }
  return {};
}

/// True for an angle or a number, in whatever parts, that is not 0.
bool is_other_than_zero(const std::string& value) {
  return value.find_first_of("123456789") != std::string::npos;
}

constexpr std::size_t kLongHeader = std::size_t{1} << 16;

void check_ers(const std::string& path) {
  const std::string rotation = value_of(begin_of(path, kLongHeader), "rotation");
  if (is_other_than_zero(rotation)) {
    refuse("this raster is rotated (Rotation = " + rotation +
               "), which GDAL passes over; make it north-up where it was made",
           path);
  }
}

void check_saga(const std::string& path) {
  const std::string name = CPLResetExtension(path.c_str(), "sgrd");
  const std::string offset = value_of(begin_of(name, kLongHeader), "datafile_offset");
  if (is_other_than_zero(offset)) {
    refuse("the heights of this raster begin behind " + offset +
               " other bytes (DATAFILE_OFFSET), and GDAL reads from the first one; save it with an "
               "offset of 0",
           path);
  }
}

void check_ascii_grid(const std::string& path) {
  const std::string header = begin_of(path, 1024);
  const auto has = [&](const char* key) { return header.find(key) != std::string::npos; };
  if ((has("xllcorner") && has("yllcenter")) || (has("xllcenter") && has("yllcorner"))) {
    refuse(
        "the header tells where a corner of the first pixel is in one direction and its centre in "
        "the "
        "other, and GDAL takes neither; write xllcorner and yllcorner, half a cellsize less than a "
        "centre",
        path);
  }
}

void check_coverage(GDALDataset& data, const std::string& path, SourceWarnings& warnings) {
  GDALRasterBand* const band = data.GetRasterBand(1);
  const char* const encoding =
      band == nullptr ? nullptr : band->GetMetadataItem("GRID_CELL_ENCODING");
  if (encoding != nullptr && EQUAL(encoding, "grid-value-is-corner")) {
    warnings.add(
        {"values_at_corners",
         "the heights are those of the corners of pixels (grid-value-is-corner), and are "
         "taken for those of their centres, so the terrain may lie half a pixel off; move it "
         "with 'gdal_translate -a_ullr' where that matters",
         path});
  }
}

}  // namespace

void check_header(GDALDataset& data, const std::string& path, SourceWarnings& warnings) {
  const std::string driver = data.GetDriver() == nullptr ? "" : data.GetDriverName();
  if (driver == "ERS") {
    check_ers(path);
  } else if (driver == "SAGA") {
    check_saga(path);
  } else if (driver == "AAIGrid") {
    check_ascii_grid(path);
  } else if (driver == "GPKG") {
    check_coverage(data, path, warnings);
  }
}

}  // namespace ptin
