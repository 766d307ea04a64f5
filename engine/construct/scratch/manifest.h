// SPDX-License-Identifier: GPL-3.0-or-later
//
// The manifest of a build in the making: which work is done, durably (engine/DESIGN.md, section 5.9).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "storage/file/file_layer.h"

namespace ptin {

/// Groups of JSON entries, each group one line behind its checksum, added at the end and never
/// changed: a group is there as a whole or not at all. A line that was torn by a power cut ends
/// what is believed, and is cut off.
class Manifest {
 public:
  /// Opens `path`, or makes it. @throws Error io_error, resource_exhausted
  Manifest(FileLayer& files, const std::string& path);
  ~Manifest();
  Manifest(const Manifest&) = delete;
  Manifest& operator=(const Manifest&) = delete;

  /// What was there when it was opened, group after group.
  [[nodiscard]] const std::vector<nlohmann::json>& entries() const noexcept { return entries_; }
  /// Writes a group and syncs. What it speaks of must be synced before.
  void append(const std::vector<nlohmann::json>& group);

 private:
  void read();

  std::string path_;
  ScratchFile file_;
  std::vector<nlohmann::json> entries_;
  std::uint64_t bytes_ = 0;
};

}  // namespace ptin
