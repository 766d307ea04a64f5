# SPDX-License-Identifier: GPL-3.0-or-later
#
# Writes the viewer's files as a source: cmake -D ASSETS=folder -D OUT=viewer_files.cc -P embed.cmake. Needs no Node: the
# files are kept in the repository.
set(type_index_html "text/html; charset=utf-8")
set(type_viewer_css "text/css")
set(type_boot_js "text/javascript")
set(type_viewer_js "text/javascript")
set(type_shared_js "text/javascript")
set(type_worker_js "text/javascript")
set(type_base_map_js "text/javascript")
set(type_ptin_terrain_js "text/javascript")
set(type_decoder_wasm "application/wasm")
set(type_questions_wasm "application/wasm")
string(REPEAT "." 128 line)  # 64 bytes
set(arrays "")
set(rows "")
foreach(name IN ITEMS index.html viewer.css boot.js viewer.js shared.js worker.js base_map.js ptin-terrain.js decoder.wasm questions.wasm)
  string(MAKE_C_IDENTIFIER ${name} id)
  file(READ ${ASSETS}/${name} hex HEX)
  string(REGEX REPLACE "(${line})" "\\1\n" hex "${hex}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," hex "${hex}")
  string(APPEND arrays "constexpr unsigned char ${id}[] = {\n${hex}};\n")
  string(APPEND rows "    {\"${name}\", \"${type_${id}}\", text(${id})},\n")
endforeach()
file(WRITE ${OUT} "// Made by tools/viewer/embed.cmake.
#include \"tools/viewer/viewer_page.h\"

#include <array>
#include <cstddef>

namespace ptin::tools {

namespace {

${arrays}
template <std::size_t N>
std::string_view text(const unsigned char (&bytes)[N]) {
  return {reinterpret_cast<const char*>(bytes), N};
}

}  // namespace

std::span<const ViewerFile> viewer_files() noexcept {
  static const auto files = std::to_array<ViewerFile>({
${rows}  });
  return files;
}

}  // namespace ptin::tools
")
