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
  kRefuse,   ///< Throw an error that says how to go on.
  kResume,   ///< Go on with it; begin a build when there is none.
  kDiscard,  ///< Remove it, and begin anew.
};

/// The folder `.NAME.ptin-build` beside the output. It holds the manifest and the pages of the
/// output, which are renamed in the end and so must be on the same disk. Other temporary files lie
/// there too, or in a folder of their own in `tmp`. The folder is locked while a process works in
/// it; the system unlocks it when the process dies.
class Workspace {
 public:
  /// Takes the folder of a build, or makes it, and locks it.
  /// @param output       The file to be built.
  /// @param tmp          A folder for temporary files; "" for beside the output. An interrupted
  ///     build goes on in the one that it began with.
  /// @param fingerprint  What decides the bytes of the output: options and inputs. An interrupted
  ///     build is taken up again only where it is the same.
  /// @throws Error invalid_argument  an interrupted build is there and `unfinished` is kRefuse, or
  ///     it is of another input or other options; another process is at it; a folder of that name
  ///     is not one of ours
  /// @throws Error not_found, io_error, resource_exhausted
  Workspace(FileLayer& files, const std::string& output, const std::string& tmp,
            Unfinished unfinished, const nlohmann::json& fingerprint);
  ~Workspace();
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  /// Refuses as the constructor does with kRefuse, but before a source is read.
  /// @throws Error invalid_argument  an interrupted build of `output` is there
  static void refuse_unfinished(const std::string& output);
  /// Path of the folder of a build of `output`.
  [[nodiscard]] static std::string folder_of(const std::string& output);
  /// Removes an interrupted build of `output`; false when there is none.
  /// @throws Error io_error; invalid_argument when another process is at it, or the folder is not
  ///               one of ours
  static bool discard(FileLayer& files, const std::string& output);

  [[nodiscard]] const std::string& folder() const noexcept { return folder_; }
  [[nodiscard]] std::string temporary(const std::string& name) const { return tmp_ + "/" + name; }
  [[nodiscard]] const std::string& temporary_folder() const noexcept { return tmp_; }
  [[nodiscard]] FileLayer& files() const noexcept { return files_; }
  /// The entries that the manifest had when it was opened, but for the first, which is of the
  /// workspace itself.
  [[nodiscard]] std::vector<nlohmann::json> lines() const;
  /// Writes lines to the manifest, as one group.  @throws Error as Manifest::append
  void append(const std::vector<nlohmann::json>& lines);
  /// True when the manifest has more than the line of the workspace: work that a resumed build need
  /// not do again.
  [[nodiscard]] bool has_work() const noexcept { return has_work_; }
  /// Makes the names of new files durable: those in the folder, in the one in `tmp`, and beside the
  /// output.
  /// @throws Error io_error
  void sync_names();

  /// Removes a temporary file, if it is there. @throws Error io_error
  void remove(const std::string& name);
  /// Removes the folder, and the one in `tmp`, with all that is in them. @throws Error io_error
  void remove_all();

 private:
  class Lock;
  void lock_folder();
  void open_manifest(const std::string& output, const std::string& tmp);
  void drop_unbegun() const;
  void begin(const nlohmann::json& fingerprint);
  void take_up(const nlohmann::json& fingerprint);
  void take_tmp(std::uint64_t owner);

  FileLayer& files_;
  std::string folder_, tmp_;
  std::unique_ptr<Lock> lock_;
  std::unique_ptr<Manifest> manifest_;
  bool has_work_ = false;
  bool is_tmp_ours_ = false;  ///< The folder in `tmp` was found to be ours, or made.
};

}  // namespace ptin
