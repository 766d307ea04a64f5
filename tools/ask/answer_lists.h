// SPDX-License-Identifier: GPL-3.0-or-later
//
// The fields of answers as tools/API.md lists them, between markers that name the list.
#pragma once

#include <string>
#include <vector>

#include "tools/ask/field.h"

namespace ptin::ask {

struct AnswerList {
  std::string name;  ///< Of the list: "locate".
  std::vector<NamedField> fields;
};
/// The lists, in the order of the document.
[[nodiscard]] std::vector<AnswerList> answer_lists();
/// "- `points[].x`: number, map unit. As asked.", in one line.
[[nodiscard]] std::string line_of(const NamedField& field);

}  // namespace ptin::ask
