// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/scratch/workspace.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <utility>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/construct/scratch/build_difference.h"
#include "engine/error.h"
#include "storage/file/checksum.h"
#include "storage/file/file_questions.h"

namespace ptin {

namespace {

namespace fs = std::filesystem;

/// Times that a folder may vanish under us while others build and discard the same output.
constexpr int kMostTries = 100;

std::string manifest_in(const std::string& folder) { return folder + "/manifest"; }
/// In a folder in `--tmp`: holds the path of the folder beside the output that it belongs to.
std::string owner_in(const std::string& folder) { return folder + "/owner"; }
std::string whole_path(const std::string& path) {
  return fs::path(absolute_path(path)).lexically_normal().string();
}

bool is_empty_but_for(const std::string& folder, const std::string& name) {
  const std::vector<std::string> paths = paths_in(folder);
  return std::all_of(paths.begin(), paths.end(),
                     [&](const std::string& path) { return path == name; });
}

/// A name that looks like ours proves nothing, and everything in a folder is removed in the end: so
/// a folder that holds something else is refused.
void require_ours(bool is_ours, const std::string& folder) {
  if (!is_ours) {
    throw Error(
        ErrorCode::invalid_argument,
        "this folder has the name of one for temporary files, and nothing in it tells that it "
        "is one; move it away, or remove it where it is left of a build",
        folder);
  }
}

/// Refuses a manifest that says nothing beside files that are there: it is another's, or damaged.
void require_empty_beside(const Manifest& manifest, const std::string& folder) {
  if (is_empty_but_for(folder, manifest_in(folder))) {
    return;
  }
  require_ours(manifest.has_more(), folder);
  throw Error(
      ErrorCode::corruption,
      "the manifest that tells whose files these are is damaged, so that neither --resume nor "
      "--discard touches them; where they are of an unfinished build, remove this folder",
      folder);
}

std::uint64_t checksum_of_text(const std::string& text) {
  return checksum_of(std::as_bytes(std::span(text)));
}

/// True for a folder in `--tmp` that belongs to the workspace with this owner; or that holds
/// nothing yet, left by a build that was killed early.
/// @param owner  Checksum of the path that the workspace had when its build began.
bool is_owned(const std::string& tmp, std::uint64_t owner) {
  std::ifstream file(owner_in(tmp));
  std::string path;
  return (std::getline(file, path, '\0') && checksum_of_text(path) == owner) ||
         is_empty_but_for(tmp, owner_in(tmp));
}
/// The owner that a manifest names.
std::uint64_t owner_of(const nlohmann::json& first, const std::string& folder) {
  return first.value("owner", checksum_of_text(whole_path(folder)));
}

/// The folder of temporary files that a manifest names. Where there is none in `--tmp`, it is the
/// folder of the manifest, however the output was named, and wherever that is now.
std::string tmp_of(const nlohmann::json& first, const std::string& folder) {
  const std::string tmp = first.value("tmp", folder);
  return checksum_of_text(whole_path(tmp)) == owner_of(first, folder) ? folder : tmp;
}

void write_owner(FileLayer& files, const std::string& tmp, const std::string& folder) {
  const std::string owner = whole_path(folder);
  const int failure = files.unlink(owner_in(tmp));  // of a build that was killed early
  if (failure != 0 && failure != ENOENT) {
    throw system_error(failure, "cannot remove a temporary file", owner_in(tmp));
  }
  ScratchFile file(files, owner_in(tmp), ScratchFile::Kept::kNew);
  file.write_at(std::as_bytes(std::span(owner)), 0);
  file.sync();
}

/// A folder in `tmp` that no other output uses.
std::string folder_in_tmp(const std::string& output, const std::string& tmp) {
  const std::string whole = absolute_path(output);
  return absolute_path(tmp) + "/." + fs::path(whole).filename().string() + ".ptin-build-" +
         std::to_string(checksum_of_text(whole));
}

void make_folder(FileLayer& files, const std::string& path) {
  const int failure = files.make_folder(path);
  if (failure != 0 && failure != EEXIST) {
    throw system_error(failure, "cannot create a folder for temporary files", path);
  }
}

void remove_file(FileLayer& files, const std::string& name) {
  const int failure = files.unlink(name);
  if (failure != 0 && failure != ENOENT) {
    throw system_error(failure, "cannot remove a temporary file", name);
  }
}

/// Removes a folder of ours with its files. Does nothing where there is no such folder.
void remove_folder(FileLayer& files, const std::string& path) {
  const auto tells_whose = [&](const std::string& n) {
    return n == manifest_in(path) || n == owner_in(path);
  };
  // The manifest goes last, when nothing else is there: without it nobody would know what the rest is. A
  // process that worked here may add a file meanwhile.
  std::vector<std::string> names{path};
  for (int i = 0; i < kMostTries && !names.empty(); ++i) {
    names.clear();
    std::error_code ignored;  // what cannot be listed cannot be removed either, which says why
    for (fs::directory_iterator entry(path, ignored); !ignored && entry != fs::directory_iterator();
         entry.increment(ignored)) {
      names.push_back(entry->path().string());
    }
    std::erase_if(names, tells_whose);
    for (const std::string& name : names) {
      remove_file(files, name);
    }
  }
  remove_file(files, owner_in(path));
  remove_file(files, manifest_in(path));
  const int failure = files.remove_folder(path);
  if (failure != 0 && failure != ENOENT) {
    throw system_error(failure, "cannot remove the folder of temporary files", path);
  }
}

/// The JSON as it is after it has been written and read: NaN becomes null, and bytes that are no
/// UTF-8 are replaced.
nlohmann::json as_read_back(const nlohmann::json& value) {
  return nlohmann::json::parse(
      value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

nlohmann::json first_line(const nlohmann::json& fingerprint, const std::string& tmp,
                          const std::string& folder) {
  return {{"ptin_build", 1},
          {"of", fingerprint},
          {"tmp", whole_path(tmp)},
          {"owner", checksum_of_text(whole_path(folder))}};
}

}  // namespace

/// An exclusive lock on the folder, held while this object lives.
class Workspace::Lock {
 public:
  /// Null when the folder is not there, or was removed while we waited for it.
  static std::unique_ptr<Lock> of(const std::string& folder) {
    std::unique_ptr<Lock> lock(new Lock());
    const int fd = lock->fd_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0 && errno == ENOENT) {
      return nullptr;
    }
    if (fd < 0) {
      throw system_error(errno, "cannot open the folder of temporary files", folder);
    }
    if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
      throw Error(ErrorCode::invalid_argument, "another process is building this output right now",
                  folder);
    }
    // Who had the lock before may have removed the folder, and a third process made it anew.
    struct stat ours {
    }, named{};
    const bool is_same = ::fstat(fd, &ours) == 0 && ::stat(folder.c_str(), &named) == 0 &&
                         ours.st_dev == named.st_dev && ours.st_ino == named.st_ino;
    return is_same ? std::move(lock) : nullptr;
  }
  ~Lock() {
    if (fd_ >= 0) {
      ::close(fd_);
    }
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  Lock() = default;
  int fd_ = -1;
};

std::string Workspace::folder_of(const std::string& output) {
  const fs::path path(output);
  const std::string parent = path.parent_path().string();
  return (parent.empty() ? "." : parent) + "/." + path.filename().string() + ".ptin-build";
}

bool Workspace::discard(FileLayer& files, const std::string& output) {
  const std::string folder = folder_of(output);
  const std::unique_ptr<Lock> lock = Lock::of(folder);
  if (!lock) {
    return false;
  }
  if (!is_there(manifest_in(folder))) {
    require_ours(paths_in(folder).empty(), folder);
    remove_folder(files, folder);
    return true;
  }
  std::string tmp = folder;
  std::uint64_t owner = 0;
  {
    const Manifest manifest(files, manifest_in(folder));
    if (manifest.entries().empty()) {
      require_empty_beside(manifest, folder);
    } else {
      tmp = tmp_of(manifest.entries().front(), folder);
      owner = owner_of(manifest.entries().front(), folder);
    }
  }
  if (tmp != folder && is_there(tmp)) {
    require_ours(is_owned(tmp, owner), tmp);
    remove_folder(files, tmp);
  }
  remove_folder(files, folder);
  return true;
}

/// Makes the folder where there is none, and locks it.
void Workspace::lock_folder() {
  for (int i = 0; lock_ == nullptr; ++i) {
    if (i == kMostTries) {
      throw Error(ErrorCode::io_error, "the folder of temporary files vanishes whenever it is made",
                  folder_);
    }
    make_folder(files_, folder_);
    lock_ = Lock::of(folder_);
  }
}

/// Locks the folder and opens its manifest.
/// @param tmp  A folder that is there, for the one in it; "" for none.
void Workspace::open_manifest(const std::string& output, const std::string& tmp) {
  const std::string manifest = manifest_in(folder_);
  lock_folder();
  if (!is_there(manifest)) {
    require_ours(paths_in(folder_).empty(), folder_);
  }
  manifest_ = std::make_unique<Manifest>(files_, manifest);
  if (!tmp.empty()) {
    tmp_ = folder_in_tmp(output, tmp);
  }
  if (manifest_->entries().empty()) {
    require_empty_beside(*manifest_, folder_);
  }
}

/// Removes the folder where nothing was begun in it: it holds nothing, or an empty manifest.
void Workspace::drop_unbegun() const {
  const int fd = lock_ ? -1 : ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ || (fd >= 0 && ::flock(fd, LOCK_EX | LOCK_NB) == 0)) {
    const std::string manifest = manifest_in(folder_);
    struct stat status {};
    if (::stat(manifest.c_str(), &status) == 0 && status.st_size == 0) {
      ::unlink(manifest.c_str());
    }
    ::rmdir(folder_.c_str());  // stays where it is not empty
  }
  if (fd >= 0) {
    ::close(fd);
  }
}

namespace {

Error unfinished_is_here(const std::string& output) {
  return {ErrorCode::invalid_argument,
          "an unfinished build of " + output +
              " is here; go on with it by --resume, or remove it by --discard",
          Workspace::folder_of(output)};
}

}  // namespace

void Workspace::refuse_unfinished(const std::string& output) {
  const std::string manifest = manifest_in(folder_of(output));
  if (is_there(manifest) && bytes_of_file(manifest) > 0) {
    throw unfinished_is_here(output);
  }
}

Workspace::Workspace(FileLayer& files, const std::string& output, const std::string& tmp,
                     Unfinished unfinished, const nlohmann::json& fingerprint)
    : files_(files), folder_(folder_of(output)), tmp_(folder_) {
  if (unfinished == Unfinished::kDiscard) {
    discard(files, output);
  }
  try {
    open_manifest(output, tmp);
  } catch (...) {
    drop_unbegun();
    throw;
  }
  if (manifest_->entries().empty()) {
    begin(fingerprint);
    return;
  }
  if (unfinished != Unfinished::kResume) {
    throw unfinished_is_here(output);
  }
  take_up(fingerprint);
}

/// Checks that the interrupted build is of the same inputs and options, and all there.
void Workspace::take_up(const nlohmann::json& fingerprint) {
  const nlohmann::json& first = manifest_->entries().front();
  const nlohmann::json begun_with =
      first.value("ptin_build", 0) == 1 ? first.value("of", nlohmann::json()) : nlohmann::json();
  if (const nlohmann::json now = as_read_back(fingerprint); begun_with != now) {
    throw Error(ErrorCode::invalid_argument,
                "the unfinished build here was begun with something else: " +
                    what_differs(begun_with, now) +
                    "; give what it was begun with, or remove it by --discard",
                folder_);
  }
  tmp_ = tmp_of(first, folder_);
  has_work_ = manifest_->entries().size() > 1;
  if (tmp_ == folder_) {
    return;
  }
  if (!has_work_) {  // killed early, perhaps before the folder was made
    take_tmp(owner_of(first, folder_));
    return;
  }
  if (!is_there(tmp_)) {
    throw Error(ErrorCode::not_found,
                "the temporary files of the unfinished build are not there; is their disk mounted? "
                "Where they are lost, start again after --discard",
                tmp_);
  }
  require_ours(is_owned(tmp_, owner_of(first, folder_)), tmp_);
}

/// Makes the folder in `--tmp`, or checks that the one there is ours.
void Workspace::take_tmp(std::uint64_t owner) {
  make_folder(files_, tmp_);
  require_ours(is_owned(tmp_, owner), tmp_);
  is_tmp_ours_ = true;
  write_owner(files_, tmp_, folder_);
}

/// Writes the first line of the manifest, which names the folder in `--tmp`, then makes that
/// folder: so whenever the process is killed, what it leaves can be found. An error leaves nothing
/// behind.
void Workspace::begin(const nlohmann::json& fingerprint) {
  try {
    manifest_->append({first_line(fingerprint, tmp_, folder_)});
    if (tmp_ != folder_) {
      take_tmp(checksum_of_text(whole_path(folder_)));
    }
    sync_names();
  } catch (...) {
    tmp_ = is_tmp_ours_ ? tmp_ : folder_;
    remove_all();
    throw;
  }
}

Workspace::~Workspace() = default;

std::vector<nlohmann::json> Workspace::lines() const {
  const std::vector<nlohmann::json>& all = manifest_->entries();
  return all.empty() ? all : std::vector<nlohmann::json>(all.begin() + 1, all.end());
}

void Workspace::append(const std::vector<nlohmann::json>& lines) {
  manifest_->append(lines);
  has_work_ = true;
}

void Workspace::sync_names() {
  const std::string parent = fs::path(folder_).parent_path().string();
  for (const std::string& folder : {folder_, tmp_, parent.empty() ? "." : parent}) {
    const int failure = files_.sync_folder(folder);
    if (failure != 0) {
      throw system_error(failure, "cannot sync", folder);
    }
  }
}

void Workspace::remove(const std::string& name) {
  const int failure = files_.unlink(temporary(name));
  if (failure != 0 && failure != ENOENT) {
    throw system_error(failure, "cannot remove a temporary file", temporary(name));
  }
}

void Workspace::remove_all() {
  manifest_.reset();
  if (tmp_ != folder_) {
    remove_folder(files_, tmp_);
  }
  remove_folder(files_, folder_);
}

}  // namespace ptin
