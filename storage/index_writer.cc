// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/index_writer.h"

#include <algorithm>
#include <utility>

#include "engine/check.h"
#include "storage/file/checksum.h"

namespace ptin {

namespace {

constexpr std::size_t kBufferedLeaves = 16;

/// A segment of fewer pages would leave more room in its last leaf than leaves of its own are worth.
constexpr std::uint64_t kLeastSegmentPages = 2 * layout::kFanOut;
/// A segment is no smaller a part of the pages up to its end, so that the table of segments stays short.
/// At 10^9 vertices it takes 6 KB, and comes with the opening of a file elsewhere.
constexpr std::uint64_t kLeastSegmentPart = 512;
/// More have no names of 32 bits.
constexpr std::uint64_t kMostSegmentPages = std::uint64_t{1} << IndexShape::kNameBits;

// The entry by which the level above describes a finished node.
layout::NodeEntry describe(const layout::IndexNode& node, const HeightEncoding& heights) {
  Descriptor all(heights);
  for (std::uint32_t i = 0; i < node.entries; ++i) {
    all.add(node.entry[i]);
  }
  layout::NodeEntry entry = all.entry();
  entry.checksum = checksum_of_object(node);
  return entry;
}

// Packs entries into the nodes of `level`.
std::vector<layout::IndexNode> pack(const std::vector<layout::NodeEntry>& entries,
                                    std::uint32_t level) {
  std::vector<layout::IndexNode> nodes((entries.size() - 1) / layout::kFanOut + 1);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    layout::IndexNode& node = nodes[i / layout::kFanOut];
    node.level = level;
    node.number = i / layout::kFanOut;
    node.entry[node.entries++] = entries[i];
  }
  return nodes;
}

}  // namespace

IndexWriter::IndexWriter(FileLayer& files, std::string folder, std::string stem,
                         const HeightEncoding& heights)
    : files_(files), folder_(std::move(folder)), stem_(std::move(stem)), heights_(heights) {}

void IndexWriter::add(const layout::NodeEntry& page) {
  if (segment_pages_ == kMostSegmentPages) {
    cut();
  }
  leaf_.entry[leaf_.entries++] = page;
  ++pages_;
  ++segment_pages_;
  if (leaf_.entries == layout::kFanOut) {
    finish_leaf();
  }
}

void IndexWriter::end_segment() {
  if (segment_pages_ >= std::max(kLeastSegmentPages, pages_ / kLeastSegmentPart)) {
    cut();
  }
}

void IndexWriter::finish() {
  if (segment_pages_ > 0) {
    cut();
  }
}

void IndexWriter::cut() {
  if (leaf_.entries > 0) {
    finish_leaf();
  }
  segments_.push_back(segment_pages_);
  segment_pages_ = 0;
  segment_leaves_ = 0;
}

void IndexWriter::finish_leaf() {
  // As IndexShape::name_of() has it.
  leaf_.number = std::uint64_t{segments_.size()} << 32 | segment_leaves_++;
  parents_.push_back(describe(leaf_, heights_));
  buffer_.push_back(leaf_);
  leaf_ = {};
  if (buffer_.size() == kBufferedLeaves) {
    if (!side_file_) {
      side_file_ = std::make_unique<ScratchFile>(files_, folder_, stem_ + ".index", true);
    }
    side_file_->write_at(std::as_bytes(std::span(buffer_)), spilled_ * layout::kNodeBytes);
    spilled_ += buffer_.size();
    buffer_.clear();
  }
}

void IndexWriter::walk(const PageVisitor& visit) const {
  std::uint64_t page = 0;
  const auto take = [&](const layout::IndexNode& leaf) {
    for (std::uint32_t i = 0; i < leaf.entries; ++i) {
      visit(page++, leaf.entry[i]);
    }
  };
  std::vector<layout::IndexNode> leaves(spilled_ > 0 ? kBufferedLeaves
                                                     : 0);  // spilled so many at once
  for (std::uint64_t leaf = 0; leaf < spilled_; leaf += leaves.size()) {
    side_file_->read_at(std::as_writable_bytes(std::span(leaves)), leaf * layout::kNodeBytes);
    std::for_each(leaves.begin(), leaves.end(), take);
  }
  std::for_each(buffer_.begin(), buffer_.end(), take);
  take(leaf_);
}

std::uint64_t IndexWriter::write_to(ScratchFile& out, std::uint64_t offset) {
  if (pages_ == 0) {
    return 0;
  }
  PTIN_CHECK(segment_pages_ == 0);
  const IndexShape shape(segments_);
  const auto place = [&](std::uint32_t level, std::uint64_t number) {
    return offset + shape.position(level, number) * layout::kNodeBytes;
  };
  if (spilled_ > 0) {
    out.copy_from(*side_file_, 0, spilled_ * layout::kNodeBytes, place(0, 0));
  }
  out.write_at(std::as_bytes(std::span(buffer_)), place(0, spilled_));
  std::vector<layout::NodeEntry> entries = std::move(parents_);
  for (std::uint32_t level = 1; level < shape.levels(); ++level) {
    const std::vector<layout::IndexNode> nodes = pack(entries, level);
    out.write_at(std::as_bytes(std::span(nodes)), place(level, 0));
    entries.clear();
    for (const layout::IndexNode& node : nodes) {
      entries.push_back(describe(node, heights_));
    }
  }
  PTIN_CHECK(entries.size() == 1);
  return entries[0].checksum;
}

}  // namespace ptin
