// SPDX-License-Identifier: GPL-3.0-or-later
//
// Meshes drawn in the tests: vertices as letters on a lattice, triangles as triples of letters.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/geometry/orient.h"
#include "engine/mesh/tin.h"

namespace ptin::drawn {

/// A mesh whose vertices are the letters of a picture. The first line of the picture is the north;
/// columns and lines are one grid unit apart. Lower-case letters have no height.
struct Drawing {
  Tin tin;
  std::string letters;  ///< Beside the vertices.

  [[nodiscard]] VertexId at(char letter) const {
    return static_cast<VertexId>(letters.find(letter));
  }
  /// The triangle with these corners, in any order; kNone when there is none.
  [[nodiscard]] TriangleId triangle(std::string_view corners) const;
  /// All alive triangles, each from its smallest letter, sorted: "ABC ACD"; void ones with a dot
  /// behind.
  [[nodiscard]] std::string triangles() const;
};

/// @param picture    Lines from north to south; anything but letters is empty space.
/// @param triangles  Triples of letters, in any order and orientation; a dot behind one makes it
/// void.
[[nodiscard]] Drawing draw(const std::vector<std::string>& picture,
                           const std::vector<std::string>& triangles);

/// Sets neighbours and Vertex::triangle of a mesh from its corners alone, by comparing all pairs of
/// edges.
void connect(Tin& tin);

}  // namespace ptin::drawn
