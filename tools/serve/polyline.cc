// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/polyline.h"

#include <cmath>
#include <cstdint>

#include "tools/http/problem.h"

namespace ptin::serve {

namespace {

[[noreturn]] void throw_broken() {
  throw http::Problem(400, "this is neither latitude,longitude nor an encoded polyline")
      .at("locations");
}

/// The next number, with its sign in the lowest bit.
std::int64_t next_number(std::string_view& text) {
  constexpr unsigned kFirst = 63, kMore = 0x20, kBits = 5, kMostBits = 30;
  std::uint64_t number = 0;
  for (unsigned shift = 0;; shift += kBits) {
    if (text.empty() || shift > kMostBits) throw_broken();
    const unsigned c = static_cast<unsigned char>(text.front());
    text.remove_prefix(1);
    if (c < kFirst || c >= kFirst + 2 * kMore) throw_broken();
    const unsigned bits = c - kFirst;
    number |= static_cast<std::uint64_t>(bits % kMore) << shift;
    if (bits < kMore) break;
  }
  const auto half = static_cast<std::int64_t>(number >> 1U);
  return (number & 1U) != 0 ? ~half : half;
}

}  // namespace

std::vector<MapPoint> decode_polyline(std::string_view text) {
  constexpr double kUnitsOfDegree = 1e5;  // Divided by, so that -11830000 is -118.3 to the bit.
  std::vector<MapPoint> places;
  std::int64_t lat = 0, lng = 0;
  while (!text.empty()) {
    lat += next_number(text);
    lng += next_number(text);
    const MapPoint place{static_cast<double>(lng) / kUnitsOfDegree,
                         static_cast<double>(lat) / kUnitsOfDegree};
    if (std::abs(place.y) > 90 || std::abs(place.x) > 180) throw_broken();
    places.push_back(place);
  }
  return places;
}

}  // namespace ptin::serve
