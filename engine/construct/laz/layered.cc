// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points of formats 6 to 10: each attribute of a chunk in bytes of its own, a layer, so those that
// nobody asks for are passed over unread (M. Isenburg, "LASzip for LAS 1.4 (native extension)", the
// specification in the open source of LAStools).
#include <array>
#include <cstring>
#include <vector>

#include "engine/construct/laz/integer_decoder.h"
#include "engine/construct/laz/las_value.h"
#include "engine/construct/laz/record_decoder.h"
#include "engine/construct/laz/return_contexts.h"

namespace ptin::laz {

namespace {

/// What formats 6 to 10 begin with, as far as it is asked for.
struct Point14 {
  std::int32_t x = 0, y = 0, z = 0;
  std::uint8_t number = 0, returns = 0;  ///< 0 .. 15
  std::uint8_t flags = 0;  ///< Four of the class, the scan's direction, edge of a line.
  std::uint8_t cls = 0;

  /// @param record  At least 17 bytes.
  static Point14 of(std::span<const unsigned char> record) noexcept {
    Point14 p{las_value<std::int32_t>(record, 0), las_value<std::int32_t>(record, 4),
              las_value<std::int32_t>(record, 8)};
    p.number = record[14] & 15U;
    p.returns = static_cast<std::uint8_t>(record[14] >> 4);
    p.flags = static_cast<std::uint8_t>((record[15] & 15U) | (record[15] >> 6) << 4);
    p.cls = record[16];
    return p;
  }
  /// Writes kRecordBytes.
  void put(unsigned char* into, std::uint32_t channel) const noexcept {
    std::memset(into, 0, kRecordBytes);
    std::memcpy(into, &x, sizeof x);
    std::memcpy(into + 4, &y, sizeof y);
    std::memcpy(into + 8, &z, sizeof z);
    into[14] = static_cast<unsigned char>(number | returns << 4);
    into[15] = static_cast<unsigned char>((flags & 15U) | channel << 4 | flags >> 4 << 6);
    into[16] = cls;
  }
};

/// What the points of one scanner channel are predicted by. A channel that a chunk has no point of yet
/// begins with the last point of the one before.
struct Channel {
  Point14 last;
  bool time_changed = false;  ///< Its last point has another time than the one before.
  std::array<StreamingMedian, 12> x_steps,
      y_steps;                            ///< By kReturnMapOf16, and whether time changed.
  std::array<std::int32_t, 8> heights{};  ///< By return_level().
  std::array<SymbolModel<128>, 8> changes;
  SymbolModel<3> channels;
  RareModels<16, 16> counts, numbers;
  SymbolModel<13> number_steps;
  RareModels<256, 64> classes;
  RareModels<64, 64> flags;
  IntegerDecoder<32, 2> x;
  IntegerDecoder<32, 22> y;
  IntegerDecoder<32, 20> z;

  void begin(const Point14& before) noexcept {
    last = before;
    time_changed = false;
    x_steps.fill({});
    y_steps.fill({});
    heights.fill(before.z);
    for (auto& model : changes) {
      model.begin();
    }
    channels.begin();
    counts.begin();
    numbers.begin();
    number_steps.begin();
    classes.begin();
    flags.begin();
    x.begin();
    y.begin();
    z.begin();
  }
};

class LayeredDecoder final : public RecordDecoder {
 public:
  LayeredDecoder(const Source& source, const Layout& layout)
      : source_(source),
        layout_(layout),
        layers_{Layer(source), Layer(source), Layer(source), Layer(source)},
        head_(layout.record_bytes + 4 + 4 * std::size_t{layout.layers()}) {}

  /// A chunk: its first point, the number of its points, the bytes of each layer, the layers.
  void open(const Chunk& chunk) override {
    if (chunk.end - chunk.begin < head_.size()) {
      throw DamagedBytes{"it is shorter than its head"};
    }
    source_.read(chunk.begin, head_);
    open_layers(chunk);
    is_first_ = true;
    has_begun_.fill(false);
    channel_ = head_[15] >> 4 & 3U;
    begin_channel(Point14::of(head_));
  }

  void read(std::span<unsigned char> records) override {
    unsigned char* into = records.data();
    const unsigned char* const end = into + records.size();
    if (is_first_ && into != end) {
      is_first_ = false;
      channels_[channel_]->last.put(into, channel_);
      into += kRecordBytes;
    }
    for (; into != end; into += kRecordBytes) {
      read_point().put(into, channel_);
    }
  }

  void close() override {
    for (const Layer& layer : layers_) {
      if (layer.is_there && layer.decoder.left() > 0) {
        throw DamagedBytes{"its bytes go on behind its points"};
      }
    }
  }

 private:
  /// The layers that are read; they come first.
  enum { kXy, kZ, kClass, kFlags, kLayers };

  struct Layer {
    explicit Layer(const Source& source) : decoder(source) {}
    ArithmeticDecoder decoder;
    bool is_there = false;  ///< Else all points of the chunk have what the first one has.
  };

  void open_layers(const Chunk& chunk) {
    const std::size_t sizes = layout_.record_bytes + 4;
    if (las_value<std::uint32_t>(head_, layout_.record_bytes) != chunk.records) {
      throw DamagedBytes{"it says that it holds another number of points"};
    }
    std::uint64_t at = chunk.begin + head_.size();
    for (std::size_t i = 0; i < layout_.layers(); ++i) {
      const auto bytes = las_value<std::uint32_t>(head_, sizes + 4 * i);
      if (bytes > chunk.end - at) {
        throw DamagedBytes{"its layers are longer than it is"};
      }
      if (i < kLayers) {
        layers_[i].is_there = bytes > 0 && chunk.records > 1;
        if (layers_[i].is_there) {
          layers_[i].decoder.open(at, at + bytes);
        }
      }
      at += bytes;
    }
    if (layout_.has_chunks && at != chunk.end) {
      throw DamagedBytes{"its layers are shorter than it is"};
    }
    if (chunk.records > 1 && !layers_[kXy].is_there) {
      throw DamagedBytes{"it has no coordinates"};
    }
  }

  void begin_channel(const Point14& before) {
    auto& channel = channels_[channel_];
    if (!channel) {
      channel = std::make_unique<Channel>();
    }
    channel->begin(before);
    has_begun_[channel_] = true;
  }

  /// The next point; its channel is then `channel_`.
  [[nodiscard]] const Point14& read_point() {
    ArithmeticDecoder& decoder = layers_[kXy].decoder;
    Channel& before = *channels_[channel_];
    const std::uint32_t context = (before.last.number == 1 ? 1 : 0) |
                                  (before.last.number >= before.last.returns ? 2 : 0) |
                                  (before.time_changed ? 4 : 0);
    const std::uint32_t changes = decoder.symbol(before.changes[context]);
    if ((changes & 0x40) != 0) {
      channel_ = (channel_ + decoder.symbol(before.channels) + 1) % 4;
      if (!has_begun_[channel_]) {
        begin_channel(before.last);
      }
    }
    Channel& c = *channels_[channel_];
    c.time_changed = (changes & 0x10) != 0;
    read_returns(decoder, changes, c);
    read_coordinates(decoder, c);
    read_class(c);
    return c.last;
  }

  static void read_returns(ArithmeticDecoder& decoder, std::uint32_t changes, Channel& c) {
    std::uint32_t number = c.last.number;
    if ((changes & 4) != 0) {
      c.last.returns = static_cast<std::uint8_t>(decoder.symbol(c.counts.of(c.last.returns)));
    }
    switch (changes & 3) {
      case 1:
        number += 1;
        break;
      case 2:
        number += 15;
        break;
      case 3:
        number = c.time_changed ? decoder.symbol(c.numbers.of(number))
                                : number + decoder.symbol(c.number_steps) + 2;
        break;
      default:
        break;
    }
    c.last.number = number % 16;
  }

  void read_coordinates(ArithmeticDecoder& decoder, Channel& c) {
    Point14& p = c.last;
    const bool is_single = p.returns == 1;
    const std::size_t map =
        std::size_t{kReturnMapOf16[p.returns][p.number]} * 2 + (c.time_changed ? 1 : 0);
    const std::int32_t x = c.x.read(decoder, c.x_steps[map].value(), is_single ? 1 : 0);
    c.x_steps[map].add(x);
    p.x = sum(p.x, x);
    const std::int32_t y =
        c.y.read(decoder, c.y_steps[map].value(), interval_context(c.x.interval(), 20, is_single));
    c.y_steps[map].add(y);
    p.y = sum(p.y, y);
    if (layers_[kZ].is_there) {
      std::int32_t& height = c.heights[return_level(p.returns, p.number)];
      height = c.z.read(layers_[kZ].decoder, height,
                        interval_context((c.x.interval() + c.y.interval()) / 2, 18, is_single));
      p.z = height;
    }
  }

  [[nodiscard]] static std::int32_t sum(std::int32_t a, std::int32_t b) noexcept {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
  }

  void read_class(Channel& c) {
    Point14& p = c.last;
    if (layers_[kClass].is_there) {
      const bool is_only = p.number == 1 && p.number >= p.returns;
      const std::uint32_t context = (p.cls & 31U) << 1 | (is_only ? 1 : 0);
      p.cls = static_cast<std::uint8_t>(layers_[kClass].decoder.symbol(c.classes.of(context)));
    }
    if (layers_[kFlags].is_there) {
      p.flags = static_cast<std::uint8_t>(layers_[kFlags].decoder.symbol(c.flags.of(p.flags)));
    }
  }

  const Source& source_;
  const Layout& layout_;
  std::array<Layer, kLayers> layers_;
  std::vector<unsigned char> head_;
  bool is_first_ = false;
  std::uint32_t channel_ = 0;  ///< That of the last point.
  std::array<bool, 4> has_begun_{};
  std::array<std::unique_ptr<Channel>, 4> channels_;
};

}  // namespace

std::unique_ptr<RecordDecoder> make_layered_decoder(const Source& source, const Layout& layout) {
  return std::make_unique<LayeredDecoder>(source, layout);
}

}  // namespace ptin::laz
