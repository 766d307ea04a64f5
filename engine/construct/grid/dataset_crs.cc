// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/dataset_crs.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/gdal_session.h"
#include "engine/handle.h"
#include "engine/number.h"

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

/// The text of the .prj that belongs to a dataset; "" for none, and where it cannot be read.
std::string prj_of(GDALDataset& data) {
  std::string text = companion_of(data, "prj");
  // The list of a shapefile leaves a .prj out that is not understood.
  if (text.empty() && EQUAL(data.GetDriverName(), "ESRI Shapefile")) {
    text = without_blanks_before(ends_of(CPLResetExtension(data.GetDescription(), "prj")));
  }
  return text;
}

/// The CRS that a GeoJSON names, whatever GDAL makes of it; "" for none.
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

/// The text by which a dataset, or a file beside it, names a CRS; "" where nothing names one, or where
/// it is not known how the format does. To be asked where GDAL knows no CRS.
/// Cost: reads up to 128 KiB of formats that are texts.
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

/// True for a message of GDAL's that is about a CRS.
bool is_about_crs(const std::string& message) {
  const CPLString text(message);
  for (const char* const word :
       {"PROJ:", "CRS", "SRS", "EPSG", "coordinate system", "projection"}) {
    if (text.ifind(word) != std::string::npos) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::string declared_crs(GDALDataset& data, const OGRSpatialReference* srs,
                         const GdalSession& opening, const std::string& path,
                         SourceWarnings& warnings) {
  const bool is_none = srs == nullptr || srs->IsEmpty();
  std::string text = is_none ? crs_in_text(data) : "";
  // GeoJSON whose CRS is not understood is given that of the standard instead.
  const bool is_geojson = EQUAL(data.GetDriverName(), "GeoJSON");
  if (std::string named = crs_in_geojson(data); !named.empty() && !is_crs(named)) {
    return named;
  }
  const bool is_lost = is_none && text.empty() && is_about_crs(opening.first_failure());
  if (opening.failed() && (is_geojson || is_lost)) {
    warnings.add(
        {"crs_not_understood",
         opening.explain("its CRS is not one that GDAL understands; the terrain is without "
                         "it; name it by --a-srs"),
         path});
    return "";
  }
  if (is_none) {
    return text;
  }
  if (srs->GetAuthorityCode(nullptr) == nullptr && srs->GetName() != nullptr &&
      STARTS_WITH_CI(srs->GetName(), "Undefined ")) {
    return "";
  }
  warn_of_shift(prj_of(data), path, warnings);
  return wkt2_of(*srs);
}

std::string with_third_axis(const std::string& plane) {
  const GdalSession session;
  OGRSpatialReference srs;
  const bool is_made =
      srs.importFromWkt(plane.c_str()) == OGRERR_NONE && srs.PromoteTo3D(nullptr) == OGRERR_NONE;
  return is_made ? wkt2_of(srs) : plane;
}

std::string height_unit_of_prj(GDALDataset& data) {
  const CPLStringList lines(CSLTokenizeString2(prj_of(data).c_str(), "\r\n", 0));
  for (int i = 0; i < lines.size(); ++i) {
    const CPLStringList words(CSLTokenizeString2(lines[i], " \t", 0));
    if (words.size() > 1 && EQUAL(words[0], "Zunits") && !EQUAL(words[1], "NO")) {
      std::string_view beginning = words[1];
      const bool is_number = take_number<double>(beginning).value_or(0.0) != 0.0;
      return is_number ? std::string("Zunits ") + words[1] : std::string(words[1]);
    }
  }
  return "";
}

void warn_of_shift(const std::string& text, const std::string& path, SourceWarnings& warnings) {
  const std::size_t name = CPLString(text).ifind("\"Vertical_Shift\"");
  const std::size_t comma = name == std::string::npos ? name : text.find(',', name);
  const std::size_t begin = text.find_first_not_of(", ", comma);
  const std::string number =
      begin == std::string::npos  // WKT2 has a comma and a unit behind the number
          ? ""
          : text.substr(begin, text.find_first_of(",]", begin) - begin);
  std::string_view beginning = number;
  if (take_number<double>(beginning).value_or(0.0) != 0.0) {
    warnings.add({"crs_vertical_shift",
                  "its vertical CRS shifts heights by " + number +
                      " (Vertical_Shift), which is not applied: heights are taken as they are, in "
                      "the vertical CRS without it; add it to the heights first where it matters",
                  path});
  }
}

}  // namespace ptin
