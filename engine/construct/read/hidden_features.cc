// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/hidden_features.h"

#include <string_view>

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

namespace ptin {
namespace {

/// True where a style draws in a colour that is fully transparent, as "PEN(c:#00000000)": so OGR says
/// that an entity of a DXF is not shown.
bool is_transparent(std::string_view style) {
  constexpr std::string_view kColour = "c:#";
  const std::size_t at = style.find(kColour);
  if (at == std::string_view::npos) {
    return false;
  }
  const std::string_view colour = style.substr(at + kColour.size());
  const std::size_t digits = colour.find_first_not_of("0123456789abcdefABCDEF");
  return colour.substr(0, digits).size() == 8 && colour.substr(6, 2) == "00";
}

}  // namespace

HiddenFeatures::HiddenFeatures(GDALDataset& data, OGRLayer& layer) {
  OGRFeatureDefn& definition = *layer.GetLayerDefn();
  is_dxf_ = EQUAL(data.GetDriverName(), "DXF");
  if (is_dxf_) {
    paper_space_ = definition.GetFieldIndex("PaperSpace");
  } else if (EQUAL(data.GetDriverName(), "LIBKML")) {
    visibility_ = definition.GetFieldIndex("visibility");
  }
}

bool HiddenFeatures::holds(const OGRFeature& feature) const {
  const auto is_set_to = [&](int field, bool wanted) {
    return field >= 0 && feature.IsFieldSetAndNotNull(field) != 0 &&
           (feature.GetFieldAsInteger(field) != 0) == wanted;
  };
  if (is_set_to(paper_space_, true) || is_set_to(visibility_, false)) {
    return true;
  }
  const char* const style = is_dxf_ ? feature.GetStyleString() : nullptr;
  return style != nullptr && is_transparent(style);
}

}  // namespace ptin
