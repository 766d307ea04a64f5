// SPDX-License-Identifier: GPL-3.0-or-later
//
// PLY: ASCII and binary of both byte orders. Elements `vertex` with x, y, z of any type and `face`
// with a list vertex_indices (or vertex_index) of three or four, names in any case; other properties
// and elements are passed over. `comment crs: ...` and `comment vertical_crs: ...` name the CRS, as
// MDAL has it, `comment units: ...` the unit of coordinates and heights.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <span>

#include "engine/construct/read/column_names.h"
#include "engine/construct/read/tin_reader.h"
#include "engine/error.h"

namespace ptin {

namespace {

enum class Type : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };
enum class Encoding : std::uint8_t { kAscii, kLittle, kBig };

struct TypeName {
  std::string_view name;
  Type type;
};
constexpr std::array<TypeName, 16> kTypes = {{{"char", Type::kInt8},
                                              {"int8", Type::kInt8},
                                              {"uchar", Type::kUint8},
                                              {"uint8", Type::kUint8},
                                              {"short", Type::kInt16},
                                              {"int16", Type::kInt16},
                                              {"ushort", Type::kUint16},
                                              {"uint16", Type::kUint16},
                                              {"int", Type::kInt32},
                                              {"int32", Type::kInt32},
                                              {"uint", Type::kUint32},
                                              {"uint32", Type::kUint32},
                                              {"float", Type::kFloat},
                                              {"float32", Type::kFloat},
                                              {"double", Type::kDouble},
                                              {"float64", Type::kDouble}}};

std::size_t bytes_of(Type t) {
  constexpr std::array<std::size_t, 8> kBytes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<std::size_t>(t)];
}

struct Property {
  std::string name;
  Type type = Type::kInt32;
  std::optional<Type> count;  ///< The type of a list's count; none where this is no list.
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};
struct Header {
  Encoding encoding = Encoding::kAscii;
  std::vector<Element> elements;
  std::vector<std::string> comments;
};

// ---------------------------------------------------------------------------------------------------
// The header.

class HeaderReader {
 public:
  explicit HeaderReader(ByteReader& in) : in_(in) {}

  Header read() {
    std::string_view line;
    const bool has_line = in_.line(line);
    split_words(line, words_);
    if (!has_line || words_.size() != 1 || words_[0] != "ply") {
      refuse_at(in_, "a PLY file begins with the line 'ply'");
    }
    if (in_.ended_in_cr()) {
      in_.end_lines_in_cr();
    }
    constexpr int kMostLines = 10'000;
    for (int i = 0; i < kMostLines && in_.line(line); ++i) {
      split_words(line, words_);
      if (words_.empty()) {
        continue;
      }
      if (words_[0] == "obj_info") {
        header_.comments.emplace_back(line.substr(line.find("obj_info") + 8));
        continue;
      }
      if (words_[0] == "end_header") {
        if (!has_format_) {
          refuse_at(in_, "the header names no format");
        }
        return std::move(header_);
      }
      read_line(line);
    }
    refuse_at(in_, "the header has no end");
  }

 private:
  void read_line(std::string_view line) {
    if (words_[0] == "comment") {
      header_.comments.emplace_back(line.substr(line.find("comment") + 7));
    } else if (words_[0] == "format" && words_.size() == 3) {
      read_format();
    } else if (words_[0] == "element" && words_.size() == 3) {
      const std::int64_t count = whole_of(words_[2], in_.place());
      if (count < 0) {
        refuse_at(in_, "an element has a negative count");
      }
      header_.elements.push_back({std::string(words_[1]), static_cast<std::uint64_t>(count), {}});
    } else if (words_[0] == "property" && !header_.elements.empty()) {
      read_property();
    } else {
      refuse_at(in_, "the header has a line that PLY does not know: '" +
                         std::string(line.substr(0, 60)) + "'");
    }
  }

  void read_format() {
    has_format_ = true;
    if (words_[1] == "ascii") {
      header_.encoding = Encoding::kAscii;
    } else if (words_[1] == "binary_little_endian") {
      header_.encoding = Encoding::kLittle;
    } else if (words_[1] == "binary_big_endian") {
      header_.encoding = Encoding::kBig;
    } else {
      refuse_at(in_, "the format is none of ascii, binary_little_endian, binary_big_endian");
    }
  }

  [[nodiscard]] Type type_of(std::string_view name) const {
    for (const TypeName& type : kTypes) {
      if (type.name == name) {
        return type.type;
      }
    }
    refuse_at(in_, "'" + std::string(name.substr(0, 40)) + "' is no type of PLY");
  }

  void read_property() {
    Property property;
    if (words_.size() == 5 && words_[1] == "list") {
      property.count = type_of(words_[2]);
      property.type = type_of(words_[3]);
      if (*property.count == Type::kFloat || *property.count == Type::kDouble) {
        refuse_at(in_, "a list is counted by a whole number");
      }
    } else if (words_.size() == 3) {
      property.type = type_of(words_[1]);
    } else {
      refuse_at(in_, "a property needs a type and a name");
    }
    property.name = words_.back();
    header_.elements.back().properties.push_back(std::move(property));
  }

  ByteReader& in_;
  Header header_;
  bool has_format_ = false;
  std::vector<std::string_view> words_;
};

// ---------------------------------------------------------------------------------------------------
// The body.

/// Values one after the other, whatever the encoding.
class Values {
 public:
  Values(ByteReader& in, Encoding encoding) : in_(in), encoding_(encoding) {}

  /// To be called before each row of an element: in text a row is a line.
  void begin_row() {
    if (encoding_ != Encoding::kAscii) {
      return;
    }
    std::string_view line;
    do {
      if (!in_.line(line)) {
        refuse_at(in_, "the file ends before its last element: it is cut short");
      }
      split_words(line, words_);
    } while (words_.empty());
    next_ = 0;
  }
  /// To be called behind each row.
  void end_row() const {
    if (encoding_ == Encoding::kAscii && next_ < words_.size()) {
      refuse_at(in_, "this line has more values than the header says");
    }
  }

  std::int64_t whole(Type type) {
    if (encoding_ == Encoding::kAscii) {
      return whole_of(word(), in_.place());
    }
    switch (type) {
      case Type::kInt8:
        return raw<std::int8_t>();
      case Type::kUint8:
        return raw<std::uint8_t>();
      case Type::kInt16:
        return raw<std::int16_t>();
      case Type::kUint16:
        return raw<std::uint16_t>();
      case Type::kInt32:
        return raw<std::int32_t>();
      case Type::kUint32:
        return raw<std::uint32_t>();
      default:
        refuse_at(in_, "an index of a vertex is a whole number");
    }
  }

  Decimal coordinate(Type type) {
    if (encoding_ == Encoding::kAscii) {
      return coordinate_of(word(), in_.place());
    }
    if (type == Type::kFloat) {
      return coordinate_of(raw<float>(), in_.path());
    }
    if (type == Type::kDouble) {
      return coordinate_of(raw<double>(), in_.path());
    }
    return Decimal{whole(type), 0};
  }

  void skip(const Property& p) {
    const std::int64_t count = p.count ? list_count(p) : 1;
    for (std::int64_t i = 0; i < count; ++i) {
      if (encoding_ == Encoding::kAscii) {
        static_cast<void>(word());
      } else {
        static_cast<void>(take(bytes_of(p.type)));
      }
    }
  }

  std::int64_t list_count(const Property& p) {
    const std::int64_t count = whole(*p.count);
    if (count < 0) {
      refuse_at(in_, "a list has a negative count");
    }
    return count;
  }

 private:
  std::string_view word() {
    if (next_ >= words_.size()) {
      refuse_at(in_, "this line has fewer values than the header says");
    }
    return words_[next_++];
  }
  const char* take(std::size_t count) {
    const auto bytes = in_.bytes(count);
    if (bytes.size() < count) {
      throw Error(ErrorCode::invalid_argument,
                  "the file ends before its last element: it is cut short", in_.path());
    }
    return bytes.data();
  }
  template <typename T>
  T raw() {
    std::array<char, sizeof(T)> bytes{};
    std::memcpy(bytes.data(), take(sizeof(T)), sizeof(T));
    if ((encoding_ == Encoding::kBig) == (std::endian::native == std::endian::little)) {
      std::reverse(bytes.begin(), bytes.end());
    }
    return std::bit_cast<T>(bytes);
  }

  ByteReader& in_;
  Encoding encoding_;
  std::vector<std::string_view> words_;
  std::size_t next_ = 0;
};

/// Where x, y and z stand among the properties: names as they are, else in any case.
std::array<std::size_t, 3> axes_of(const Element& element, const ByteReader& in) {
  std::array<std::size_t, 3> axes{};
  constexpr std::array<std::string_view, 3> kNames = {"x", "y", "z"};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto find = [&](const auto& is_name) {
      return std::find_if(element.properties.begin(), element.properties.end(),
                          [&](const Property& p) { return !p.count && is_name(p.name); });
    };
    auto found = find([&](std::string_view name) { return name == kNames[a]; });
    if (found == element.properties.end()) {
      found = find([&](std::string_view name) { return equal_in_any_case(name, kNames[a]); });
    }
    if (found == element.properties.end()) {
      refuse_at(in, "vertices have no property " + std::string(kNames[a]));
    }
    axes[a] = static_cast<std::size_t>(found - element.properties.begin());
  }
  return axes;
}

void read_vertices(const Element& element, const ByteReader& in, Values& values, TinReceiver& tin) {
  const auto axes = axes_of(element, in);
  tin.expect_vertices(element.count);
  for (std::uint64_t row = 0; row < element.count; ++row) {
    values.begin_row();
    std::array<Decimal, 3> p;
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const auto axis = std::find(axes.begin(), axes.end(), i);
      if (axis == axes.end()) {
        values.skip(element.properties[i]);
      } else {
        p[static_cast<std::size_t>(axis - axes.begin())] =
            values.coordinate(element.properties[i].type);
      }
    }
    values.end_row();
    tin.add_vertex({p[0], p[1], p[2]});
  }
}

void read_faces(const Element& element, const ByteReader& in, Values& values, TinReceiver& tin) {
  const auto is_corners = [](const Property& p) {
    return p.count && (equal_in_any_case(p.name, "vertex_indices") ||
                       equal_in_any_case(p.name, "vertex_index"));
  };
  if (std::none_of(element.properties.begin(), element.properties.end(), is_corners)) {
    refuse_at(in, "faces have no list vertex_indices");
  }
  for (std::uint64_t row = 0; row < element.count; ++row) {
    values.begin_row();
    for (const Property& p : element.properties) {
      if (!is_corners(p)) {
        values.skip(p);
        continue;
      }
      const std::int64_t count = values.list_count(p);
      if (count != 3 && count != 4) {
        TinReceiver::refuse_corners(static_cast<std::uint64_t>(count),
                                    in.path() + ": face " + std::to_string(row));
      }
      std::array<std::int64_t, 4> ids{};
      for (std::int64_t i = 0; i < count; ++i) {
        ids[static_cast<std::size_t>(i)] = values.whole(p.type);
      }
      tin.add_face(std::span(ids).first(static_cast<std::size_t>(count)), in.path());
    }
    values.end_row();
  }
}

/// Refuses a header that claims more rows than the rest of the file has bytes for, before anything
/// is done for them.
void check_counts(const Header& header, const ByteReader& in) {
  const std::uint64_t left = in.size() - std::min(in.size(), in.position());
  for (const Element& element : header.elements) {
    if (element.properties.empty()) {
      refuse_at(in, "the element " + element.name.substr(0, 40) + " has no properties");
    }
    std::uint64_t row = 0;  // its least bytes; in text a value is a digit and what ends it
    for (const Property& p : element.properties) {
      row += header.encoding == Encoding::kAscii ? 2 : bytes_of(p.count.value_or(p.type));
    }
    if (element.count > left / row + 1) {
      refuse_at(in, "the header claims " + std::to_string(element.count) + " rows of " +
                        element.name.substr(0, 40) +
                        ", more than the file can hold: it is cut short, or damaged");
    }
  }
}

}  // namespace

TinFileFacts read_ply(ByteReader& in, const TinReading& reading, TinFileSink& sink) {
  const Header header = HeaderReader(in).read();
  check_counts(header, in);
  TinReceiver tin(in, reading, sink);
  for (const std::string& comment : header.comments) {
    tin.note_comment(comment);
  }
  Values values(in, header.encoding);
  for (const Element& element : header.elements) {
    if (element.name == "vertex") {
      read_vertices(element, in, values, tin);
    } else if (element.name == "face") {
      read_faces(element, in, values, tin);
    } else if (element.name == "tristrips" && element.count > 0) {
      refuse_at(in, "there are strips of triangles (tristrips); save them as faces");
    } else {
      for (std::uint64_t row = 0; row < element.count; ++row) {
        values.begin_row();
        for (const Property& p : element.properties) {
          values.skip(p);
        }
        values.end_row();
      }
    }
  }
  return tin.finish();
}

}  // namespace ptin
