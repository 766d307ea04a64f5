// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which layer of a vector file is meant.
#pragma once

#include <cstdint>
#include <string>

class GDALDataset;
class OGRLayer;

namespace ptin {

/// What the features of a layer should be; several parts or none known beforehand are allowed.
enum class LayerKind : std::uint8_t { kPoints, kLines, kAreas };

/// A layer of OGR, or a surface of LandXML.
struct LayerWish {
  LayerKind kind = LayerKind::kPoints;
  std::string name;                ///< Empty: the only layer that fits.
  std::string option = "--layer";  ///< That names one where several fit, for messages.
};

/// The layer of this name. Without a name, the only one that fits: whose type may hold such
/// features, and which has any, if several may hold them.
/// @param path  Path of the file, for errors.
/// @throws Error  invalid_argument  there is no layer, or none of this name; its type does not fit;
///                                  none fits, or several do
/// Cost: reads the first feature of each layer where several fit.
[[nodiscard]] OGRLayer& choose_layer(GDALDataset& data, const LayerWish& wish,
                                     const std::string& path);

}  // namespace ptin
