// SPDX-License-Identifier: GPL-3.0-or-later
//
// The fuzz targets of readers of TINs: bytes of any kind are read as a TIN whose indices are in
// range, or refused with an Error that names a place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "engine/construct/read/tin_file.h"
#include "engine/error.h"
#include "tests/support/read_soup.h"

namespace ptin::fuzz {

/// Aborts where `read` breaks its promise. Always 0, as libFuzzer wants it.
inline int fuzz_reader(TinReader& read, const std::uint8_t* data, std::size_t size) {
  ByteReader in("fuzz", std::string(reinterpret_cast<const char*>(data), size));
  try {
    const test::TinSoup soup = test::read_soup(read, in, {});
    for (const auto& t : soup.triangles) {
      for (const std::uint32_t v : t) {
        if (v >= soup.vertices.size()) std::abort();
      }
    }
    for (const auto& q : soup.quads) {
      for (const std::uint32_t v : q) {
        if (v >= soup.vertices.size()) std::abort();
      }
    }
    if (soup.triangles.size() + soup.quads.size() == 0 || soup.vertices.size() > size) std::abort();
  } catch (const Error& e) {
    if (e.code() != ErrorCode::invalid_argument || !e.context().starts_with("fuzz")) {
      std::abort();
    }
  }
  return 0;
}

}  // namespace ptin::fuzz
