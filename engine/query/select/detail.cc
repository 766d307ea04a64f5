// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/select/detail.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "engine/query/select/predicate.h"

namespace ptin {

std::uint64_t records_of_first(std::uint64_t vertices, const StoreFile& store) {
  const std::uint64_t t0 = store.t0().vertices.size();
  if (vertices < t0) {
    refuse(std::to_string(vertices) + " vertices are asked for, but the coarsest TIN has " +
               std::to_string(t0) + ": ask for at least that many",
           store.path());
  }
  return std::min(vertices - t0, store.record_count());
}

Detail::Detail(const DetailRequest& request, const RecordSource& source, QueryContext& context)
    : asked_(request.tolerance || request.vertices) {
  if (request.tolerance && request.vertices) {
    refuse("both a tolerance and a number of vertices are given: give one of them");
  }
  if (request.tolerance && !(*request.tolerance >= 0)) {
    refuse("the tolerance is negative or not a number: expected a value >= 0 in the height's unit");
  }
  if (request.vertices) {
    cut_behind(records_of_first(*request.vertices, source.store), source, context);
    return;
  }
  tolerance_ = request.tolerance.value_or(-1.0);
  certificate_ = certify_below(source.store, tolerance_);
}

void Detail::keep(std::vector<PendingSplit>& splits) const {
  if (last_) {
    std::erase_if(splits, [this](const PendingSplit& s) { return !keeps(s); });
  }
}

/// Leaves out all but the first `records` records. The table of errors says which bin holds the
/// last one; where the table is wrong, all records are looked at.
void Detail::cut_behind(std::uint64_t records, const RecordSource& source, QueryContext& context) {
  if (records == source.store.record_count()) {
    certificate_ = certify_below(source.store, -1.0);
    return;
  }
  if (records == 0) {
    tolerance_ = kInfinity;
    certificate_ = certify_below(source.store, kInfinity);
    return;
  }
  const std::span<const ErrorBin> bins = source.store.error_bins();
  std::uint64_t above = 0;
  for (std::size_t i = bins.size(); i-- > 0;) {
    above += bins[i].records;
    if (above >= records) {
      const double low = i == 0 ? -1.0 : bins[i - 1].upper;
      if (cut_between(low, bins[i].upper, records, source, context)) return;
      break;
    }
  }
  if (!cut_between(-1.0, kInfinity, records, source, context)) {
    throw Error(ErrorCode::corruption,
                "the index finds fewer than " + std::to_string(records) + " of the " +
                    std::to_string(source.store.record_count()) +
                    " records that the file counts: see `ptin verify`, and build it again",
                source.store.path());
  }
}

/// Looks for the last of the first `records` records among those of error in (low, high]. False
/// when it is not there.
bool Detail::cut_between(double low, double high, std::uint64_t records, const RecordSource& source,
                         QueryContext& context) {
  const AboveError predicate(low);
  std::vector<PageId> pages;
  source.index.search(predicate, pages, context.cost.io);
  source.store.announce(pages, context.heights(), context.cost.io);
  std::uint64_t above = 0;
  std::vector<RecordPlace> within;
  std::vector<VertexSplit> found;
  for (const PageId page : pages) {
    context.check_stop();
    found.clear();
    context.cost.records_examined +=
        source.store.read_matching(page, predicate, found, context.heights(), context.cost.io);
    context.cost.records_retrieved += found.size();
    for (const VertexSplit& r : found) {
      if (r.error > high) {
        ++above;
      } else {
        within.push_back({r.error, r.rank, key_of(r.u)});
      }
    }
    context.admit(within.capacity() * sizeof(RecordPlace));
  }
  if (above >= records || within.size() < records - above) return false;
  const auto last = within.begin() + static_cast<std::ptrdiff_t>(records - above - 1);
  std::nth_element(within.begin(), last, within.end());
  last_ = *last;
  tolerance_ = std::nextafter(static_cast<double>(last->error), -kInfinity);
  double left = low;
  std::for_each(last + 1, within.end(),
                [&](const RecordPlace& p) { left = std::max<double>(left, p.error); });
  certificate_ = certify_below(source.store, left);
  return true;
}

}  // namespace ptin
