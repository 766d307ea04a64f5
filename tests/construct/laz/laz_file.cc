// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/laz/laz_file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <utility>

#include "tests/construct/laz/laz_encoder.h"

namespace ptin {
namespace {

using oracle::Encoder, oracle::Integers, oracle::Median, oracle::Model, oracle::Models;

template <class T>
T get(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

constexpr int kMap8[8][8] = {
    {15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},
    {13, 1, 2, 4, 7, 11, 11, 10},    {12, 3, 4, 5, 8, 12, 12, 11},
    {11, 6, 7, 8, 9, 13, 13, 12},    {10, 10, 11, 12, 13, 14, 14, 13},
    {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15},
};

/// A row for each number of returns, a digit for each number of the echo.
constexpr const char* kMap16[16] = {
    "0123453445555555", "1013333333333333", "2124444444433333", "3345444444444444",
    "4344544444444444", "5344454444444444", "3344445444444444", "4344444544444444",
    "4344444454444444", "5344444445444444", "5344444444544444", "5334444444455444",
    "5334444444455544", "5334444444445554", "5334444444444555", "5334444444444455",
};

std::uint32_t even(std::uint32_t k, std::uint32_t most) { return std::min(k, most) / 2 * 2; }

std::size_t level_of(std::uint32_t n, std::uint32_t r) {
  return std::min<std::size_t>(n > r ? n - r : r - n, 7);
}

/// The three coordinates of points 0 to 10.
struct Coordinates {
  std::array<Median, 16> dx, dy;
  std::array<std::int32_t, 8> z{};
  Integers ix{32, 2}, iy{32, 22}, iz{32, 20};
  void write(Encoder& xy, Encoder& zs, const std::string& last, const std::string& p,
             std::size_t map, std::size_t level, bool single) {
    const auto difference = [&](std::size_t at) {
      return static_cast<std::int32_t>(get<std::uint32_t>(p, at) - get<std::uint32_t>(last, at));
    };
    const std::uint32_t one = single ? 1 : 0;
    ix.write(xy, dx[map].v[2], difference(0), one);
    dx[map].add(difference(0));
    iy.write(xy, dy[map].v[2], difference(4), one + even(ix.k(), 20));
    dy[map].add(difference(4));
    iz.write(zs, z[level], get<std::int32_t>(p, 8), one + even((ix.k() + iy.k()) / 2, 18));
    z[level] = get<std::int32_t>(p, 8);
  }
};

/// A chunk of formats 0 to 5.
class PointWise {
 public:
  PointWise(int format, const std::string& first) : format_(format), last_(first) {
    last_[12] = last_[13] = 0;
    if (has_time()) times_[0] = get<std::uint64_t>(first, 20);
  }
  void add(const std::string& p) {
    add_point(p);
    std::size_t at = 20;
    if (has_time()) {
      add_time(get<std::uint64_t>(p, at));
      at += 8;
    }
    if (format_ == 2 || format_ == 3 || format_ == 5) {
      add_colour(p, at);
      at += 6;
    }
    if (format_ >= 4) {
      add_wave(p, at);
      at += 29;
    }
    extra_.resize(p.size() - at, Model(256));
    for (std::size_t i = at; i < p.size(); ++i) {
      e_.symbol(extra_[i - at], static_cast<std::uint8_t>(p[i] - last_[i]));
    }
    last_ = p;
  }
  std::string finish() { return e_.finish(); }

 private:
  bool has_time() const { return format_ != 0 && format_ != 2; }
  std::uint8_t byte(std::size_t at) const { return static_cast<std::uint8_t>(last_[at]); }

  void add_point(const std::string& p) {
    const auto b = static_cast<std::uint8_t>(p[14]);
    const std::uint32_t r = b & 7, n = b >> 3 & 7;
    const auto m = static_cast<std::size_t>(kMap8[n][r]);
    const auto intensity = get<std::uint16_t>(p, 12);
    const auto differs = [&](std::size_t at) { return p[at] != last_[at]; };
    const bool source = differs(18) || differs(19);
    e_.symbol(changes_, (differs(14) ? 32U : 0U) | (intensity != intensities_[m] ? 16U : 0U) |
                            (differs(15) ? 8U : 0U) | (differs(16) ? 4U : 0U) |
                            (differs(17) ? 2U : 0U) | (source ? 1U : 0U));
    const auto own = [&](Models& models, std::size_t at) {
      if (differs(at)) e_.symbol(models[byte(at)], static_cast<std::uint8_t>(p[at]));
    };
    own(returns_, 14);
    if (intensity != intensities_[m]) {
      intensity_.write(e_, intensities_[m], intensity,
                       static_cast<std::uint32_t>(std::min<std::size_t>(m, 3)));
      intensities_[m] = intensity;
    }
    own(classes_, 15);
    if (differs(16)) e_.symbol(angles_[b >> 6 & 1], static_cast<std::uint8_t>(p[16] - last_[16]));
    own(users_, 17);
    if (source) sources_.write(e_, get<std::uint16_t>(last_, 18), get<std::uint16_t>(p, 18));
    xyz_.write(e_, e_, last_, p, m, level_of(n, r), n == 1);
  }

  /// The difference to the last time of a sequence, if 32 bits hold it.
  bool reaches(std::size_t sequence, std::uint64_t time, std::int32_t& step) const {
    const auto difference = static_cast<std::int64_t>(time - times_[sequence]);
    step = static_cast<std::int32_t>(difference);
    return step == difference;
  }
  void begin_sequence(std::uint64_t time) {
    gps_.write(e_, static_cast<std::int32_t>(times_[now_] >> 32),
               static_cast<std::int32_t>(time >> 32), 8);
    e_.bits(32, static_cast<std::uint32_t>(time));
    now_ = newest_ = (newest_ + 1) % 4;
    times_[now_] = time;
    steps_[now_] = 0;
    odd_[now_] = 0;
  }
  void odd(std::int32_t step) {
    if (++odd_[now_] > 3) {
      steps_[now_] = step;
      odd_[now_] = 0;
    }
  }
  void add_time(std::uint64_t time) {
    const bool stood = steps_[now_] == 0;
    std::int32_t step = 0;
    if (time == times_[now_]) return e_.symbol(stood ? kinds_ : multiples_, stood ? 0 : 511);
    if (!reaches(now_, time, step)) {
      for (std::uint32_t i = 1; i < 4; ++i) {
        if (reaches((now_ + i) % 4, time, step)) {
          e_.symbol(stood ? kinds_ : multiples_, stood ? i + 2 : 512 + i);
          now_ = (now_ + i) % 4;
          return add_time(time);
        }
      }
      e_.symbol(stood ? kinds_ : multiples_, stood ? 2 : 512);
      return begin_sequence(time);
    }
    if (stood) {
      e_.symbol(kinds_, 1);
      gps_.write(e_, 0, step, 0);
      steps_[now_] = step;
      odd_[now_] = 0;
    } else {
      add_step(step);
    }
    times_[now_] = time;
  }
  void add_step(std::int32_t step) {
    const std::int64_t of = steps_[now_];
    const std::int64_t multiple = std::clamp<std::int64_t>(step / of, -10, 500);
    const auto predicted = static_cast<std::int32_t>(static_cast<std::uint32_t>(multiple) *
                                                     static_cast<std::uint32_t>(of));
    e_.symbol(multiples_, static_cast<std::uint32_t>(multiple >= 0 ? multiple : 500 - multiple));
    const auto write = [&](std::uint32_t context) { gps_.write(e_, predicted, step, context); };
    if (multiple == 1) {
      write(1);
      odd_[now_] = 0;
    } else if (multiple == 0) {
      write(7);
      odd(step);
    } else if (multiple == 500 || multiple == -10) {
      write(multiple > 0 ? 4 : 6);
      odd(step);
    } else {
      write(multiple < 0 ? 5 : multiple < 10 ? 2 : 3);
    }
  }

  void add_colour(const std::string& p, std::size_t at) {
    std::array<int, 6> was{}, is{};
    std::uint32_t changes = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      was[i] = byte(at + i);
      is[i] = static_cast<std::uint8_t>(p[at + i]);
      changes |= was[i] != is[i] ? 1U << i : 0U;
    }
    const bool grey = is[0] == is[2] && is[0] == is[4] && is[1] == is[3] && is[1] == is[5];
    changes |= grey ? 0 : 64U;
    e_.symbol(colour_changes_, changes);
    const auto correct = [&](std::size_t i, int predicted) {
      if ((changes >> i & 1) != 0) {
        e_.symbol(colours_[i], static_cast<std::uint8_t>(is[i] - std::clamp(predicted, 0, 255)));
      }
    };
    correct(0, was[0]);
    correct(1, was[1]);
    for (std::size_t i = 0; i < 2 && !grey; ++i) {
      const int red = is[i] - was[i];
      correct(i + 2, was[i + 2] + red);
      correct(i + 4, was[i + 4] + (red + is[i + 2] - was[i + 2]) / 2);
    }
  }

  void add_wave(const std::string& p, std::size_t at) {
    e_.symbol(descriptors_, static_cast<std::uint8_t>(p[at]));
    const auto offset = get<std::uint64_t>(p, at + 1), before = get<std::uint64_t>(last_, at + 1);
    const auto step = static_cast<std::int64_t>(offset - before);
    const std::uint32_t kind = step == 0                                   ? 0
                               : step == get<std::uint32_t>(last_, at + 9) ? 1
                               : step == static_cast<std::int32_t>(step)   ? 2
                                                                           : 3;
    e_.symbol(offset_kinds_[offset_kind_], kind);
    offset_kind_ = kind;
    if (kind == 2) {
      offsets_.write(e_, offset_step_, static_cast<std::int32_t>(step));
      offset_step_ = static_cast<std::int32_t>(step);
    } else if (kind == 3) {
      e_.bits(32, static_cast<std::uint32_t>(offset));
      e_.bits(32, static_cast<std::uint32_t>(offset >> 32));
    }
    const auto write = [&](Integers& to, std::size_t i, std::uint32_t context = 0) {
      to.write(e_, get<std::int32_t>(last_, at + i), get<std::int32_t>(p, at + i), context);
    };
    write(sizes_, 9);
    write(places_, 13);
    for (std::uint32_t i = 0; i < 3; ++i) write(directions_, 17 + 4 * i, i);
  }

  int format_;
  std::string last_;
  Encoder e_;
  Model changes_{64};
  std::array<std::uint16_t, 16> intensities_{};
  Models returns_{256}, classes_{256}, users_{256};
  std::array<Model, 2> angles_{Model(256), Model(256)};
  Integers intensity_{16, 4}, sources_{16, 1};
  Coordinates xyz_;
  std::array<std::uint64_t, 4> times_{};
  std::array<std::int32_t, 4> steps_{};
  std::array<int, 4> odd_{};
  std::size_t now_ = 0, newest_ = 0;
  Model multiples_{516}, kinds_{6};
  Integers gps_{32, 9};
  Model colour_changes_{128};
  std::vector<Model> colours_ = std::vector<Model>(6, Model(256));
  Model descriptors_{256};
  std::vector<Model> offset_kinds_ = std::vector<Model>(4, Model(4));
  std::uint32_t offset_kind_ = 0;
  std::int32_t offset_step_ = 0;
  Integers offsets_, sizes_, places_, directions_{32, 3};
  std::vector<Model> extra_;
};

/// A chunk of formats 6 to 10.
class Layered {
 public:
  explicit Layered(const std::string& first) : now_(channel_of(first)) { begin(now_, first); }

  void add(const std::string& p) {
    Channel& before = *channels_[now_];
    const std::uint32_t channel = channel_of(p);
    const std::uint32_t r0 = number_of(before.last), n0 = returns_of(before.last);
    const std::uint32_t context =
        (r0 == 1 ? 1U : 0U) | (r0 >= n0 ? 2U : 0U) | (before.changed ? 4U : 0U);
    const Channel& old = channels_[channel] ? *channels_[channel] : before;
    const std::uint32_t r = number_of(p), n = returns_of(p), last_r = number_of(old.last),
                        last_n = returns_of(old.last);
    const bool time = p.compare(22, 8, old.last, 22, 8) != 0;
    const std::uint32_t step = r == last_r               ? 0
                               : r == (last_r + 1) % 16  ? 1
                               : r == (last_r + 15) % 16 ? 2
                                                         : 3;
    xy_.symbol(before.changes[context],
               step | (n != last_n ? 4U : 0U) | (time ? 16U : 0U) | (channel != now_ ? 64U : 0U));
    if (channel != now_) xy_.symbol(before.channels, (channel + 3 - now_) % 4);
    if (!channels_[channel]) begin(channel, before.last);
    now_ = channel;
    Channel& c = *channels_[now_];
    if (n != last_n) xy_.symbol(c.counts[last_n], n);
    if (step == 3) {
      if (time) {
        xy_.symbol(c.numbers[last_r], r);
      } else {
        xy_.symbol(c.number_steps, (r + 14 - last_r) % 16);
      }
    }
    const std::size_t map = static_cast<std::size_t>(kMap16[n][r] - '0') * 2 + (time ? 1 : 0);
    c.xyz.write(xy_, z_, c.last, p, map, level_of(n, r), n == 1);
    add_class(c, p, r == 1 && r >= n);
    c.last = p;
    c.changed = time;
  }

  /// The numbers of bytes of all layers, and the layers.
  std::string finish(std::size_t layers, std::size_t bytes_of_others) {
    std::vector<std::string> all{xy_.finish(), z_differs_ ? z_.finish() : "",
                                 class_differs_ ? class_.finish() : "",
                                 flags_differ_ ? flags_.finish() : ""};
    all.resize(layers, std::string(bytes_of_others, '\x5a'));
    std::string sizes, content;
    for (const std::string& layer : all) {
      put(sizes, static_cast<std::uint32_t>(layer.size()));
      content += layer;
    }
    return sizes + content;
  }

 private:
  struct Channel {
    std::string last;
    bool changed = false;
    std::vector<Model> changes = std::vector<Model>(8, Model(128));
    Model channels{3}, number_steps{13};
    Models counts{16}, numbers{16}, classes{256}, flags{64};
    Coordinates xyz;
  };
  static std::uint32_t channel_of(const std::string& p) {
    return static_cast<std::uint8_t>(p[15]) >> 4 & 3;
  }
  static std::uint32_t number_of(const std::string& p) { return p[14] & 15; }
  static std::uint32_t returns_of(const std::string& p) {
    return static_cast<std::uint8_t>(p[14]) >> 4;
  }
  static std::uint32_t flags_of(const std::string& p) {
    const auto b = static_cast<std::uint8_t>(p[15]);
    return (b & 15U) | (b >> 6) << 4;
  }
  void begin(std::uint32_t channel, const std::string& before) {
    channels_[channel] = std::make_unique<Channel>();
    channels_[channel]->last = before;
    channels_[channel]->xyz.z.fill(get<std::int32_t>(before, 8));
  }
  void add_class(Channel& c, const std::string& p, bool only) {
    z_differs_ = z_differs_ || p.compare(8, 4, c.last, 8, 4) != 0;
    class_differs_ = class_differs_ || p[16] != c.last[16];
    flags_differ_ = flags_differ_ || flags_of(p) != flags_of(c.last);
    class_.symbol(c.classes[(c.last[16] & 31U) * 2 + (only ? 1 : 0)],
                  static_cast<std::uint8_t>(p[16]));
    flags_.symbol(c.flags[flags_of(c.last)], flags_of(p));
  }

  std::uint32_t now_;
  std::array<std::unique_ptr<Channel>, 4> channels_;
  Encoder xy_, z_, class_, flags_;
  bool z_differs_ = false, class_differs_ = false, flags_differ_ = false;
};

struct Part {
  std::uint16_t type, bytes, version;
};

std::vector<Part> parts_of(int format, std::uint16_t record_bytes) {
  static constexpr int kFormat[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  std::vector<Part> parts;
  const bool is_new = format >= 6;
  parts.push_back(is_new ? Part{10, 30, 3} : Part{6, 20, 2});
  if (!is_new && format != 0 && format != 2) parts.push_back({7, 8, 2});
  if (format == 2 || format == 3 || format == 5) parts.push_back({8, 6, 2});
  if (format == 7) parts.push_back({11, 6, 3});
  if (format == 8 || format == 10) parts.push_back({12, 8, 3});
  if (format == 4 || format == 5) parts.push_back({9, 29, 1});
  if (format == 9 || format == 10) parts.push_back({13, 29, 3});
  const auto extra = static_cast<std::uint16_t>(record_bytes - kFormat[format]);
  if (extra > 0)
    parts.push_back({static_cast<std::uint16_t>(is_new ? 14 : 0), extra,
                     static_cast<std::uint16_t>(is_new ? 3 : 2)});
  return parts;
}

std::size_t layers_of(const std::vector<Part>& parts) {
  std::size_t layers = 0;
  for (const Part& p : parts) {
    layers += p.type == 10 ? 9U : p.type == 12 ? 2U : p.type == 14 ? p.bytes : 1U;
  }
  return layers;
}

std::string layout_record(const LazOptions& options, const std::vector<Part>& parts) {
  std::string record(54, '\0');
  std::memcpy(record.data() + 2, "laszip encoded", 14);
  const std::uint16_t id = 22204, bytes = static_cast<std::uint16_t>(34 + 6 * parts.size());
  std::memcpy(record.data() + 18, &id, 2);
  std::memcpy(record.data() + 20, &bytes, 2);
  put(record, static_cast<std::uint16_t>(options.compressor));
  put(record, std::uint16_t{0});
  record += std::string("\3\4\3\0\0\0\0\0", 8);
  put(record, options.chunks.empty() ? options.chunk_records : 0xffffffffU);
  put(record, std::int64_t{-1});
  put(record, std::int64_t{-1});
  put(record, static_cast<std::uint16_t>(parts.size()));
  for (const Part& p : parts) {
    put(record, p.type);
    put(record, p.bytes);
    put(record, p.version);
  }
  return record;
}

std::string chunk_of(const LazOptions& options, int format, const std::vector<Part>& parts,
                     const std::vector<std::string>& points) {
  std::string chunk = points[0];
  if (options.compressor == 3) {
    put(chunk, static_cast<std::uint32_t>(points.size()));
    Layered layered(points[0]);
    for (std::size_t i = 1; i < points.size(); ++i) layered.add(points[i]);
    return chunk + layered.finish(layers_of(parts), options.bytes_of_others);
  }
  PointWise point_wise(format, points[0]);
  for (std::size_t i = 1; i < points.size(); ++i) point_wise.add(points[i]);
  return chunk + point_wise.finish();
}

/// The table of chunks, given the points and the bytes of each.
std::string table_of(const LazOptions& options,
                     const std::vector<std::pair<std::uint32_t, std::uint32_t>>& chunks) {
  std::string table;
  put(table, std::uint32_t{0});
  put(table, static_cast<std::uint32_t>(chunks.size()));
  if (chunks.empty()) return table;
  Encoder e;
  Integers numbers(32, 2);
  std::pair<std::uint32_t, std::uint32_t> before;
  for (const auto& chunk : chunks) {
    if (!options.chunks.empty()) {
      numbers.write(e, static_cast<std::int32_t>(before.first),
                    static_cast<std::int32_t>(chunk.first), 0);
    }
    numbers.write(e, static_cast<std::int32_t>(before.second),
                  static_cast<std::int32_t>(chunk.second), 1);
    before = chunk;
  }
  return table + e.finish();
}

}  // namespace

std::string laz_of(const std::string& las, const LazOptions& options) {
  const auto header_bytes = get<std::uint16_t>(las, 94),
             record_bytes = get<std::uint16_t>(las, 105);
  const auto first = get<std::uint32_t>(las, 96), records = get<std::uint32_t>(las, 100);
  const int format = las[104];
  const std::vector<Part> parts = parts_of(format, record_bytes);
  const std::string record = layout_record(options, parts);
  std::string file =
      las.substr(0, header_bytes) + record + las.substr(header_bytes, first - header_bytes);
  const auto set = [&](std::size_t at, auto value) {
    std::memcpy(file.data() + at, &value, sizeof value);
  };
  set(96, static_cast<std::uint32_t>(file.size()));
  set(100, records + 1);
  file[104] = static_cast<char>(format | 0x80);
  const std::size_t place = file.size();
  if (options.compressor != 1) put(file, std::int64_t{-1});
  std::vector<std::pair<std::uint32_t, std::uint32_t>> chunks;
  for (std::size_t at = first; at < las.size();) {
    std::size_t count = options.compressor == 1 ? las.size() : options.chunk_records;
    if (!options.chunks.empty()) count = options.chunks.at(chunks.size());
    std::vector<std::string> points;
    for (; at < las.size() && points.size() < count; at += record_bytes) {
      points.push_back(las.substr(at, record_bytes));
    }
    const std::string chunk = chunk_of(options, format, parts, points);
    chunks.emplace_back(points.size(), chunk.size());
    file += chunk;
  }
  const auto table = static_cast<std::int64_t>(file.size());
  if (options.compressor == 1) return file;
  if (!options.table_place_at_end) set(place, table);
  file += table_of(options, chunks);
  if (options.table_place_at_end) put(file, table);
  return file;
}

}  // namespace ptin
