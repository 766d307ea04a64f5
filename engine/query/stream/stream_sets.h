// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which records a receiver has and which it lacks, decided for each record by itself.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/predicate.h"
#include "engine/query/select/retrieval.h"
#include "engine/query/select/total_order.h"

namespace ptin {

/// Sets of records that never are in memory as a whole: each is named by a predicate and by the place
/// in the total order at which it ends. So pages can be read in any parts. Threads: const functions
/// may be called at once.
class StreamSets {
 public:
  /// @param source  Borrowed.
  explicit StreamSets(const RecordSource& source) : source_(source) {}

  /// From now on the receiver also has the records for which `predicate` is true, up to `end`.
  void hold(PredicatePtr predicate, std::optional<RecordPlace> end) {
    held_.push_back({std::move(predicate), end});
  }
  /// The receiver shall have these.
  void want(PredicatePtr predicate, std::optional<RecordPlace> end = {}) {
    wanted_ = {std::move(predicate), end};
  }

  /// Records of a part of the file.
  struct Records {
    std::vector<PendingSplit> held, missing;
    void clear() {
      held.clear();
      missing.clear();
    }
  };
  /// The pages with records that are held or wanted and whose roi meets the box; null: with any.
  /// @throws Error corruption, io_error, cancelled
  [[nodiscard]] std::vector<PageId> pages(const GridBox* box, QueryContext& context) const;
  /// Appends what such a page holds of them.  @throws Error as pages()
  void read(PageId page, const GridBox* box, QueryContext& context, Records& out) const;

 private:
  struct Set {
    PredicatePtr predicate;
    std::optional<RecordPlace> end;  ///< The first record that is not in it; none: there is no end.
  };
  void read(PageId page, const Set& set, const GridBox* box, QueryContext& context,
            std::vector<PendingSplit>& out) const;

  RecordSource source_;
  std::vector<Set> held_;
  Set wanted_{everything(), std::nullopt};
};

}  // namespace ptin
