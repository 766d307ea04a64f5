// SPDX-License-Identifier: GPL-3.0-or-later
//
// The web viewer as it is packed into the program (tools/viewer/README.md).
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace ptin::tools {

/// One of the viewer's files, which lie in one folder of a web host.
struct ViewerFile {
  std::string_view name;
  std::string_view media_type;
  std::string_view content;  ///< Lives as long as the program.
};

/// index.html, viewer.js, worker.js, decoder.wasm, questions.wasm.
[[nodiscard]] std::span<const ViewerFile> viewer_files() noexcept;

/// index.html, made to open a stream when its address names none.
/// @param stream  The name of a file beside the page; any bytes but `/` and NUL.
[[nodiscard]] std::string viewer_page_for(std::string_view stream);

}  // namespace ptin::tools
