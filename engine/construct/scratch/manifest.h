// SPDX-License-Identifier: GPL-3.0-or-later
//
// The manifest of a build in the making: which work is done, durably (engine/DESIGN.md,
// section 5.9).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "storage/file/file_layer.h"

namespace ptin {

/// Groups of JSON entries. Each group is one line behind its checksum, added at the end and never
/// changed: it is there as a whole or not at all. The first line whose checksum is wrong, torn by a
/// power cut, ends what is believed; the file is cut off there when a group is written.
class Manifest {
 public:
  /// Opens `path`, or makes it. @throws Error io_error, resource_exhausted
  Manifest(FileLayer& files, const std::string& path);
  ~Manifest();
  Manifest(const Manifest&) = delete;
  Manifest& operator=(const Manifest&) = delete;

  /// The entries that the file had when it was opened, group after group.
  [[nodiscard]] const std::vector<nlohmann::json>& entries() const noexcept { return entries_; }
  /// True where the file holds more than entries() has: its end is torn, or it is damaged.
  [[nodiscard]] bool has_more() const noexcept { return bytes_ != file_bytes_; }
  /// Writes a group and syncs it. What the group speaks of must be durable before.
  /// @throws Error io_error, resource_exhausted
  void append(const std::vector<nlohmann::json>& group);

 private:
  void read();

  std::string path_;
  ScratchFile file_;
  std::vector<nlohmann::json> entries_;
  std::uint64_t bytes_ = 0;  ///< Bytes that are believed.
  std::uint64_t file_bytes_ = 0;
};

}  // namespace ptin
