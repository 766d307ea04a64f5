// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points of formats 0 to 5: one after the other, all attributes of each out of the same bytes
// (LASzip's open source, version 2 of the parts).
#include <array>
#include <cstring>
#include <optional>
#include <vector>

#include "engine/construct/laz/attributes.h"
#include "engine/construct/laz/integer_decoder.h"
#include "engine/construct/laz/las_value.h"
#include "engine/construct/laz/record_decoder.h"
#include "engine/construct/laz/return_contexts.h"

namespace ptin::laz {

namespace {

/// What formats 0 to 5 begin with, where it is kept to predict the next point.
class Points10 {
 public:
  void begin(std::span<const unsigned char> first) noexcept {
    std::memcpy(last_.data(), first.data(), last_.size());
    std::memset(last_.data() + kIntensity, 0, 2);
    x_steps_.fill({});
    y_steps_.fill({});
    heights_.fill(0);
    intensities_.fill(0);
    changes_.begin();
    return_bytes_.begin();
    classes_.begin();
    user_bytes_.begin();
    angles_[0].begin();
    angles_[1].begin();
    intensity_.begin();
    source_ids_.begin();
    x_.begin();
    y_.begin();
    z_.begin();
  }

  /// The next point.
  [[nodiscard]] const unsigned char* read(ArithmeticDecoder& decoder) {
    const std::uint32_t changes = decoder.symbol(changes_);
    if ((changes & 0x20) != 0) {
      take_symbol(decoder, return_bytes_, kReturns);
    }
    const std::uint32_t number = last_[kReturns] & 7U, returns = last_[kReturns] >> 3 & 7U;
    const std::uint32_t map = kReturnMap[returns][number];
    read_others(decoder, changes, map);
    read_coordinates(decoder, map, return_level(returns, number), returns == 1);
    return last_.data();
  }

 private:
  static constexpr std::size_t kIntensity = 12, kReturns = 14, kClass = 15, kAngle = 16,
                               kUserByte = 17, kSourceId = 18;

  void take_symbol(ArithmeticDecoder& decoder, RareModels<256, 256>& models, std::size_t byte) {
    last_[byte] = static_cast<unsigned char>(decoder.symbol(models.of(last_[byte])));
  }
  template <class T>
  void put(std::size_t at, T value) noexcept {
    std::memcpy(last_.data() + at, &value, sizeof value);
  }
  template <class T>
  [[nodiscard]] T get(std::size_t at) const noexcept {
    return las_value<T>(last_, at);
  }

  void read_others(ArithmeticDecoder& decoder, std::uint32_t changes, std::uint32_t map) {
    if ((changes & 0x10) != 0) {
      intensities_[map] = static_cast<std::uint16_t>(
          intensity_.read(decoder, intensities_[map], std::min(map, 3U)));
    }
    put<std::uint16_t>(kIntensity, intensities_[map]);
    if ((changes & 8) != 0) {
      take_symbol(decoder, classes_, kClass);
    }
    if ((changes & 4) != 0) {
      const std::uint32_t turn = decoder.symbol(angles_[last_[kReturns] >> 6 & 1U]);
      last_[kAngle] = static_cast<unsigned char>(last_[kAngle] + turn);
    }
    if ((changes & 2) != 0) {
      take_symbol(decoder, user_bytes_, kUserByte);
    }
    if ((changes & 1) != 0) {
      put(kSourceId,
          static_cast<std::uint16_t>(source_ids_.read(decoder, get<std::uint16_t>(kSourceId))));
    }
  }

  void step(std::size_t at, std::int32_t by) noexcept {
    put(at, get<std::uint32_t>(at) + static_cast<std::uint32_t>(by));
  }

  void read_coordinates(ArithmeticDecoder& decoder, std::uint32_t map, std::uint32_t level,
                        bool is_single) {
    const std::int32_t x = x_.read(decoder, x_steps_[map].value(), is_single ? 1 : 0);
    x_steps_[map].add(x);
    step(0, x);
    const std::int32_t y =
        y_.read(decoder, y_steps_[map].value(), interval_context(x_.interval(), 20, is_single));
    y_steps_[map].add(y);
    step(4, y);
    heights_[level] = z_.read(decoder, heights_[level],
                              interval_context((x_.interval() + y_.interval()) / 2, 18, is_single));
    put(8, heights_[level]);
  }

  std::array<unsigned char, kRecordBytes> last_{};
  std::array<StreamingMedian, 16> x_steps_, y_steps_;  ///< By kReturnMap.
  std::array<std::uint16_t, 16> intensities_{};
  std::array<std::int32_t, 8> heights_{};  ///< By return_level().
  SymbolModel<64> changes_;
  RareModels<256, 256> return_bytes_, classes_, user_bytes_;
  std::array<SymbolModel<256>, 2> angles_;
  IntegerDecoder<16, 4> intensity_;
  IntegerDecoder<16, 1> source_ids_;
  IntegerDecoder<32, 2> x_;
  IntegerDecoder<32, 22> y_;
  IntegerDecoder<32, 20> z_;
};

class PointWiseDecoder final : public RecordDecoder {
 public:
  PointWiseDecoder(const Source& source, const Layout& layout)
      : source_(source), layout_(layout), decoder_(source), first_(layout.record_bytes) {
    for (const Layout::Part& part : layout.parts) {
      switch (part.item) {
        case Item::kGpsTime11:
          times_.emplace();
          break;
        case Item::kRgb12:
          colours_.emplace();
          break;
        case Item::kWavePacket13:
          waves_.emplace();
          break;
        case Item::kBytes:
          extra_.emplace(part.bytes);
          break;
        default:
          break;
      }
    }
  }

  void open(const Chunk& chunk) override {
    if (chunk.end - chunk.begin < first_.size()) {
      throw DamagedBytes{"it is shorter than a point"};
    }
    source_.read(chunk.begin, first_);
    is_first_ = true;
    points_.begin(first_);
    std::span<const unsigned char> rest = std::span(first_).subspan(kRecordBytes);
    if (times_) {
      times_->begin(rest);
      rest = rest.subspan(GpsTimes::kBytes);
    }
    if (colours_) {
      colours_->begin(rest);
      rest = rest.subspan(Colours::kBytes);
    }
    if (waves_) {
      waves_->begin(rest);
      rest = rest.subspan(WavePackets::kBytes);
    }
    if (extra_) {
      extra_->begin(rest);
    }
    may_have_more_ = !layout_.has_chunks;
    decoder_.open(chunk.begin + first_.size(), chunk.end);
  }

  void read(std::span<unsigned char> records) override {
    unsigned char* into = records.data();
    const unsigned char* const end = into + records.size();
    if (is_first_ && into != end) {
      is_first_ = false;
      std::memcpy(into, first_.data(), kRecordBytes);
      give_extra(into);
      into += step_;
    }
    for (; into != end; into += step_) {
      std::memcpy(into, points_.read(decoder_), kRecordBytes);
      if (times_) {
        times_->pass(decoder_);
      }
      if (colours_) {
        colours_->pass(decoder_);
      }
      if (waves_) {
        waves_->pass(decoder_);
      }
      if (extra_) {
        extra_->pass(decoder_);
        give_extra(into);
      }
    }
  }

  void close() override {
    if (decoder_.left() > 0 && !may_have_more_) {
      throw DamagedBytes{"its bytes go on behind its points"};
    }
  }

 private:
  void give_extra(unsigned char* record) const noexcept {
    if (step_ > kRecordBytes) {
      std::copy_n(extra_->bytes().begin(), step_ - kRecordBytes, record + kRecordBytes);
    }
  }

  const Source& source_;
  const Layout& layout_;
  const std::size_t step_ = layout_.given_bytes();
  ArithmeticDecoder decoder_;
  std::vector<unsigned char> first_;  ///< The first point of the chunk, which is not compressed.
  bool is_first_ = false;
  bool may_have_more_ = false;  ///< What lies behind the points belongs to the last chunk.
  Points10 points_;
  std::optional<GpsTimes> times_;
  std::optional<Colours> colours_;
  std::optional<WavePackets> waves_;
  std::optional<ExtraBytes> extra_;
};

}  // namespace

std::unique_ptr<RecordDecoder> make_point_wise_decoder(const Source& source, const Layout& layout) {
  return std::make_unique<PointWiseDecoder>(source, layout);
}

}  // namespace ptin::laz
