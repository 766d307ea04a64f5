// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/warnings_file.h"

#include <cstdint>
#include <utility>

namespace ptin {

template <class File, MaybeConst<SourceWarning> Warning>
void serialize(File& file, Warning& w) {
  file.values(w.kind, w.message, w.file, w.subject, w.last_file, w.line, w.count, w.files, w.point);
}

void serialize(ArrayFileWriter& file, const SourceWarnings& warnings) {
  file.values(std::uint64_t{warnings.all().size()});
  for (const SourceWarning& warning : warnings.all()) {
    file.values(warning);
  }
}

void serialize(ArrayFileReader& file, SourceWarnings& warnings) {
  std::uint64_t size = 0;
  file.values(size);
  for (; size > 0; --size) {
    SourceWarning warning;
    file.values(warning);
    warnings.add(std::move(warning));
  }
}

}  // namespace ptin
