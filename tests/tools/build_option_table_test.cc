// SPDX-License-Identifier: GPL-3.0-or-later
//
// The command line and its documents have the options of the table, and no others that decide bytes.
#include "engine/construct/build_option_table.h"

#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

const std::string kDocument = PTIN_TEST_DATA "/../../tools/API.md";
const std::string kBegin =
    "<!-- options of build: made from engine/construct/build_option_table.cc -->\n";
const std::string kEnd = "<!-- end of the options of build -->\n";

/// "--max-edge L".
std::string as_written(const BuildOption& option) {
  return std::string("--") + option.name +
         (option.value == nullptr ? "" : std::string(" ") + option.value);
}

/// The list of the document, as the table has it.
std::string list_of_options() {
  std::string list = "| option | in the metadata | meaning |\n|---|---|---|\n";
  for (const BuildOption& option : build_option_table()) {
    std::string help = option.help;
    for (char& c : help) c = c == '\n' ? ' ' : c;
    list += "| `" + as_written(option) + "` | `" + key_of(option) + "` | " + help + " |\n";
  }
  return list;
}

TEST(BuildOptionTable, IsWhatHelpHas) {
  const std::string help = testing::run_ptin({"build", "--help"}).out;
  for (const BuildOption& option : build_option_table()) {
    EXPECT_NE(help.find(std::string("--") + option.name), std::string::npos) << option.name;
    EXPECT_NE(help.find(option.value == nullptr ? "" : option.value), std::string::npos);
    std::istringstream words(option.help);
    for (std::string word; words >> word;) {  // help breaks lines where it likes
      EXPECT_NE(help.find(word), std::string::npos) << option.name << ": " << word;
    }
  }
}

TEST(BuildOptionTable, IsWhatTheDocumentLists) {
  const std::string text = testing::read_file(kDocument);
  const std::size_t begin = text.find(kBegin), end = text.find(kEnd);
  ASSERT_LT(begin, end) << "the marks are gone";
  EXPECT_EQ(text.substr(begin + kBegin.size(), end - begin - kBegin.size()), list_of_options())
      << "write it anew: --gtest_also_run_disabled_tests "
         "--gtest_filter='BuildOptionTable.*WritesTheDocument'";
}

TEST(BuildOptionTable, DISABLED_WritesTheDocument) {
  std::string text = testing::read_file(kDocument);
  const std::size_t begin = text.find(kBegin) + kBegin.size();
  text.replace(begin, text.find(kEnd) - begin, list_of_options());
  std::ofstream(kDocument) << text;
}

}  // namespace
}  // namespace ptin::tools
