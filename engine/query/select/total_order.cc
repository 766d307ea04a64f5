// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/select/total_order.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <numeric>
#include <utility>

#include "engine/query/select/predicate.h"

namespace ptin {

namespace {

constexpr std::size_t kLeastPages = 16;  // Pages read at once, at least.

struct RankedPage {
  PageId id;
  std::uint32_t records;
  double largest_error;
};

/// The state of the search: the records found, the pages read, and the largest error of what was
/// given up.
class Search {
 public:
  Search(const RecordSource& source, const AttributePredicate& predicate, Growth growth,
         std::uint64_t fixed_bytes, QueryContext& context, const LeftOut& left_out)
      : source_(source),
        predicate_(predicate),
        growth_(growth),
        fixed_bytes_(fixed_bytes),
        context_(context),
        left_out_(left_out) {}

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

  FirstRecords result() && {
    if (is_one_too_many_) {
      std::erase_if(found_, [this](const PendingSplit& s) { return s.u == last_.u; });
      dropped_ = std::max<double>(dropped_, last_.error);
    }
    return {std::move(found_), std::max(left_, dropped_)};
  }

 private:
  [[nodiscard]] bool is_full() const noexcept { return grown_ >= growth_.most; }
  /// True when no record with at most this error can be among the first any more.
  [[nodiscard]] bool is_done(double error) const noexcept {
    return growth_.most == 0 || (is_full() && last_.error > error);
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
  /// Once there are enough records: an eighth of the pages read so far, 16 at least, and of those
  /// behind the first as many as there is memory for.
  std::size_t read_some(const std::vector<RankedPage>& pages, std::size_t next) {
    const std::uint64_t room = growth_.most - std::min(growth_.most, grown_);
    const std::uint64_t missing = room / growth_.by_one() + room % growth_.by_one();
    const std::size_t least = next + std::max(kLeastPages, read_.size() / 8);
    std::vector<PageId> ids;
    std::uint64_t records = 0;
    const auto bytes_with = [&](const RankedPage& page) {
      return fixed_bytes_ + refinement_bytes(found_.size() + records + page.records);
    };
    while (next < pages.size() &&
           (records < missing || (missing == 0 && next < least &&
                                  (ids.empty() || context_.fits(bytes_with(pages[next])))))) {
      ids.push_back(pages[next].id);
      records += pages[next].records;
      ++next;
    }
    context_.admit(fixed_bytes_ + refinement_bytes(found_.size() + records));
    std::sort(ids.begin(), ids.end());
    const auto before = static_cast<std::ptrdiff_t>(found_.size());
    read_pages(source_.store, ids, predicate_, context_, found_);
    if (left_out_.is) {
      found_.erase(std::remove_if(found_.begin() + before, found_.end(),
                                  [this](const PendingSplit& s) { return left_out_.is(s.u); }),
                   found_.end());
    }
    std::for_each(found_.begin() + before, found_.end(),
                  [this](const PendingSplit& s) { grown_ += growth_.by(s); });
    const auto middle = static_cast<std::ptrdiff_t>(read_.size());
    read_.insert(read_.end(), ids.begin(), ids.end());
    std::inplace_merge(read_.begin(), read_.begin() + middle, read_.end());
    if (is_full()) prune();
    return next;
  }

  /// Keeps the first of the records found, in the order in which they were read. Where they leave
  /// room that the next one exceeds, that one is kept too: it says where the prefix ends, however
  /// many records are found yet.
  void prune() {
    order_ = found_;
    const auto end = order_.end();
    auto next = order_.begin();
    std::uint64_t room = growth_.most;
    while (room > 0 && next != end) {
      // So many fit whatever they add; of what is less, one record alone may fit.
      const std::uint64_t fit = std::max<std::uint64_t>(room / growth_.by_one(), 1);
      const auto taken = std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(fit), end - next);
      std::nth_element(next, next + (taken - 1), end, is_before);
      const auto first = next;
      next += taken;
      const std::uint64_t added = std::accumulate(
          first, next, std::uint64_t{0},
          [this](std::uint64_t sum, const PendingSplit& s) { return sum + growth_.by(s); });
      is_one_too_many_ = added > room;
      room -= std::min(added, room);
    }
    last_ = place_of(*(next - 1));
    std::for_each(next, end, [this](const PendingSplit& s) {
      dropped_ = std::max<double>(dropped_, s.error);
    });
    std::erase_if(found_, [this](const PendingSplit& s) { return last_ < place_of(s); });
    grown_ = growth_.most - room + (is_one_too_many_ ? 1 : 0);
  }

  const RecordSource& source_;
  const AttributePredicate& predicate_;
  Growth growth_;
  std::uint64_t fixed_bytes_;
  QueryContext& context_;
  const LeftOut& left_out_;
  std::vector<PendingSplit> found_, order_;
  std::vector<PageId> read_;      ///< Ascending.
  std::uint64_t grown_ = 0;       ///< By all of found_.
  RecordPlace last_{};            ///< Last of found_, once it is full.
  bool is_one_too_many_ = false;  ///< The last of found_ exceeds the growth.
  double dropped_ = -1.0;         ///< Largest error of a record found and given up.
  double left_ = -1.0;            ///< No record in an unread page has a larger error.
};

}  // namespace

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

FirstRecords first_records(const RecordSource& source, const AttributePredicate& predicate,
                           Growth growth, std::uint64_t fixed_bytes, QueryContext& context,
                           const LeftOut& left_out) {
  Search search(source, predicate, growth, fixed_bytes, context, left_out);
  const std::uint64_t fewest =
      std::max<std::uint64_t>(growth.most / growth.by_one(), 1) + left_out.count;
  for (std::uint64_t target = fewest;; target *= 4) {
    const bool all = target >= source.store.record_count();
    const double bound = all ? -1.0 : bound_exceeded_by(source.store.error_bins(), target);
    if (search.round(bound) || bound < 0) {
      return std::move(search).result();
    }
  }
}

}  // namespace ptin
