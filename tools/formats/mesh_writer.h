// SPDX-License-Identifier: GPL-3.0-or-later
//
// Writing meshes: one writer a format, chosen by the extension of the file's name.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "tools/formats/mesh.h"
#include "tools/formats/mesh_stream.h"
#include "tools/output/byte_sink.h"

namespace ptin::tools {

/// A mesh format: its extension and how to write it.
struct MeshFormat {
  std::string_view extension;                      ///< Lower case, without the dot.
  std::string_view description;                    ///< For --help and error messages.
  void (*write)(const Mesh& mesh, ByteSink& out);  ///< Null where there is `make`.
  /// Set for a format that is written piece by piece; else null.
  std::unique_ptr<MeshStream> (*make)(const MeshStreamTarget& target);
};

/// Every known format.
[[nodiscard]] std::span<const MeshFormat> mesh_formats() noexcept;

/// The format of `path` by its extension, in any case.
/// @throws Error invalid_argument  unknown or no extension; lists the known ones
[[nodiscard]] const MeshFormat& mesh_format_of(const std::string& path);

/// Writes `mesh` to `path` in its format, whole or not at all.
/// @throws Error  as mesh_format_of and OutputFile; invalid_argument when the format cannot hold
/// the mesh
void write_mesh(const Mesh& mesh, const std::string& path, bool overwrite);

/// Feeds a mesh to a stream, and publishes it.
void write_in_pieces(const Mesh& mesh, MeshStream& stream);

// The writers of whole meshes. Each documents its own conventions.
void write_ply(const Mesh& mesh, ByteSink& out);
void write_glb(const Mesh& mesh, ByteSink& out);

}  // namespace ptin::tools
