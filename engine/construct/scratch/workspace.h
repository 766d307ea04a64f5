// SPDX-License-Identifier: GPL-3.0-or-later
//
// The folder of a build in the making: beside the output, named after it, gone when it is done.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/construct/scratch/manifest.h"
#include "storage/file/file_layer.h"

namespace ptin {

/// What to do with a build of this output that was interrupted.
enum class Unfinished : std::uint8_t {
  kRefuse,   ///< Say so, and how to go on.
  kResume,   ///< Go on with it; begin when there is none.
  kDiscard,  ///< Remove it, and begin anew.
};

/// `.NAME.ptin-build` in the output's folder holds the manifest and the pages of the output, since
/// those are renamed in the end. Other temporary files lie there too, or in a folder of their own
/// in `tmp`. Locked while in use; unlocked by the system when the process dies.
class Workspace {
 public:
  /// Takes the folder of a build, or makes it, and locks it.
  /// @param output       The file to be built.
  /// @param tmp          A folder for temporary files; "" for beside the output.
  /// @param fingerprint  What decides the bytes of the output: options and inputs. An interrupted
  ///                     build is taken up again only where it is the same.
  /// @throws Error invalid_argument  an interrupted build is there and `unfinished` is kRefuse, or
  ///                                 it is of another input or other options; another process is
  ///                                 at it; a folder of that name is not one of ours
  ///               not_found, io_error, resource_exhausted
  Workspace(FileLayer& files, const std::string& output, const std::string& tmp,
            Unfinished unfinished, const nlohmann::json& fingerprint);
  ~Workspace();
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  /// The constructor's refusal where `unfinished` is kRefuse, before a source is read.
  /// @throws Error invalid_argument  an interrupted build of `output` is there
  static void refuse_unfinished(const std::string& output);
  /// Where the build of `output` has its folder.
  [[nodiscard]] static std::string folder_of(const std::string& output);
  /// Removes an interrupted build of `output`; false when there is none.
  /// @throws Error io_error; invalid_argument when another process is at it, or the folder is not
  ///               one of ours
  static bool discard(FileLayer& files, const std::string& output);

  [[nodiscard]] const std::string& folder() const noexcept { return folder_; }
  [[nodiscard]] std::string temporary(const std::string& name) const { return tmp_ + "/" + name; }
  [[nodiscard]] const std::string& temporary_folder() const noexcept { return tmp_; }
  [[nodiscard]] FileLayer& files() const noexcept { return files_; }
  /// What an interrupted build had done, without the line of the workspace itself.
  [[nodiscard]] std::vector<nlohmann::json> lines() const;
  void append(const std::vector<nlohmann::json>& lines);
  /// True when there is something that a resumed build need not do again.
  [[nodiscard]] bool has_work() const noexcept { return has_work_; }
  /// Makes the names of new files durable. @throws Error io_error
  void sync_names();

  /// Removes a temporary file, if it is there. @throws Error io_error
  void remove(const std::string& name);
  /// Removes the folder and all that is in it. @throws Error io_error
  void remove_all();

 private:
  class Lock;
  void lock_folder();
  void begin(const nlohmann::json& fingerprint);
  void take_up(const nlohmann::json& fingerprint);
  void take_tmp(std::uint64_t owner);

  FileLayer& files_;
  std::string folder_, tmp_;
  std::unique_ptr<Lock> lock_;
  std::unique_ptr<Manifest> manifest_;
  bool has_work_ = false;
  bool is_tmp_ours_ = false;
};

}  // namespace ptin
