// SPDX-License-Identifier: GPL-3.0-or-later
//
// A file layer that fails, and what must hold when it does.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/error.h"
#include "storage/file/file_layer.h"
#include "tests/storage/store_fixture.h"

namespace ptin::test {

/// The code of the Error that `work` throws; none when it throws nothing.
inline std::optional<ErrorCode> code_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& e) {
    return e.code();
  }
  return std::nullopt;
}

/// Fails the n-th call; with `for_good`, all that follow too, but for those that clean up.
class FailingFiles final : public FileLayer {
 public:
  FailingFiles(int nth, int failure, bool for_good)
      : nth_(nth), failure_(failure), for_good_(for_good) {}

  [[nodiscard]] int calls() const { return calls_; }
  /// True when the first failure was one that no promise depends on: space could not be reserved
  /// ahead, or a side file could not be closed after the new file had its name.
  [[nodiscard]] bool was_harmless() const { return was_harmless_; }

  int create(const std::string& path, int& fd) noexcept override {
    return fails() ? failure_ : FileLayer::create(path, fd);
  }
  int open(const std::string& path, int& fd) noexcept override {
    return fails() ? failure_ : FileLayer::open(path, fd);
  }
  int create_nameless(const std::string& folder, int& fd) noexcept override {
    return fails() ? failure_ : FileLayer::create_nameless(folder, fd);
  }
  int close(int fd) noexcept override {
    const int result = FileLayer::close(fd);
    return fails(is_renamed_) ? failure_ : result;
  }
  int write_at(int fd, std::span<const std::byte> bytes, std::uint64_t offset,
               std::size_t& written) noexcept override {
    if (fails()) {
      // What a full disk does: a part is written, then the error comes.
      static_cast<void>(FileLayer::write_at(fd, bytes.first(bytes.size() / 2), offset, written));
      written = 0;
      return failure_;
    }
    return FileLayer::write_at(fd, bytes, offset, written);
  }
  int read_at(int fd, std::span<std::byte> bytes, std::uint64_t offset,
              std::size_t& read) noexcept override {
    return fails() ? failure_ : FileLayer::read_at(fd, bytes, offset, read);
  }
  int allocate(int fd, std::uint64_t offset, std::uint64_t bytes) noexcept override {
    return fails(failure_ != ENOSPC) ? failure_ : FileLayer::allocate(fd, offset, bytes);
  }
  int size(int fd, std::uint64_t& bytes) noexcept override {
    return fails() ? failure_ : FileLayer::size(fd, bytes);
  }
  int truncate(int fd, std::uint64_t bytes) noexcept override {
    return fails() ? failure_ : FileLayer::truncate(fd, bytes);
  }
  int sync(int fd) noexcept override { return fails() ? failure_ : FileLayer::sync(fd); }
  int rename(const std::string& from, const std::string& to, bool replace) noexcept override {
    if (fails()) {
      return failure_;
    }
    is_renamed_ = true;
    return FileLayer::rename(from, to, replace);
  }
  int unlink(const std::string& path) noexcept override {
    return calls_ < nth_ && fails() ? failure_ : FileLayer::unlink(path);
  }
  int sync_folder(const std::string& path) noexcept override {
    return fails() ? failure_ : FileLayer::sync_folder(path);
  }

 private:
  bool fails(bool harmless = false) noexcept {
    ++calls_;
    if (calls_ == nth_) {
      was_harmless_ = harmless;
    }
    return for_good_ ? calls_ >= nth_ : calls_ == nth_;
  }
  int nth_, failure_;
  bool for_good_;
  int calls_ = 0;
  bool is_renamed_ = false;
  bool was_harmless_ = false;
};

/// A disk that may be without power: what truncate() cuts off is remembered until the file is
/// synced, and can be put back. With `renames` off no file gets its final name.
class PowerCutFiles final : public FileLayer {
 public:
  bool renames = true;

  int create(const std::string& path, int& fd) noexcept override;
  int open(const std::string& path, int& fd) noexcept override;
  int truncate(int fd, std::uint64_t bytes) noexcept override;
  int sync(int fd) noexcept override;
  int rename(const std::string& from, const std::string& to, bool replace) noexcept override {
    return renames ? FileLayer::rename(from, to, replace) : EIO;
  }
  /// Undoes the cuts of this file that no sync() followed. REQUIRES: it is not open.
  void lose_cuts(const std::string& path);

 private:
  struct Cut {
    std::uint64_t at = 0;
    std::vector<std::byte> tail;
  };
  std::map<int, std::string> names_;
  std::map<std::string, Cut> cuts_;
};

/// Publishes `content` over an older file, with each call of the file layer failing in turn: the
/// result is the old file or the new one, and no other file.
/// @param step  Each so many calls one fails, the last among them.
void expect_old_or_new(const StoreContent& content, int step = 1);

}  // namespace ptin::test
