// SPDX-License-Identifier: GPL-3.0-or-later
//
// What rasters declare.
#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

std::vector<Declaration> raster_declarations() {
  return {
      {"raster.nodata",
       [](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
         RasterRecipe recipe;
         recipe.value = [](int x, int y) { return x == 5 && y == 5 ? -32768.0 : hills(x, y); };
         if (is_declared) recipe.nodata = -32768.0;
         make_raster(folder.file("source.tif"), recipe);
         return {folder.file("source.tif")};
       }},
  };
}

}  // namespace ptin::tools::testing
