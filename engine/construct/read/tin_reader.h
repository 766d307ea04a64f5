// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the readers of TINs share: words of a line, numbers, counts.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/declared_comments.h"
#include "engine/construct/read/tin_file.h"

namespace ptin {

/// Splits a line at spaces and tabs.
/// @param words  Overwritten; views into `line`.
void split_words(std::string_view line, std::vector<std::string_view>& words);

/// The number that a word is.
/// @param place  The context of errors: "path:line", or the path.
/// @throws Error invalid_argument  the word is no finite number, or its magnitude is 10^18 or more
[[nodiscard]] Decimal coordinate_of(std::string_view word, const std::string& place);
/// The same for a number in binary: the shortest decimal that reads back to the same bits.
[[nodiscard]] Decimal coordinate_of(double value, const std::string& place);
[[nodiscard]] Decimal coordinate_of(float value, const std::string& place);

/// The whole number that a word is.  @throws Error invalid_argument, with the context `place`
[[nodiscard]] std::int64_t whole_of(std::string_view word, const std::string& place);

/// What a reader hands vertices and triangles to: counts them and passes them on to the sink. Every
/// 65536 of them it reports the progress and looks at the stop token. Keeps references to all that
/// it is made of.
class TinReceiver {
 public:
  TinReceiver(const ByteReader& in, const TinReading& reading, TinFileSink& sink)
      : in_(in), reading_(reading), sink_(sink) {}

  void expect_vertices(std::uint64_t count) { sink_.expect_vertices(count); }
  /// The next vertex, numbered from 0.  @throws Error cancelled, and what the sink throws
  void add_vertex(const SourcePoint& p) {
    add_vertex(static_cast<std::int64_t>(facts_.vertices), p);
  }
  /// A vertex with an id of the file's own.
  void add_vertex(std::int64_t id, const SourcePoint& p) {
    look_around();
    ++facts_.vertices;
    sink_.add_vertex(id, p);
  }
  /// A face. A quad one of whose sides ends where it begins is the triangle of the others.
  /// @param ids    Numbers of the corners from 0 where vertices are numbered, else their ids.
  /// @param place  The context of errors.
  /// @throws Error invalid_argument  it has not three or four corners
  void add_face(std::span<const std::int64_t> ids, const std::string& place);
  /// @throws Error invalid_argument  a face has so many corners, which are not three or four; always
  [[noreturn]] static void refuse_corners(std::uint64_t count, const std::string& place);
  /// A triangle that the file marks as invisible: counted, and not passed on.
  void add_hidden() { ++facts_.hidden_triangles; }
  void set_crs(std::string crs, std::string vertical_crs = {}) {
    facts_.crs = std::move(crs);
    facts_.vertical_crs = std::move(vertical_crs);
  }
  void warn(SourceWarning warning) { facts_.warnings.add(std::move(warning)); }
  void set_units(DeclaredUnits units) { facts_.units = std::move(units); }
  [[nodiscard]] std::uint64_t vertices() const noexcept { return facts_.vertices; }
  /// Takes what a comment declares (read/declared_comments.h).
  void note_comment(std::string_view comment) { comments_.note(comment); }
  /// To be called at the end of the file.
  /// @throws Error invalid_argument  there was no vertex, or no triangle
  [[nodiscard]] TinFileFacts finish();

 private:
  void look_around();
  void take_comments();

  const ByteReader& in_;
  const TinReading& reading_;
  TinFileSink& sink_;
  TinFileFacts facts_;
  DeclaredComments comments_;
  std::uint64_t added_ = 0;
};

}  // namespace ptin
