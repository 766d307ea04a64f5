// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output/pending_file.h"

#include <filesystem>

#include <unistd.h>

#include "tools/output/companion_files.h"
#include "tools/output/output_file.h"

namespace ptin::tools {

PendingFile::PendingFile(std::string path, bool overwrite)
    : path_(std::move(path)), overwrite_(overwrite) {
  check_output(path_, overwrite_);
  target_ = output_target(path_);
  temporary_ = target_ + ".tmp" + std::to_string(getpid()) +
               std::filesystem::path(path_).extension().string();
}

PendingFile::~PendingFile() {
  if (temporary_.empty()) return;
  unlink(temporary_.c_str());
  remove_side_files();
}

void PendingFile::remove_side_files() const noexcept {
  for (const char* beside : {"-journal", "-wal", "-shm", ".aux.xml", ".ovr", ".ovr.tmp",
                             ".msk.ovr.tmp", ".warped.tif.tmp"}) {
    unlink((temporary_ + beside).c_str());
  }
}

void PendingFile::publish() {
  if (overwrite_) remove_companions(target_);
  move_into_place(temporary_, target_, overwrite_);
  remove_side_files();  // Their names begin with the temporary one.
  temporary_.clear();
}

}  // namespace ptin::tools
