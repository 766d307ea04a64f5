// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/stream/stream_writer.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "engine/query/stream/frame_coder.h"
#include "engine/query/stream/stream_format.h"
#include "engine/query/stream/stream_frames.h"

namespace ptin {

namespace {

constexpr std::size_t kMostMetadata = std::size_t{1} << 20;

class Writer {
 public:
  Writer(const OpenedTerrain& terrain, const StreamRequest& request, const ByteSink& sink)
      : terrain_(terrain),
        store_(terrain.store()),
        request_(request),
        sink_(sink),
        context_(request.limits, store_.path()) {}

  StreamSummary run() {
    const auto start = std::chrono::steady_clock::now();
    frames_ = fits_as_a_whole() ? whole_stream(terrain_, request_, context_)
                                : stream_in_parts(terrain_, request_, context_);
    summary_.base_vertices = frames_->base_vertices();
    send_head();
    send_start();
    if (request_.held.empty()) {
      send_t0(stream::numbered_by_key(terrain_.t0()));
    }
    summary_.certificate = certificate_before(0);
    FrameCoder coder(frames_->begin(), store_.path());
    const FrameCuts& cuts = frames_->cuts();
    for (std::size_t frame = 0; frame < cuts.frames(); ++frame) {
      context_.check_stop();
      if (!send_splits(frame, coder)) break;
      summary_.certificate = certificate_before(frame + 1);
      summary_.splits = cuts.begin(frame + 1);
    }
    if (!summary_.is_cut) send_end();
    context_.cost.records_applied = summary_.splits;
    summary_.cost = context_.cost;
    summary_.cost.seconds = seconds_since(start);
    return summary_;
  }

 private:
  [[nodiscard]] bool fits_as_a_whole();
  [[nodiscard]] std::uint64_t most_records_of(const PredicatePtr& predicate);
  /// The certificate of the mesh once all splits before a frame are applied.
  [[nodiscard]] Certificate certificate_before(std::size_t frame) const {
    return certify_below(
        store_, std::max(frames_->cuts().error_before(frame), request_.tolerance.value_or(-1.0)));
  }
  void send(std::span<const std::byte> bytes) {
    sink_(bytes);
    summary_.bytes += bytes.size();
  }
  void send_frame(stream::FrameKind kind, std::span<const std::byte> payload);
  void send_head();
  void send_start();
  void send_t0(const Tin& base);
  /// @return False where the frame would go beyond the bytes of the request: it is not sent.
  bool send_splits(std::size_t frame, FrameCoder& coder);
  void send_end();

  const OpenedTerrain& terrain_;
  const StoreFile& store_;
  const StreamRequest& request_;
  const ByteSink& sink_;
  QueryContext context_;
  std::unique_ptr<StreamFrames> frames_;
  std::vector<std::byte> coded_;
  StreamSummary summary_;
  std::uint32_t sequence_ = 0;
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

std::uint64_t Writer::most_records_of(const PredicatePtr& predicate) {
  std::vector<PageId> pages;
  terrain_.index().search(predicate ? *predicate : *everything(), pages, context_.cost.io);
  return most_records(store_, pages);
}

/// Whether all that is held and sent is certain to fit the memory; the index is asked where the number
/// of all records does not decide it.
bool Writer::fits_as_a_whole() {
  if (request_.temporary_folder.empty()) return true;
  const std::uint64_t limit = std::min(request_.limits.memory_bytes, request_.most_part_bytes);
  const std::uint64_t t0 = terrain_.t0().vertices.size(), all = store_.record_count();
  const auto fit = [&](std::uint64_t held, std::uint64_t splits) {
    const std::uint64_t finding = held == 0 && splits < request_.most_splits ? 0 : held + splits;
    return std::max(bytes_of_sending(t0 + held, splits), 2 * refinement_bytes(finding)) <= limit;
  };
  if (fit(request_.held.empty() ? 0 : all, all)) return true;
  std::uint64_t held = 0;
  for (const StreamHeld& serving : request_.held) {
    held += std::min(serving.splits, most_records_of(serving.predicate));
  }
  const std::uint64_t splits = std::min(request_.most_splits, most_records_of(request_.wanted));
  return fit(std::min(held, all), splits);
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

void Writer::send_start() {
  if (request_.metadata.size() > kMostMetadata) {
    refuse("the stream's metadata is longer than 1 MiB");
  }
  const StoreFacts& f = store_.facts();
  const Certificate now = certificate_before(0);
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
                            frames_->base_vertices(),
                            frames_->base_digest(),
                            frames_->cuts().splits(),
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
bool Writer::send_splits(std::size_t frame, FrameCoder& coder) {
  const std::uint64_t count = frames_->cuts().count(frame);
  const Certificate left = certificate_before(frame + 1);
  frames_->take(frame, coded_);
  std::vector<std::byte> payload;
  append(payload, stream::Splits{static_cast<std::uint32_t>(count), 0, layout::to_bits(left.error),
                                 layout::to_bits(left.deviation)});
  const std::size_t before = payload.size();
  coder.code(coded_, count, payload);
  frames_->count_vertices(frame, coder);
  const std::size_t least = (count + stream::kMostSplitsPerByte - 1) / stream::kMostSplitsPerByte;
  payload.resize(std::max(payload.size(), before + least), std::byte{0});
  const std::uint64_t bytes = summary_.bytes;
  const std::uint64_t whole = bytes + sizeof(stream::FrameHead) + payload.size();
  summary_.is_cut = whole > request_.most_bytes && summary_.split_bytes > 0;
  if (summary_.is_cut) return false;
  send_frame(stream::FrameKind::kSplits, payload);
  summary_.split_bytes += summary_.bytes - bytes;
  return true;
}

void Writer::send_end() {
  const stream::End end{summary_.splits, frames_->base_vertices() + summary_.splits,
                        frames_->base_digest() + frames_->digest()};
  send_frame(stream::FrameKind::kEnd, std::as_bytes(std::span(&end, 1)));
}

}  // namespace

StreamSummary write_stream(const OpenedTerrain& terrain, const StreamRequest& request,
                           const ByteSink& sink) {
  return Writer(terrain, request, sink).run();
}

}  // namespace ptin
