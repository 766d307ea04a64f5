// SPDX-License-Identifier: GPL-3.0-or-later
//
// The fields that every answer has: how far it can be off, what was done to its region, its units,
// what it cost.
#pragma once

#include <optional>

#include "engine/crs/border_move.h"
#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "tools/ask/field.h"
#include "tools/region/straight_sides.h"

namespace ptin::ask {

struct AnswerFacts {
  double certified_error = 0.0, certified_deviation = 0.0;
  double border_moved_at_most = 0.0;  ///< Infinite where nothing bounds it.
  bool exact = false;
  const CrsFacts* crs = nullptr;
  /// What was done to lines or a polygon of another CRS; null where the question takes none.
  const std::optional<tools::Transformed>* transformed = nullptr;
  const QueryCost* cost = nullptr;  ///< Null: it is not told here.
};
/// The facts of a TIN with a certificate.
[[nodiscard]] inline AnswerFacts facts_of(const Certificate& certificate, bool exact,
                                          const StoreFile& store, const CrsFacts& crs) {
  return {certificate.error, certificate.deviation, border_moved_at_most(store, certificate.error),
          exact, &crs};
}
/// The facts of a result, which outlives them, as does `crs`.
template <typename Result>
[[nodiscard]] AnswerFacts facts_of(const Result& result, const StoreFile& store,
                                   const CrsFacts& crs,
                                   const std::optional<tools::Transformed>* transformed = nullptr) {
  AnswerFacts facts =
      facts_of({result.certified_error, result.certified_deviation}, result.exact, store, crs);
  facts.transformed = transformed;
  facts.cost = &result.cost;
  return facts;
}

/// How far a TIN can be off; the fields of all answers, which begin so.
[[nodiscard]] Fields<AnswerFacts> certificate_fields();
[[nodiscard]] Fields<AnswerFacts> answer_fields();
/// The cost of an answer, and the names of a terrain's units, by themselves.
[[nodiscard]] Json cost_json(const QueryCost& cost);
[[nodiscard]] Json units_json(const CrsFacts& crs);

}  // namespace ptin::ask
