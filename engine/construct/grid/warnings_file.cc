// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/warnings_file.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace ptin {

void put_warnings(ArrayFileWriter& file, const SourceWarnings& warnings) {
  file.put(std::vector<std::uint64_t>{warnings.all().size()});
  for (const SourceWarning& w : warnings.all()) {
    for (const std::string* text : {&w.kind, &w.message, &w.file, &w.subject, &w.last_file}) {
      file.put_text(*text);
    }
    file.put(std::vector<std::uint64_t>{w.line, w.count, w.files});
  }
}

SourceWarnings take_warnings(ArrayFileReader& file) {
  SourceWarnings warnings;
  const std::vector<std::uint64_t> size = file.take_copy<std::uint64_t>();
  for (std::uint64_t i = 0; i < size.at(0); ++i) {
    SourceWarning w;
    for (std::string* text : {&w.kind, &w.message, &w.file, &w.subject, &w.last_file}) {
      *text = file.take_text();
    }
    const std::vector<std::uint64_t> numbers = file.take_copy<std::uint64_t>();
    w.line = numbers.at(0);
    w.count = numbers.at(1);
    w.files = numbers.at(2);
    warnings.add(std::move(w));
  }
  return warnings;
}

}  // namespace ptin
