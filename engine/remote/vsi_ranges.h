// SPDX-License-Identifier: GPL-3.0-or-later
//
// An object in one of GDAL's file systems, by GDAL: archives, memory, and stores of objects whose
// URLs cannot be signed.
#pragma once

#include <cstddef>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include <cpl_vsi.h>

#include "engine/remote/remote_file.h"

namespace ptin {

/// Ranges by VSIFReadMultiRangeL, at most 16 in a call, since GDAL opens a connection for each. GDAL
/// gives no status and no tag: so only the checksums of nodes and pages show that an object was
/// replaced midway. Threads: as RangeSource; one reads at a time.
class VsiRanges final : public RangeSource {
 public:
  /// @param name  As it was given, for errors.
  /// @param path  "/vsi...".
  VsiRanges(std::string name, const std::string& path, const RemoteOptions& options);
  ~VsiRanges() override;

  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept override { return bytes_; }
  [[nodiscard]] std::span<const std::byte> front() const noexcept override { return front_; }
  void read(std::span<const RangeRead> ranges) override;

 private:
  [[nodiscard]] bool try_reading(std::span<const RangeRead> ranges);

  std::string name_;
  RemoteOptions options_;
  std::mutex mutex_;
  VSILFILE* file_ = nullptr;
  std::uint64_t bytes_ = 0;
  std::vector<std::byte> front_;
};

}  // namespace ptin
