// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/layer_choice.h"

#include <vector>

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "engine/error.h"

namespace ptin {
namespace {

const char* words_of(LayerKind kind) {
  return kind == LayerKind::kPoints ? "points" : kind == LayerKind::kLines ? "lines" : "polygons";
}

bool fits(OGRLayer& layer, LayerKind kind) {
  const OGRwkbGeometryType type = wkbFlatten(layer.GetGeomType());
  const auto is_a = [&](OGRwkbGeometryType of) { return OGR_GT_IsSubClassOf(type, of) != 0; };
  if (type == wkbUnknown || type == wkbGeometryCollection) {
    return true;
  }
  switch (kind) {
    case LayerKind::kPoints:
      return is_a(wkbPoint) || is_a(wkbMultiPoint);
    case LayerKind::kLines:
      return is_a(wkbCurve) || is_a(wkbMultiCurve);
    case LayerKind::kAreas:
      break;
  }
  return is_a(wkbSurface) || is_a(wkbMultiSurface);
}

bool has_a_feature(OGRLayer& layer) {
  layer.ResetReading();
  const bool has = OGRFeatureUniquePtr(layer.GetNextFeature()) != nullptr;
  layer.ResetReading();
  return has;
}

std::string type_of_layer(OGRLayer& layer) {
  return wkbFlatten(layer.GetGeomType()) == wkbNone ? "no geometry"
                                                    : OGRGeometryTypeToName(layer.GetGeomType());
}

std::string layers_in(const std::vector<OGRLayer*>& layers) {
  constexpr std::size_t kShown = 10;
  std::string names;
  for (std::size_t i = 0; i < layers.size() && i < kShown; ++i) {
    names.append(i == 0 ? "'" : ", '").append(layers[i]->GetName());
    names.append("' (").append(type_of_layer(*layers[i])).append(")");
  }
  return names + (layers.size() > kShown ? ", ..." : "");
}

}  // namespace

OGRLayer& choose_layer(GDALDataset& data, const LayerWish& wish, const std::string& path) {
  const auto refuse = [&](const std::string& sentence) {
    throw Error(ErrorCode::invalid_argument, sentence, path);
  };
  const std::string words = words_of(wish.kind);
  std::vector<OGRLayer*> all, fitting, filled;
  for (OGRLayer* layer : data.GetLayers()) {
    all.push_back(layer);
    if (fits(*layer, wish.kind)) {
      fitting.push_back(layer);
    }
  }
  if (all.empty()) {
    refuse("there is no layer in this file");
  }
  OGRLayer* named = wish.name.empty() ? all.size() == 1 ? all[0] : nullptr
                                      : data.GetLayerByName(wish.name.c_str());
  if (named == nullptr && !wish.name.empty()) {
    refuse("there is no layer '" + wish.name + "'; there is " + layers_in(all));
  }
  if (named != nullptr) {
    if (!fits(*named, wish.kind)) {
      refuse("the layer '" + std::string(named->GetName()) + "' holds " + type_of_layer(*named) +
             ", not " + words);
    }
    return *named;
  }
  if (fitting.empty()) {
    refuse("no layer holds " + words + "; there is " + layers_in(all));
  }
  if (fitting.size() == 1) {
    return *fitting[0];
  }
  for (OGRLayer* layer : fitting) {
    if (has_a_feature(*layer)) {
      filled.push_back(layer);
    }
  }
  if (filled.size() > 1) {
    refuse("there are several layers of " + words + ", " + layers_in(filled) + "; name one with " +
           wish.option);
  }
  return filled.empty() ? *fitting[0] : *filled[0];
}

}  // namespace ptin
