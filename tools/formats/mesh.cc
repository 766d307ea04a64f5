// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/mesh.h"

#include <algorithm>

namespace ptin::tools {

std::array<double, 3> middle_of(const Mesh& mesh) {
  std::array<double, 3> low = mesh.vertices.front();
  std::array<double, 3> high = low;
  for (const auto& vertex : mesh.vertices) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], vertex[i]);
      high[i] = std::max(high[i], vertex[i]);
    }
  }
  std::array<double, 3> middle{};
  for (std::size_t i = 0; i < 3; ++i) middle[i] = low[i] + (high[i] - low[i]) / 2;
  return middle;
}

}  // namespace ptin::tools
