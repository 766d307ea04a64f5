// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/progressive_tin.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "engine/error.h"
#include "engine/query/refine/clip.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/certificate.h"
#include "engine/query/select/coarsest.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/retrieval.h"
#include "engine/query/select/total_order.h"

namespace ptin {

namespace {

/// The records to apply, and what leaving out the others means.
struct Selection {
  std::vector<PendingSplit> splits;
  Certificate certificate;
};

/// The predicate of a request, `vertices` left aside.
PredicatePtr predicate_of(const RefineRequest& request, const StoreFacts& facts) {
  std::vector<PredicatePtr> parts;
  if (request.tolerance) {
    parts.push_back(error_above(*request.tolerance));
  }
  if (request.region) {
    parts.push_back(meets_region(*request.region, facts.map));
  }
  if (request.also != nullptr) {
    parts.push_back(borrowed(*request.also));
  }
  return all_of(std::move(parts));
}

std::uint64_t records_wanted(const RefineRequest& request, const StoreFile& store) {
  if (request.tolerance) {
    throw Error(ErrorCode::invalid_argument,
                "both a tolerance and a number of vertices are given: give one of them");
  }
  return records_of_first(*request.vertices, store);
}

Selection select(const RefineRequest& request, const RecordSource& source,
                 std::uint64_t fixed_bytes, QueryContext& context) {
  const PredicatePtr predicate = predicate_of(request, source.store.facts());
  Selection selection;
  double left = request.tolerance.value_or(-1.0);
  if (request.vertices) {
    FirstRecords first = first_records(source, *predicate, records_wanted(request, source.store),
                                       fixed_bytes, context);
    selection.splits = std::move(first.splits);
    left = first.largest_error_left;
  } else {
    selection.splits = retrieve(source, *predicate, fixed_bytes, context);
  }
  // What a caller's own predicate leaves out is known only by counting what it does not.
  selection.certificate = request.also == nullptr ? certify_below(source.store, left)
                                                  : certify_applied(source.store, selection.splits);
  return selection;
}

void count_parts(RefinedTin& result) {
  result.vertices = result.tin.vertices.size();
  result.triangles = result.tin.triangles.size();
  result.void_vertices = static_cast<std::uint64_t>(
      std::count(result.tin.has_height.begin(), result.tin.has_height.end(), 0));
}

}  // namespace

ProgressiveTin ProgressiveTin::open(const std::string& path, const OpenOptions& options) {
  return ProgressiveTin(StoreFile::open(path, options.access));
}

ProgressiveTin::ProgressiveTin(std::shared_ptr<const StoreFile> store)
    : store_(std::move(store)),
      t0_(std::make_shared<const Tin>(mesh_of(store_->t0(), store_->path()))) {}

void ProgressiveTin::use_index(std::shared_ptr<const RecordIndex> index) {
  index_ = std::move(index);
}

RefinedTin ProgressiveTin::refine(const RefineRequest& request) const {
  const auto start = std::chrono::steady_clock::now();
  QueryContext context(request.stop, request.memory_limit_bytes, store_->path());
  const RecordSource source{*store_, index()};
  const Selection selection = select(request, source, bytes_of(*t0_), context);

  Refinement refinement(*t0_, request.page_of_triangle);
  refinement.apply(selection.splits, context);
  RefinedTin result;
  result.tin = refinement.release_tin();
  result.page_of_triangle = refinement.release_pages();
  if (request.region && request.form == ResultForm::kMeetingRegion) {
    keep_meeting(result.tin, GridRegion(*request.region, store_->facts().map),
                 result.page_of_triangle, context);
  }
  store_->pages().check_unchanged();

  count_parts(result);
  result.t0_vertices = t0_->vertices.size();
  result.certified_error = selection.certificate.error;
  result.certified_deviation = selection.certificate.deviation;
  result.exact = selection.certificate.complete && store_->facts().base_error == 0;
  result.cost = context.cost;
  result.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace ptin
