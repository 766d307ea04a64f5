// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file/mapped_file.h"

#include <boost/interprocess/exceptions.hpp>
#include <sys/mman.h>

#include "engine/error.h"

namespace ptin {

namespace ip = boost::interprocess;

namespace {

ip::mapped_region mapped(const ReadOnlyFile& file) {
  try {
    return {file.mapping(), ip::read_only, 0, static_cast<std::size_t>(file.bytes())};
  } catch (const ip::interprocess_exception& e) {
    throw system_error(e.get_native_error(), "cannot map the file into memory", file.path());
  }
}

}  // namespace

MappedFile::MappedFile(const ReadOnlyFile& file)
    : path_(file.path()), region_(mapped(file)), guard_(region_.get_address(), region_.get_size()) {
  ::madvise(region_.get_address(), region_.get_size(), MADV_RANDOM);
}

void MappedFile::report_damage() const {
  throw Error(ErrorCode::corruption, "the file was cut short while it was open; open it again",
              path_);
}

}  // namespace ptin
