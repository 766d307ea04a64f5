// SPDX-License-Identifier: GPL-3.0-or-later
//
// Declarations of points as text.
#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

namespace {

/// A slope of 5 x 4 points, each a line as `line(x, y, z)` makes it.
template <typename LineOf>
std::string slope(const LineOf& line) {
  std::string text;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 5; ++x) text += line(x, y, x + 2 * y) + "\n";
  }
  return text;
}

std::string joined(int x, int y, int z) {
  return std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z);
}

/// A text that is the slope under these lines.
Declaration under(const std::string& key, const std::string& declared,
                  const std::string& undeclared = "") {
  return {key, [=](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
            write_file(folder.file("source.txt"),
                       (is_declared ? declared : undeclared) + slope(joined));
            return {folder.file("source.txt")};
          }};
}

std::string in_utf_16(const std::string& text) {
  std::string wide = "\xFF\xFE";
  for (const char c : text) wide.append(1, c).append(1, '\0');
  return wide;
}

}  // namespace

std::vector<Declaration> text_declarations() {
  return {
      under("text.header", "y x z\n"),
      under("text.comment_header", "# lat lon ele\n", "# made by hand\n"),
      under("text.unit", "x[m] y[m] z[ft]\n", "x y z\n"),
      under("text.unknown_unit", "x y z(fathoms-ish)\n", "x y z\n"),
      under("text.no_number", "1 1 nan\n"),
      under("text.no_height", "1 1.5 -9999\n"),
      under("text.far_points", "500000 0 0\n"),
      {"text.digits",
       [](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
         write_file(folder.file("source.xyz"),
                    slope([](int x, int y, int z) { return joined(500000 * x, 500000 * y, z); }) +
                        (is_declared ? "250000.1234 250000.1234 3\n" : "250000.12 250000.12 3\n"));
         return {folder.file("source.xyz")};
       }},
      {"text.encoding",
       [](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
         const std::string text = slope(joined);
         write_file(folder.file("source.csv"), is_declared ? in_utf_16(text) : text);
         return {folder.file("source.csv")};
       }},
      {"text.northing_first",
       [](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
         write_file(folder.file("source.xyz"), slope([&](int x, int y, int z) {
                      const std::string east = std::to_string(500000 + x);
                      const std::string north = std::to_string(5200000 + y);
                      return (is_declared ? north + " " + east : east + " " + north) + " " +
                             std::to_string(z);
                    }));
         return {folder.file("source.xyz"), "--a-srs", "EPSG:32632"};
       }},
  };
}

}  // namespace ptin::tools::testing
