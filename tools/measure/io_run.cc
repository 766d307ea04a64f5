// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/measure/io_run.h"

#include <optional>

#include "tools/measure/uring_announcer.h"

namespace ptin::tools {

IoRun::IoRun(const IoRequest& request)
    : request_(request),
      cache_(request.file),
      unmapped_(StoreFile::open(request.file, PageAccess::kPread)),
      questions_(unmapped_.store(), request.seed, request.tolerance),
      why_not_cold_(cache_.why_never_cold()),
      why_no_uring_(why_not_cold_.empty() ? ptin::tools::why_no_uring()
                                          : "a warm question does not use it") {
  for (const ReadWay way : kReadWays) {
    if (way != ReadWay::kUring || why_no_uring_.empty()) ways_.push_back(way);
  }
  has_device_bytes_ = why_not_cold_.empty() && find_device_bytes();
}

/// Whether the system counts bytes that certainly come from a device: network file systems have
/// none.
bool IoRun::find_device_bytes() {
  if (!make_cold()) return false;
  const SystemReads before = SystemReads::now();
  const auto store = StoreFile::open(request_.file, PageAccess::kPread);
  return SystemReads::now().since(before).device_bytes.value_or(0) > 0;
}

IoRun::Opened IoRun::open(ReadWay way) {
  std::optional<Terrain> terrain;
  const Reading reading = timed([&] {
    terrain.emplace(opener_.open(request_.file, way));
    return IoCounters{};
  });
  check_unchanged();
  return {std::move(*terrain), reading};
}

}  // namespace ptin::tools
