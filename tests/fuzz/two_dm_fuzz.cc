// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bytes of any kind are read as a TIN whose indices are in range, or refused with an Error that
// names a place.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "engine/construct/tin_soup.h"
#include "engine/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ptin::ByteReader in("fuzz", std::string(reinterpret_cast<const char*>(data), size));
  try {
    const ptin::TinSoup soup = ptin::read_soup(ptin::read_two_dm, in, {});
    for (const auto& t : soup.triangles) {
      for (const std::uint32_t v : t) {
        if (v >= soup.vertices.size()) std::abort();
      }
    }
    if (soup.triangles.empty() || soup.vertices.size() > size) std::abort();
  } catch (const ptin::Error& e) {
    if (e.code() != ptin::ErrorCode::invalid_argument || !e.context().starts_with("fuzz")) {
      std::abort();
    }
  }
  return 0;
}
