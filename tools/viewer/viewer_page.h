// SPDX-License-Identifier: GPL-3.0-or-later
//
// The web viewer as it is packed into the program (tools/viewer/README.md).
#pragma once

#include <optional>
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

/// index.html, viewer.css, boot.js, viewer.js, shared.js, worker.js, base_map.js, ptin-terrain.js, decoder.wasm, questions.wasm.
[[nodiscard]] std::span<const ViewerFile> viewer_files() noexcept;

/// index.html, made to open a stream when its address names none.
/// @param stream  The name of a file beside the page; any bytes but `/` and NUL.
/// @param first_mesh  first_mesh_element() of the stream.
[[nodiscard]] std::string viewer_page_for(std::string_view stream,
                                          std::string_view first_mesh = {});

/// index.html with the first mesh of what its address names.
[[nodiscard]] std::string viewer_page_with(std::string_view first_mesh);

/// The rights of the page, as Content-Security-Policy has them. The page itself says the same in an element, but
/// for who may show it in a frame.
/// @param in_frames  Any page may show it in a frame; else its own host's alone.
/// @param asked      The only origin that the page may ask beside its own; "": none. Without it any, as a
///                   page of streams from other hosts needs.
[[nodiscard]] std::string viewer_policy(bool in_frames,
                                        std::optional<std::string_view> asked = std::nullopt);

}  // namespace ptin::tools
