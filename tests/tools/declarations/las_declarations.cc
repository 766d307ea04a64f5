// SPDX-License-Identifier: GPL-3.0-or-later
//
// Declarations of LAS files.
#include <functional>

#include "tests/support/las_file.h"
#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

namespace {

/// A plane of 25 points that rises to the north-east.
LasFileMaker plane() {
  LasFileMaker las;
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) las.points.push_back({1000 * x, 1000 * y, 100 * (x + y)});
  }
  return las;
}

std::string keys(const std::vector<std::array<std::uint16_t, 4>>& entries) {
  std::vector<std::uint16_t> words = {1, 1, 0, static_cast<std::uint16_t>(entries.size())};
  for (const auto& e : entries) words.insert(words.end(), e.begin(), e.end());
  return {reinterpret_cast<const char*>(words.data()), words.size() * 2};
}

const std::array<std::uint16_t, 4> kProjected = {1024, 0, 1, 1}, kUtm = {3072, 0, 1, 32617},
                                   kNavd88 = {4096, 0, 1, 5703}, kFeet = {4099, 0, 1, 9003},
                                   kMetres = {4099, 0, 1, 9001};

LasRecord utm_with(const std::vector<std::array<std::uint16_t, 4>>& more) {
  std::vector<std::array<std::uint16_t, 4>> entries = {kProjected, kUtm};
  entries.insert(entries.end(), more.begin(), more.end());
  return {34735, keys(entries)};
}

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

std::vector<std::string> source(const TestFolder& folder, const std::string& bytes) {
  write_file(folder.file("source.las"), bytes);
  return {folder.file("source.las")};
}

/// A plane of which `change` makes the file that declares, or the one that does not.
Declaration of(const std::string& key, const std::function<void(LasFileMaker&, bool)>& change) {
  return {key, [change](const TestFolder& folder, bool is_declared) {
            LasFileMaker las = plane();
            change(las, is_declared);
            return source(folder, las.bytes());
          }};
}

/// A plane without and with these records.
Declaration of_records(const std::string& key, const std::vector<LasRecord>& without,
                       const std::vector<LasRecord>& with) {
  return of(key, [=](LasFileMaker& las, bool is_declared) {
    las.minor = 4;
    las.records = is_declared ? with : without;
  });
}

/// A plane whose bytes are changed where it declares.
Declaration of_bytes(const std::string& key, int minor,
                     const std::function<void(std::string&)>& change) {
  return {key, [=](const TestFolder& folder, bool is_declared) {
            LasFileMaker las = plane();
            las.minor = minor;
            std::string bytes = las.bytes();
            if (is_declared) change(bytes);
            return source(folder, bytes);
          }};
}

const char* const kHeights =
    "VERT_CS[\"site heights\",VERT_DATUM[\"bench mark\",2005],UNIT[\"foot\",0.3048],"
    "AXIS[\"Up\",UP]]";

std::vector<Declaration> of_las_crs() {
  return {
      of_records("las.crs_wkt", {}, {{2112, "EPSG:32617"}}),
      of_records("las.crs_keys", {}, {utm_with({})}),
      of_records("las.crs_behind", {}, {{2112, "EPSG:32617", true}}),
      of_records("las.vertical_crs", {utm_with({})}, {utm_with({kNavd88})}),
      of_records("las.vertical_wkt", {{2112, "EPSG:32617"}}, {{2112, "EPSG:32617+5703"}}),
      of_records("las.height_unit", {utm_with({})}, {utm_with({kFeet})}),
      of_records("las.height_unit_beside_crs", {utm_with({kNavd88, kMetres})},
                 {utm_with({kNavd88, kFeet})}),
      of_records("las.height_unit_unknown", {utm_with({})}, {utm_with({{4099, 0, 1, 9102}})}),
      of_records("las.vertical_unknown", {utm_with({})}, {utm_with({{4096, 0, 1, 12345}})}),
      of_records("las.vertical_alone", {}, {{2112, kHeights}}),
      of_records("las.depths", {{2112, "EPSG:32617"}}, {{2112, "EPSG:32617+5715"}}),
      of_records("las.axes", {{2112, "EPSG:32735"}}, {{2112, "EPSG:2053"}}),
      of_records("las.crs_not_understood", {}, {{2112, "''"}}),
      of_records("las.crs_twice", {utm_with({}), {2112, "EPSG:32617"}},
                 {utm_with({}), {2112, "EPSG:32618"}}),
      of_records("las.math_transform", {{2112, "EPSG:32617"}},
                 {{2112, "EPSG:32617"}, {2111, "PARAM_MT[\"Affine\"]"}}),
      {"las.crs_superseded",
       [](const TestFolder& folder, bool is_declared) {
         LasFileMaker las = plane();
         las.records = {{2112, "EPSG:32617"}};
         std::string bytes = las.bytes();
         if (is_declared) {
           bytes.replace(bytes.find("LASF_Projection"), 15,
                         std::string("LASF_Spec\0\0\0\0\0\0", 15));
           put<std::uint16_t>(bytes, 227 + 18, 7);
         }
         return source(folder, bytes);
       }},
  };
}

std::vector<Declaration> of_header() {
  return {
      of("las.scale", [](LasFileMaker& las, bool is) { las.scale[2] = is ? 0.001 : 0.01; }),
      of("las.offset", [](LasFileMaker& las, bool is) { las.offset[0] = is ? 1000.0 : 0.0; }),
      of_bytes("las.box", 2,
               [](std::string& bytes) {
                 for (std::size_t i = 0; i < 3; ++i) put(bytes, 179 + 16 * i, 15.0);
               }),
      of_bytes("las.count", 2, [](std::string& bytes) { put<std::uint32_t>(bytes, 107, 26); }),
      of_bytes("las.count_too_small", 2,
               [](std::string& bytes) { put<std::uint32_t>(bytes, 107, 20); }),
      of_bytes("las.count_of_old_programs", 4,
               [](std::string& bytes) { put<std::uint32_t>(bytes, 107, 24); }),
      of_bytes("las.record_count", 2,
               [](std::string& bytes) { put<std::uint32_t>(bytes, 100, 5); }),
      of_bytes("las.compressed", 2,
               [](std::string& bytes) { bytes[104] = static_cast<char>(0x80); }),
  };
}

std::vector<Declaration> of_points() {
  return {
      of("las.withheld", [](LasFileMaker& las, bool is) { las.points.back().withheld = is; }),
      of("las.noise", [](LasFileMaker& las, bool is) { las.points[7].cls = is ? 7 : 2; }),
      {"las.made_up_returns",
       [](const TestFolder& folder, bool is_declared) {
         std::string bytes = plane().bytes();
         put<std::uint16_t>(bytes, 6, is_declared ? 8 : 0);
         auto arguments = source(folder, bytes);
         arguments.insert(arguments.end(), {"--returns", "last"});
         return arguments;
       }},
      {"las.odd_returns",
       [](const TestFolder& folder, bool is_declared) {
         LasFileMaker las = plane();
         if (is_declared) las.points[3].number = 2;
         auto arguments = source(folder, las.bytes());
         arguments.insert(arguments.end(), {"--returns", "last"});
         return arguments;
       }},
  };
}

}  // namespace

std::vector<Declaration> las_declarations() {
  std::vector<Declaration> all = of_las_crs();
  for (const auto& some : {of_header(), of_points()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace ptin::tools::testing
