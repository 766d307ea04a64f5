// SPDX-License-Identifier: GPL-3.0-or-later
//
// Places on the disk that go away with the test that uses them.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <sys/mount.h>
#include <unistd.h>

namespace ptin::test {

/// A folder of its own, removed with all it holds.
class TestFolder {
 public:
  /// Small ones are in memory where the system has a place for that: a disk takes minutes for what
  /// some tests do to one file.
  enum class Size { kAny, kSmall };
  explicit TestFolder(Size size = Size::kAny) : TestFolder(place_for(size)) {}
  /// In a folder that is there.
  explicit TestFolder(const std::filesystem::path& parent) {
    std::string name = (parent / "ptin_test_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error("cannot make a folder in " + parent.string());
    }
    path_ = name;
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  ~TestFolder() {
    std::error_code ignored;
    // A test may have taken its own rights to it.
    std::filesystem::permissions(path_, std::filesystem::perms::owner_all, ignored);
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
  /// Of what is in it, sorted.
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  static std::filesystem::path place_for(Size size) {
    const std::filesystem::path memory = "/dev/shm";
    return size == Size::kSmall && ::access(memory.c_str(), W_OK) == 0
               ? memory
               : std::filesystem::temp_directory_path();
  }

  std::filesystem::path path_;
};

/// A file system of few bytes, in memory; unmounted at the end.
class SmallDisk {
 public:
  /// @param path  The folder that it becomes; made when it is not there.
  SmallDisk(std::string path, int mebibytes) : path_(std::move(path)) {
    std::filesystem::create_directories(path_);
    const std::string size = "size=" + std::to_string(mebibytes) + "m";
    is_mounted_ = ::mount("tmpfs", path_.c_str(), "tmpfs", 0, size.c_str()) == 0;
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() {
    if (is_mounted_) {
      ::umount(path_.c_str());
    }
  }

  /// False where mounting is not permitted: `GTEST_SKIP() << SmallDisk::kNeeded`.
  [[nodiscard]] bool is_mounted() const { return is_mounted_; }
  static constexpr const char* kNeeded = "needs the right to mount a small tmpfs";
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  bool is_mounted_ = false;
};

}  // namespace ptin::test
