// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/kept_inputs.h"

#include <string>
#include <vector>

#include "engine/construct/kept_inputs.h"
#include "engine/number.h"

namespace ptin::tools {

void check_inputs_are_kept(const ask::Reading& reading) {
  const auto output = reading.given().find("output");
  if (output == reading.given().end()) return;
  std::vector<std::string> inputs;
  for (const auto& [name, values] : reading.given()) {
    if (name == "output") continue;
    for (const std::string& value : values) {
      if (!parse_number<double>(value)) inputs.push_back(value);
    }
  }
  ptin::check_inputs_are_kept(inputs, output->second.back());
}

}  // namespace ptin::tools
