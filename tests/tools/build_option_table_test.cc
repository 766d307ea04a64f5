// SPDX-License-Identifier: GPL-3.0-or-later
//
// The command line has the options of the table.
#include "engine/construct/build_option_table.h"

#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

/// A text with one blank between its words: help breaks lines where it likes.
std::string in_one_line(const std::string& text) {
  std::string line;
  std::istringstream words(text);
  for (std::string word; words >> word;) line += word + " ";
  return line;
}

TEST(BuildOptionTable, IsWhatHelpHas) {
  const std::string help = in_one_line(testing::run_ptin({"build", "--help"}).out);
  EXPECT_NE(help.find("--cost TEXT:{error,roi,elevation} "), std::string::npos) << help;
  for (const BuildOption& option : build_option_table()) {
    const std::string name = std::string(" --") + option.name;
    const std::size_t sentence = help.find(" " + in_one_line(option.help));
    ASSERT_NE(sentence, std::string::npos) << name << ": " << option.help;
    const std::size_t at = help.rfind(name, sentence);
    ASSERT_NE(at, std::string::npos) << name;
    // Between its name and its sentence stands its value, and no other option.
    const std::string value = help.substr(at + name.size(), sentence - at - name.size());
    EXPECT_EQ(value.find(" -"), std::string::npos) << name << value;
    EXPECT_EQ(value.find_first_of(" ,=") == 0, !value.empty()) << name << value;
    if (option.value != nullptr) {
      EXPECT_NE(value.find(std::string(" ") + option.value), std::string::npos) << name << value;
    }
  }
}

}  // namespace
}  // namespace ptin::tools
