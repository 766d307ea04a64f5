// SPDX-License-Identifier: GPL-3.0-or-later
//
// Features of a layer that are no part of the ground: what a drawing has switched off, or has on its
// sheet.
#pragma once

class GDALDataset;
class OGRFeature;
class OGRLayer;

namespace ptin {

/// Knows them by what OGR says of two formats. DXF: entities in paper space, which are in units of
/// the sheet, and those that are invisible themselves or lie on a layer that is off or frozen. KML:
/// `visibility` 0.
class HiddenFeatures {
 public:
  /// @param data   The file of the layer. Nothing of it is kept.
  HiddenFeatures(GDALDataset& data, OGRLayer& layer);

  [[nodiscard]] bool holds(const OGRFeature& feature) const;

 private:
  bool is_dxf_ = false;
  int paper_space_ = -1;  ///< The attributes; -1: the layer has no such.
  int visibility_ = -1;
};

}  // namespace ptin
