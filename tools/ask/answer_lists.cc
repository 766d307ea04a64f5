// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/answer_lists.h"

#include "tools/ask/answer_facts.h"
#include "tools/ask/locate.h"
#include "tools/ask/profile.h"
#include "tools/ask/sight.h"

namespace ptin::ask {

namespace {

/// What the command line tells as JSON.
template <typename Row>
std::vector<NamedField> printed(const Fields<Row>& fields, const std::string& prefix = {}) {
  std::vector<NamedField> all;
  list(all, fields, prefix);
  std::erase_if(all, [](const NamedField& field) {
    return !is_at(field.facts.doors, Door::kProgram) || !is_in(field.facts.as, As::kObject);
  });
  return all;
}

}  // namespace

std::vector<AnswerList> answer_lists() {
  std::vector<NamedField> of_all = answer_fields();
  std::erase_if(of_all, [](const NamedField& f) { return !is_at(f.facts.doors, Door::kProgram); });
  return {{"all answers", std::move(of_all)},
          {"locate", printed(located_fields(), "points[].")},
          {"profile", printed(profile_answer_fields())},
          {"points of profile", printed(profile_fields(), "points[].")},
          {"sight", printed(sight_fields())}};
}

std::string line_of(const NamedField& field) {
  std::string line = "- `" + field.name + "`: " + std::string(field.facts.type);
  if (!field.facts.unit.empty()) line.append(", ").append(field.facts.unit);
  return line.append(". ").append(field.facts.meaning);
}

}  // namespace ptin::ask
