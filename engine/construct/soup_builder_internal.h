// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the readers of TINs share: words of a line, numbers, vertices by id, limits.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "engine/construct/tin_soup.h"

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

/// Collects a soup. Vertices may have ids of the file's own and may come after the triangles that
/// use them.
class SoupBuilder {
 public:
  SoupBuilder(const ByteReader& in, const TinReading& reading) : in_(in), reading_(reading) {}

  /// The next vertex, numbered from 0.  @throws Error resource_exhausted, cancelled
  void add_vertex(const SourcePoint& p);
  /// One with an id.  @throws Error invalid_argument when the id was there before
  void add_vertex(std::int64_t id, const SourcePoint& p);
  /// Three numbers or ids, as the vertices have.
  void add_triangle(const std::array<std::int64_t, 3>& ids);
  void add_hidden() { ++soup_.hidden_triangles; }

  [[nodiscard]] std::uint64_t vertices() const noexcept { return soup_.vertices.size(); }
  [[nodiscard]] TinSoup& soup() noexcept { return soup_; }
  /// Turns ids into indices.
  /// @throws Error invalid_argument  an id that no vertex has; no vertex; no triangle
  [[nodiscard]] TinSoup finish();

 private:
  void look_around();

  const ByteReader& in_;
  const TinReading& reading_;
  TinSoup soup_;
  std::vector<std::array<std::int64_t, 3>> triangles_;
  std::unordered_map<std::int64_t, std::uint32_t> index_of_;
  std::uint64_t added_ = 0;
};

}  // namespace ptin
