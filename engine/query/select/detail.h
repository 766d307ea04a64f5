// SPDX-License-Identifier: GPL-3.0-or-later
//
// Levels of detail: the full TIN, the TIN of a certified error, or that of the most important
// vertices (the paper's M_t). A level is turned once into the records that a question leaves out,
// and into the certificate of its answers.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/geometry/infinity.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/certificate.h"
#include "engine/query/select/region.h"
#include "engine/query/select/retrieval.h"
#include "engine/query/select/total_order.h"

namespace ptin {

/// How finely a question looks at the terrain. Neither member set: the full TIN.
struct DetailRequest {
  /// Certified error allowed, in the height's unit, >= 0.
  std::optional<double> tolerance;
  /// The TIN of this many vertices: the first ones of the whole terrain in the total order
  /// (select/total_order.h), T0 and vertices without a height included. At least |T0|; more than
  /// there are means all. Excludes `tolerance`. The TIN is the same wherever it is asked, except by
  /// refine() with a region, which counts within the region (refine/refine.h).
  std::optional<std::uint64_t> vertices;
};

/// A level of detail as questions use it: a TIN between T0 and the full one, the same wherever it
/// is asked. The records that the level keeps are closed under dependency, and so are those of them
/// for which a monotone predicate is true. Threads: immutable.
class Detail {
 public:
  /// The full TIN.
  explicit Detail(const StoreFile& store) : certificate_(certify_below(store, -1.0)) {}

  /// @throws Error invalid_argument    tolerance negative or NaN; both given; fewer vertices than
  ///                                   T0
  ///               resource_exhausted  the last bin of errors exceeds the memory limit
  ///               corruption, io_error, cancelled
  /// Cost: with `vertices` it reads, over the whole terrain, every page with an error in the last
  /// vertex's bin (an eighth of an octave) or above, and keeps 16 bytes for each record of that
  /// bin. Otherwise it reads no page.
  Detail(const DetailRequest& request, const RecordSource& source, QueryContext& context);

  /// Every record of error at or below this is left out; negative: none are. Questions put it into
  /// the predicate by which they select pages and records, and call keep() afterwards.
  [[nodiscard]] double tolerance() const noexcept { return tolerance_; }
  /// True when tolerance() alone tells what is left out. False where a number of vertices cuts
  /// between records of one error.
  [[nodiscard]] bool is_by_error() const noexcept { return !last_; }
  /// Nothing is left out: the level is the full TIN.
  [[nodiscard]] bool is_full() const noexcept { return is_by_error() && tolerance_ < 0; }
  /// The error up to which triangles have died at the level: tolerance(), or the error of the last
  /// record kept. Which triangles die at the latter, the records kept decide.
  [[nodiscard]] double level() const noexcept { return last_ ? last_->error : tolerance_; }
  /// True when the level keeps the record.
  [[nodiscard]] bool keeps(const RecordPlace& record) const noexcept {
    return record.error > tolerance_ && (!last_ || !(*last_ < record));
  }
  [[nodiscard]] bool keeps(const PendingSplit& split) const noexcept {
    return keeps(place_of(split));
  }
  /// Drops the splits that the level leaves out; the others keep their order.
  void keep(std::vector<PendingSplit>& splits) const;

  /// True when a tolerance or a number of vertices was asked for. False when the full TIN was:
  /// heights in answers are then no intervals.
  [[nodiscard]] bool is_asked() const noexcept { return asked_; }
  /// The certificate of every answer at this level.
  [[nodiscard]] const Certificate& certificate() const noexcept { return certificate_; }
  /// True when no record is left out and the file's finest TIN is its source's.
  [[nodiscard]] bool is_exact(const StoreFacts& facts) const noexcept {
    return certificate_.complete && facts.base_error == 0;
  }

 private:
  void cut_behind(std::uint64_t records, const RecordSource& source, QueryContext& context);
  [[nodiscard]] bool cut_between(double low, double high, std::uint64_t records,
                                 const RecordSource& source, QueryContext& context);

  double tolerance_ = -1.0;
  /// Last record kept, in the total order; none: the tolerance alone decides.
  std::optional<RecordPlace> last_;
  bool asked_ = false;
  Certificate certificate_;
};

/// How many records the TIN of `vertices` vertices applies: `vertices` - |T0|, but at most all of
/// the file.
/// @throws Error invalid_argument  `vertices` is below |T0|
[[nodiscard]] std::uint64_t records_of_first(std::uint64_t vertices, const StoreFile& store);

/// Records of error above a tolerance, by the table of errors: the bin that holds the tolerance
/// counts as a whole, so they may be too many, by at most those of an eighth of an octave. A
/// negative tolerance counts all.
[[nodiscard]] std::uint64_t records_above(const StoreFile& store, double tolerance);

/// The level that is as fine as so many vertices, pixels for example, in a window: the least end of
/// a bin of errors above which the TIN has about at most so many vertices in the window, or the
/// greatest finite one. Nothing is set where the full TIN has no more.
///
/// An estimate: exact where the window holds the whole terrain, else by the index, which tells of
/// each page a box, the number of its records and the range of their errors. Of windows of a 5th to
/// a 64th of several terrains the median of what was counted was 1.05 to 1.15 of what was asked, and
/// nearly all lay between half and twice as many.
/// @param window  Map units.
/// @param io      What was read is added.
/// @param most_error  The level has no greater error, though it has more vertices: the borders of many
///                    voids take more than there are pixels (engine/crs/border_move.h).
/// @throws Error corruption, io_error
/// Cost: a few nodes of the index for windows of few vertices, at most those of the window; no page.
[[nodiscard]] DetailRequest detail_for(const StoreFile& store, std::uint64_t vertices,
                                       const Window& window, IoCounters& io,
                                       double most_error = kInfinity);

}  // namespace ptin
