// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every length and height of the command line with a unit behind it.
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/measures_with_units.h"
#include "tools/facts/human.h"
#include "tools/facts/quantity.h"
#include "tools/ptin/command.h"

namespace ptin::tools {
namespace {

using testing::answer_and_file;
using testing::AnswerAndFile;
using testing::AskedWith;
using testing::expect_done;
using testing::MeasuresWithUnits;
using testing::questions_of;

/// Real numbers that are no length or height.
const std::set<std::string> kNumbers = {
    "refine --exaggeration", "export --exaggeration", "export --nodata",
    "export --azimuth",      "export --altitude",     "sight PAIR",
    "sight --curvature",     "viewshed --curvature",  "bench --seconds",
    "build --nodata",        "build --void-slope"};

/// The options and arguments of all subcommands that are lengths or heights. Every other real number
/// is a position, or one of kNumbers.
std::set<std::string> measures_of_the_program() {
  std::set<std::string> all;
  for (const Command& command : commands()) {
    Context context;
    const Declared declared = command.declare(context);
    for (const ask::Parameter& row : declared.parameters) {
      if (!is_at(row.doors, ask::Door::kProgram)) continue;
      const std::string name =
          std::string(command.name) + " " + ask::name_at(row, ask::Door::kProgram);
      const bool is_measure = row.unit == ask::Unit::kHeight || row.unit == ask::Unit::kGround;
      if (is_measure) all.insert(name);
      const bool is_real = !ask::is_text(row) && !ask::is_flag(row) && !ask::is_whole(row);
      const bool has_no_unit = row.unit == ask::Unit::kNone && row.source_unit.empty();
      EXPECT_EQ(is_real && has_no_unit, kNumbers.contains(name)) << name;
    }
  }
  return all;
}

TEST_F(MeasuresWithUnits, AllLengthsAndHeightsTakeUnits) {
  const std::string feet = built("feet", 2913, "foot");
  expect_done({"stream", feet, "-o", file("sent.pts"), "-q"});
  const std::map<std::string, AskedWith> questions = questions_of(feet, folder_);
  for (const std::string& name : measures_of_the_program()) {
    SCOPED_TRACE(name);
    const auto question = questions.find(name);
    EXPECT_TRUE(question != questions.end()) << "a new length or height: put it into the table";
    if (question == questions.end()) continue;
    const std::string option = name.substr(name.find(' ') + 1);
    const auto& [words, metres] = question->second;
    const std::string plain = exact_number(metres / 0.3048);
    if (words.front() == "bench") {  // figures of time: what was asked is told
      EXPECT_EQ(answer_and_file(words, option, exact_number(metres) + "m").answer.at("error"),
                metres / 0.3048);
      continue;
    }
    const AnswerAndFile want = answer_and_file(words, option, plain);
    EXPECT_EQ(answer_and_file(words, option, exact_number(metres) + "m"), want);
    EXPECT_EQ(answer_and_file(words, option, plain + "us-ft"), want) << "the terrain's own foot";
    EXPECT_NE(answer_and_file(words, option, exact_number(2 * metres)), want) << "it has no effect";
  }
}

}  // namespace
}  // namespace ptin::tools
