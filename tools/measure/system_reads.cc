// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/measure/system_reads.h"

#include <fstream>
#include <string>

#include <sys/resource.h>

namespace ptin::tools {

SystemReads SystemReads::now() {
  SystemReads reads;
  std::ifstream io("/proc/self/io");
  std::string key;
  std::uint64_t value = 0;
  while (io >> key >> value) {
    if (key == "read_bytes:") reads.device_bytes = value;
  }
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  reads.major_faults = static_cast<std::uint64_t>(usage.ru_majflt);
  return reads;
}

SystemReads SystemReads::since(const SystemReads& before) const {
  SystemReads between;
  if (device_bytes && before.device_bytes) {
    between.device_bytes = *device_bytes - *before.device_bytes;
  }
  between.major_faults = major_faults - before.major_faults;
  return between;
}

}  // namespace ptin::tools
