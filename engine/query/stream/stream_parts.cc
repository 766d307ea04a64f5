// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stream of a terrain of any size, cell after cell.
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "engine/error.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/shape/tiler.h"
#include "engine/query/stream/cell_coder.h"
#include "engine/query/stream/frame_file.h"
#include "engine/query/stream/stream_format.h"
#include "engine/query/stream/stream_frames.h"
#include "engine/query/stream/stream_sets.h"
#include "storage/file/external_sorter.h"

namespace ptin {

namespace {

/// Cells are cut until they take no more than this, so that their mesh stays in the caches.
constexpr std::uint64_t kCellBytes = std::uint64_t{64} << 20;

class StreamParts final : public StreamFrames {
 public:
  StreamParts(const OpenedTerrain& terrain, const StreamRequest& request, QueryContext& context,
              FileLayer& files)
      : terrain_(terrain),
        store_(terrain.store()),
        request_(request),
        context_(context),
        files_(files),
        t0_(stream::numbered_by_key(terrain.t0())),
        sets_(terrain.record_source()),
        fixed_bytes_(3 * bytes_of(terrain.t0())) {
    context_.admit(fixed_bytes_);
    name_sets();
    cut();
    store_.pages().check_unchanged();
    context_.admit(fixed_bytes_ + FrameCoder::bytes_of(cuts_->largest()));
  }

  [[nodiscard]] std::uint64_t base_vertices() const override { return base_vertices_; }
  [[nodiscard]] std::uint64_t base_digest() const override { return base_digest_; }
  [[nodiscard]] const FrameCuts& cuts() const override { return *cuts_; }
  [[nodiscard]] std::vector<std::uint64_t> begin() override;
  void take(std::size_t frame, std::vector<std::byte>& coded) override {
    context_.check_stop();
    file_->take(frame, coded);
  }
  void count_vertices(std::size_t frame, FrameCoder& coder) const override {
    for (std::size_t i = 0; i < cells_.size(); ++i)
      coder.add(i, born_[i * cuts_->frames() + frame]);
  }
  [[nodiscard]] std::uint64_t digest() const override { return digest_; }

 private:
  [[nodiscard]] ExternalSorter<RecordPlace> sorter() const;
  template <class Visit>
  void visit_places(const Visit& visit);
  void name_sets();
  void cut();
  void cut_cells();
  [[nodiscard]] bool fits(const GridCell& cell, double share);
  [[nodiscard]] std::uint64_t bytes_for(std::uint64_t records) const;
  [[nodiscard]] int workers() const;
  void work_on(std::size_t cell, QueryContext& context);
  [[nodiscard]] Tin base_of(const std::vector<PendingSplit>& held, QueryContext& context) const;

  const OpenedTerrain& terrain_;
  const StoreFile& store_;
  const StreamRequest& request_;
  QueryContext& context_;
  FileLayer& files_;
  Tin t0_;  ///< Numbered by key.
  StreamSets sets_;
  std::uint64_t fixed_bytes_;
  std::uint64_t base_vertices_ = 0, base_digest_ = 0;
  std::optional<FrameCuts> cuts_;
  std::vector<GridCell> cells_;
  std::vector<std::uint32_t> born_;           ///< In each cell with each frame.
  std::vector<std::uint64_t> cell_vertices_;  ///< Of the base.
  std::optional<FrameFile> file_;
  std::atomic<std::uint64_t> digest_ = 0;
};

ExternalSorter<RecordPlace> StreamParts::sorter() const {
  const std::uint64_t bytes = context_.left_beside(fixed_bytes_) / 2;
  return ExternalSorter<RecordPlace>({files_, request_.temporary_folder, bytes},
                                     "ptin-stream-order", request_.limits.stop);
}

/// Calls visit(place) for the records that are wanted and not held, in the total order, until it
/// returns false.
template <class Visit>
void StreamParts::visit_places(const Visit& visit) {
  ExternalSorter<RecordPlace> places = sorter();
  const std::vector<PageId> pages = sets_.pages(nullptr, context_);
  store_.announce(pages, context_.heights(), context_.cost.io);
  StreamSets::Records records;
  base_vertices_ = t0_.vertices.size();
  base_digest_ = stream::digest_of(t0_);
  for (const PageId page : pages) {
    records.clear();
    sets_.read(page, nullptr, context_, records);
    for (const PendingSplit& s : records.missing) places.add(place_of(s));
    base_vertices_ += records.held.size();
    for (const PendingSplit& s : records.held) {
      base_digest_ +=
          stream::digest_of(point_of(s.u), s.height, (s.flags & VertexSplit::kVertexVoid) == 0);
    }
  }
  std::vector<RecordPlace> batch;
  while (places.take(batch, request_.limits.stop)) {
    for (const RecordPlace& place : batch) {
      if (!visit(place)) return;
    }
  }
}

/// Says where the servings end that a receiver has had.
void StreamParts::name_sets() {
  for (const StreamHeld& held : request_.held) {
    const PredicatePtr predicate = held.predicate ? held.predicate : everything();
    std::optional<RecordPlace> end;
    if (held.splits < store_.record_count()) {
      sets_.want(predicate);
      std::uint64_t left = held.splits;
      visit_places([&](const RecordPlace& place) {
        if (left == 0) end = place;
        return left-- != 0;
      });
    }
    sets_.hold(predicate, end);
  }
  sets_.want(request_.wanted ? request_.wanted : everything());
}

void StreamParts::cut() {
  // The number of vertices is known once all pages were read, before the first place comes.
  visit_places([&](const RecordPlace& place) {
    if (!cuts_) cuts_.emplace(base_vertices_, request_.most_splits);
    cuts_->add(place);
    return !cuts_->end();
  });
  if (!cuts_) cuts_.emplace(base_vertices_, request_.most_splits);
  sets_.want(request_.wanted ? request_.wanted : everything(), cuts_->end());
}

std::vector<std::uint64_t> StreamParts::begin() {
  cut_cells();
  file_.emplace(files_, request_.temporary_folder, cuts_->frames());
  born_.resize(cells_.size() * cuts_->frames());
  cell_vertices_.resize(cells_.size());
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failed;
  run_on_threads(workers(), [&](int /*worker*/) noexcept {
    QueryContext context(request_.limits, store_.path());
    try {
      for (std::size_t i = next++; i < cells_.size(); i = next++) work_on(i, context);
    } catch (...) {
      next = cells_.size();
      const std::lock_guard lock(mutex);
      if (!failed) failed = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    context_.cost.add_counts(context.cost);
  });
  if (failed) std::rethrow_exception(failed);
  store_.pages().check_unchanged();
  return cell_vertices_;
}

std::uint64_t StreamParts::bytes_for(std::uint64_t records) const {
  return CellCoder::bytes_of(t0_.vertices.size(), records) +
         (request_.held.empty() ? 0 : refinement_bytes(t0_.vertices.size() + records));
}

/// As many as have room for a quarter of a cell each.
int StreamParts::workers() const {
  const TileLimits limits{context_.left_beside(fixed_bytes_), kCellBytes, request_.threads};
  return limits.workers();
}

void StreamParts::cut_cells() {
  work_on_cells(store_.facts().bounds, [&](const GridCell& cell, double share, double /*done*/) {
    context_.check_stop();
    if (!fits(cell, share)) return false;
    cells_.push_back(cell);
    return true;
  });
}

bool StreamParts::fits(const GridCell& cell, double share) {
  const std::uint64_t limit =
      context_.left_beside(fixed_bytes_) / static_cast<std::uint64_t>(workers());
  const std::uint64_t wanted = std::min({limit, kCellBytes, request_.most_part_bytes});
  const auto even = static_cast<std::uint64_t>(static_cast<double>(store_.record_count()) * share);
  // A search of the index lists all pages: not worth it for cells that are far too large anyway.
  if (request_.held.empty() && !request_.wanted && bytes_for(even) / 16 > wanted) return false;
  const GridBox box = cell.box();
  const std::uint64_t records = most_records(store_, sets_.pages(&box, context_));
  const std::uint64_t bytes = bytes_for(records);
  // Four times the share: mostly records that reach beyond the cell, and would be applied again in
  // each of its parts.
  if (bytes <= wanted || (bytes <= limit && (records / 4 > even || cell.level == 0))) return true;
  if (cell.level == 0) {
    throw Error(ErrorCode::resource_exhausted,
                "the records around position (" + std::to_string(cell.x) + ", " +
                    std::to_string(cell.y) + ") take " + std::to_string((bytes + 0xFFFFF) >> 20) +
                    " MiB to send, more than the limit of " + std::to_string(limit >> 20) +
                    " MiB: give more memory",
                store_.path());
  }
  return false;
}

void StreamParts::work_on(std::size_t cell, QueryContext& context) {
  const GridBox box = cells_[cell].box();
  StreamSets::Records records;
  const std::vector<PageId> pages = sets_.pages(&box, context);
  store_.announce(pages, context.heights(), context.cost.io);
  reserve_large(records.missing, most_records(store_, pages));
  for (const PageId page : pages) sets_.read(page, &box, context, records);
  CellCoder coder(records.held.empty() ? t0_ : base_of(records.held, context),
                  std::move(records.missing), *cuts_, cells_[cell],
                  static_cast<std::uint32_t>(cell), store_.facts().heights.type, context);
  cell_vertices_[cell] = coder.base_vertices();
  std::vector<std::byte> coded;
  for (std::size_t frame = 0; frame < cuts_->frames(); ++frame) {
    coded.clear();
    coder.code(coded);
    file_->add(frame, coded);
    born_[cell * cuts_->frames() + frame] = coder.born();
  }
  digest_ += coder.digest();
}

/// The mesh that the receiver has around a cell, in the order of keys that it has as a whole.
Tin StreamParts::base_of(const std::vector<PendingSplit>& held, QueryContext& context) const {
  Refinement refinement(terrain_.t0());
  refinement.apply(held, context);
  return stream::numbered_by_key(refinement.tin());
}

}  // namespace

std::unique_ptr<StreamFrames> stream_in_parts(const OpenedTerrain& terrain,
                                              const StreamRequest& request, QueryContext& context,
                                              FileLayer& files) {
  return std::make_unique<StreamParts>(terrain, request, context, files);
}

}  // namespace ptin
