// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/verify_floor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <vector>

#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "engine/geometry/interval.h"
#include "storage/file/checksum.h"
#include "storage/floor.h"
#include "storage/floor_page.h"
#include "storage/floor_writer.h"

namespace ptin {

namespace {

using PageBytes = std::array<std::byte, layout::kFloorPageBytes + kFloorTileTail>;

std::string page_name(std::uint64_t number) { return "page of heights " + std::to_string(number); }

/// Packs the tiles of pages again, one page after the other.
class PagesAgain {
 public:
  explicit PagesAgain(const TellFault& tell) : tell_(tell) {}

  /// Begins with a page, whose tiles come next.
  void begin(std::uint64_t number, const PageBytes& bytes) {
    number_ = number;
    std::copy_n(bytes.begin(), layout::kFloorPageBytes, bytes_.begin());
    is_first_ = true;
  }
  void add(std::uint64_t key, const FloorTile& tile) {
    if (is_first_ && packer_) end_page_before(key, tile);
    if (is_first_) start();
    is_first_ = false;
    // A page that is packed otherwise takes more room, or less; it is told of when it is whole.
    if (packer_) is_whole_ = packer_->add(key, tile) && is_whole_;
  }
  /// The next page is not there, or cannot be read.
  void end() {
    if (!packer_) return;
    packer_->finish();
    compare();
    packer_.reset();
  }

 private:
  void start() {
    packed_number_ = number_;
    packed_ = bytes_;
    written_ = 0;
    is_whole_ = is_same_ = true;
    packer_.emplace([this](std::span<const std::byte> page, const layout::FloorEntry&) {
      ++written_;
      is_same_ = is_same_ && std::ranges::equal(page, packed_);
    });
  }
  /// A page is as full as it can be: the next tile would not fit.
  void end_page_before(std::uint64_t key, const FloorTile& tile) {
    const std::uint64_t before = written_;
    const bool is_added = packer_->add(key, tile);
    if (is_added && is_whole_ && before == 0 && written_ == 0) {
      tell_("the page has room for the tile that comes next", page_name(packed_number_));
    } else {
      compare();
    }
    packer_.reset();
  }
  void compare() {
    if (!is_whole_ || written_ != 1 || !is_same_) {
      tell_("the page does not hold its tiles as they are to be packed", page_name(packed_number_));
    }
  }

  const TellFault& tell_;
  std::optional<FloorPacker> packer_;  ///< Has the tiles of page `packed_number_`, or of none.
  std::array<std::byte, layout::kFloorPageBytes> bytes_{}, packed_{};
  std::uint64_t number_ = 0, packed_number_ = 0, written_ = 0;
  bool is_first_ = true, is_whole_ = true, is_same_ = true;
};

class FloorVerifier {
 public:
  FloorVerifier(const ReadableFile& file, const StoreFront& front, const TellFault& tell,
                const std::function<void()>& check_stop)
      : file_(file),
        place_(*front.floor),
        front_(front),
        floor_(file, place_, front.facts),
        numbers_of_source_(range_of(floor_.facts().source)),
        tree_(floor_.pages()),
        tell_(tell),
        check_stop_(check_stop),
        again_(tell) {}

  void run() {
    const FloorShape& shape = floor_.facts().shape;
    const std::uint64_t samples = std::uint64_t{shape.width} * shape.height;
    if (const std::uint64_t vertices = front_.header.record_count + front_.t0.vertices.size();
        vertices != samples) {
      tell_("the heights are those of " + std::to_string(samples) + " samples, and there are " +
                std::to_string(vertices) + " vertices",
            kWhere);
    }
    look_at_node(0, 0, place_.root_checksum);
    again_.end();
    if (all_seen_) compare_totals();
  }

 private:
  static constexpr const char* kWhere = "the heights of the raster";

  /// Looks at a node and at all below it. @return What an entry says of it, but for its checksum; none
  /// when it is damaged.
  std::optional<layout::FloorEntry> look_at_node(std::size_t level, std::uint64_t number,
                                                 std::uint64_t checksum) {
    const std::string where =
        "height node " + std::to_string(number) + " of level " + std::to_string(level);
    layout::FloorNode node{};
    file_.read_at(std::as_writable_bytes(std::span(&node, 1)),
                  place_.offset_of_node(tree_.position(level, number)));
    const char* const fault = checksum_of_object(node) != checksum
                                  ? "the node does not match the checksum that its parent holds; "
                                    "what lies below cannot be "
                                    "looked at"
                                  : fault_in(node, tree_.children(level, number));
    if (fault != nullptr) {
      miss(fault, where);
      return std::nullopt;
    }
    if (!has_zeros(node, level)) tell_("unused entries or bytes are not zero", where);
    FloorBounds all;
    for (std::uint32_t i = 0; i < node.entries; ++i) {
      const layout::FloorEntry& entry = node.entry[i];
      const std::uint64_t child = number * layout::kFloorFanOut + i;
      const auto found = level + 1 == tree_.levels()
                             ? look_at_page(child, entry)
                             : look_at_node(level + 1, child, entry.checksum);
      all.join({entry.least, entry.greatest});
      if (found && (found->first != entry.first || found->least != entry.least ||
                    found->greatest != entry.greatest)) {
        tell_("the entry is not the union of what it describes",
              where + ", entry " + std::to_string(i));
      }
    }
    return layout::FloorEntry{node.entry[0].first, all.least, all.greatest, 0};
  }

  /// Whether nothing stands in a node beside its entries and, in the root, what is told of the raster.
  [[nodiscard]] bool has_zeros(const layout::FloorNode& node, std::size_t level) const {
    layout::FloorNode expected{};
    expected.entries = node.entries;
    std::copy_n(node.entry.begin(), node.entries, expected.entry.begin());
    if (level == 0) put_facts(floor_.facts(), tree_.pages(), expected);
    return std::memcmp(&node, &expected, sizeof node) == 0;
  }

  std::optional<layout::FloorEntry> look_at_page(std::uint64_t number,
                                                 const layout::FloorEntry& entry) {
    check_stop_();
    const std::span<std::byte> bytes = std::span(page_).first(layout::kFloorPageBytes);
    file_.read_at(bytes, place_.offset_of_page(number));
    const FloorPageView page(bytes);
    const char* fault = checksum_of(bytes) != entry.checksum
                            ? "the page does not match the checksum in its node"
                            : page.fault();
    FloorBounds all;
    if (fault == nullptr) again_.begin(number, page_);
    for (std::size_t i = 0; fault == nullptr && i < page.tiles(); ++i) {
      fault = look_at_tile(entry.first + page.key(i), page.tile(i), all);
    }
    if (fault != nullptr) {
      miss(fault, page_name(number));
      again_.end();
      return std::nullopt;
    }
    return layout::FloorEntry{entry.first, all.least, all.greatest, 0};
  }

  /// @return What is wrong with the tile, or null; its bounds are joined to those of its page.
  const char* look_at_tile(std::uint64_t key, std::span<const std::byte> bytes, FloorBounds& all) {
    const FloorShape& shape = floor_.facts().shape;
    const HilbertCell at = hilbert_cell(key);
    if (key < next_key_) return "a tile of heights comes twice, or before one that it follows";
    if (at.x >= shape.columns() || at.y >= shape.rows()) {
      return "a tile of heights lies beside the raster";
    }
    next_key_ = key + 1;
    ++tiles_;
    const char* const fault = read_floor_tile(bytes, shape.samples_of(at.x, shape.width),
                                              shape.samples_of(at.y, shape.height), tile_);
    if (fault != nullptr) return fault;
    const FloorBounds heights = bounds_of(tile_);
    all.join(heights);
    if (!take_heights(at, heights)) return "a height is a number that no program writes";
    again_.add(key, tile_);
    return nullptr;
  }

  /// Counts heights, and widens their range. False: one is no number that a writer takes.
  bool take_heights(HilbertCell at, const FloorBounds& bounds) {
    const FloorNumbers& numbers = floor_.numbers();
    const OrderedHeights range = numbers.all();
    FloorBounds with_lone = bounds;
    bool are_written = true;
    for (const FloorTile::Lone& lone : tile_.lone) {
      with_lone.join({lone.height, lone.height});
      are_written = are_written && lone.height >= range.least && lone.height <= range.most &&
                    numbers.is_written(lone.height);
    }
    if (with_lone.is_empty()) return true;
    if (!are_written || with_lone.least < range.least || with_lone.greatest > range.most) {
      return false;
    }
    for (const OrderedHeight h : {with_lone.least, with_lone.greatest}) {
      range_ = united(range_, front_.facts.heights.height(numbers.bits(h)));
    }
    are_of_source_ = are_of_source_ && std::ranges::all_of(tile_.lone, [&](const auto& lone) {
                       return is_of_source(lone.height);
                     });
    return count_heights(at);
  }

  /// Whether a source whose numbers come back can have had a height: as a number of its type, and not as
  /// its nodata value.
  [[nodiscard]] bool is_of_source(OrderedHeight height) const {
    const FloorFacts& facts = floor_.facts();
    if (!facts.is_exact) return true;
    const HeightEncoding& heights = front_.facts.heights;
    const HeightBits bits = floor_.numbers().bits(height);
    const double number = are_codes(facts.source) ? heights.code(bits) : heights.height(bits);
    return contains(numbers_of_source_, number) && number != facts.nodata &&
           (facts.source > SourceNumber::kInt32 || number == std::trunc(number));
  }

  /// Counts each sample in the one tile that it belongs to: the first rows and columns of tiles are the
  /// last ones of those before.
  bool count_heights(HilbertCell at) {
    const std::uint32_t first_x = at.x > 0 ? 1 : 0, first_y = at.y > 0 ? 1 : 0;
    const bool is_code = floor_.facts().step == 0 && front_.facts.heights.type == HeightType::int32;
    bool are_written = true;
    std::size_t i = 0;
    for (std::uint32_t y = 0; y < tile_.height; ++y) {
      for (std::uint32_t x = 0; x < tile_.width; ++x, ++i) {
        if (!tile_.is_void.empty() && tile_.is_void[i] != 0) continue;
        are_written = are_written && (is_code || floor_.numbers().is_written(tile_.heights[i]));
        are_of_source_ = are_of_source_ && is_of_source(tile_.heights[i]);
        heights_ += x >= first_x && y >= first_y ? 1 : 0;
      }
    }
    for (const FloorTile::Lone& lone : tile_.lone) {
      heights_ +=
          lone.place % tile_.width >= first_x && lone.place / tile_.width >= first_y ? 1 : 0;
    }
    return are_written;
  }

  void compare_totals() {
    const StoreFacts& facts = front_.facts;
    if (const std::uint64_t all = floor_.facts().shape.tiles(); tiles_ != all) {
      tell_(std::to_string(all - tiles_) + " tiles of heights are missing", kWhere);
      return;
    }
    if (heights_ != facts.source_samples) {
      tell_("the header says " + std::to_string(facts.source_samples) + " samples, and " +
                std::to_string(heights_) + " have a height",
            kWhere);
    }
    if (heights_ > 0 && (range_.lo != facts.min_height || range_.hi != facts.max_height)) {
      tell_("the least and largest height are not those of the header", kWhere);
    }
    compare_source();
  }

  /// What is told of a source whose numbers come back must go with them.
  void compare_source() {
    const FloorFacts& told = floor_.facts();
    if (!are_of_source_) {
      tell_("a height is the nodata value of the source, or no number of its type", kWhere);
    }
    const std::uint64_t samples = std::uint64_t{told.shape.width} * told.shape.height;
    const bool has_voids = heights_ < samples;
    if (told.is_exact && told.source <= SourceNumber::kInt32 && !told.nodata && has_voids) {
      tell_("samples are void, and a source of whole numbers without a nodata value has none",
            kWhere);
    }
  }

  void miss(const char* fault, const std::string& where) {
    all_seen_ = false;
    tell_(fault, where);
  }

  const ReadableFile& file_;
  const FloorPlace& place_;
  const StoreFront& front_;
  const Floor floor_;
  const Interval numbers_of_source_;
  const FloorTree tree_;
  const TellFault& tell_;
  const std::function<void()>& check_stop_;
  PagesAgain again_;
  PageBytes page_{};
  FloorTile tile_;
  std::uint64_t next_key_ = 0, tiles_ = 0, heights_ = 0;
  Interval range_{kInfinity, -kInfinity};
  bool all_seen_ = true, are_of_source_ = true;
};

}  // namespace

void verify_floor(const ReadableFile& file, const StoreFront& front, const TellFault& tell,
                  const std::function<void()>& check_stop) {
  std::optional<FloorVerifier> verifier;
  try {
    verifier.emplace(file, front, tell, check_stop);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::corruption) throw;
    tell(e.message(), "section \"height root\"");
    return;
  }
  verifier->run();
}

}  // namespace ptin
