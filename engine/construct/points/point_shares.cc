// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_shares.h"

#include <algorithm>
#include <utility>

#include "engine/construct/points/point_spool.h"
#include "engine/error.h"
#include "engine/stop.h"
#include "storage/file/checksum.h"

namespace ptin {

namespace {

/// Writes records to the ranges of one file.
template <PlainValue Record>
class ShareWriter {
 public:
  ShareWriter(const SortPlan& plan, const PointFiles& files, std::size_t share)
      : plan_(plan),
        file_(files.files, without_old(files.files, files.path("share", share)),
              ScratchFile::Kept::kNew),
        waiting_(plan.ranges()),
        blocks_(plan.ranges()) {}

  void add(const Record& record) {
    const std::size_t range = plan_.range_of(record.key);
    std::vector<Record>& waiting = waiting_[range];
    if (waiting.capacity() == 0) {
      waiting.reserve(plan_.block_records);
    }
    waiting.push_back(record);
    if (waiting.size() == plan_.block_records) {
      write(range);
    }
  }
  void finish(ArrayFileWriter& facts, ShareCounts counts) {
    for (std::size_t range = 0; range < waiting_.size(); ++range) {
      write(range);
    }
    file_.close();
    counts.records = records_;
    facts.values(counts);
    for (const std::vector<ShareBlock>& blocks : blocks_) {
      facts.put(blocks);
    }
  }

 private:
  void write(std::size_t range) {
    std::vector<Record>& waiting = waiting_[range];
    if (waiting.empty()) {
      return;
    }
    const auto bytes = std::as_bytes(std::span<const Record>(waiting));
    file_.write_at(bytes, offset_);
    blocks_[range].push_back({offset_, waiting.size(), checksum_of(bytes)});
    offset_ += bytes.size();
    records_ += waiting.size();
    waiting.clear();
  }

  const SortPlan& plan_;
  ScratchFile file_;
  std::vector<std::vector<Record>> waiting_;
  std::vector<std::vector<ShareBlock>> blocks_;
  std::uint64_t offset_ = 0, records_ = 0;
};

/// Calls visit(points, number of the first of them) for the blocks of a share.
template <class Visit>
void visit_blocks(const SortPlan& plan, const PointFiles& files, std::uint64_t share,
                  const Visit& visit) {
  std::uint64_t all = 0;
  for (const PointReading::Spool& spool : plan.spools) {
    all += spool_blocks(spool.points);
  }
  const std::uint64_t begin = all * share / plan.shares, end = all * (share + 1) / plan.shares;
  std::uint64_t first_block = 0, first_point = 0;
  std::vector<SourcePoint> points;
  for (const PointReading::Spool& spool : plan.spools) {
    const std::uint64_t blocks = spool_blocks(spool.points);
    const std::uint64_t from = std::max(begin, first_block);
    const std::uint64_t to = std::min(end, first_block + blocks);
    if (from < to) {
      ArrayFileReader file = files.open(files.path("spool", spool.number), spool.facts);
      skip_blocks(file, from - first_block);
      for (std::uint64_t block = from - first_block; block < to - first_block; ++block) {
        read_block(file, points);
        visit(points, first_point + block * kSpoolBlock);
      }
    }
    first_block += blocks;
    first_point += spool.points;
  }
}

/// Calls add(key, height) for those vertices of lines that a share takes. No point of the source that
/// is shared out lies where one of them does.
template <class Add>
void add_fixed_vertices(const SortPlan& plan, std::uint64_t share, const Add& add) {
  const PointOrder order = plan.order();
  const std::span<const GridVertex> all = plan.fixed.vertices();
  const std::size_t begin = all.size() * share / plan.shares;
  const std::size_t end = all.size() * (share + 1) / plan.shares;
  for (const GridVertex& v : all.subspan(begin, end - begin)) {
    add(order.key(v.position), v.height);
  }
}

template <class Record>
Record record_of(std::uint64_t key, double height, std::uint64_t number) {
  if constexpr (std::is_same_v<Record, NumberedHeight>) {
    return {key, height, number};
  } else {
    return {key, height};
  }
}

template <class Record>
ArrayFileFacts share_out_as(const SortPlan& plan, const PointFiles& files, const Task& task) {
  const PointOrder order = plan.order();
  ShareWriter<Record> writer(plan, files, number_of(task.name));
  ShareCounts counts;
  std::uint64_t done = 0;
  visit_blocks(plan, files, number_of(task.name),
               [&](const std::vector<SourcePoint>& points, std::uint64_t number) {
                 stop_if_asked(task.stop, "sorting the points");
                 for (const SourcePoint& p : points) {
                   const GridPoint position = plan.grid.position(p);
                   counts.largest_shift_plan =
                       std::max(counts.largest_shift_plan, plan.grid.shift(p));
                   const std::uint64_t n = number++;
                   if (!plan.fixed.is_empty()) {
                     if (plan.fixed.vertex_at(position) != KeyTable::kAbsent) {
                       continue;
                     }
                     if (!plan.fixed.holds(position)) {
                       ++counts.left_out;
                       continue;
                     }
                   }
                   writer.add(record_of<Record>(order.key(position), plan.grid.height(p.z), n));
                 }
                 done += points.size();
                 task.tell(done);
               });
  add_fixed_vertices(plan, number_of(task.name), [&](std::uint64_t key, double height) {
    writer.add(record_of<Record>(key, height, 0));
  });
  ArrayFileWriter facts(files.files, files.path("shared", number_of(task.name)));
  writer.finish(facts, counts);
  return facts.finish();
}

}  // namespace

ArrayFileFacts share_out(const SortPlan& plan, const PointFiles& files, const Task& task) {
  return plan.is_numbered() ? share_out_as<NumberedHeight>(plan, files, task)
                            : share_out_as<KeyedHeight>(plan, files, task);
}

ShareCounts counts_of_share(const PointFiles& files, std::size_t share,
                            const ArrayFileFacts& facts) {
  ArrayFileReader file = files.open(files.path("shared", share), facts);
  ShareCounts counts;
  file.values(counts);
  return counts;
}

RangeOfShares::RangeOfShares(const PointFiles& files, const std::vector<ArrayFileFacts>& shares,
                             std::size_t range)
    : files_(files), blocks_(shares.size()) {
  for (std::size_t share = 0; share < shares.size(); ++share) {
    ArrayFileReader file = files.open(files.path("shared", share), shares[share]);
    file.skip();  // the counts
    for (std::size_t i = 0; i < range; ++i) {
      file.skip();
    }
    blocks_[share] = file.take_copy<ShareBlock>();
    for (const ShareBlock& block : blocks_[share]) {
      records_ += block.records;
    }
  }
}

void RangeOfShares::read_block(const ScratchFile& file, const std::string& path,
                               const ShareBlock& block, std::span<std::byte> bytes) {
  if (block.offset + bytes.size() > file.size()) {
    refuse_damaged(path);
  }
  file.read_at(bytes, block.offset);
  if (checksum_of(bytes) != block.checksum) {
    refuse_damaged(path);
  }
}

}  // namespace ptin
