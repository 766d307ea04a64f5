// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file/mapped_file.h"

#include <algorithm>

#include <boost/interprocess/exceptions.hpp>
#include <sys/mman.h>
#include <unistd.h>

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

void MappedFile::will_need(std::uint64_t offset, std::uint64_t bytes) const noexcept {
  static const std::uint64_t kSystemPage = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  const std::uint64_t begin = offset & ~(kSystemPage - 1);
  auto* address = static_cast<std::byte*>(region_.get_address());
  // The kernel cuts one call short at its read-ahead limit, commonly 128 KiB, and faults in the
  // rest page by page.
  constexpr std::uint64_t kStep = std::uint64_t{128} << 10;
  for (std::uint64_t at = begin; at < offset + bytes; at += kStep) {
    ::madvise(address + at, static_cast<std::size_t>(std::min(kStep, offset + bytes - at)),
              MADV_WILLNEED);
  }
}

void MappedFile::report_damage() const {
  throw Error(ErrorCode::corruption, "the file was cut short while it was open; open it again",
              path_);
}

}  // namespace ptin
