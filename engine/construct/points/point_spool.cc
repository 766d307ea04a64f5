// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_spool.h"

namespace ptin {

void SpoolWriter::add(const SourcePoint& p) {
  for (const Decimal& number : {p.x, p.y, p.z}) {
    mantissas_.push_back(number.mantissa);
    decimals_.push_back(static_cast<std::uint8_t>(number.decimals));
  }
  if (mantissas_.size() == 3 * kSpoolBlock) {
    flush();
  }
}

void SpoolWriter::flush() {
  file_.values(mantissas_, decimals_);
  mantissas_.clear();
  decimals_.clear();
}

ArrayFileFacts SpoolWriter::finish() {
  if (!mantissas_.empty()) {
    flush();
  }
  return file_.finish();
}

void skip_blocks(ArrayFileReader& spool, std::uint64_t blocks) {
  for (std::uint64_t array = 0; array < 2 * blocks; ++array) {
    spool.skip();
  }
}

void read_block(ArrayFileReader& spool, std::vector<SourcePoint>& points) {
  const auto mantissas = spool.take<std::int64_t>();
  const auto decimals = spool.take<std::uint8_t>();
  const auto number = [&](std::size_t i) { return Decimal{mantissas[i], decimals[i]}; };
  points.clear();
  for (std::size_t i = 0; i + 2 < mantissas.size(); i += 3) {
    points.push_back({number(i), number(i + 1), number(i + 2)});
  }
  spool.require_undamaged();
}

}  // namespace ptin
