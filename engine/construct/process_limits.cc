// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/process_limits.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <vector>

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

namespace ptin {

namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// The number in a file of one word; no limit where there is none ("max", no such file).
std::uint64_t limit_in(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t value = 0;
  return file >> value ? value : kNoLimit;
}

/// The processors that a group's quota pays for; infinite where there is no quota: no such files,
/// "max", -1. The second version holds quota and period in one file, the first in two.
double processors_of(const std::string& folder, bool is_first_version) {
  double quota = 0.0, period = 0.0;
  bool is_there = false;
  if (is_first_version) {
    std::ifstream quota_file(folder + "/cpu.cfs_quota_us");
    std::ifstream period_file(folder + "/cpu.cfs_period_us");
    is_there = (quota_file >> quota) && (period_file >> period);
  } else {
    std::ifstream file(folder + "/cpu.max");
    is_there = static_cast<bool>(file >> quota >> period);
  }
  return is_there && quota > 0.0 && period > 0.0 ? quota / period
                                                 : std::numeric_limits<double>::infinity();
}

bool holds_word(const std::string& words, const std::string& word) {
  std::istringstream list(words);
  for (std::string one; std::getline(list, one, ',');) {
    if (one == word) {
      return true;
    }
  }
  return false;
}

/// Calls visit(folder, is_first_version) for the folder of each of this process's groups that may
/// limit what `controller` controls, and for those of the groups around them, whose limits hold for
/// what is inside. The folder of a group may be absent: a container sees its own group as the root.
template <class Visit>
void visit_groups(const CgroupPlace& place, const std::string& controller, const Visit& visit) {
  std::ifstream groups(place.groups);
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (second == std::string::npos) {
      continue;
    }
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool is_first_version = holds_word(controllers, controller);
    if (!controllers.empty() && !is_first_version) {
      continue;
    }
    const std::string root = is_first_version ? place.root + "/" + controller : place.root;
    std::string path = line.substr(second + 1);
    while (true) {
      visit(root + path, is_first_version);
      if (path.empty() || path == "/") {
        break;
      }
      path.resize(path.rfind('/'));
    }
  }
}

std::uint64_t resource_limit(int resource) {
  rlimit limit{};
  return ::getrlimit(static_cast<__rlimit_resource>(resource), &limit) == 0 &&
                 limit.rlim_cur != RLIM_INFINITY
             ? static_cast<std::uint64_t>(limit.rlim_cur)
             : kNoLimit;
}

/// Processors of the affinity; those of the machine where the system does not say.
int processors_of_affinity() {
  constexpr int kMostProcessors = 1 << 20;
  for (int processors = CPU_SETSIZE; processors <= kMostProcessors; processors *= 2) {
    std::vector<cpu_set_t> set(static_cast<std::size_t>(processors) / CPU_SETSIZE);
    const std::size_t bytes = set.size() * sizeof(cpu_set_t);
    if (::sched_getaffinity(0, bytes, set.data()) == 0) {
      return CPU_COUNT_S(bytes, set.data());
    }
  }
  return static_cast<int>(::sysconf(_SC_NPROCESSORS_ONLN));
}

}  // namespace

std::uint64_t allowed_memory(const CgroupPlace& place) {
  std::uint64_t least = std::min(resource_limit(RLIMIT_DATA), resource_limit(RLIMIT_AS));
  visit_groups(place, "memory", [&](const std::string& folder, bool is_first_version) {
    const char* name = is_first_version ? "/memory.limit_in_bytes" : "/memory.max";
    least = std::min(least, limit_in(folder + name));
  });
  return least;
}

int allowed_threads(const CgroupPlace& place) {
  double least = std::max(1, processors_of_affinity());
  visit_groups(place, "cpu", [&](const std::string& folder, bool is_first_version) {
    least = std::min(least, std::ceil(processors_of(folder, is_first_version)));
  });
  return std::max(1, static_cast<int>(least));
}

}  // namespace ptin
