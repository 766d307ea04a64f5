// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/mesh/drawn.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace ptin::drawn {

TriangleId Drawing::triangle(std::string_view corners) const {
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.is_alive(t) &&
        std::all_of(std::begin(tin.triangles[t].v), std::end(tin.triangles[t].v), [&](VertexId v) {
          return corners.find(letters[v]) != std::string_view::npos;
        })) {
      return t;
    }
  }
  return kNone;
}

std::string Drawing::triangles() const {
  std::vector<std::string> all;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.is_alive(t)) {
      std::string corners;
      for (const VertexId v : tin.triangles[t].v) {
        corners += letters[v];
      }
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      all.push_back(corners + (tin.classes[t] == TriangleClass::kVoid ? "." : ""));
    }
  }
  std::sort(all.begin(), all.end());
  std::string joined;
  for (const std::string& t : all) {
    joined += (joined.empty() ? "" : " ") + t;
  }
  return joined;
}

void connect(Tin& tin) {
  for (Triangle& a : tin.triangles) {
    for (int i = 0; i < 3; ++i) {
      a.n[i] = kNone;
      for (TriangleId b = 0; b < tin.triangles.size(); ++b) {
        for (int k = 0; k < 3; ++k) {
          const Triangle& other = tin.triangles[b];
          if (other.v[next_corner(k)] == a.v[previous_corner(i)] &&
              other.v[previous_corner(k)] == a.v[next_corner(i)]) {
            a.n[i] = b;
          }
        }
      }
    }
  }
  point_vertices(tin);
}

Drawing draw(const std::vector<std::string>& picture, const std::vector<std::string>& triangles) {
  Drawing d;
  for (std::size_t line = 0; line < picture.size(); ++line) {
    for (std::size_t column = 0; column < picture[line].size(); ++column) {
      const char letter = picture[line][column];
      if (std::isalpha(static_cast<unsigned char>(letter)) != 0) {
        const GridPoint p{static_cast<int>(column), static_cast<int>(picture.size() - 1 - line)};
        d.letters += letter;
        d.tin.vertices.push_back({p, 0, kNone});
        d.tin.has_height.push_back(std::isupper(static_cast<unsigned char>(letter)) != 0 ? 1 : 0);
      }
    }
  }
  for (const std::string& t : triangles) {
    Triangle triangle{{d.at(t[0]), d.at(t[1]), d.at(t[2])}, {kNone, kNone, kNone}};
    if (orient(d.tin.position(triangle.v[0]), d.tin.position(triangle.v[1]),
               d.tin.position(triangle.v[2])) < 0) {
      std::swap(triangle.v[1], triangle.v[2]);
    }
    d.tin.triangles.push_back(triangle);
    d.tin.classes.push_back(t.back() == '.' ? TriangleClass::kVoid : TriangleClass::kSurface);
  }
  connect(d.tin);
  return d;
}

}  // namespace ptin::drawn
