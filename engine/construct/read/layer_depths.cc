// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/layer_depths.h"

#include <array>

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "engine/construct/grid/depth_names.h"
#include "engine/error.h"

namespace ptin {

namespace {

/// The unit of depths that the header of a chart states (S-57, DSPM_DUNI); "" where it is silent.
std::string unit_of_depths(GDALDataset& data) {
  constexpr std::array<const char*, 5> kUnitsOfDepths = {"", "metres", "fathoms and feet", "feet",
                                                         "fathoms and fractions"};
  OGRLayer* const header = data.GetLayerByName("DSID");
  if (header == nullptr) {
    return "";
  }
  header->ResetReading();
  const OGRFeatureUniquePtr feature(header->GetNextFeature());
  const int field = feature == nullptr ? -1 : feature->GetFieldIndex("DSPM_DUNI");
  const int code = field < 0 ? 0 : feature->GetFieldAsInteger(field);
  return code > 0 && code < 5 ? kUnitsOfDepths[static_cast<std::size_t>(code)] : "";
}

}  // namespace

void refuse_depths(GDALDataset& data, OGRLayer& layer, const std::string& z_field,
                   const std::string& path, SourceWarnings& warnings) {
  const std::string name = z_field.empty() ? layer.GetName() : z_field;
  const std::string what = z_field.empty() ? "the layer '" : "the attribute '";
  if (!is_name_of_depths(name)) {
    return;
  }
  if (!EQUAL(data.GetDriverName(), "S57")) {
    warnings.add(
        {.kind = "depths",
         .message = what + name +
                    "' has a name of depths, and is taken for heights, which grow upwards; "
                    "if it grows downwards, turn the sign of its values first",
         .file = path});
    return;
  }
  const std::string unit = unit_of_depths(data);
  refuse(
      what + name + "' of this chart holds depths" + (unit.empty() ? "" : " in " + unit) +
          ", which grow downwards, and a terrain has heights; " +
          (z_field.empty()
               ? "turn their sign with 'ogr2ogr -f CSV -lco GEOMETRY=AS_XY HEIGHTS.csv FILE -oo "
                 "SPLIT_MULTIPOINT=ON -oo ADD_SOUNDG_DEPTH=ON -sql \"SELECT -1 * DEPTH AS z FROM "
                 "SOUNDG\"', and name the CRS of the CSV by --a-srs EPSG:4326"
               : "turn their sign with 'ogr2ogr -sql \"SELECT -1 * " + z_field + " AS z, * FROM " +
                     layer.GetName() + "\" HEIGHTS.gpkg FILE'"),
      path);
}

}  // namespace ptin
