// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/page_journal.h"

#include <algorithm>

#include "engine/error.h"
#include "storage/file/checksum.h"

namespace ptin {

namespace {

constexpr std::uint64_t kMarkMagic = 0x6b72614d6e697450U;  // "PtinMark"
constexpr std::size_t kBufferedEntries = 4096;

std::uint64_t next_in_chain(std::uint64_t chain, const layout::NodeEntry& page) {
  struct {
    std::uint64_t chain;
    layout::NodeEntry page;
  } link{chain, page};
  return checksum_of_object(link);
}

std::uint64_t mark_checksum(const PublishMark& mark) {
  return ptin::checksum_of(
      std::as_bytes(std::span(&mark, 1)).first(offsetof(PublishMark, checksum)));
}

}  // namespace

PageJournal::PageJournal(FileLayer& files, const std::string& path, ScratchFile::Kept kept)
    : path_(path), file_(files, path, kept) {}

void PageJournal::add(const layout::NodeEntry& page) {
  pending_.push_back(page);
  chain_ = next_in_chain(chain_, page);
  ++pages_;
  if (pending_.size() == kBufferedEntries) {
    write_pending();
  }
}

void PageJournal::write_pending() {
  file_.write_at(std::as_bytes(std::span(pending_)), written_ * sizeof(layout::NodeEntry));
  written_ += pending_.size();
  pending_.clear();
}

void PageJournal::sync() {
  write_pending();
  file_.sync();
}

void PageJournal::mark(std::uint64_t moved_bytes, std::uint64_t moved_to) {
  write_pending();
  PublishMark mark{kMarkMagic, written_, moved_bytes, moved_to, 0};
  mark.checksum = mark_checksum(mark);
  file_.write_at(std::as_bytes(std::span(&mark, 1)), written_ * sizeof(layout::NodeEntry));
  file_.sync();
}

std::optional<PublishMark> PageJournal::find_mark() const {
  const std::uint64_t bytes = file_.size();
  if (bytes < sizeof(PublishMark)) {
    return std::nullopt;
  }
  PublishMark mark;
  file_.read_at(std::as_writable_bytes(std::span(&mark, 1)), bytes - sizeof mark);
  const bool is_sound = mark.magic == kMarkMagic && mark.checksum == mark_checksum(mark) &&
                        mark.pages == (bytes - sizeof mark) / sizeof(layout::NodeEntry);
  return is_sound ? std::optional(mark) : std::nullopt;
}

void PageJournal::replay(std::uint64_t pages, std::uint64_t chain,
                         const std::function<void(const layout::NodeEntry&)>& page) {
  const auto refuse = [this](const char* what) { throw Error(ErrorCode::corruption, what, path_); };
  if (file_.size() / sizeof(layout::NodeEntry) < pages) {
    refuse("the unfinished build's list of pages is shorter than its manifest says");
  }
  pages_ = chain_ = 0;
  std::vector<layout::NodeEntry> entries(kBufferedEntries);
  while (pages_ < pages) {
    const auto part = std::span(entries).first(
        static_cast<std::size_t>(std::min<std::uint64_t>(kBufferedEntries, pages - pages_)));
    file_.read_at(std::as_writable_bytes(part), pages_ * sizeof(layout::NodeEntry));
    for (const layout::NodeEntry& entry : part) {
      page(entry);
      chain_ = next_in_chain(chain_, entry);
      ++pages_;
    }
  }
  if (chain_ != chain) {
    refuse("the unfinished build's list of pages is not the one that its manifest speaks of");
  }
  file_.truncate(pages_ * sizeof(layout::NodeEntry));
  written_ = pages_;
}

}  // namespace ptin
