// SPDX-License-Identifier: GPL-3.0-or-later
//
// Uses the geometry room alone: no GDAL or CGAL is linked.
#include <engine/error.h>
#include <engine/geometry/orient.h>

int main() {
  const bool exact = ptin::orient({0, 0}, {4, 0}, {0, 3}) == 12;
  const bool linked = ptin::to_string(ptin::ErrorCode::not_found) == "not_found";
  return exact && linked ? 0 : 1;
}
