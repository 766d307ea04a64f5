// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/vrt_background.h"

#include <algorithm>
#include <vector>

#include <cpl_conv.h>
#include <cpl_minixml.h>
#include <cpl_string.h>

namespace ptin {
namespace {

/// VRTs in VRTs are looked through to this depth: one may name itself.
constexpr int kDeepestSource = 8;

constexpr const char* kNan = "nan";

bool is_vrt(GDALDataset& data) {
  return data.GetDriver() != nullptr && EQUAL(data.GetDriverName(), "VRT");
}

/// The folder to which names in the XML of a VRT are relative.
std::string folder_of_vrt(GDALDataset& data) {
  const std::string name = data.GetDescription();
  return name.starts_with("<VRTDataset") ? "" : CPLGetPath(name.c_str());
}

std::vector<CPLXMLNode*> elements_in(CPLXMLNode* parent) {
  std::vector<CPLXMLNode*> found;
  for (CPLXMLNode* child = parent->psChild; child != nullptr; child = child->psNext) {
    if (child->eType == CXT_Element) {
      found.push_back(child);
    }
  }
  return found;
}

void set_element(CPLXMLNode* parent, const char* name, const std::string& value) {
  if (CPLXMLNode* const old = CPLGetXMLNode(parent, name)) {
    CPLRemoveXMLChild(parent, old);
    CPLDestroyXMLNode(old);
  }
  CPLCreateXMLElementAndValue(parent, name, value.c_str());
}

std::string text_of(CPLXMLNode* root) {
  char* const serialized = CPLSerializeXMLTree(root);
  std::string text = serialized == nullptr ? "" : serialized;
  CPLFree(serialized);
  return text;
}

std::string with_background(GDALDataset& data, const std::string& background, int depth);

/// Writes out names that are relative to the folder of a VRT: its XML has none by itself.
void make_absolute(CPLXMLNode* parent, const std::string& folder) {
  for (CPLXMLNode* child : elements_in(parent)) {
    make_absolute(child, folder);
    if (EQUAL(CPLGetXMLValue(child, "relativeToVRT", "0"), "1")) {
      const std::string path =
          CPLProjectRelativeFilename(folder.c_str(), CPLGetXMLValue(child, nullptr, ""));
      CPLSetXMLValue(child, nullptr, path.c_str());
      CPLSetXMLValue(child, "#relativeToVRT", "0");
    }
  }
}

/// Puts a VRT with a background in the place of one that is named in an element. False where it names
/// none.
bool look_through(CPLXMLNode* parent, const char* element, const std::string& background,
                  int depth) {
  const std::string name = CPLGetXMLValue(parent, element, "");
  if (!name.starts_with("<VRTDataset") && !EQUAL(CPLGetExtension(name.c_str()), "vrt")) {
    return false;
  }
  const GDALDatasetUniquePtr inner(
      GDALDataset::Open(name.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
  const std::string text =
      inner != nullptr && is_vrt(*inner) ? with_background(*inner, background, depth + 1) : "";
  if (!text.empty()) {
    CPLSetXMLValue(parent, element, text.c_str());
  }
  return !text.empty();
}

/// Lets a source that is a VRT itself not cover what none of its own sources covers.
void look_through_source(CPLXMLNode* source, const std::string& background, int depth) {
  if (STARTS_WITH_CI(CPLGetXMLValue(source, "SourceBand", "1"), "mask") ||
      !look_through(source, "SourceFilename", background, depth)) {
    return;
  }
  if (EQUAL(source->pszValue, "SimpleSource")) {
    CPLFree(source->pszValue);
    source->pszValue = CPLStrdup("ComplexSource");
  }
  if (EQUAL(source->pszValue, "ComplexSource") && CPLGetXMLNode(source, "NODATA") == nullptr) {
    set_element(source, "NODATA", background);
  }
}

bool has_sources(const CPLXMLNode* band) {
  return EQUAL(CPLGetXMLValue(band, "subClass", "VRTSourcedRasterBand"), "VRTSourcedRasterBand");
}

/// Adds an alpha band to a VRT that warps. False where it states otherwise what it covers.
bool add_alpha(CPLXMLNode* root) {
  CPLXMLNode* const options = CPLGetXMLNode(root, "GDALWarpOptions");
  if (options == nullptr || CPLGetXMLNode(options, "DstAlphaBand") != nullptr) {
    return false;
  }
  int bands = 0;
  for (CPLXMLNode* child : elements_in(root)) {
    if (EQUAL(child->pszValue, "VRTRasterBand")) {
      ++bands;
      if (CPLGetXMLNode(child, "NoDataValue") != nullptr) {
        return false;
      }
    }
  }
  CPLXMLNode* const alpha = CPLCreateXMLNode(root, CXT_Element, "VRTRasterBand");
  CPLAddXMLAttributeAndValue(alpha, "dataType", "Byte");
  CPLAddXMLAttributeAndValue(alpha, "band", std::to_string(bands + 1).c_str());
  CPLAddXMLAttributeAndValue(alpha, "subClass", "VRTWarpedRasterBand");
  CPLCreateXMLElementAndValue(alpha, "ColorInterp", "Alpha");
  set_element(options, "DstAlphaBand", std::to_string(bands + 1));
  return true;
}

/// The XML of a VRT with the background in its bands; "" where it has none.
std::string with_background(GDALDataset& data, const std::string& background, int depth) {
  char** const xml = data.GetMetadata("xml:VRT");
  if (depth > kDeepestSource || xml == nullptr || xml[0] == nullptr) {
    return {};
  }
  const CPLXMLTreeCloser parsed(CPLParseXMLString(xml[0]));
  CPLXMLNode* const root = CPLGetXMLNode(parsed.get(), "=VRTDataset");
  if (root == nullptr) {
    return {};
  }
  make_absolute(root, folder_of_vrt(data));
  const std::string kind = CPLGetXMLValue(root, "subClass", "");
  bool has_changed = false;
  if (kind == "VRTWarpedDataset") {
    has_changed = depth == 0 && add_alpha(root);
    CPLXMLNode* const options = CPLGetXMLNode(root, "GDALWarpOptions");
    // A warp carries NaN on; a number would be one of its values.
    if (options != nullptr && background == kNan) {
      has_changed = look_through(options, "SourceDataset", background, depth) || has_changed;
    }
  }
  for (CPLXMLNode* band : elements_in(root)) {
    if (!kind.empty() || !EQUAL(band->pszValue, "VRTRasterBand") || !has_sources(band) ||
        EQUAL(CPLGetXMLValue(band, "ColorInterp", ""), "Alpha")) {
      continue;
    }
    for (CPLXMLNode* source : elements_in(band)) {
      look_through_source(source, background, depth);
    }
    set_element(band, "NoDataValue", background);
    has_changed = true;
  }
  return has_changed ? text_of(root) : std::string();
}

}  // namespace

GDALDatasetUniquePtr open_with_background(GDALDataset& data, const std::string& background) {
  const std::string text = is_vrt(data) ? with_background(data, background, 0) : "";
  if (text.empty()) {
    return nullptr;
  }
  static constexpr const char* kDrivers[] = {"VRT", nullptr};
  return GDALDatasetUniquePtr(
      GDALDataset::Open(text.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, kDrivers));
}

}  // namespace ptin
