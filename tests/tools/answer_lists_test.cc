// SPDX-License-Identifier: GPL-3.0-or-later
//
// The lists of tools/API.md that are made from rows: each stands there as the rows have it.
#include "tools/ask/answer_lists.h"

#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/program.h"
#include "tools/facts/human.h"

namespace ptin::ask {
namespace {

const std::string kDocument = PTIN_TEST_DATA "/../../tools/API.md";

/// Lines of a document, broken where its others are.
std::string text_of(const AnswerList& list) {
  constexpr std::size_t kColumns = 128;
  std::string text;
  for (const NamedField& field : list.fields) {
    bool is_first = true;
    for (const std::string& line : tools::wrapped(line_of(field), kColumns)) {
      text += (is_first ? "" : "  ") + line + "\n";
      is_first = false;
    }
  }
  return text;
}

/// The place of a list between its markers; the end is before the second one.
struct Place {
  std::size_t begin, end;
};
Place place_of(const AnswerList& list, const std::string& document) {
  const std::string marker = "<!-- rows of " + list.name + " -->\n";
  const std::size_t begin = document.find(marker);
  EXPECT_NE(begin, std::string::npos) << marker;
  if (begin == std::string::npos) return {0, 0};
  return {begin + marker.size(), document.find("<!-- end -->", begin)};
}

TEST(AnswerLists, AreThoseOfTheDocument) {
  const std::string document = tools::testing::read_file(kDocument);
  for (const AnswerList& list : answer_lists()) {
    const Place place = place_of(list, document);
    EXPECT_EQ(document.substr(place.begin, place.end - place.begin), text_of(list))
        << "write them anew: --gtest_also_run_disabled_tests --gtest_filter='*WritesTheLists'";
  }
}

TEST(AnswerLists, DISABLED_WritesTheLists) {
  std::string document = tools::testing::read_file(kDocument);
  for (const AnswerList& list : answer_lists()) {
    const Place place = place_of(list, document);
    document.replace(place.begin, place.end - place.begin, text_of(list));
  }
  std::ofstream(kDocument, std::ios::binary) << document;
}

}  // namespace
}  // namespace ptin::ask
