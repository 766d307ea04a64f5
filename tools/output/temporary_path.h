// SPDX-License-Identifier: GPL-3.0-or-later
//
// Names of temporary files and folders, which are gone when the program ends, even where it ends
// because the system refuses memory.
#pragma once

#include <span>
#include <string>

namespace ptin::tools {

/// A file or a folder with files that does not stay: removed by the destructor, with what lies
/// beside it. Neither that nor remove_temporary_paths() allocates by operator new, so both work
/// where memory is refused.
class TemporaryPath {
 public:
  /// Made before the file is, so that nothing comes between.
  /// @param beside  What follows its name in those of the files beside it; outlives the object.
  explicit TemporaryPath(std::string path, std::span<const char* const> beside = {}) noexcept;
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;
  ~TemporaryPath();

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// It has another name now, under which it stays. What lies beside it goes all the same.
  void keep() noexcept { is_kept_ = true; }
  /// Removes it now, as the destructor would.
  void remove() const noexcept;

 private:
  std::string path_;
  std::span<const char* const> beside_;
  bool is_kept_ = false;
};

/// Removes all that the living TemporaryPaths name: the last thing that a program does which ends
/// without destructors. At most 32 of them are known to it.
void remove_temporary_paths() noexcept;

}  // namespace ptin::tools
