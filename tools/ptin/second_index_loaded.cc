// SPDX-License-Identifier: GPL-3.0-or-later
//
// The second index of the program: loaded when it is asked for, so that nobody else needs
// libspatialindex.
#include <filesystem>
#include <string>
#include <system_error>

#include <dlfcn.h>

#include "engine/error.h"
#include "tools/second_index.h"

namespace ptin::tools {

namespace {

using Open = RecordIndex*(const std::shared_ptr<const StoreFile>&, const SpatialIndexOptions&);

/// The function of second_index.so, which stays loaded: the code of indexes lies in it. It is found
/// by where the program lies, never in the current folder.
Open* load() {
  std::error_code fault;
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", fault);
  const std::string path =
      (here.parent_path() / PTIN_WHOLE_FOLDER / "second_index.so").lexically_normal().string();
  void* const module = fault ? nullptr : ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const open = module != nullptr ? ::dlsym(module, "ptin_open_second_index") : nullptr;
  if (open == nullptr) {
    const char* const why = fault ? "mount /proc" : ::dlerror();
    throw Error(ErrorCode::not_found,
                "the second index needs libspatialindex (Debian's libspatialindex6): " +
                    std::string(why != nullptr ? why : "there is another version of it"));
  }
  return reinterpret_cast<Open*>(open);
}

}  // namespace

std::unique_ptr<RecordIndex> open_second_index(const std::shared_ptr<const StoreFile>& store,
                                               const SpatialIndexOptions& options) {
  static Open* const open = load();
  return std::unique_ptr<RecordIndex>(open(store, options));
}

}  // namespace ptin::tools
