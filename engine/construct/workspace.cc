// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/workspace.h"

#include <cerrno>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <unistd.h>

#include "engine/error.h"
#include "storage/checksum.h"

namespace ptin {

namespace {

namespace fs = std::filesystem;

std::string manifest_in(const std::string& folder) { return folder + "/manifest"; }

/// A folder in `tmp` that no other output uses.
std::string temporary_folder(const std::string& output, const std::string& tmp) {
  const fs::path whole = fs::absolute(output);
  const std::string text = whole.string();
  const std::uint64_t name = checksum_of(std::as_bytes(std::span(text)));
  return fs::absolute(tmp).string() + "/." + whole.filename().string() + ".ptin-build-" +
         std::to_string(name);
}

void make_folder(FileLayer& files, const std::string& path) {
  const int failure = files.make_folder(path);
  if (failure != 0 && failure != EEXIST) {
    throw system_error(failure, "cannot create a folder for temporary files", path);
  }
}

/// Removes a folder of ours with its files; one that is not there is no fault.
void remove_folder(FileLayer& files, const std::string& path) {
  std::error_code ignored;
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, ignored)) {
    names.push_back(entry.path().string());
  }
  // The manifest goes last: without it nobody would know what the rest is.
  std::stable_partition(names.begin(), names.end(),
                        [&](const std::string& n) { return n != manifest_in(path); });
  for (const std::string& name : names) {
    const int failure = files.unlink(name);
    if (failure != 0 && failure != ENOENT) {
      throw system_error(failure, "cannot remove a temporary file", name);
    }
  }
  const int failure = files.remove_folder(path);
  if (failure != 0 && failure != ENOENT) {
    throw system_error(failure, "cannot remove the folder of temporary files", path);
  }
}

/// As it is when it has been written and read: NaN becomes null, and bytes that are no UTF-8 are
/// replaced.
nlohmann::json as_read_back(const nlohmann::json& json) {
  return nlohmann::json::parse(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

nlohmann::json first_line(const nlohmann::json& fingerprint, const std::string& tmp) {
  return {{"ptin_build", 1}, {"of", fingerprint}, {"tmp", tmp}};
}

}  // namespace

/// An exclusive lock on the folder, for as long as this lives.
class Workspace::Lock {
 public:
  explicit Lock(const std::string& folder)
      : fd_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (fd_ < 0) {
      throw system_error(errno, "cannot open the folder of temporary files", folder);
    }
    if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      ::close(fd_);
      throw Error(ErrorCode::invalid_argument, "another process is building this output right now",
                  folder);
    }
  }
  ~Lock() { ::close(fd_); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  int fd_;
};

std::string Workspace::folder_of(const std::string& output) {
  const fs::path path(output);
  const std::string parent = path.parent_path().string();
  return (parent.empty() ? "." : parent) + "/." + path.filename().string() + ".ptin-build";
}

bool Workspace::discard(FileLayer& files, const std::string& output) {
  const std::string folder = folder_of(output);
  if (!fs::exists(folder)) {
    return false;
  }
  const Lock lock(folder);
  if (fs::exists(manifest_in(folder))) {
    const Manifest manifest(files, manifest_in(folder));
    if (!manifest.entries().empty()) {
      remove_folder(files, manifest.entries().front().value("tmp", folder));
    }
  }
  if (fs::exists(folder)) {
    remove_folder(files, folder);
  }
  return true;
}

Workspace::Workspace(FileLayer& files, const std::string& output, const std::string& tmp,
                     Unfinished unfinished, const nlohmann::json& fingerprint)
    : files_(files), folder_(folder_of(output)), tmp_(folder_) {
  if (unfinished == Unfinished::kDiscard) {
    discard(files, output);
  }
  make_folder(files_, folder_);
  lock_ = std::make_unique<Lock>(folder_);
  manifest_ = std::make_unique<Manifest>(files_, manifest_in(folder_));
  if (!tmp.empty()) {
    tmp_ = temporary_folder(output, tmp);
  }
  if (manifest_->entries().empty()) {
    begin(fingerprint);
    return;
  }
  if (unfinished != Unfinished::kResume) {
    throw Error(ErrorCode::invalid_argument,
                "an unfinished build of " + output +
                    " is here; go on with it by --resume, or remove it by --discard",
                folder_);
  }
  const nlohmann::json& first = manifest_->entries().front();
  if (first.value("ptin_build", 0) != 1 ||
      first.value("of", nlohmann::json()) != as_read_back(fingerprint)) {
    throw Error(ErrorCode::invalid_argument,
                "the unfinished build here is of other inputs or other options; repeat those, or "
                "remove it by --discard",
                folder_);
  }
  tmp_ = first.value("tmp", folder_);
  has_work_ = manifest_->entries().size() > 1;
  if (!fs::exists(tmp_)) {
    throw Error(ErrorCode::not_found,
                "the temporary files of the unfinished build are not there; is their disk mounted?",
                tmp_);
  }
}

/// The first line; until it is there, there is nothing to resume, and nothing stays behind.
void Workspace::begin(const nlohmann::json& fingerprint) {
  try {
    make_folder(files_, tmp_);
    manifest_->append({first_line(fingerprint, tmp_)});
    sync_names();
  } catch (...) {
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
