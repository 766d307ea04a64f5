// SPDX-License-Identifier: GPL-3.0-or-later
//
// A text file in GDAL's memory, gone with its scope.
#pragma once

#include <cstring>
#include <string>

#include <cpl_vsi.h>

namespace ptin {

class MemoryFile {
 public:
  MemoryFile(const std::string& name, const std::string& content) : path_("/vsimem/" + name) {
    VSILFILE* file = VSIFOpenL(path_.c_str(), "wb");
    VSIFWriteL(content.data(), 1, content.size(), file);
    VSIFCloseL(file);
  }
  ~MemoryFile() { VSIUnlink(path_.c_str()); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// The text as gzip packs it.
inline std::string packed(const std::string& text) {
  { const MemoryFile made("packing.gz", ""); }
  VSILFILE* file = VSIFOpenL("/vsigzip//vsimem/packing.gz", "wb");
  VSIFWriteL(text.data(), 1, text.size(), file);
  VSIFCloseL(file);
  vsi_l_offset bytes = 0;
  const GByte* content = VSIGetMemFileBuffer("/vsimem/packing.gz", &bytes, FALSE);
  const std::string result(reinterpret_cast<const char*>(content), bytes);
  VSIUnlink("/vsimem/packing.gz");
  return result;
}

}  // namespace ptin
