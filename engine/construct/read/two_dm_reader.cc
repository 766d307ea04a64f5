// SPDX-License-Identifier: GPL-3.0-or-later
//
// SMS 2DM: `MESH2D`, then `ND id x y z` and elements in any order: triangles (E3T) and quads (E4Q),
// and those with nodes on their sides (E6T, E8Q, E9Q), which are divided at these, so that the height
// of every node counts. Lines (E2L, E3L), node strings, materials and the rest are passed over.
#include <algorithm>
#include <array>
#include <span>

#include "engine/construct/read/column_names.h"
#include "engine/construct/read/tin_reader.h"
#include "engine/error.h"

namespace ptin {

namespace {

/// The faces that an element is divided into, as places among its nodes; -1 for no fourth corner.
using Places = std::array<int, 4>;

// Nodes are named around the element, a corner and the node behind it in turn; the ninth of a quad is
// its middle.
constexpr std::array<Places, 1> kTriangle = {{{0, 1, 2, -1}}};
constexpr std::array<Places, 1> kQuad = {{{0, 1, 2, 3}}};
constexpr std::array<Places, 4> kSixNodes = {
    {{0, 1, 5, -1}, {2, 3, 1, -1}, {4, 5, 3, -1}, {1, 3, 5, -1}}};
constexpr std::array<Places, 5> kEightNodes = {
    {{0, 1, 7, -1}, {2, 3, 1, -1}, {4, 5, 3, -1}, {6, 7, 5, -1}, {1, 3, 5, 7}}};
constexpr std::array<Places, 4> kNineNodes = {
    {{0, 1, 8, 7}, {2, 3, 8, 1}, {4, 5, 8, 3}, {6, 7, 8, 5}}};

struct ElementKind {
  std::string_view card;
  std::size_t nodes;
  std::span<const Places> faces;
};
constexpr std::array<ElementKind, 5> kElements = {{{"E3T", 3, kTriangle},
                                                   {"E4Q", 4, kQuad},
                                                   {"E6T", 6, kSixNodes},
                                                   {"E8Q", 8, kEightNodes},
                                                   {"E9Q", 9, kNineNodes}}};

void read_element(const ByteReader& in, const ElementKind& kind,
                  const std::vector<std::string_view>& words, TinReceiver& tin) {
  const std::string place = in.place();
  if (words.size() < 2 + kind.nodes) {
    refuse_at(in, "a " + std::string(kind.card) + " element needs an id and " +
                      std::to_string(kind.nodes) + " nodes");
  }
  std::array<std::int64_t, 9> nodes{};
  for (std::size_t i = 0; i < kind.nodes; ++i) {
    nodes[i] = whole_of(words[i + 2], place);
  }
  for (const Places& face : kind.faces) {
    std::array<std::int64_t, 4> ids{};
    const std::size_t corners = face[3] < 0 ? 3 : 4;
    for (std::size_t i = 0; i < corners; ++i) {
      ids[i] = nodes[static_cast<std::size_t>(face[i])];
    }
    tin.add_face(std::span(ids).first(corners), place);
  }
}

void read_card(const ByteReader& in, const std::vector<std::string_view>& words, TinReceiver& tin) {
  if (words[0] == "ND") {
    const std::string place = in.place();
    if (words.size() < 5) {
      refuse_at(in, "a node needs an id, x, y and z");
    }
    tin.add_vertex(whole_of(words[1], place),
                   {coordinate_of(words[2], place), coordinate_of(words[3], place),
                    coordinate_of(words[4], place)});
    return;
  }
  if (words[0] == "NUM_MATERIALS_PER_ELEM" && words.size() > 1 && words[1] != "0" &&
      words[1] != "1") {
    tin.warn({.kind = "values_of_elements",
              .message =
                  "elements have several values of their own (NUM_MATERIALS_PER_ELEM), among "
                  "which some programs keep a height of the bed; the heights of nodes are "
                  "taken, and those are not",
              .file = in.path()});
    return;
  }
  const auto kind = std::find_if(kElements.begin(), kElements.end(),
                                 [&](const ElementKind& k) { return k.card == words[0]; });
  if (kind != kElements.end()) {
    read_element(in, *kind, words, tin);
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
    if (words.empty()) {
      continue;
    }
    if (words[0].starts_with('#')) {
      if (tin.vertices() == 0) {
        tin.note_comment(line.substr(line.find('#') + 1));
      }
      continue;
    }
    if (!has_begun) {
      if (!equal_in_any_case(words[0], "MESH2D")) {
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
