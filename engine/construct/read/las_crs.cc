// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/las_crs.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/construct/grid/crs.h"
#include "engine/construct/read/las_records.h"

namespace ptin {

namespace {

using Bytes = std::vector<unsigned char>;

constexpr std::uint64_t kMostCrsBytes = std::uint64_t{1} << 24;

constexpr std::uint16_t kMathTransform = 2111, kWkt = 2112;
constexpr std::uint16_t kKeys = 34735, kDoubles = 34736, kText = 34737;

/// The records of a LAS file that state its CRS.
struct LasRecords {
  /// The texts that are not empty, in the order of the file; those that the library libLAS wrote under
  /// its own name where there are no others.
  std::vector<std::string> wkt;
  GeoTiffKeys keys;  ///< The last of each kind of record.
  bool has_math_transform = false;
  std::vector<SourceWarning> warnings;  ///< About records that are not there; they name no file.
};

std::string_view text_of(std::span<const unsigned char> bytes) {
  const std::string_view all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return all.substr(0, all.find('\0'));
}

void take_wkt(const Bytes& content, LasRecords& records) {
  const std::string_view text = text_of(content);
  if (text.find_first_not_of(" \t\r\n") != std::string_view::npos) {
    records.wkt.emplace_back(text);
  }
}

/// Reads the content of a record if it is about the CRS.
/// @param id  The number of the record among those of the projection.
void take_record(const LasFile& file, std::uint16_t id, std::uint64_t at, std::uint64_t bytes,
                 LasRecords& records) {
  records.has_math_transform = records.has_math_transform || id == kMathTransform;
  const bool is_wanted = id == kWkt || id == kKeys || id == kDoubles || id == kText;
  if (!is_wanted || bytes > kMostCrsBytes) {
    return;
  }
  Bytes content(bytes);
  file.read(at, content);
  switch (id) {
    case kWkt:
      take_wkt(content, records);
      break;
    case kKeys:
      records.keys.directory = std::move(content);
      break;
    case kDoubles:
      records.keys.doubles = std::move(content);
      break;
    default:
      records.keys.text = std::move(content);
      break;
  }
}

/// Reads the records of a place that are about the CRS.
/// @param of_liblas  Receives texts under the name of that library, of which others know nothing.
void walk_all(const LasFile& file, const LasRecordPlace& place, const char* where,
              LasRecords& records, LasRecords& of_liblas) {
  const std::uint64_t there = walk_records(file, place, [&](const LasRecordHead& head) {
    if (head.user == "LASF_Projection") {
      take_record(file, head.id, head.at, head.bytes, records);
    } else if (head.user == "liblas" && head.id == kWkt) {
      take_record(file, head.id, head.at, head.bytes, of_liblas);
    }
  });
  if (there < place.count) {
    records.warnings.push_back({"las_records",
                                "the header counts " + std::to_string(place.count) + " records " +
                                    where + ", and " + std::to_string(there) +
                                    " are there; what the others may declare is not known",
                                ""});
  }
}

/// Looks at the header of each record, and reads those that are about the CRS. Records end where the
/// points begin, those behind the points with the file, whatever the header counts.
LasRecords read_las_records(const LasFile& file, const LasHeader& header) {
  LasRecords records, of_liblas;
  walk_all(file, records_before_points(file, header), "before the points", records, of_liblas);
  if (header.extended_records > 0) {
    walk_all(file, records_behind_points(file, header), "behind the points", records, of_liblas);
  }
  if (records.wkt.empty()) {
    records.wkt = std::move(of_liblas.wkt);
  }
  return records;
}

/// The last text that is understood; else the last one, as it is.
DeclaredCrs crs_of_texts(const LasRecords& records) {
  DeclaredCrs declared;
  std::string& found = declared.crs;
  for (const std::string& text : records.wkt) {
    if (found.empty() || is_crs(text)) {
      if (is_crs(found) && !is_same_crs(found, text)) {
        declared.warnings.push_back(
            {"crs_contradiction",
             "it holds several texts (WKT) of its CRS, which are not the same; the last one is "
             "taken",
             ""});
      }
      found = text;
    }
  }
  if (is_vertical_crs(found)) {
    std::swap(declared.crs, declared.vertical_crs);
  }
  return declared;
}

bool says_nothing(const DeclaredCrs& d) {
  return d.crs.empty() && d.vertical_crs.empty() && d.units == DeclaredUnits{};
}

bool is_understood(const DeclaredCrs& d) {
  return !says_nothing(d) && (d.crs.empty() || is_crs(d.crs));
}

/// Adds what `other` says of heights where `declared` is silent; both are about the same plane.
/// @return  Both say something, and it is not the same.
bool complete_heights(DeclaredCrs& declared, const DeclaredCrs& other) {
  const Crs crs = resolve_crs(declared.crs, "", declared.vertical_crs);
  const Crs of_other = resolve_crs(other.crs, "", other.vertical_crs);
  const auto unit_of = [](const Crs& c, const DeclaredCrs& d) {
    return c.vertical_unit == "unknown" && !d.units.heights.empty() ? d.units.heights
                                                                    : c.vertical_unit;
  };
  const std::string unit = unit_of(crs, declared), unit_of_other = unit_of(of_other, other);
  if (!crs.vertical_known && unit == "unknown") {
    declared.crs = of_other.wkt;
    declared.vertical_crs.clear();
    declared.units.heights = other.units.heights;
    return false;
  }
  return unit_of_other != "unknown" && unit_of_other != unit;
}

/// The CRS that the records declare, as declared_by_las() says.
DeclaredCrs crs_of_records(const LasRecords& records, bool is_wkt) {
  DeclaredCrs text = crs_of_texts(records);
  if (records.keys.directory.empty()) {
    return text;
  }
  DeclaredCrs keys = crs_of_keys(records.keys);
  if (says_nothing(text)) {
    return keys;
  }
  DeclaredCrs& first = is_wkt ? text : keys;
  DeclaredCrs& second = is_wkt ? keys : text;
  const std::string name = is_wkt ? "WKT" : "GeoTIFF keys";
  const std::string other = is_wkt ? "GeoTIFF keys" : "WKT";
  if (!is_understood(first)) {
    if (!is_understood(second)) {
      return text;
    }
    second.warnings.push_back(
        {"crs_contradiction",
         "its CRS as " + name + ", which its header says is the one, is not understood; that as " +
             other + " is taken",
         ""});
    return second;
  }
  if (!is_understood(second) || first.crs.empty() || second.crs.empty()) {
    return first;
  }
  if (!is_same_in_plan(first.crs, second.crs) || complete_heights(first, second)) {
    first.warnings.push_back({"crs_contradiction",
                              "its CRS is one as WKT and another one as GeoTIFF keys; the " + name +
                                  " is taken, as its header says",
                              ""});
  }
  return first;
}

}  // namespace

DeclaredCrs declared_by_las(const LasFile& file, const LasHeader& header) {
  LasRecords records = read_las_records(file, header);
  DeclaredCrs declared = crs_of_records(records, header.crs_is_wkt);
  std::swap(declared.warnings, records.warnings);
  std::move(records.warnings.begin(), records.warnings.end(),
            std::back_inserter(declared.warnings));
  if (records.has_math_transform) {
    declared.warnings.push_back(
        {"las_math_transform",
         "it declares a transformation of its coordinates (record 2111), which is not applied",
         ""});
  }
  return declared;
}

}  // namespace ptin
