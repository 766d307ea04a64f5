// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/crs_in_text.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>

#include "engine/handle.h"

namespace ptin {

namespace {

constexpr std::size_t kEndBytes = 1 << 16;  // of a text's begin and end that are looked at

/// How the texts of a format name a CRS: what stands before it, and what may end it.
struct NamesOfFormat {
  const char* driver;
  std::string_view before, after;
};
constexpr std::array<NamesOfFormat, 5> kNames = {{{"GML", "srsName=\"", "\""},
                                                  {"OGR_VRT", "<LayerSRS>", "<"},
                                                  {"VRT", "<SRS>", "<"},
                                                  {"OGR_GMT", "@J", " \r\n"},
                                                  {"MapInfo File", "CoordSys ", "\r\n"}}};

/// The beginning and the end of a file, which may be the same; "" where it cannot be read.
std::string ends_of(const char* path) {
  const Handle<VSILFILE, &VSIFCloseL> file(VSIFOpenL(path, "rb"));
  if (file == nullptr) {
    return "";
  }
  std::string text(2 * kEndBytes, '\0');
  std::size_t there = VSIFReadL(text.data(), 1, kEndBytes, file.get());
  VSIFSeekL(file.get(), 0, SEEK_END);
  const vsi_l_offset size = VSIFTellL(file.get());
  const vsi_l_offset rest = std::min<vsi_l_offset>(size - there, kEndBytes);
  VSIFSeekL(file.get(), size - rest, SEEK_SET);
  there += VSIFReadL(text.data() + there, 1, static_cast<std::size_t>(rest), file.get());
  text.resize(there);
  return text;
}

std::string without_blanks_before(std::string text) {
  return text.erase(0, std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

/// The text behind `before`, up to one of the characters `after`; "" where that is not there.
std::string between(std::string_view text, std::string_view before, std::string_view after) {
  const std::size_t at = text.find(before);
  if (at == std::string_view::npos) {
    return "";
  }
  const std::string_view rest = text.substr(at + before.size());
  return without_blanks_before(std::string(rest.substr(0, rest.find_first_of(after))));
}

/// The text of the file that belongs to a dataset and has this extension; "" for none.
std::string companion_of(GDALDataset& data, const char* extension) {
  const CPLStringList files(data.GetFileList(), TRUE);
  for (int i = 0; i < files.size(); ++i) {
    if (EQUAL(CPLGetExtension(files[i]), extension)) {
      return without_blanks_before(ends_of(files[i]));
    }
  }
  return "";
}

std::string ers_item(GDALDataset& data, const char* name) {
  const char* const value = data.GetMetadataItem(name, "ERS");
  return value == nullptr || EQUAL(value, "RAW") ? "" : value;
}

/// The kind of projection in the attributes of a netCDF file.
std::string grid_mapping_of(GDALDataset& data) {
  const CPLStringList items(data.GetMetadata(), FALSE);
  for (int i = 0; i < items.size(); ++i) {
    const std::string_view text(items[i]);
    if (const std::size_t at = text.find("#grid_mapping_name="); at != std::string_view::npos) {
      return std::string(text.substr(at + 1));
    }
  }
  return "";
}

}  // namespace

std::string prj_of(GDALDataset& data) {
  std::string text = companion_of(data, "prj");
  // The list of a shapefile leaves a .prj out that is not understood.
  if (text.empty() && EQUAL(data.GetDriverName(), "ESRI Shapefile")) {
    text = without_blanks_before(ends_of(CPLResetExtension(data.GetDescription(), "prj")));
  }
  return text;
}

std::string crs_in_geojson(GDALDataset& data) {
  if (!EQUAL(data.GetDriverName(), "GeoJSON")) {
    return "";
  }
  constexpr std::size_t kLongest = 1024;
  const std::string text = ends_of(data.GetDescription());
  for (std::size_t at = text.find("\"crs\""); at != std::string::npos;
       at = text.find("\"crs\"", at + 1)) {
    const std::string member = text.substr(at, kLongest);
    const std::size_t colon = member.find("\"name\"", member.find("\"properties\""));
    const std::size_t begin = colon == std::string::npos ? colon : member.find(':', colon);
    const bool is_object = member.find_first_not_of(" \t\r\n:", 5) == member.find('{');
    if (is_object && begin != std::string::npos) {
      return between(member.substr(begin), "\"", "\"");
    }
  }
  return "";
}

std::string crs_in_text(GDALDataset& data) {
  if (std::string text = prj_of(data); !text.empty()) {
    return text;
  }
  const std::string datum = ers_item(data, "DATUM"), projection = ers_item(data, "PROJ");
  if (!datum.empty() || !projection.empty()) {
    return projection + " " + datum;
  }
  if (std::string text = grid_mapping_of(data); !text.empty()) {
    return text;
  }
  for (const NamesOfFormat& of : kNames) {
    if (EQUAL(data.GetDriverName(), of.driver)) {
      std::string text = between(ends_of(data.GetDescription()), of.before, of.after);
      return CPLString(text).ifind("NonEarth") == 0 ? "" : text;
    }
  }
  return between(companion_of(data, "xml"), "<SRS>", "<");
}

}  // namespace ptin
