// SPDX-License-Identifier: GPL-3.0-or-later
//
// Wavefront OBJ: `v x y z` and `f a b c` (a/t/n too; negative indices count from the last vertex),
// z up. Comments (#, to the end of the line) and everything else are passed
// over.
#include "engine/construct/read/tin_reader.h"
#include "engine/error.h"

namespace ptin {

namespace {

/// The index of a corner, from 0.
std::int64_t corner_of_word(std::string_view word, std::uint64_t vertices,
                            const std::string& place) {
  const std::int64_t n = whole_of(word.substr(0, word.find('/')), place);
  if (n == 0) {
    throw Error(ErrorCode::invalid_argument, "vertices are numbered from 1, not 0", place);
  }
  return n > 0 ? n - 1 : static_cast<std::int64_t>(vertices) + n;
}

}  // namespace

TinFileFacts read_obj(ByteReader& in, const TinReading& reading, TinFileSink& sink) {
  TinReceiver tin(in, reading, sink);
  std::string_view line;
  std::vector<std::string_view> words;
  while (in.line(line)) {
    split_words(line.substr(0, line.find('#')), words);
    if (words.empty()) {
      continue;
    }
    if (words[0] == "v") {
      if (words.size() < 4) {
        throw Error(ErrorCode::invalid_argument, "a vertex needs x, y and z", in.place());
      }
      const std::string place = in.place();
      tin.add_vertex({coordinate_of(words[1], place), coordinate_of(words[2], place),
                      coordinate_of(words[3], place)});
    } else if (words[0] == "f") {
      if (words.size() != 4) {
        throw Error(ErrorCode::invalid_argument,
                    "a face has " + std::to_string(words.size() - 1) +
                        " corners; triangulate the mesh first",
                    in.place());
      }
      std::array<std::int64_t, 3> ids{};
      for (std::size_t i = 0; i < 3; ++i) {
        ids[i] = corner_of_word(words[i + 1], tin.vertices(), in.place());
      }
      tin.add_triangle(ids);
    }
  }
  return tin.finish();
}

}  // namespace ptin
