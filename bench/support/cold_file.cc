// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/support/cold_file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <random>
#include <system_error>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

namespace ptin::bench {

namespace {

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

class OpenFile {
 public:
  OpenFile(const std::string& path, int flags) : fd_(::open(path.c_str(), flags | O_CLOEXEC)) {
    if (fd_ < 0) fail(path);
    struct stat seen {};
    if (::fstat(fd_, &seen) != 0) fail(path);
    bytes_ = static_cast<std::size_t>(seen.st_size);
  }
  ~OpenFile() { ::close(fd_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  [[nodiscard]] int fd() const { return fd_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  int fd_;
  std::size_t bytes_ = 0;
};

constexpr std::size_t kBlock = std::size_t{1} << 20;
using Buffer = std::unique_ptr<void, decltype(&std::free)>;
Buffer aligned_buffer() { return {std::aligned_alloc(4096, kBlock), &std::free}; }

/// Seconds that 8 readers take for the first `blocks` blocks.
double read_in_order(const OpenFile& file, std::size_t blocks) {
  const auto begin = std::chrono::steady_clock::now();
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::vector<std::thread> readers;
  for (int i = 0; i < 8; ++i) {
    readers.emplace_back([&] {
      const Buffer buffer = aligned_buffer();
      for (std::size_t b = next++; b < blocks; b = next++) {
        if (::pread(file.fd(), buffer.get(), kBlock, static_cast<off_t>(b * kBlock)) < 0)
          failed = true;
      }
    });
  }
  for (std::thread& t : readers) t.join();
  if (failed) fail("reading with O_DIRECT");
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double median_random_ms(const OpenFile& file) {
  const Buffer buffer = aligned_buffer();
  std::mt19937_64 random(1);
  std::vector<double> spent;
  for (int i = 0; i < 400; ++i) {
    const auto at = static_cast<off_t>(random() % (file.bytes() / 4096) * 4096);
    const auto begin = std::chrono::steady_clock::now();
    if (::pread(file.fd(), buffer.get(), 4096, at) < 0) fail("reading with O_DIRECT");
    spent.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
            .count());
  }
  std::nth_element(spent.begin(), spent.begin() + 200, spent.end());
  return spent[200];
}

}  // namespace

std::uint64_t resident_bytes(const std::string& path) {
  const OpenFile file(path, O_RDONLY);
  if (file.bytes() == 0) return 0;
  void* mapping = ::mmap(nullptr, file.bytes(), PROT_READ, MAP_SHARED, file.fd(), 0);
  if (mapping == MAP_FAILED) fail(path);
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  std::vector<unsigned char> state((file.bytes() + page - 1) / page);
  const int result = ::mincore(mapping, file.bytes(), state.data());
  ::munmap(mapping, file.bytes());
  if (result != 0) fail(path);
  return page * static_cast<std::uint64_t>(
                    std::count_if(state.begin(), state.end(), [](auto s) { return (s & 1) != 0; }));
}

std::uint64_t drop_from_cache(const std::string& path) {
  std::uint64_t left = 0;
  for (int i = 0; i < 20; ++i) {
    {
      const OpenFile file(path, O_RDONLY);
      ::fdatasync(file.fd());
      ::posix_fadvise(file.fd(), 0, 0, POSIX_FADV_DONTNEED);
    }
    left = resident_bytes(path);
    if (left == 0) break;
    // Pages that are just being read or written are dropped in a later round.
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return left;
}

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
  reads.minor_faults = static_cast<std::uint64_t>(usage.ru_minflt);
  return reads;
}

DeviceSpeed measure_device(const std::string& path) {
  const OpenFile file(path, O_RDONLY | O_DIRECT);
  const std::size_t blocks =
      std::min<std::size_t>(512, std::max<std::size_t>(1, file.bytes() / kBlock));
  DeviceSpeed speed;
  for (int pass = 0; pass < 5; ++pass) {
    speed.sequential_mb_s = std::max(speed.sequential_mb_s,
                                     double(blocks * kBlock) / 1e6 / read_in_order(file, blocks));
  }
  speed.random_4k_ms = median_random_ms(file);
  return speed;
}

}  // namespace ptin::bench
