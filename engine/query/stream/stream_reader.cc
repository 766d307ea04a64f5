// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/stream/stream_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "engine/error.h"
#include "engine/mesh/split.h"
#include "engine/query/refine/split_site.h"
#include "engine/query/select/coarsest.h"
#include "engine/query/stream/split_decoder.h"
#include "engine/stop.h"
#include "storage/coarsest_tin.h"
#include "storage/facts.h"
#include "storage/file_beginning.h"
#include "storage/metadata_text.h"

namespace ptin {

namespace {

template <class T>
T read_object(std::span<const std::byte> bytes) {
  T object;
  std::memcpy(&object, bytes.data(), sizeof object);
  return object;
}

template <class T>
std::vector<T> read_array(std::span<const std::byte> bytes, std::size_t count) {
  std::vector<T> array(count);
  if (count != 0) {
    std::memcpy(array.data(), bytes.data(), count * sizeof(T));
  }
  return array;
}

StoreFacts facts_of(const stream::Start& s) {
  StoreFacts f;
  f.map = {layout::to_double(s.origin_x), layout::to_double(s.origin_y),
           layout::to_double(s.step_x), layout::to_double(s.step_y)};
  f.heights = {static_cast<HeightType>(s.height_type), layout::to_double(s.height_step),
               layout::to_double(s.height_offset)};
  f.bounds = {s.bounds[0], s.bounds[1], s.bounds[2], s.bounds[3]};
  f.min_height = layout::to_double(s.min_height);
  f.max_height = layout::to_double(s.max_height);
  f.base_error = layout::to_double(s.base_error);
  f.base_deviation = layout::to_double(s.base_deviation);
  return f;
}

bool is_bound(double v) { return v >= 0; }

/// Most bytes that a mesh of so many vertices takes while it grows, with its vertices along the
/// curve: arrays that grow hold up to twice what is in them.
std::uint64_t growing_bytes(std::uint64_t vertices) {
  constexpr std::uint64_t kMesh = sizeof(Vertex) + 1 + 2 * (sizeof(Triangle) + 1);
  constexpr std::uint64_t kAlongCurve = 16;
  return vertices * 2 * (kMesh + kAlongCurve);
}

}  // namespace

StreamReader::StreamReader(std::string name, StreamReaderOptions options)
    : name_(std::move(name)), options_(std::move(options)) {}
StreamReader::StreamReader(StreamReader&&) noexcept = default;
StreamReader& StreamReader::operator=(StreamReader&&) noexcept = default;
StreamReader::~StreamReader() = default;

std::string StreamReader::place() const {
  return name_ + ", frame " + std::to_string(sequence_) + " at byte " + std::to_string(offset_);
}

void StreamReader::reject(const std::string& why) const {
  const char* const before = has_mesh() ? "; what came before it is sound and can be kept" : "";
  throw Error(ErrorCode::corruption, why + before, place());
}

void StreamReader::check_stop() const { stop_if_asked(options_.limits.stop, "receiving", name_); }

void StreamReader::admit(std::uint64_t bytes) const {
  if (bytes <= options_.limits.memory_bytes) return;
  throw Error(ErrorCode::resource_exhausted,
              "what the stream brings may take " + std::to_string(bytes) +
                  " bytes, and the limit is " + std::to_string(options_.limits.memory_bytes) +
                  "; raise it, or ask the sender for less (a larger error, a window)",
              place());
}

void StreamReader::begin_next() {
  offset_ += waiting_.size();
  waiting_.clear();
  sequence_ = 0;
  complete_ = false;
  expects_ = Expects::kHead;
}

std::size_t StreamReader::wanted() const {
  if (expects_ == Expects::kHead) {
    return sizeof(stream::Head);
  }
  if (waiting_.size() < sizeof(stream::FrameHead)) {
    return sizeof(stream::FrameHead);
  }
  const auto head = read_object<stream::FrameHead>(waiting_);
  if (head.bytes > stream::kMaxFrameBytes || head.reserved != 0 || head.sequence != sequence_) {
    reject("the head of the frame holds values that no program wrote");
  }
  admit(growing_bytes(tin_.vertices.size()) + head.bytes);
  return sizeof(stream::FrameHead) + head.bytes;
}

std::size_t StreamReader::feed(std::span<const std::byte> bytes, bool one_frame) {
  const std::size_t given = bytes.size();
  if (expects_ == Expects::kNothing) {
    reject("the stream was rejected before");
  }
  if (expects_ == Expects::kHead && waiting_.empty() && !bytes.empty()) {
    complete_ = false;  // From its first byte on the next stream is the current one.
    splits_ = splits_in_all_ = 0;
  }
  try {
    while (true) {
      const std::size_t missing = wanted() - waiting_.size();
      const std::size_t taken = std::min(missing, bytes.size());
      waiting_.insert(waiting_.end(), bytes.begin(),
                      bytes.begin() + static_cast<std::ptrdiff_t>(taken));
      bytes = bytes.subspan(taken);
      if (expects_ == Expects::kHead) {
        check_magic();
      }
      if (taken < missing) {
        return given;
      }
      if (waiting_.size() == wanted()) {
        take(waiting_);
        offset_ += waiting_.size();
        waiting_.clear();
        if (one_frame || is_complete()) {
          return given - bytes.size();
        }
      }
    }
  } catch (...) {
    expects_ = Expects::kNothing;
    throw;
  }
}

void StreamReader::take(std::span<const std::byte> bytes) {
  if (expects_ == Expects::kHead) {
    take_head(bytes);
    return;
  }
  const auto head = read_object<stream::FrameHead>(bytes);
  const std::span<const std::byte> payload = bytes.subspan(sizeof head);
  if (stream::checksum_of_frame(head, payload) != head.checksum) {
    reject("the frame does not match its checksum; the stream is damaged");
  }
  take_frame(head, payload);
  ++sequence_;
}

/// Checks as much of the magic as has arrived: so a few bytes of something else are not taken for a
/// stream that was cut.
void StreamReader::check_magic() const {
  const auto begins_like = [this](const std::array<std::uint8_t, 8>& magic) {
    const std::size_t bytes = std::min(waiting_.size(), magic.size());
    return std::equal(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(bytes),
                      magic.begin(), [](std::byte a, std::uint8_t b) { return a == std::byte{b}; });
  };
  if (begins_like(stream::kMagic)) return;
  if (begins_like(layout::kMagic)) {
    throw Error(ErrorCode::invalid_argument,
                "this is a store, not a stream; `ptin refine` makes a mesh of it, `ptin stream` a "
                "stream",
                name_);
  }
  const auto first =
      std::span(std::as_const(waiting_)).first(std::min(waiting_.size(), kBeginningBytes));
  std::size_t agree = 0;
  for (std::size_t i = 0; i < std::min(first.size(), stream::kMagic.size()); ++i) {
    agree += first[i] == std::byte{stream::kMagic[i]} ? 1 : 0;
  }
  // Bytes that follow a stream, or begin nearly like one, were meant to be one.
  if (has_mesh() || 2 * agree > std::min(first.size(), stream::kMagic.size()))
    reject("the first bytes are not those of a stream; it is damaged");
  throw Error(ErrorCode::invalid_argument, "this is not a stream of ptin: " + beginning_of(first),
              name_);
}

void StreamReader::take_head(std::span<const std::byte> bytes) {
  const auto head = read_object<stream::Head>(bytes);
  if (head.major_version > stream::kMajorVersion) {
    throw Error(ErrorCode::unsupported_version,
                "the stream has version " + std::to_string(head.major_version) +
                    ", this program reads up to version " + std::to_string(stream::kMajorVersion) +
                    "; use a newer one",
                name_);
  }
  const bool newer = head.minor_version > stream::kMinorVersion;
  if (head.major_version == 0 || (head.reserved != 0 && !newer)) {
    reject("the head of the stream holds values that no program wrote");
  }
  sequence_ = 0;
  complete_ = false;
  expects_ = Expects::kStart;
}

void StreamReader::take_frame(const stream::FrameHead& head, std::span<const std::byte> payload) {
  const auto kind = static_cast<stream::FrameKind>(head.kind);
  if (kind == stream::FrameKind::kStart && expects_ == Expects::kStart) {
    take_start(payload);
  } else if (kind == stream::FrameKind::kT0 && expects_ == Expects::kT0) {
    take_t0(payload);
  } else if (kind == stream::FrameKind::kSplits && expects_ == Expects::kSplits) {
    take_splits(payload);
  } else if (kind == stream::FrameKind::kEnd && expects_ == Expects::kSplits) {
    take_end(payload);
  } else {
    reject("a frame of this kind cannot come here");
  }
}

void StreamReader::take_start(std::span<const std::byte> payload) {
  if (payload.size() < sizeof(stream::Start)) {
    reject("the start of the stream is too short");
  }
  const auto start = read_object<stream::Start>(payload);
  const std::span<const std::byte> text = payload.subspan(sizeof start);
  StoreFacts facts = facts_of(start);
  const Certificate now{layout::to_double(start.error), layout::to_double(start.deviation), false};
  if (const char* fault = fault_in(facts); fault != nullptr) {
    reject(std::string("the start of the stream: ").append(fault));
  }
  if (start.metadata_bytes != text.size() || (start.flags & ~stream::kIsDelta) != 0 ||
      !is_bound(now.error) || !is_bound(now.deviation) ||
      nesting_of({reinterpret_cast<const char*>(text.data()), text.size()}) > kMostNesting) {
    reject("the start of the stream holds values that no program wrote");
  }
  const bool is_delta = (start.flags & stream::kIsDelta) != 0;
  if (is_delta != has_mesh()) {
    reject(is_delta ? "the stream goes on from another one, which must come first"
                    : "the stream begins anew, and there is a mesh already");
  }
  if (is_delta) {
    if (start.fingerprint != fingerprint_ || start.base_vertices != tin_.vertices.size() ||
        start.base_digest != digest_) {
      reject(start.fingerprint != fingerprint_
                 ? "the stream goes on from one of another file"
                 : "the stream goes on from another mesh than this one: what was said to be there "
                   "is not what is");
    }
    check_stop();
    admit(growing_bytes(tin_.vertices.size()) * 3 / 2);
    tin_ = stream::numbered_by_key(tin_);
    ++numbering_;
  }
  fingerprint_ = start.fingerprint;
  facts_ = facts;
  base_vertices_ = start.base_vertices;
  base_digest_ = start.base_digest;
  metadata_.assign(reinterpret_cast<const char*>(text.data()), text.size());
  certificate_ = now;
  splits_ = 0;
  splits_in_all_ = start.splits;
  code_ = std::make_unique<SplitDecoder>(facts.heights.type);
  expects_ = is_delta ? Expects::kSplits : Expects::kT0;
}

void StreamReader::take_t0(std::span<const std::byte> payload) {
  if (payload.size() < sizeof(stream::T0Counts)) {
    reject("T0 is too short");
  }
  const auto counts = read_object<stream::T0Counts>(payload);
  const std::span<const std::byte> rest = payload.subspan(sizeof counts);
  const std::uint64_t vertex_bytes = std::uint64_t{counts.vertices} * sizeof(layout::T0Vertex);
  if (counts.vertices != base_vertices_ || counts.triangles == 0 ||
      vertex_bytes + std::uint64_t{counts.triangles} * sizeof(stream::T0Triangle) != rest.size()) {
    reject("the counts of T0 are not those of its bytes");
  }
  admit(growing_bytes(counts.vertices) + 4 * payload.size());  // read, checked, and as a mesh
  CoarsestTin t0;
  for (const auto& v : read_array<layout::T0Vertex>(rest, counts.vertices)) {
    if (!t0.vertices.empty() && key_of(t0.vertices.back().position) >= key_of({v.x, v.y})) {
      reject("the vertices of T0 do not ascend");
    }
    t0.vertices.push_back({{v.x, v.y}, v.height, v.has_height});
  }
  for (const auto& t :
       read_array<stream::T0Triangle>(rest.subspan(vertex_bytes), counts.triangles)) {
    t0.triangles.push_back({{t.v[0], t.v[1], t.v[2]}, t.is_void, kLivesOn});
  }
  if (const char* fault = fault_in(t0, facts_); fault != nullptr) {
    reject(fault);
  }
  Tin tin = mesh_of(t0, place());
  digest_ = stream::digest_of(tin);
  if (digest_ != base_digest_) {
    reject("T0 is not what the start of the stream says");
  }
  tin_ = std::move(tin);
  ++numbering_;
  t0_vertices_ = counts.vertices;
  expects_ = Expects::kSplits;
}

void StreamReader::take_splits(std::span<const std::byte> payload) {
  if (payload.size() < sizeof(stream::Splits)) {
    reject("the frame of splits is too short");
  }
  const auto head = read_object<stream::Splits>(payload);
  const std::span<const std::byte> bytes = payload.subspan(sizeof head);
  const Certificate now{layout::to_double(head.error), layout::to_double(head.deviation), false};
  if (head.reserved != 0 || head.count == 0 || head.count > splits_in_all_ - splits_ ||
      head.count > bytes.size() * stream::kMostSplitsPerByte || !is_bound(now.error) ||
      !is_bound(now.deviation)) {
    reject("the frame holds a number of splits or bounds that no program wrote");
  }
  const std::uint64_t vertices = tin_.vertices.size();
  if (head.count < std::min(vertices / stream::kLeastShare, stream::kMostLeastSplits) &&
      head.count != splits_in_all_ - splits_) {
    reject("the frame holds fewer splits than a frame for so large a mesh has");
  }
  admit(growing_bytes(vertices + head.count) + payload.size());
  RangeDecoder coder(bytes);
  code_->begin_block(tin_);
  for (std::uint32_t i = 0; i < head.count; ++i) {
    if (i % kStopInterval == 0) check_stop();
    LocalSplit split;
    if (const char* fault = code_->decode(coder, tin_, split); fault != nullptr) {
      reject("split " + std::to_string(i) + " " + fault);
    }
    apply(split);
  }
  const bool padded = std::all_of(
      bytes.begin() + static_cast<std::ptrdiff_t>(std::min(coder.taken(), bytes.size())),
      bytes.end(), [](std::byte b) { return b == std::byte{0}; });
  if (coder.taken() > bytes.size() || !padded) {
    reject("the code does not end with its last split");
  }
  splits_ += head.count;
  certificate_ = now;
}

/// Applies a split that decode() gave. Its corners are in order and its classes fit. What is left
/// to check, the geometry of a border and of the new triangles, split() checks.
void StreamReader::apply(const LocalSplit& s) {
  const auto u = static_cast<VertexId>(tin_.vertices.size());
  if (u >= kNone / 2) {
    throw Error(ErrorCode::resource_exhausted,
                "the stream has more vertices than one mesh can number", place());
  }
  const bool has_height = (s.flags & VertexSplit::kVertexVoid) == 0;
  tin_.vertices.push_back({s.u, s.height, kNone});
  tin_.has_height.push_back(has_height ? 1 : 0);
  if (!split(tin_, site_of(u, s.w, s.vl, s.vr, s.flags)).applied) {
    tin_.vertices.pop_back();
    tin_.has_height.pop_back();
    reject("a split does not fit the mesh");
  }
  digest_ += stream::digest_of(s.u, s.height, has_height);
}

void StreamReader::take_end(std::span<const std::byte> payload) {
  if (payload.size() != sizeof(stream::End)) {
    reject("the end of the stream is no end");
  }
  const auto end = read_object<stream::End>(payload);
  if (end.splits != splits_ || splits_ != splits_in_all_ || end.vertices != tin_.vertices.size() ||
      end.digest != digest_) {
    reject("the mesh at the end of the stream is not the one that was sent");
  }
  complete_ = true;
  expects_ = Expects::kHead;
}

}  // namespace ptin
