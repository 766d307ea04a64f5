// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the readers of TINs share: words of a line, numbers, counts.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/tin_soup.h"

namespace ptin {

/// Splits at spaces and tabs.
void split_words(std::string_view line, std::vector<std::string_view>& words);

/// @throws Error invalid_argument at `place`: no finite number, or 10^18 and above
[[nodiscard]] Decimal coordinate_of(std::string_view word, const std::string& place);
/// The same for numbers in binary, with the shortest decimals that read back to the same bits.
[[nodiscard]] Decimal coordinate_of(double value, const std::string& place);
[[nodiscard]] Decimal coordinate_of(float value, const std::string& place);

/// A whole number in decimals.  @throws Error invalid_argument at `place`
[[nodiscard]] std::int64_t whole_of(std::string_view word, const std::string& place);

/// Counts what goes to the sink, and looks at the stop token now and then.
class TinReceiver {
 public:
  TinReceiver(const ByteReader& in, const TinReading& reading, SoupSink& sink)
      : in_(in), reading_(reading), sink_(sink) {}

  void expect_vertices(std::uint64_t count) { sink_.expect_vertices(count); }
  /// The next vertex, numbered from 0.  @throws Error cancelled, and what the sink throws
  void add_vertex(const SourcePoint& p) {
    add_vertex(static_cast<std::int64_t>(facts_.vertices), p);
  }
  /// One with an id of the file's own.
  void add_vertex(std::int64_t id, const SourcePoint& p) {
    look_around();
    ++facts_.vertices;
    sink_.add_vertex(id, p);
  }
  /// Three numbers or ids, as the vertices have.
  void add_triangle(const std::array<std::int64_t, 3>& ids) {
    look_around();
    ++facts_.triangles;
    sink_.add_triangle(ids);
  }
  void add_hidden() { ++facts_.hidden_triangles; }
  void set_crs(std::string crs, std::string vertical_crs = {}) {
    facts_.crs = std::move(crs);
    facts_.vertical_crs = std::move(vertical_crs);
  }
  [[nodiscard]] std::uint64_t vertices() const noexcept { return facts_.vertices; }
  /// @throws Error invalid_argument  no vertex; no triangle
  [[nodiscard]] TinFileFacts finish();

 private:
  void look_around();

  const ByteReader& in_;
  const TinReading& reading_;
  SoupSink& sink_;
  TinFileFacts facts_;
  std::uint64_t added_ = 0;
};

}  // namespace ptin
