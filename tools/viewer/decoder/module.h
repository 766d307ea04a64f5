// SPDX-License-Identifier: GPL-3.0-or-later
//
// The means that both modules (decoder.cc, questions.cc) have to talk to their host: exported functions, refusals, and the
// facts of a terrain in an order that the host knows.
//
// Errors: these builds have no exceptions to catch, so `throw` ends in __cxa_throw() (module.cc). That hands code and text to
// the host, whose function throws in its own language and so leaves the module for good.
#pragma once

#include <cstdint>
#include <type_traits>

#include "engine/mesh/tin.h"
#include "storage/store_facts.h"

#define PTIN_EXPORT(name) extern "C" __attribute__((export_name(#name)))

namespace ptin::viewer {

/// The mesh that the module holds and exports (module.cc), as engine/mesh/tin.h has it in memory.
[[nodiscard]] const Tin& tin();

/// Facts in the order in which src/decoder.ts reads them, and src/questions.ts hands them on.
struct PlainFacts {
  double origin_x, origin_y, step_x, step_y;
  double height_is_float, height_step, height_offset;
  double min_x, min_y, max_x, max_y;
  double min_height, max_height, base_error, base_deviation;
};
static_assert(sizeof(PlainFacts) == 15 * sizeof(double) && std::is_trivial_v<PlainFacts>);

[[nodiscard]] inline PlainFacts plain(const StoreFacts& f) {
  return {f.map.origin_x,
          f.map.origin_y,
          f.map.step_x,
          f.map.step_y,
          f.heights.type == HeightType::float32 ? 1.0 : 0.0,
          f.heights.step,
          f.heights.offset,
          static_cast<double>(f.bounds.min_x),
          static_cast<double>(f.bounds.min_y),
          static_cast<double>(f.bounds.max_x),
          static_cast<double>(f.bounds.max_y),
          f.min_height,
          f.max_height,
          f.base_error,
          f.base_deviation};
}

/// The facts again. Numbers of samples and bytes of a page stay behind: no question of a mesh needs them.
[[nodiscard]] inline StoreFacts facts_of(const PlainFacts& p) {
  StoreFacts facts;
  facts.map = {p.origin_x, p.origin_y, p.step_x, p.step_y};
  facts.heights = {p.height_is_float != 0 ? HeightType::float32 : HeightType::int32, p.height_step,
                   p.height_offset};
  facts.bounds = {static_cast<std::int32_t>(p.min_x), static_cast<std::int32_t>(p.min_y),
                  static_cast<std::int32_t>(p.max_x), static_cast<std::int32_t>(p.max_y)};
  facts.min_height = p.min_height;
  facts.max_height = p.max_height;
  facts.base_error = p.base_error;
  facts.base_deviation = p.base_deviation;
  return facts;
}

}  // namespace ptin::viewer
