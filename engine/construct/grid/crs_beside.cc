// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/crs_beside.h"

#include <memory>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <ogr_spatialref.h>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/gdal_session.h"

namespace ptin {
namespace {

struct Beside {
  std::string path;  ///< "" where there is no such file.
  std::string text;
};

/// The text of a .prj beside the file.
Beside read_beside(const std::string& path) {
  constexpr const char* kPacked = ".gz";  // "a.xyz.gz" has its CRS in a.prj
  const bool is_packed = EQUAL(CPLGetExtension(path.c_str()), kPacked + 1);
  const std::string unpacked = is_packed ? path.substr(0, path.rfind('.')) : path;
  for (const char* extension : {"prj", "PRJ"}) {
    const std::string name = CPLResetExtension(unpacked.c_str(), extension);
    constexpr std::size_t kLongest = std::size_t{1} << 16;
    if (const auto text = beginning_of_file(name, kLongest)) {
      return {name, CPLString(*text).Trim()};
    }
  }
  return {};
}

/// The CRS as WKT2; the text itself where nobody understands it.
std::string crs_of_prj(const std::string& text) {
  OGRSpatialReference srs;
  const CPLStringList lines(CSLTokenizeString2(text.c_str(), "\r\n", 0));
  if (srs.importFromESRI(const_cast<char**>(lines.List())) != OGRERR_NONE) {
    return text;
  }
  srs.AutoIdentifyEPSG();
  const std::string wkt = wkt2_of(srs);
  return wkt.empty() ? text : wkt;
}

/// The code of the CRS in the tables that is this one, whatever its names are; "" where there is none.
std::string code_of(const std::string& text) {
  OGRSpatialReference srs;
  if (srs.SetFromUserInput(text.c_str()) != OGRERR_NONE) {
    return {};
  }
  srs.StripVertical();
  int count = 0;
  int* confidence = nullptr;
  OGRSpatialReferenceH* const matches = srs.FindMatches(nullptr, &count, &confidence);
  std::string code;
  constexpr int kSure = 70;
  if (count > 0 && confidence[0] >= kSure) {
    const char* const found =
        OGRSpatialReference::FromHandle(matches[0])->GetAuthorityCode(nullptr);
    code = found == nullptr ? "" : found;
  }
  OSRFreeSRSArray(matches);
  CPLFree(confidence);
  return code;
}

bool is_same_place(const std::string& a, const std::string& b) {
  if (is_same_in_plan(a, b)) {
    return true;
  }
  const std::string code = code_of(a);
  return !code.empty() && code == code_of(b);
}

std::string name_of_crs(const std::string& text) {
  OGRSpatialReference srs;
  const bool is_known = srs.SetFromUserInput(text.c_str()) == OGRERR_NONE;
  return is_known && srs.GetName() != nullptr ? srs.GetName() : text.substr(0, 60);
}

}  // namespace

void take_crs_beside(const std::string& path, std::string& crs, SourceWarnings& warnings) {
  const GdalSession session;
  const Beside beside = read_beside(path);
  if (beside.text.empty()) {
    return;
  }
  const std::string stated = crs_of_prj(beside.text);
  if (crs.empty()) {
    crs = stated;
    return;
  }
  if (is_crs(crs) && is_crs(stated) && !is_same_place(crs, stated)) {
    warnings.add({.kind = "crs_beside_differs",
                  .message = "the file says that its CRS is '" + name_of_crs(crs) + "', and " +
                             beside.path + " beside it '" + name_of_crs(stated) +
                             "'; the file is believed; where it is wrong, name the CRS by --a-srs",
                  .file = path});
  }
}

}  // namespace ptin
