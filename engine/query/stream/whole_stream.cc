// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stream of what fits into memory.
#include <algorithm>
#include <optional>
#include <utility>

#include "engine/geometry/key_table.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/total_order.h"
#include "engine/query/stream/cell_coder.h"
#include "engine/query/stream/growing_mesh.h"
#include "engine/query/stream/stream_format.h"
#include "engine/query/stream/stream_frames.h"

namespace ptin {

namespace {

/// The cell that is the whole grid.
constexpr GridCell kAll{0, 0, 31};

/// The largest number that fits, where all smaller ones do, too; 0: none does.
template <class Fits>
std::uint64_t largest_that(const Fits& fits) noexcept {
  std::uint64_t fit = 0, too_many = std::uint64_t{1} << 32;
  while (too_many - fit > 1) {
    const std::uint64_t middle = fit + (too_many - fit) / 2;
    (fits(middle) ? fit : too_many) = middle;
  }
  return fit;
}

/// The most splits that can be sent in so much memory.
std::uint64_t splits_within(std::uint64_t held, std::uint64_t memory_bytes) noexcept {
  return largest_that(
      [&](std::uint64_t splits) { return bytes_of_sending(held, splits) <= memory_bytes; });
}

/// Keeps the first splits of the total order.
void keep_first(std::vector<PendingSplit>& splits, std::uint64_t most) {
  if (most >= splits.size()) return;
  const auto last = splits.begin() + static_cast<std::ptrdiff_t>(most);
  std::nth_element(splits.begin(), last, splits.end(), is_before);
  splits.erase(last, splits.end());
}

class WholeStream final : public StreamFrames {
 public:
  WholeStream(const OpenedTerrain& terrain, const StreamRequest& request, QueryContext& context)
      : terrain_(terrain),
        store_(terrain.store()),
        request_(request),
        source_(terrain.record_source()),
        context_(context) {
    admit_what_is_told();
    Tin base = base_mesh();
    base_vertices_ = base.vertices.size();
    base_digest_ = stream::digest_of(base);
    std::vector<PendingSplit> splits = missing_splits(base);
    store_.pages().check_unchanged();
    cut(splits);
    cell_.emplace(base, std::move(splits), *cuts_, kAll, 0, store_.facts().heights.type, context_);
  }

  [[nodiscard]] std::uint64_t base_vertices() const override { return base_vertices_; }
  [[nodiscard]] std::uint64_t base_digest() const override { return base_digest_; }
  [[nodiscard]] const FrameCuts& cuts() const override { return *cuts_; }
  [[nodiscard]] std::vector<std::uint64_t> begin() override { return {base_vertices_}; }
  void take(std::size_t /*frame*/, std::vector<std::byte>& coded) override {
    coded.clear();
    cell_->code(coded);
  }
  void count_vertices(std::size_t /*frame*/, FrameCoder& coder) const override {
    coder.add(0, cell_->born());
  }
  [[nodiscard]] std::uint64_t digest() const override { return cell_->digest(); }

 private:
  void admit_what_is_told() const;
  [[nodiscard]] Tin base_mesh();
  [[nodiscard]] std::vector<PendingSplit> missing_splits(const Tin& base);
  [[nodiscard]] std::vector<PendingSplit> all_of_pages(const AttributePredicate& predicate,
                                                       std::span<const PageId> pages,
                                                       const LeftOut& held);
  [[nodiscard]] std::vector<PageId> pages_of(const AttributePredicate& predicate);
  [[nodiscard]] std::vector<PendingSplit> first_of(const AttributePredicate& predicate,
                                                   std::uint64_t most, const LeftOut& held,
                                                   std::uint64_t fixed_bytes);
  void cut(const std::vector<PendingSplit>& splits);

  const OpenedTerrain& terrain_;
  const StoreFile& store_;
  const StreamRequest& request_;
  RecordSource source_;
  QueryContext& context_;
  std::uint64_t base_vertices_ = 0, base_digest_ = 0;
  double left_out_ = -1.0;  ///< Largest error of a record that is wanted and beyond `most_splits`.
  std::optional<FrameCuts> cuts_;
  std::optional<CellCoder> cell_;
};

/// Records that the servings brought are known before anything is read.
void WholeStream::admit_what_is_told() const {
  std::uint64_t held_records = 0;
  for (const StreamHeld& held : request_.held) {
    if (held.splits > store_.record_count()) return;
    held_records += held.splits;
  }
  held_records = std::min(held_records, store_.record_count());
  const std::uint64_t least =
      std::min(request_.fewest_splits.value_or(1), store_.record_count() - held_records);
  context_.admit(bytes_of_sending(terrain_.t0().vertices.size() + held_records, least));
}

/// The mesh that the receiver has, numbered as the receiver numbers it: T0, and the records of all
/// servings. Each serving is closed under dependency together with those before it.
Tin WholeStream::base_mesh() {
  Refinement refinement(terrain_.t0());
  for (const StreamHeld& held : request_.held) {
    const PredicatePtr predicate = held.predicate ? held.predicate : everything();
    const std::uint64_t vertices = refinement.tin().vertices.size();
    // A serving counts the splits that it sent, without those that the receiver had by then.
    const LeftOut before{[&](VertexKey u) { return refinement.find(u) != kNone; }, vertices};
    const std::uint64_t fixed = refinement_bytes(vertices);
    if (held.splits >= store_.record_count() - std::min(store_.record_count(), vertices)) {
      const std::vector<PageId> pages = pages_of(*predicate);
      context_.admit(fixed + refinement_bytes(most_records(store_, pages)));
      std::vector<PendingSplit> splits = all_of_pages(*predicate, pages, before);
      keep_first(splits, held.splits);
      refinement.apply(splits, context_);
    } else {
      refinement.apply(first_of(*predicate, held.splits, before, fixed), context_);
    }
  }
  return stream::numbered_by_key(refinement.tin());
}

std::vector<PageId> WholeStream::pages_of(const AttributePredicate& predicate) {
  std::vector<PageId> pages;
  source_.index.search(predicate, pages, context_.cost.io);
  context_.check_stop();
  return pages;
}

/// The records of these pages for which a predicate is true and that are not held.
std::vector<PendingSplit> WholeStream::all_of_pages(const AttributePredicate& predicate,
                                                    std::span<const PageId> pages,
                                                    const LeftOut& held) {
  std::vector<PendingSplit> splits;
  read_pages(store_, pages, predicate, context_, splits);
  std::erase_if(splits, [&](const PendingSplit& s) { return held.is(s.u); });
  return splits;
}

/// The first `most` records for which a predicate is true and that are not held. Notes the largest error
/// that is left out.
std::vector<PendingSplit> WholeStream::first_of(const AttributePredicate& predicate,
                                                std::uint64_t most, const LeftOut& held,
                                                std::uint64_t fixed_bytes) {
  FirstRecords first = first_records(source_, predicate, Growth{most}, fixed_bytes, context_, held);
  left_out_ = first.largest_error_left;
  return std::move(first.splits);
}

/// The records that are wanted and not held. They are closed together with those that are held, and so
/// is any first part of them.
std::vector<PendingSplit> WholeStream::missing_splits(const Tin& base) {
  const PredicatePtr wanted = request_.wanted ? request_.wanted : everything();
  const std::uint64_t vertices = base.vertices.size(), all = store_.record_count();
  KeyTable ids(vertices);
  for (VertexId v = 0; v < vertices; ++v) ids.insert(key_of(base.position(v)), v);
  const LeftOut held{[&](VertexKey u) { return ids.find(u) != KeyTable::kAbsent; }, vertices};
  const std::uint64_t left = all - std::min(all, vertices - terrain_.t0().vertices.size());
  const std::uint64_t fit = splits_within(vertices, request_.limits.memory_bytes);
  const std::uint64_t most =
      std::min(request_.most_splits, std::max(fit, request_.fewest_splits.value_or(all)));
  left_out_ = -1.0;
  std::vector<PendingSplit> splits;
  if (most >= left) {
    const std::vector<PageId> pages = pages_of(*wanted);
    context_.admit(bytes_of_sending(vertices, std::min(most_records(store_, pages), left)));
    splits = all_of_pages(*wanted, pages, held);
  } else {
    splits = first_of(*wanted, most, held, GrowingMesh::bytes_of(vertices));
    context_.admit(bytes_of_sending(vertices, splits.size()));
  }
  splits.shrink_to_fit();
  return splits;
}

void WholeStream::cut(const std::vector<PendingSplit>& splits) {
  std::vector<RecordPlace> places;
  reserve_large(places, splits.size());
  for (const PendingSplit& s : splits) places.push_back(place_of(s));
  std::sort(places.begin(), places.end());
  cuts_.emplace(base_vertices_, splits.size());
  for (const RecordPlace& place : places) cuts_->add(place);
  cuts_->leave_out(left_out_);
}

}  // namespace

std::uint64_t bytes_of_sending(std::uint64_t base_vertices, std::uint64_t splits) noexcept {
  const std::uint64_t frame = FrameCuts::most_of_frame(base_vertices, splits);
  return CellCoder::bytes_of(base_vertices, splits) + FrameCoder::bytes_of(frame);
}

std::uint64_t most_held_within(std::uint64_t memory_bytes, std::uint64_t splits) noexcept {
  return largest_that(
      [&](std::uint64_t held) { return bytes_of_sending(held, splits) <= memory_bytes; });
}

std::unique_ptr<StreamFrames> whole_stream(const OpenedTerrain& terrain,
                                           const StreamRequest& request, QueryContext& context) {
  return std::make_unique<WholeStream>(terrain, request, context);
}

}  // namespace ptin
