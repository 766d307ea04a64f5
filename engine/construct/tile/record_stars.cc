// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/record_stars.h"

#include <utility>

#include "engine/large_array.h"

namespace ptin {

void RecordStars::reserve(std::size_t stars) {
  reserve_large(corners, 6 * stars);
  reserve_large(successors, 6 * stars);
  reserve_large(ring_end, stars);
}

StarredRecords starred_records(std::vector<VertexSplit>&& records, std::size_t first,
                               RecordStars&& stars) {
  RecordStars own = std::move(stars);
  std::vector<float> errors;  // close together, since they are asked for in any order
  errors.reserve(records.size());
  for (const VertexSplit& r : records) {
    errors.push_back(r.error);
  }
  set_deaths(own.corners, own.successors,
             [&](std::uint32_t successor) { return errors[successor]; });
  StarredRecords result;
  result.corners = std::move(own.corners);
  records.erase(records.begin(), records.begin() + static_cast<std::ptrdiff_t>(first));
  result.splits = std::move(records);
  result.ring_end = std::move(own.ring_end);
  result.ring_end.insert(result.ring_end.begin(), result.size() - result.ring_end.size(), 0);
  return result;
}

}  // namespace ptin
