// SPDX-License-Identifier: GPL-3.0-or-later
//
// Wavefront OBJ: `v x y z` and `f a b c`, also of four corners (a/t/n too; negative indices count
// from the last vertex), z up. All objects and groups are one TIN. A line that ends in a backslash
// goes on in the next one. A weight behind x, y and z divides them. Comments (#, to the end of the
// line), lines, points, normals, textures, materials and colours of vertices are passed over; comments
// before the first vertex may name the CRS, as in `# crs: EPSG:25832` (read/declared_comments.h).
#include <algorithm>
#include <array>
#include <string>

#include "engine/construct/read/tin_reader.h"
#include "engine/error.h"

namespace ptin {

namespace {

constexpr std::size_t kLongestLine = std::size_t{1} << 20;  // with those that it goes on in

/// The index of a corner, from 0.
std::int64_t corner_of_word(std::string_view word, std::uint64_t vertices,
                            const std::string& place) {
  const std::int64_t n = whole_of(word.substr(0, word.find('/')), place);
  if (n == 0) {
    throw Error(ErrorCode::invalid_argument, "vertices are numbered from 1, not 0", place);
  }
  return n > 0 ? n - 1 : static_cast<std::int64_t>(vertices) + n;
}

class ObjReader {
 public:
  ObjReader(ByteReader& in, const TinReading& reading, TinFileSink& sink)
      : in_(in), tin_(in, reading, sink) {}

  TinFileFacts read() {
    std::string_view line;
    while (next(line)) {
      const std::size_t mark = line.find('#');
      if (mark != std::string_view::npos && tin_.vertices() == 0) {
        tin_.note_comment(line.substr(mark + 1));
      }
      split_words(line.substr(0, mark), words_);
      if (!words_.empty()) {
        read_words();
      }
    }
    return tin_.finish();
  }

 private:
  /// The next line with those that it goes on in; `place_` says where it begins.
  bool next(std::string_view& line) {
    if (!in_.line(line)) {
      return false;
    }
    place_ = in_.place();
    if (!goes_on(line)) {
      return true;
    }
    joined_.clear();
    for (;;) {
      const bool is_last = !goes_on(line);
      joined_.append(line);
      if (is_last) {
        break;
      }
      joined_.back() = ' ';
      if (joined_.size() > kLongestLine) {
        refuse("a line goes on for more than a mebibyte", place_);
      }
      if (!in_.line(line)) {
        break;
      }
    }
    line = joined_;
    return true;
  }
  [[nodiscard]] static bool goes_on(std::string_view& line) {
    const std::size_t last = line.find_last_not_of(" \t");
    line = line.substr(0, last == std::string_view::npos ? 0 : last + 1);
    return line.ends_with('\\') && line.find('#') == std::string_view::npos;
  }

  /// x, y, z, and a weight by which they are divided, where nothing else follows: three or four numbers
  /// more are a colour.
  void add_vertex() {
    SourcePoint p{coordinate_of(words_[1], place_), coordinate_of(words_[2], place_),
                  coordinate_of(words_[3], place_)};
    if (words_.size() == 5) {
      const double weight = to_double(coordinate_of(words_[4], place_));
      if (weight == 0.0) {
        refuse("a vertex has the weight 0, and so lies nowhere; leave it out", place_);
      }
      if (weight != 1.0) {
        for (Decimal* d : {&p.x, &p.y, &p.z}) {
          *d = coordinate_of(to_double(*d) / weight, place_);
        }
      }
    }
    tin_.add_vertex(p);
  }

  void read_words() {
    if (words_[0] == "v") {
      if (words_.size() < 4) {
        refuse("a vertex needs x, y and z", place_);
      }
      add_vertex();
    } else if (words_[0] == "f") {
      ids_.clear();
      for (std::size_t i = 1; i < words_.size(); ++i) {
        ids_.push_back(corner_of_word(words_[i], tin_.vertices(), place_));
      }
      tin_.add_face(ids_, place_);
    } else if (words_[0] == "surf" || words_[0] == "call") {
      refuse(words_[0] == "surf"
                 ? "there is a surface of curves (surf); save it as triangles or quads"
                 : "the file goes on in another one (call); save both as one",
             place_);
    }
  }

  ByteReader& in_;
  TinReceiver tin_;
  std::string joined_, place_;
  std::vector<std::string_view> words_;
  std::vector<std::int64_t> ids_;
};

}  // namespace

TinFileFacts read_obj(ByteReader& in, const TinReading& reading, TinFileSink& sink) {
  return ObjReader(in, reading, sink).read();
}

}  // namespace ptin
