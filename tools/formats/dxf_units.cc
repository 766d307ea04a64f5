// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/dxf_units.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <fstream>
#include <iterator>
#include <string_view>

#include <cpl_conv.h>
#include <cpl_vsi.h>

#include "engine/crs/height_unit.h"
#include "engine/error.h"

namespace ptin::tools {

namespace {

struct UnitCode {
  std::string_view name;  ///< The name of height_unit_named().
  DxfUnits units;
};

constexpr std::array<UnitCode, 10> kUnitCodes = {{{"metre", {6, 1}},
                                                  {"foot", {2, 0}},
                                                  {"US survey foot", {21, 0}},
                                                  {"kilometre", {7, 1}},
                                                  {"decimetre", {14, 1}},
                                                  {"centimetre", {5, 1}},
                                                  {"millimetre", {4, 1}},
                                                  {"yard", {10, 0}},
                                                  {"inch", {1, 0}},
                                                  {"Statute mile", {3, 0}}}};

/// Sets the value of a variable: two lines below its name, that of the group's code between them.
void set_variable(std::string& header, const std::string& name, int value) {
  const std::size_t at = header.find(name);
  const std::size_t code = at == std::string::npos ? at : header.find('\n', at);
  const std::size_t begin = code == std::string::npos ? code : header.find('\n', code + 1);
  const std::size_t end = begin == std::string::npos ? begin : header.find('\n', begin + 1);
  if (end == std::string::npos) return;
  header.replace(begin + 1, end - begin - 1, "     " + std::to_string(value));
}

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

DxfUnits dxf_units(const CrsFacts& crs) {
  const std::string unit = height_unit_named(crs.horizontal_unit);
  const auto* const code = std::find_if(kUnitCodes.begin(), kUnitCodes.end(),
                                        [&](const UnitCode& c) { return c.name == unit; });
  return code == kUnitCodes.end() ? DxfUnits{} : code->units;
}

DxfHeader::DxfHeader(const CrsFacts& crs) {
  static std::atomic<unsigned> number{0};
  const char* const found = CPLFindFile("gdal", "header.dxf");
  const std::string original = found == nullptr ? "header.dxf" : found;
  text_ = text_of(original);
  if (text_.empty()) {
    throw Error(ErrorCode::io_error,
                "GDAL's own data lack this file, which every drawing begins with; is GDAL_DATA set "
                "to another folder?",
                original);
  }
  const DxfUnits units = dxf_units(crs);
  set_variable(text_, "$INSUNITS", units.insunits);
  set_variable(text_, "$MEASUREMENT", units.measurement);
  path_ = "/vsimem/ptin_header_" + std::to_string(number++) + ".dxf";
  VSIFCloseL(VSIFileFromMemBuffer(path_.c_str(), reinterpret_cast<GByte*>(text_.data()),
                                  text_.size(), FALSE));
}

DxfHeader::~DxfHeader() { VSIUnlink(path_.c_str()); }

}  // namespace ptin::tools
