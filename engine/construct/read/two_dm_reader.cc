// SPDX-License-Identifier: GPL-3.0-or-later
//
// SMS 2DM: `MESH2D`, then `ND id x y z` and `E3T id a b c material` in any order. Quadrilaterals
// and elements with nodes on their sides are refused; node strings and the rest are passed over.
#include <algorithm>
#include <array>

#include "engine/construct/read/tin_reader.h"
#include "engine/error.h"

namespace ptin {

namespace {

void read_card(const ByteReader& in, const std::vector<std::string_view>& words, TinReceiver& tin) {
  constexpr std::array<std::string_view, 5> kOthers = {"E2L", "E6T", "E8Q", "E9Q", "E4Q"};
  const std::string place = in.place();
  if (words[0] == "ND") {
    if (words.size() < 5) {
      refuse_at(in, "a node needs an id, x, y and z");
    }
    tin.add_vertex(whole_of(words[1], place),
                   {coordinate_of(words[2], place), coordinate_of(words[3], place),
                    coordinate_of(words[4], place)});
  } else if (words[0] == "E3T") {
    if (words.size() < 5) {
      refuse_at(in, "a triangle needs an id and three nodes");
    }
    tin.add_triangle(
        {whole_of(words[2], place), whole_of(words[3], place), whole_of(words[4], place)});
  } else if (words[0] != "E2L" &&
             std::find(kOthers.begin(), kOthers.end(), words[0]) != kOthers.end()) {
    refuse_at(in, "there is a " + std::string(words[0]) +
                      " element; only triangles (E3T) are read: triangulate the mesh first");
  }
}

}  // namespace

TinFileFacts read_two_dm(ByteReader& in, const TinReading& reading, TinFileSink& sink) {
  TinReceiver tin(in, reading, sink);
  std::string_view line;
  std::vector<std::string_view> words;
  bool has_begun = false;
  while (in.line(line)) {
    split_words(line, words);
    if (words.empty() || words[0].starts_with('#')) {
      continue;
    }
    if (!has_begun) {
      if (words[0] != "MESH2D") {
        refuse_at(in, "a 2DM file begins with MESH2D");
      }
      has_begun = true;
      continue;
    }
    read_card(in, words, tin);
  }
  return tin.finish();
}

}  // namespace ptin
