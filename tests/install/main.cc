// SPDX-License-Identifier: GPL-3.0-or-later
//
// Uses the installed headers and library as another project would: exit status 0 when they do what
// they say.
#include <engine/error.h>
#include <engine/geometry/orient.h>

int main() {
  const ptin::GridPoint a{0, 0};
  const ptin::GridPoint b{4, 0};
  const ptin::GridPoint c{0, 3};
  const bool exact = ptin::orient(a, b, c) == 12 && ptin::orient(a, c, b) == -12;
  const bool linked = ptin::to_string(ptin::ErrorCode::not_found) == "not_found";
  return exact && linked ? 0 : 1;
}
