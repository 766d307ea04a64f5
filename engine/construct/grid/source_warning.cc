// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/source_warning.h"

#include <algorithm>
#include <utility>

namespace ptin {

void SourceWarnings::add(SourceWarning warning) {
  if (warning.last_file.empty()) {
    warning.last_file = warning.file;
  }
  const auto same = std::find_if(all_.begin(), all_.end(), [&](const SourceWarning& w) {
    return w.kind == warning.kind && w.subject == warning.subject;
  });
  if (same == all_.end()) {
    all_.push_back(std::move(warning));
    return;
  }
  same->count += warning.count;
  same->files += warning.files - (same->last_file == warning.file ? 1 : 0);
  same->last_file = std::move(warning.last_file);
}

void SourceWarnings::join(const SourceWarnings& next) {
  for (const SourceWarning& w : next.all_) {
    add(w);
  }
}

}  // namespace ptin
