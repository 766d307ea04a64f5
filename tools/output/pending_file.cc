// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output/pending_file.h"

#include <array>
#include <filesystem>
#include <utility>

#include <unistd.h>

#include "tools/output/companion_files.h"
#include "tools/output/output_file.h"
#include "tools/refused_memory.h"

namespace ptin::tools {

namespace {

constexpr std::array kSideFiles = {"-journal", "-wal",     "-shm",         ".aux.xml",
                                   ".ovr",     ".ovr.tmp", ".msk.ovr.tmp", ".warped.tif.tmp"};

}  // namespace

PendingFile::PendingFile(std::string path, bool overwrite)
    : path_(std::move(path)),
      target_(target_of(path_, overwrite)),
      temporary_(target_ + ".tmp" + std::to_string(getpid()) +
                     std::filesystem::path(path_).extension().string(),
                 kSideFiles),
      overwrite_(overwrite) {}

void PendingFile::publish() {
  require_memory_given(path_);
  if (overwrite_) remove_companions(target_);
  move_into_place(temporary_.path(), target_, overwrite_);
  temporary_.keep();
  temporary_.remove();  // the side files
}

}  // namespace ptin::tools
