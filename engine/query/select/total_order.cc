// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/select/total_order.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include "engine/query/select/predicate.h"

namespace ptin {

namespace {

constexpr std::size_t kLeastPages = 16;  // Pages read at once, at least.

/// A bound that the errors of at least `count` records of the whole file exceed, by the table of
/// errors; -1 when all are needed.
double bound_exceeded_by(std::span<const ErrorBin> bins, std::uint64_t count) {
  std::uint64_t records = 0;
  for (std::size_t i = bins.size(); i-- > 1;) {
    records += bins[i].records;
    if (records >= count) {
      return bins[i - 1].upper;
    }
  }
  return -1.0;
}

struct RankedPage {
  PageId id;
  std::uint32_t records;
  double largest_error;
};

/// The state of the search: the records found, the pages read, and the largest error of what was
/// given up.
class Search {
 public:
  Search(const RecordSource& source, const AttributePredicate& predicate, std::uint64_t count,
         std::uint64_t fixed_bytes, QueryContext& context)
      : source_(source),
        predicate_(predicate),
        count_(count),
        fixed_bytes_(fixed_bytes),
        context_(context) {}

  /// Looks at all records with error above `bound`. True when no other record can be among the
  /// first.
  bool round(double bound) {
    const std::vector<RankedPage> pages = unread_pages(bound);
    std::size_t next = 0;
    while (next < pages.size() && !is_done(pages[next].largest_error)) {
      next = read_some(pages, next);
    }
    left_ = std::max(bound, next < pages.size() ? pages[next].largest_error : -1.0);
    return is_done(left_);
  }

  FirstRecords result() && { return {std::move(found_), std::max(left_, dropped_)}; }

 private:
  [[nodiscard]] bool is_full() const noexcept { return found_.size() >= count_; }
  /// True when no record with at most this error can be among the first any more.
  [[nodiscard]] bool is_done(double error) const noexcept {
    return count_ == 0 || (is_full() && smallest_ > error);
  }

  std::vector<RankedPage> unread_pages(double bound) {
    std::vector<PageId> ids;
    const PredicatePtr wanted = all_of({std::make_shared<AboveError>(bound), borrowed(predicate_)});
    source_.index.search(*wanted, ids, context_.cost.io);
    context_.check_stop();
    std::vector<RankedPage> pages;
    for (const PageId id : ids) {
      if (!std::binary_search(read_.begin(), read_.end(), id)) {
        const StoreFile::PageInfo info = source_.store.page_info(id);
        pages.push_back({id, info.records, info.attributes.error});
      }
    }
    std::stable_sort(pages.begin(), pages.end(), [](const RankedPage& a, const RankedPage& b) {
      return a.largest_error > b.largest_error;
    });
    return pages;
  }

  /// Reads the next pages. While records are missing: as many pages as could hold the missing ones.
  /// Once there are enough records: an eighth of the pages read so far, 16 at least.
  std::size_t read_some(const std::vector<RankedPage>& pages, std::size_t next) {
    const std::uint64_t missing = count_ - std::min<std::uint64_t>(count_, found_.size());
    const std::size_t least = next + std::max(kLeastPages, read_.size() / 8);
    std::vector<PageId> ids;
    std::uint64_t records = 0;
    while (next < pages.size() && (records < missing || (missing == 0 && next < least))) {
      ids.push_back(pages[next].id);
      records += pages[next].records;
      ++next;
    }
    context_.admit(fixed_bytes_ + refinement_bytes(found_.size() + records));
    std::sort(ids.begin(), ids.end());
    read_pages(source_.store, ids, predicate_, context_, found_);
    const auto middle = static_cast<std::ptrdiff_t>(read_.size());
    read_.insert(read_.end(), ids.begin(), ids.end());
    std::inplace_merge(read_.begin(), read_.begin() + middle, read_.end());
    prune();
    return next;
  }

  /// Keeps the first `count` of the records found, in the order in which they were read.
  void prune() {
    if (!is_full()) {
      return;
    }
    order_ = found_;
    const auto last = order_.begin() + static_cast<std::ptrdiff_t>(count_ - 1);
    std::nth_element(order_.begin(), last, order_.end(), is_before);
    smallest_ = last->error;
    std::for_each(last + 1, order_.end(), [this](const PendingSplit& s) {
      dropped_ = std::max<double>(dropped_, s.error);
    });
    std::erase_if(found_, [last](const PendingSplit& s) { return is_before(*last, s); });
  }

  const RecordSource& source_;
  const AttributePredicate& predicate_;
  std::uint64_t count_;
  std::uint64_t fixed_bytes_;
  QueryContext& context_;
  std::vector<PendingSplit> found_, order_;
  std::vector<PageId> read_;  ///< Ascending.
  double smallest_ = 0.0;     ///< Error of the last of the first `count`.
  double dropped_ = -1.0;     ///< Largest error of a record found and given up.
  double left_ = -1.0;        ///< No record in an unread page has a larger error.
};

}  // namespace

FirstRecords first_records(const RecordSource& source, const AttributePredicate& predicate,
                           std::uint64_t count, std::uint64_t fixed_bytes, QueryContext& context) {
  Search search(source, predicate, count, fixed_bytes, context);
  for (std::uint64_t target = count;; target *= 4) {
    const bool all = target >= source.store.record_count();
    const double bound = all ? -1.0 : bound_exceeded_by(source.store.error_bins(), target);
    if (search.round(bound) || bound < 0) {
      return std::move(search).result();
    }
  }
}

}  // namespace ptin
