// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/measure/device_speed.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/error.h"
#include "engine/stop.h"
#include "tools/measure/deadline.h"
#include "tools/measure/quantiles.h"

namespace ptin::tools {

namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
constexpr std::size_t kReadBytes = 4096;
constexpr double kPassSeconds = 1.0, kRandomSeconds = 1.0;

/// A descriptor, closed when it goes.
struct DirectFile {
  int fd;
  std::uint64_t bytes = 0;
  explicit DirectFile(const std::string& path)
      : fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_DIRECT)) {
    struct stat seen {};
    if (fd >= 0 && ::fstat(fd, &seen) == 0) bytes = static_cast<std::uint64_t>(seen.st_size);
  }
  ~DirectFile() {
    if (fd >= 0) ::close(fd);
  }
  DirectFile(const DirectFile&) = delete;
  DirectFile& operator=(const DirectFile&) = delete;
};

using AlignedBuffer = std::unique_ptr<void, decltype(&std::free)>;
AlignedBuffer aligned_buffer() {
  AlignedBuffer buffer(std::aligned_alloc(kReadBytes, kBlockBytes), &std::free);
  if (!buffer) throw std::bad_alloc();
  return buffer;
}

/// Bytes a second that 8 readers reach over the first blocks, for at most kPassSeconds; 0 when a
/// read fails.
double read_in_order(const DirectFile& file, std::uint64_t blocks, const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  std::atomic<std::uint64_t> next{0}, bytes{0};
  std::atomic<bool> has_failed{false};
  {
    std::vector<std::jthread> readers;
    for (int i = 0; i < 8; ++i) {
      readers.emplace_back([&] {
        const AlignedBuffer buffer = aligned_buffer();
        for (std::uint64_t b = next++;
             b < blocks && seconds_since(begin) < kPassSeconds && !stop.stop_requested();
             b = next++) {
          const ssize_t n =
              ::pread(file.fd, buffer.get(), kBlockBytes, static_cast<off_t>(b * kBlockBytes));
          n < 0 ? has_failed.store(true) : void(bytes += static_cast<std::uint64_t>(n));
        }
      });
    }
  }
  return has_failed ? 0 : static_cast<double>(bytes) / seconds_since(begin);
}

/// Seconds of single reads at seeded places; empty when a read fails.
std::vector<double> read_anywhere(const DirectFile& file, const std::stop_token& stop) {
  const AlignedBuffer buffer = aligned_buffer();
  std::mt19937_64 random(1);
  std::vector<double> spent;
  const auto begin = std::chrono::steady_clock::now();
  while (spent.size() < 400 && (spent.size() < 10 || seconds_since(begin) < kRandomSeconds)) {
    stop_if_asked(stop, "the benchmark");
    const auto at = static_cast<off_t>(random() % (file.bytes / kReadBytes) * kReadBytes);
    const auto asked = std::chrono::steady_clock::now();
    if (::pread(file.fd, buffer.get(), kReadBytes, at) < 0) return {};
    spent.push_back(seconds_since(asked));
  }
  return spent;
}

}  // namespace

std::optional<DeviceSpeed> measure_device(const std::string& path, const std::stop_token& stop) {
  const DirectFile file(path);
  if (file.fd < 0 && errno != EINVAL) throw system_error(errno, "cannot open", path);
  if (file.bytes < kReadBytes) return {};
  const std::uint64_t blocks = std::clamp<std::uint64_t>(file.bytes / kBlockBytes, 1, 512);
  DeviceSpeed speed;
  const auto begin = std::chrono::steady_clock::now();
  for (int pass = 0; pass < 5 && seconds_since(begin) < 2 * kPassSeconds; ++pass) {
    stop_if_asked(stop, "the benchmark");
    speed.sequential_mb_s =
        std::max(speed.sequential_mb_s, read_in_order(file, blocks, stop) / 1e6);
  }
  const Quantiles random = quantiles_of(read_anywhere(file, stop));
  if (!random.median || speed.sequential_mb_s == 0) return {};
  speed.random_4k_ms = *random.median * 1e3;
  return speed;
}

}  // namespace ptin::tools
