// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/stream/stream_writer.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "engine/geometry/hilbert.h"
#include "engine/geometry/key_table.h"
#include "engine/mesh/split.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/refine/split_site.h"
#include "engine/query/select/total_order.h"
#include "engine/query/stream/growing_mesh.h"
#include "engine/query/stream/split_code.h"
#include "engine/query/stream/stream_format.h"

namespace ptin {

namespace {

constexpr std::uint64_t kLeastSplits = 256;
constexpr std::uint64_t kMostSplits = std::uint64_t{1} << 20;
constexpr std::uint64_t kShare = 8;
static_assert(kShare <= stream::kLeastShare && kMostSplits >= stream::kMostLeastSplits);
constexpr std::size_t kMostMetadata = std::size_t{1} << 20;

/// The level of each split of a frame: the length of the longest chain of splits of the frame that
/// it depends on. Level 0 depends on none of them. The splits of one level can come in any order.
class Levels {
 public:
  Levels(const Tin& base, std::uint64_t splits) : mesh_(base, splits) {}

  /// @param frame  In order of falling rank.
  std::vector<std::uint32_t> of(std::span<const PendingSplit> frame, const QueryContext& context) {
    std::vector<std::uint32_t> levels;
    levels.reserve(frame.size());
    marks_.assign(mesh_.tin().triangles.size(), 0);
    for (const PendingSplit& s : frame) {
      const SplitResult made = mesh_.apply(s, context);
      marks_.resize(mesh_.tin().triangles.size(), 0);
      walk_star(mesh_.tin(), find_u(), star_);
      std::uint32_t level = 0;
      for (const TriangleId t : star_.triangles) {
        level = t == made.left || t == made.right ? level : std::max(level, marks_[t]);
      }
      for (const TriangleId t : star_.triangles) {
        marks_[t] = level + 1;
      }
      levels.push_back(level);
    }
    return levels;
  }

 private:
  [[nodiscard]] VertexId find_u() const noexcept {
    return static_cast<VertexId>(mesh_.tin().vertices.size() - 1);
  }
  GrowingMesh mesh_;
  std::vector<std::uint32_t>
      marks_;  ///< For each triangle 1 + level of the split of this frame that made it.
  Star star_;
};

/// Most bytes that a stream takes beside T0: two meshes of all vertices, the splits, and for each
/// vertex 42 of its place on the curve (SplitCode), 16 of marks, and 36 of a frame that holds a ninth
/// of them, in two orders. What grows is counted twice.
std::uint64_t bytes_of_sending(std::uint64_t held, std::uint64_t splits) noexcept {
  constexpr std::uint64_t kBesideMesh = 96;
  return 2 * GrowingMesh::bytes_of(held + splits) + kBesideMesh * (held + splits) +
         splits * sizeof(PendingSplit);
}

/// The most splits that can be sent in so much memory.
std::uint64_t splits_within(std::uint64_t held, std::uint64_t memory_bytes) noexcept {
  std::uint64_t fit = 0, too_many = std::uint64_t{1} << 32;
  while (too_many - fit > 1) {
    const std::uint64_t middle = fit + (too_many - fit) / 2;
    (bytes_of_sending(held, middle) <= memory_bytes ? fit : too_many) = middle;
  }
  return fit;
}

/// Keeps the first splits of the total order.
void keep_first(std::vector<PendingSplit>& splits, std::uint64_t most) {
  if (most >= splits.size()) return;
  const auto last = splits.begin() + static_cast<std::ptrdiff_t>(most);
  std::nth_element(splits.begin(), last, splits.end(), is_before);
  splits.erase(last, splits.end());
}

/// A split of a level, and the number of its w.
struct Ordered {
  std::uint32_t rank;
  VertexId w;
  const PendingSplit* split;
};

class Writer {
 public:
  Writer(const OpenedTerrain& terrain, const StreamRequest& request, const ByteSink& sink)
      : terrain_(terrain),
        store_(terrain.store()),
        request_(request),
        sink_(sink),
        source_(terrain.record_source()),
        context_(request.limits, store_.path()),
        code_(store_.facts().heights.type) {}

  StreamSummary run() {
    const auto start = std::chrono::steady_clock::now();
    admit_what_is_told();
    Tin base = base_mesh();
    std::vector<PendingSplit> splits = missing_splits(base);
    store_.pages().check_unchanged();
    summary_.base_vertices = base.vertices.size();
    send_head();
    send_start(base, splits);
    if (request_.held.empty()) {
      send_t0(base);
    }
    summary_.certificate = certificate_from(splits, 0);
    GrowingMesh mesh(base, splits.size());
    Levels levels(base, splits.size());
    base = {};
    for (std::size_t at = 0; at < splits.size();) {
      context_.check_stop();
      const std::uint64_t share = mesh.tin().vertices.size() / kShare;
      const std::size_t count =
          std::min<std::uint64_t>(splits.size() - at, std::clamp(share, kLeastSplits, kMostSplits));
      const Certificate left = certificate_from(splits, at + count);
      if (!send_splits(std::span(splits).subspan(at, count), left, mesh, levels)) break;
      summary_.certificate = left;
      at += count;
      summary_.splits = at;
    }
    if (!summary_.is_cut) send_end(mesh.tin());
    context_.cost.records_applied = summary_.splits;
    summary_.cost = context_.cost;
    summary_.cost.seconds = seconds_since(start);
    return summary_;
  }

 private:
  void admit_what_is_told() const;
  [[nodiscard]] Tin base_mesh();
  [[nodiscard]] std::vector<PendingSplit> missing_splits(const Tin& base);
  [[nodiscard]] Certificate certificate_from(std::span<const PendingSplit> splits,
                                             std::size_t next) const;
  [[nodiscard]] std::vector<PendingSplit> all_of_pages(const AttributePredicate& predicate,
                                                       std::span<const PageId> pages,
                                                       const LeftOut& held);
  [[nodiscard]] std::vector<PageId> pages_of(const AttributePredicate& predicate);
  [[nodiscard]] std::vector<PendingSplit> first_of(const AttributePredicate& predicate,
                                                   std::uint64_t most, const LeftOut& held,
                                                   std::uint64_t fixed_bytes);
  void send(std::span<const std::byte> bytes) {
    sink_(bytes);
    summary_.bytes += bytes.size();
  }
  void send_frame(stream::FrameKind kind, std::span<const std::byte> payload);
  void send_head();
  void send_start(const Tin& base, std::span<const PendingSplit> splits);
  void send_t0(const Tin& base);
  /// @return False where the frame would go beyond the bytes of the request: it is not sent.
  bool send_splits(std::span<PendingSplit> splits, const Certificate& left, GrowingMesh& mesh,
                   Levels& levels);
  void code_level(std::span<const PendingSplit> splits, RangeEncoder& coder, GrowingMesh& mesh);
  void send_end(const Tin& tin);

  const OpenedTerrain& terrain_;
  const StoreFile& store_;
  const StreamRequest& request_;
  const ByteSink& sink_;
  RecordSource source_;
  QueryContext context_;
  SplitCode code_;
  StreamSummary summary_;
  std::uint32_t sequence_ = 0;
  double left_out_ = -1.0;  ///< Largest error of a record that is wanted and beyond `most_splits`.
};

void append_bytes(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
  const std::size_t before = out.size();
  out.resize(before + bytes.size());
  std::copy(bytes.begin(), bytes.end(), out.begin() + static_cast<std::ptrdiff_t>(before));
}

template <class T>
void append(std::vector<std::byte>& out, const T& object) {
  append_bytes(out, std::as_bytes(std::span(&object, 1)));
}

/// Sorts splits by falling rank, and within a rank along the Hilbert curve, where the mesh is in
/// the caches.
void sort_by_rank(std::span<PendingSplit> splits) {
  struct LevelPlace {
    std::uint64_t curve;
    std::uint32_t index;
    std::uint16_t rank;
  };
  std::vector<LevelPlace> places;
  places.reserve(splits.size());
  for (std::uint32_t i = 0; i < splits.size(); ++i) {
    const GridPoint p = point_of(splits[i].u);
    places.push_back(
        {hilbert_position(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y)), i,
         splits[i].rank});
  }
  std::sort(places.begin(), places.end(), [](const LevelPlace& a, const LevelPlace& b) {
    return a.rank != b.rank ? a.rank > b.rank : a.curve < b.curve;
  });
  std::vector<PendingSplit> sorted;
  sorted.reserve(splits.size());
  for (const LevelPlace& p : places) {
    sorted.push_back(splits[p.index]);
  }
  std::copy(sorted.begin(), sorted.end(), splits.begin());
}

/// Records that the servings brought are known before anything is read.
void Writer::admit_what_is_told() const {
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
Tin Writer::base_mesh() {
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

std::vector<PageId> Writer::pages_of(const AttributePredicate& predicate) {
  std::vector<PageId> pages;
  source_.index.search(predicate, pages, context_.cost.io);
  context_.check_stop();
  return pages;
}

/// The records of these pages for which a predicate is true and that are not held.
std::vector<PendingSplit> Writer::all_of_pages(const AttributePredicate& predicate,
                                               std::span<const PageId> pages, const LeftOut& held) {
  std::vector<PendingSplit> splits;
  read_pages(store_, pages, predicate, context_, splits);
  std::erase_if(splits, [&](const PendingSplit& s) { return held.is(s.u); });
  return splits;
}

/// The first `most` records for which a predicate is true and that are not held. Notes the largest error
/// that is left out.
std::vector<PendingSplit> Writer::first_of(const AttributePredicate& predicate, std::uint64_t most,
                                           const LeftOut& held, std::uint64_t fixed_bytes) {
  FirstRecords first = first_records(source_, predicate, Growth{most}, fixed_bytes, context_, held);
  left_out_ = first.largest_error_left;
  return std::move(first.splits);
}

/// The records that are wanted and not held, in the total order. They are closed together with
/// those that are held, and so is any first part of them.
std::vector<PendingSplit> Writer::missing_splits(const Tin& base) {
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
  std::sort(splits.begin(), splits.end(), is_before);
  return splits;
}

/// The certificate of the mesh once all splits before `next` are applied.
Certificate Writer::certificate_from(std::span<const PendingSplit> splits, std::size_t next) const {
  const double left = next < splits.size() ? splits[next].error : left_out_;
  return certify_below(store_, std::max(left, request_.tolerance.value_or(-1.0)));
}

void Writer::send_frame(stream::FrameKind kind, std::span<const std::byte> payload) {
  if (payload.size() > stream::kMaxFrameBytes) {
    throw Error(ErrorCode::resource_exhausted,
                "a frame of the stream would take more than 256 MiB: T0 is too large for a stream",
                store_.path());
  }
  stream::FrameHead head{static_cast<std::uint32_t>(kind), sequence_++,
                         static_cast<std::uint32_t>(payload.size()), 0, 0};
  head.checksum = stream::checksum_of_frame(head, payload);
  send(std::as_bytes(std::span(&head, 1)));
  send(payload);
  ++summary_.frames;
}

void Writer::send_head() {
  const stream::Head head{stream::kMagic, stream::kMajorVersion, stream::kMinorVersion, 0};
  send(std::as_bytes(std::span(&head, 1)));
}

void Writer::send_start(const Tin& base, std::span<const PendingSplit> splits) {
  if (request_.metadata.size() > kMostMetadata) {
    refuse("the stream's metadata is longer than 1 MiB");
  }
  const StoreFacts& f = store_.facts();
  const Certificate now = certificate_from(splits, 0);
  const auto bits = [](double v) { return layout::to_bits(v); };
  const stream::Start start{store_.fingerprint(),
                            static_cast<std::uint32_t>(f.heights.type),
                            !request_.held.empty() ? stream::kIsDelta : 0,
                            bits(f.heights.step),
                            bits(f.heights.offset),
                            bits(f.map.origin_x),
                            bits(f.map.origin_y),
                            bits(f.map.step_x),
                            bits(f.map.step_y),
                            {f.bounds.min_x, f.bounds.min_y, f.bounds.max_x, f.bounds.max_y},
                            bits(f.min_height),
                            bits(f.max_height),
                            bits(f.base_error),
                            bits(f.base_deviation),
                            bits(now.error),
                            bits(now.deviation),
                            base.vertices.size(),
                            stream::digest_of(base),
                            splits.size(),
                            request_.metadata.size()};
  std::vector<std::byte> payload;
  append(payload, start);
  append_bytes(payload, std::as_bytes(std::span(request_.metadata)));
  send_frame(stream::FrameKind::kStart, payload);
}

void Writer::send_t0(const Tin& base) {
  std::vector<std::byte> payload;
  append(payload, stream::T0Counts{static_cast<std::uint32_t>(base.vertices.size()),
                                   static_cast<std::uint32_t>(base.triangles.size())});
  for (VertexId v = 0; v < base.vertices.size(); ++v) {
    const GridPoint p = base.position(v);
    append(payload,
           layout::T0Vertex{p.x, p.y, base.vertices[v].height, base.has_height[v] != 0 ? 1U : 0U});
  }
  for (TriangleId t = 0; t < base.triangles.size(); ++t) {
    const Triangle& c = base.triangles[t];
    append(payload, stream::T0Triangle{{c.v[0], c.v[1], c.v[2]},
                                       base.classes[t] == TriangleClass::kVoid ? 1U : 0U});
  }
  send_frame(stream::FrameKind::kT0, payload);
}

/// Sends one frame. Within it splits come level by level, and in a level by the number of w: an
/// order costs bits only where it says something.
bool Writer::send_splits(std::span<PendingSplit> splits, const Certificate& left, GrowingMesh& mesh,
                         Levels& levels) {
  sort_by_rank(splits);
  const std::vector<std::uint32_t> level = levels.of(splits, context_);
  std::vector<std::vector<PendingSplit>> by_level;
  for (std::size_t i = 0; i < splits.size(); ++i) {
    by_level.resize(std::max<std::size_t>(by_level.size(), level[i] + std::size_t{1}));
    by_level[level[i]].push_back(splits[i]);
  }
  std::vector<std::byte> payload;
  append(payload, stream::Splits{static_cast<std::uint32_t>(splits.size()), 0,
                                 layout::to_bits(left.error), layout::to_bits(left.deviation)});
  const std::size_t before = payload.size();
  RangeEncoder coder(payload);
  code_.begin_block(mesh.tin());
  for (const std::vector<PendingSplit>& one : by_level) {
    code_level(one, coder, mesh);
  }
  coder.finish();
  const std::size_t least =
      (splits.size() + stream::kMostSplitsPerByte - 1) / stream::kMostSplitsPerByte;
  payload.resize(std::max(payload.size(), before + least), std::byte{0});
  const std::uint64_t bytes = summary_.bytes;
  const std::uint64_t whole = bytes + sizeof(stream::FrameHead) + payload.size();
  summary_.is_cut = whole > request_.most_bytes && summary_.split_bytes > 0;
  if (summary_.is_cut) return false;
  send_frame(stream::FrameKind::kSplits, payload);
  summary_.split_bytes += summary_.bytes - bytes;
  return true;
}

void Writer::code_level(std::span<const PendingSplit> splits, RangeEncoder& coder,
                        GrowingMesh& mesh) {
  std::vector<Ordered> order;
  order.reserve(splits.size());
  for (const PendingSplit& s : splits) {
    const VertexId w = mesh.find(s.w);
    if (w == KeyTable::kAbsent) {
      throw_refused(s, "it names a vertex that no record before it makes", context_);
    }
    order.push_back({code_.rank_of(w), w, &s});
  }
  std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return a.rank != b.rank ? a.rank < b.rank : a.split->u < b.split->u;
  });
  bool begins = true;
  for (const auto& [rank, w, s] : order) {
    const LocalSplit local{begins,         w,         mesh.find(s->vl), mesh.find(s->vr),
                           point_of(s->u), s->height, s->flags};
    begins = false;
    if (const char* fault = code_.encode(coder, mesh.tin(), local); fault != nullptr) {
      throw_refused(*s, std::string("it ") + fault, context_);
    }
    mesh.apply(*s, context_);
  }
}

void Writer::send_end(const Tin& tin) {
  const stream::End end{summary_.splits, tin.vertices.size(), stream::digest_of(tin)};
  send_frame(stream::FrameKind::kEnd, std::as_bytes(std::span(&end, 1)));
}

}  // namespace

StreamSummary write_stream(const OpenedTerrain& terrain, const StreamRequest& request,
                           const ByteSink& sink) {
  return Writer(terrain, request, sink).run();
}

}  // namespace ptin
