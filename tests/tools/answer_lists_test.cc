// SPDX-License-Identifier: GPL-3.0-or-later
//
// The lists of tools/API.md that are made from rows: each stands there, between markers that name it,
// as the rows have it.
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/build_option_table.h"
#include "tests/tools/program.h"
#include "tools/ask/questions.h"
#include "tools/facts/human.h"
#include "tools/ptin/export_report.h"

namespace ptin::ask {
namespace {

const std::string kDocument = PTIN_TEST_DATA "/../../tools/API.md";

struct List {
  std::string name, text;
};

/// Lines of a document, broken where its others are: "- `points[].x`: number, map unit. As asked."
template <typename Row>
List list_of(std::string name, const Fields<Row>& fields, const std::string& prefix = {}) {
  constexpr std::size_t kColumns = 128;
  List list{std::move(name), {}};
  for (const Field& field : fields.told(Told::kProgram & Told::kDocument)) {
    std::string all = "- `" + prefix + field.name + "`: " + std::string(field.type);
    if (!field.unit.empty()) all.append(", ").append(field.unit);
    all.append(". ").append(field.meaning);
    const char* indent = "";
    for (const std::string& line : tools::wrapped(all, kColumns)) {
      list.text += indent + line + "\n";
      indent = "  ";
    }
  }
  return list;
}

List options_of_build() {
  List list{"the options of build", "| option | in the metadata | meaning |\n|---|---|---|\n"};
  for (const BuildOption& option : build_option_table()) {
    std::string help = option.help;
    for (char& c : help) c = c == '\n' ? ' ' : c;
    list.text += std::string("| `--") + option.name +
                 (option.value == nullptr ? "" : std::string(" ") + option.value) + "` | `" +
                 key_of(option) + "` | " + help + " |\n";
  }
  return list;
}

std::vector<List> all_lists() {
  return {list_of("all answers", answer_fields()),
          list_of("refine", mesh_fields()),
          list_of("export", tools::exported_fields()),
          list_of("isoline", isoline_fields()),
          list_of("isoline --polygons", band_fields()),
          list_of("locate", located_fields(), "points[]."),
          list_of("profile", profile_answer_fields()),
          list_of("points of profile", profile_fields(), "points[]."),
          list_of("sight", sight_fields()),
          list_of("viewshed", viewshed_fields()),
          list_of("highest", highest_fields()),
          list_of("volume", volume_fields()),
          list_of("stream", stream_fields()),
          list_of("the mesh of unstream", mesh_fields()),
          options_of_build()};
}

/// The place of a list between its markers; the end is before the second one.
struct Place {
  std::size_t begin, end;
};
Place place_of(const List& list, const std::string& document) {
  const std::string marker = "<!-- rows of " + list.name + " -->\n";
  const std::size_t begin = document.find(marker);
  EXPECT_NE(begin, std::string::npos) << marker;
  if (begin == std::string::npos) return {0, 0};
  return {begin + marker.size(), document.find("<!-- end -->", begin)};
}

TEST(AnswerLists, AreThoseOfTheDocument) {
  const std::string document = tools::testing::read_file(kDocument);
  for (const List& list : all_lists()) {
    const Place place = place_of(list, document);
    EXPECT_EQ(document.substr(place.begin, place.end - place.begin), list.text)
        << "write them anew: --gtest_also_run_disabled_tests --gtest_filter='*WritesTheLists'";
  }
}

TEST(AnswerLists, DISABLED_WritesTheLists) {
  std::string document = tools::testing::read_file(kDocument);
  for (const List& list : all_lists()) {
    const Place place = place_of(list, document);
    document.replace(place.begin, place.end - place.begin, list.text);
  }
  std::ofstream(kDocument, std::ios::binary) << document;
}

/// What a field that is added to a table of rows looks like in the document.
TEST(AnswerLists, HaveTheRowsThatAreAdded) {
  struct Hill {
    double height;
  };
  Fields<Hill> fields;
  fields.add("height", "number or null", kHeightUnit, "Of its top.", &Hill::height);
  fields.add("note", "string", "", "Elsewhere.", Told::kService, [](const Hill&) { return "-"; });
  Fields<std::vector<Hill>> range;
  range.add_array("hills", "All of them.", fields, [](const auto& hills) { return &hills; });
  EXPECT_EQ(list_of("", fields, "top.").text,
            "- `top.height`: number or null, height's unit. Of its top.\n");
  EXPECT_EQ(list_of("", range).text,
            "- `hills`: array of objects. All of them.\n"
            "- `hills[].height`: number or null, height's unit. Of its top.\n");
}

}  // namespace
}  // namespace ptin::ask
