// SPDX-License-Identifier: GPL-3.0-or-later
//
// Levels of detail: the full TIN, a certified error, or the most important vertices (paper, M_t),
// turned once into what a question leaves out and into its certificate.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/query/select/accounting.h"
#include "engine/query/select/certificate.h"
#include "engine/query/select/retrieval.h"
#include "engine/query/select/total_order.h"

namespace ptin {

/// How finely a question looks at the terrain. Nothing given: the full TIN.
struct DetailRequest {
  /// Certified error allowed, in the height's unit, >= 0.
  std::optional<double> tolerance;
  /// The first so many vertices of the whole terrain in the total order (total_order.h), T0 and
  /// void ones counted: >= |T0|; more than there are means all. Excludes `tolerance`. Unlike
  /// RefineRequest::vertices, which counts within a region, this is one TIN wherever it is asked.
  std::optional<std::uint64_t> vertices;
};

/// A level of detail as questions use it: a TIN between T0 and the full one, the same wherever it
/// is asked. The records it keeps are closed under dependency, and so are those of them for which
/// a monotone predicate is true. Threads: immutable.
class Detail {
 public:
  /// The full TIN.
  explicit Detail(const StoreFile& store) : certificate_(certify_below(store, -1.0)) {}

  /// @throws Error invalid_argument    tolerance negative or NaN; both given; fewer vertices than
  ///                                   T0
  ///               resource_exhausted  the last bin of errors exceeds the memory limit
  ///               corruption, io_error, cancelled
  /// Cost: none but for `vertices`: reads the pages with errors as large as the last vertex's, of
  /// the whole terrain; memory for the vertices whose error is within an eighth of an octave of it.
  Detail(const DetailRequest& request, const RecordSource& source, QueryContext& context);

  /// Records of error at or below it are left out: for predicates of pages and records, before
  /// keep(). Negative: none are.
  [[nodiscard]] double tolerance() const noexcept { return tolerance_; }
  /// True when the level keeps the record.
  [[nodiscard]] bool keeps(const PendingSplit& split) const noexcept {
    return split.error > tolerance_ && (!last_ || !is_behind(split));
  }
  /// Drops the splits that the level leaves out; the others keep their order.
  void keep(std::vector<PendingSplit>& splits) const;

  /// False for the full TIN as it was asked for: answers then have no interval.
  [[nodiscard]] bool is_asked() const noexcept { return asked_; }
  /// Of the answers, wherever they are.
  [[nodiscard]] const Certificate& certificate() const noexcept { return certificate_; }
  /// Nothing was left out, and the file's finest TIN is its source.
  [[nodiscard]] bool is_exact(const StoreFacts& facts) const noexcept {
    return certificate_.complete && facts.base_error == 0;
  }

 private:
  [[nodiscard]] bool is_behind(const PendingSplit& s) const noexcept {
    return *last_ < place_of(s);
  }
  void cut_behind(std::uint64_t records, const RecordSource& source, QueryContext& context);
  [[nodiscard]] bool cut_between(double low, double high, std::uint64_t records,
                                 const RecordSource& source, QueryContext& context);

  double tolerance_ = -1.0;
  std::optional<RecordPlace> last_;  ///< What is kept ends with it; none: the tolerance says all.
  bool asked_ = false;
  Certificate certificate_;
};

/// Records that come with the first `vertices` vertices, at most all.
/// @throws Error invalid_argument  fewer than T0 has
[[nodiscard]] std::uint64_t records_of_first(std::uint64_t vertices, const StoreFile& store);

}  // namespace ptin
