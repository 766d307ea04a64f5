// SPDX-License-Identifier: GPL-3.0-or-later
//
// TINs in files that go with the test, and what is read from them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/tin/tin_source.h"
#include "engine/error.h"
#include "engine/mesh/validate.h"

namespace ptin::tin_test {

using Vertex3 = std::array<double, 3>;
using Face = std::array<int, 3>;

/// A file that goes with the test.
class TestFile {
 public:
  TestFile(const std::string& extension, const std::string& content)
      : path_(
            std::filesystem::temp_directory_path() /
            ("ptin_tin_" + std::to_string(getpid()) + "_" + std::to_string(count_++) + extension)) {
    std::ofstream(path_, std::ios::binary) << content;
  }
  ~TestFile() { std::filesystem::remove(path_); }
  TestFile(const TestFile&) = delete;
  TestFile& operator=(const TestFile&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  static inline int count_ = 0;
  std::filesystem::path path_;
};

inline std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

inline std::string obj_of(const std::vector<Vertex3>& vertices, const std::vector<Face>& faces) {
  std::string text = "# a mesh\n";
  for (const Vertex3& v : vertices) {
    text += "v " + number(v[0]) + " " + number(v[1]) + " " + number(v[2]) + "\n";
  }
  for (const Face& f : faces) {
    text += "f " + std::to_string(f[0] + 1) + " " + std::to_string(f[1] + 1) + "/7 " +
            std::to_string(f[2] + 1) + "/7/7\n";
  }
  return text;
}

/// Everything at once.
struct TinTerrain : TinCounts {
  TinTerrain(const TinTriangles& triangles, std::uint64_t parts = 1)
      : TinCounts(triangles.counts()), frame(triangles.frame()), tin(triangles.part(0, parts)) {}
  TerrainFrame frame;
  Tin tin;
};

inline TinTriangles triangles_in(const std::string& path, const SourceOptions& options = {},
                                 std::uint64_t memory = std::uint64_t{64} << 20) {
  return TinTriangles::read(path, options,
                            {FileLayer::system(), std::filesystem::temp_directory_path(), memory});
}

inline TinTerrain read(const std::vector<Vertex3>& vertices, const std::vector<Face>& faces,
                       const SourceOptions& options = {}) {
  const TestFile file(".obj", obj_of(vertices, faces));
  return triangles_in(file.path(), options);
}

inline std::string refusal(const std::vector<Vertex3>& vertices, const std::vector<Face>& faces) {
  try {
    static_cast<void>(read(vertices, faces));
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    return e.message();
  }
  return "accepted";
}

using KeyTriangle = std::array<VertexKey, 3>;

inline std::set<KeyTriangle> triangles_of(const Tin& tin, TriangleClass wanted) {
  std::set<KeyTriangle> set;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.classes[t] != wanted) continue;
    KeyTriangle keys{};
    for (std::size_t i = 0; i < 3; ++i) keys[i] = key_of(tin.position(tin.triangles[t].v[i]));
    std::rotate(keys.begin(), std::min_element(keys.begin(), keys.end()), keys.end());
    EXPECT_TRUE(set.insert(keys).second);
  }
  return set;
}

inline void expect_sound(const TinTerrain& terrain, std::size_t surface, std::size_t filling) {
  EXPECT_EQ(validate(terrain.tin), "");
  EXPECT_EQ(triangles_of(terrain.tin, TriangleClass::kSurface).size(), surface);
  EXPECT_EQ(triangles_of(terrain.tin, TriangleClass::kVoid).size(), filling);
  EXPECT_EQ(terrain.surface_triangles, surface);
}

inline const std::vector<Vertex3> kSquare = {{0, 0, 1}, {10, 0, 2}, {10, 10, 3}, {0, 10, 4}};
inline const std::vector<Face> kTwo = {{0, 1, 2}, {0, 2, 3}};

}  // namespace ptin::tin_test
