// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/geotiff_keys.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <optional>
#include <utility>

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/dataset_crs.h"
#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/grid/vertical_part.h"
#include "engine/crs/height_unit.h"

namespace ptin {

namespace {

using Bytes = std::vector<unsigned char>;

/// Numbers of keys (OGC 19-008r4, annex A), and the values that mean "none" and "by other keys".
enum Key : std::uint16_t {
  kModelType = 1024,
  kGeodeticCrs = 2048,
  kProjectedCrs = 3072,
  kPlaneUnits = 3076,
  kVertical = 4096,
  kVerticalCitation = 4097,
  kVerticalDatum = 4098,
  kVerticalUnits = 4099,
};
constexpr std::uint16_t kUndefined = 0, kUserDefined = 32767;

/// One entry of the directory: a number, where its value is, how many values, and the value itself
/// or its place.
using KeyEntry = std::array<std::uint16_t, 4>;

bool is_vertical(const KeyEntry& e) { return e[0] >= kVertical && e[0] <= kVerticalUnits; }

/// The entries of a directory; none where it is cut off.
std::optional<std::vector<KeyEntry>> entries_of(const Bytes& directory) {
  std::array<std::uint16_t, 4> head{};
  if (directory.size() < sizeof head) {
    return std::nullopt;
  }
  std::memcpy(head.data(), directory.data(), sizeof head);
  std::vector<KeyEntry> entries(head[3]);
  const std::size_t bytes = entries.size() * sizeof(KeyEntry);
  if (directory.size() - sizeof head < bytes) {
    return std::nullopt;
  }
  if (bytes > 0) {
    std::memcpy(entries.data(), directory.data() + sizeof head, bytes);
  }
  return entries;
}

/// The directory of entries. Its revision is that of GeoTIFF 1.0, in which GDAL takes codes of
/// vertical datums for their CRSs, too.
Bytes directory_of(const std::vector<KeyEntry>& entries) {
  const KeyEntry head = {1, 1, 0, static_cast<std::uint16_t>(entries.size())};
  Bytes directory(sizeof head * (entries.size() + 1));
  std::memcpy(directory.data(), head.data(), sizeof head);
  if (!entries.empty()) {
    std::memcpy(directory.data() + sizeof head, entries.data(), entries.size() * sizeof(KeyEntry));
  }
  return directory;
}

/// The value of a key that is a code; 0 where it is not there.
std::uint16_t code_of(const std::vector<KeyEntry>& entries, Key key) {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const KeyEntry& e) { return e[0] == key && e[1] == 0; });
  return found == entries.end() ? kUndefined : (*found)[3];
}

/// The text of a key; "" where it is not there.
std::string text_of_key(const std::vector<KeyEntry>& entries, Key key, const Bytes& text) {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const KeyEntry& e) { return e[0] == key && e[1] == 34737; });
  if (found == entries.end() || (*found)[3] >= text.size()) {
    return "";
  }
  const std::size_t begin = (*found)[3];
  const std::string all(text.begin() + static_cast<std::ptrdiff_t>(begin), text.end());
  const std::string own = all.substr(0, (*found)[2]);
  return own.substr(0, own.find_first_of(std::string("|\0", 2)));
}

/// A TIFF of one pixel that holds keys: GDAL opens it, and so says what they mean.
class KeyTiff {
 public:
  KeyTiff(const Bytes& directory, const GeoTiffKeys& keys) {
    add(256, 3, 1, 1);
    add(257, 3, 1, 1);
    add(258, 3, 1, 8);
    add(259, 3, 1, 1);
    add(262, 3, 1, 1);
    add(273, 4, 1, 8);  // the pixel: a byte of padding in the header
    add(277, 3, 1, 1);
    add(278, 3, 1, 1);
    add(279, 4, 1, 1);
    entries_.push_back({34735, 3, directory.size() / 2, directory});
    if (!keys.doubles.empty()) {
      entries_.push_back({34736, 12, keys.doubles.size() / 8, keys.doubles});
    }
    if (!keys.text.empty()) {
      entries_.push_back({34737, 2, keys.text.size(), keys.text});
    }
  }

  [[nodiscard]] Bytes bytes() const {
    Bytes file = {'I', 'I', 42, 0, 16, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    const std::size_t data_begin = 16 + 2 + entries_.size() * 12 + 4;
    put(file, entries_.size(), 2);
    Bytes data;
    for (const Tag& e : entries_) {
      put(file, e.tag, 2);
      put(file, e.type, 2);
      put(file, e.count, 4);
      if (e.data.size() <= 4) {
        Bytes value = e.data;
        value.resize(4);
        file.insert(file.end(), value.begin(), value.end());
      } else {
        data.resize((data.size() + 7) / 8 * 8);
        put(file, data_begin + data.size(), 4);
        data.insert(data.end(), e.data.begin(), e.data.end());
      }
    }
    put(file, 0, 4);
    file.insert(file.end(), data.begin(), data.end());
    return file;
  }

 private:
  struct Tag {
    std::uint64_t tag, type, count;
    Bytes data;
  };
  static void put(Bytes& to, std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) {
      to.push_back(static_cast<unsigned char>(value >> (8 * i)));
    }
  }
  void add(std::uint64_t tag, std::uint64_t type, std::uint64_t count, std::uint64_t value) {
    Bytes data;
    put(data, value, 4);
    entries_.push_back({tag, type, count, data});
  }
  std::vector<Tag> entries_;
};

/// Asks GDAL what keys mean.
class KeyReader {
 public:
  explicit KeyReader(const GeoTiffKeys& keys) : keys_(keys) {}

  /// The CRS that some entries name, vertical part included; an empty one where GDAL knows none.
  [[nodiscard]] OGRSpatialReference crs(const std::vector<KeyEntry>& entries) const {
    Bytes tiff = KeyTiff(directory_of(entries), keys_).bytes();
    const ReportedVerticalParts vertical;
    static constexpr const char* kDriver[] = {"GTiff", nullptr};
    char name[64];
    std::snprintf(name, sizeof name, "/vsimem/ptin_keys_%p.tif", static_cast<void*>(&tiff));
    VSIFCloseL(VSIFileFromMemBuffer(name, tiff.data(), tiff.size(), FALSE));
    OGRSpatialReference srs;
    {
      const GDALDatasetUniquePtr data(
          GDALDataset::Open(name, GDAL_OF_RASTER | GDAL_OF_READONLY, kDriver));
      const OGRSpatialReference* found = data == nullptr ? nullptr : data->GetSpatialRef();
      if (found != nullptr) {
        srs = *found;
      }
    }
    VSIUnlink(name);
    return srs;
  }

  /// The CRS of keys of heights, with some CRS in plan, which GDAL wants before it looks at them.
  [[nodiscard]] OGRSpatialReference crs_of_vertical(std::vector<KeyEntry> entries) const {
    entries.insert(entries.begin(),
                   {KeyEntry{kModelType, 0, 1, 1}, KeyEntry{kProjectedCrs, 0, 1, 32631}});
    return crs(entries);
  }

  /// A unit of length; none where the code is that of another kind of unit, or of none.
  [[nodiscard]] std::optional<LengthUnit> unit(std::uint16_t code) const {
    const bool is_angle_or_scale = code >= 9100 && code < 9300;
    if (code == kUndefined || code == kUserDefined || is_angle_or_scale) {
      return std::nullopt;
    }
    const OGRSpatialReference srs = crs_of_vertical({KeyEntry{kVerticalUnits, 0, 1, code}});
    if (srs.IsCompound() == 0) {
      return std::nullopt;
    }
    return vertical_unit_of(srs);
  }

  /// The words for the vertical part; "" for none.
  [[nodiscard]] std::string citation(const std::vector<KeyEntry>& entries) const {
    return text_of_key(entries, kVerticalCitation, keys_.text);
  }

 private:
  const GeoTiffKeys& keys_;
};

void warn(DeclaredCrs& declared, const char* kind, std::string message) {
  declared.warnings.push_back({kind, std::move(message), ""});
}

/// Old codes of VerticalCSType mean heights above an ellipsoid.
bool is_above_ellipsoid(std::uint16_t code) { return code >= 5001 && code <= 5033; }

/// The code of the CRS in plan; 0 where none is named.
std::uint16_t code_of_plane(const std::vector<KeyEntry>& entries) {
  for (const Key key : {kProjectedCrs, kGeodeticCrs}) {
    const std::uint16_t code = code_of(entries, key);
    if (code != kUndefined && code != kUserDefined) {
      return code;
    }
  }
  return kUndefined;
}

/// Says of which kind the CRS is that a code names, where the key for that is absent or says nothing.
void tell_model(std::vector<KeyEntry>& entries) {
  constexpr std::uint16_t kProjected = 1, kGeographic = 2;
  if (code_of(entries, kModelType) != kUndefined) {
    return;
  }
  const std::uint16_t plane = code_of(entries, kProjectedCrs);
  const std::uint16_t model = plane != kUndefined                            ? kProjected
                              : code_of(entries, kGeodeticCrs) != kUndefined ? kGeographic
                                                                             : kUndefined;
  if (model != kUndefined) {
    std::erase_if(entries, [](const KeyEntry& e) { return e[0] == kModelType; });
    entries.insert(entries.begin(), KeyEntry{kModelType, 0, 1, model});
  }
}

/// Adds heights above the ellipsoid to a horizontal CRS. Such a CRS has metres: with another unit the
/// unit alone is kept.
void add_ellipsoidal(OGRSpatialReference plane, const std::optional<LengthUnit>& unit,
                     DeclaredCrs& declared) {
  const bool is_metre = !unit || unit->name == "metre";
  if (is_metre && !plane.IsEmpty() && plane.IsLocal() == 0 &&
      plane.PromoteTo3D(nullptr) == OGRERR_NONE) {
    declared.crs = wkt2_of(plane);
    return;
  }
  declared.units.heights = unit ? unit->name : "metre";
  warn(declared, "crs_ellipsoidal",
       "its heights are above the ellipsoid, which cannot be added to its CRS; their unit alone is "
       "kept");
}

/// Adds what the keys of the vertical part say to what a horizontal CRS declares.
void add_vertical(const std::vector<KeyEntry>& entries, const KeyReader& reader,
                  const OGRSpatialReference& plane, DeclaredCrs& declared) {
  const std::uint16_t code = code_of(entries, kVertical);
  const std::uint16_t unit_code = code_of(entries, kVerticalUnits);
  const std::optional<LengthUnit> unit = reader.unit(unit_code);
  if (!unit && unit_code != kUndefined) {
    warn(declared, "crs_height_unit",
         "the unit of its heights (VerticalUnitsGeoKey " + std::to_string(unit_code) +
             ") is not one that is known; name a vertical CRS in that unit by --vertical-crs");
  }
  if (is_above_ellipsoid(code)) {
    add_ellipsoidal(plane, unit, declared);
    return;
  }
  std::vector<KeyEntry> vertical;
  std::copy_if(
      entries.begin(), entries.end(), std::back_inserter(vertical),
      [&](const KeyEntry& e) { return is_vertical(e) && (unit || e[0] != kVerticalUnits); });
  const OGRSpatialReference both = reader.crs_of_vertical(std::move(vertical));
  if (both.GetAxesCount() == 3 && both.IsCompound() == 0) {
    add_ellipsoidal(plane, unit, declared);
    return;
  }
  if (both.IsCompound() == 0 || is_vertical_unnamed(both)) {
    if (code != kUndefined && code != kUserDefined) {
      warn(declared, "crs_vertical",
           "its vertical CRS (VerticalCSTypeGeoKey " + std::to_string(code) +
               ") is not one that is known; name it by --vertical-crs");
    } else if (const std::string words = reader.citation(entries); !words.empty()) {
      warn(declared, "crs_vertical_in_words",
           "its heights are told to be above '" + words.substr(0, 80) +
               "', which is no code and not used; name the vertical CRS by --vertical-crs");
    }
    declared.units.heights = unit ? unit->name : "";
    if (unit && !metres_in(unit->name)) {
      declared.vertical_crs = vertical_text(both, *unit);  // which alone states its length
    }
    return;
  }
  const LengthUnit of_crs = vertical_unit_of(both);
  const bool differs = unit && std::abs(unit->metres / of_crs.metres - 1.0) > 1e-9;
  if (differs) {
    warn(declared, "crs_height_units",
         "its heights are said to be in units of '" + unit->name +
             "', and in a vertical CRS in units of '" + of_crs.name +
             "'; they are taken to be in the former");
  }
  declared.vertical_crs = vertical_text(both, differs ? *unit : of_crs);
}

}  // namespace

bool tell_of_heights(const GeoTiffKeys& keys) {
  const auto entries = entries_of(keys.directory);
  return entries && std::any_of(entries->begin(), entries->end(), is_vertical);
}

DeclaredCrs crs_of_keys(const GeoTiffKeys& keys) {
  DeclaredCrs declared;
  const auto entries = entries_of(keys.directory);
  if (!entries) {
    warn(declared, "crs_not_understood",
         "its GeoTIFF keys are cut off, and the terrain has no CRS; name it by --a-srs");
    return declared;
  }
  const GdalSession session;
  const KeyReader reader(keys);
  std::vector<KeyEntry> horizontal;
  std::remove_copy_if(entries->begin(), entries->end(), std::back_inserter(horizontal),
                      is_vertical);
  const bool has_plane = code_of(horizontal, kModelType) != kUndefined ||
                         code_of(horizontal, kGeodeticCrs) != kUndefined ||
                         code_of(horizontal, kProjectedCrs) != kUndefined;
  const std::uint16_t code = code_of_plane(horizontal);
  tell_model(horizontal);
  OGRSpatialReference plane = has_plane ? reader.crs(horizontal) : OGRSpatialReference();
  if (code != kUndefined && plane.IsLocal() != 0) {
    plane.Clear();  // what GDAL makes of a code that it does not know
  }
  declared.crs = wkt2_of(plane);
  if (has_plane && declared.crs.empty()) {
    warn(declared, "crs_not_understood",
         (code == kUndefined ? std::string("its GeoTIFF keys are not ones that GDAL understands")
                             : "the code of its CRS in its GeoTIFF keys, " + std::to_string(code) +
                                   ", is not one that GDAL understands") +
             ", and the terrain has no CRS; name it by --a-srs");
  }
  const std::optional<LengthUnit> plane_unit = reader.unit(code_of(horizontal, kPlaneUnits));
  if (declared.crs.empty() && plane_unit) {
    declared.units.plane = plane_unit->name;
  }
  if (horizontal.size() < entries->size()) {
    add_vertical(*entries, reader, plane, declared);
  }
  return declared;
}

}  // namespace ptin
