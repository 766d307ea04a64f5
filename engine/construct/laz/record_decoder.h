// SPDX-License-Identifier: GPL-3.0-or-later
//
// What decodes the points of a chunk, one after the other.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "engine/construct/laz/byte_window.h"
#include "engine/construct/laz/chunk_table.h"
#include "engine/construct/laz/layout.h"

namespace ptin::laz {

class RecordDecoder {
 public:
  RecordDecoder() = default;
  RecordDecoder(const RecordDecoder&) = delete;
  RecordDecoder& operator=(const RecordDecoder&) = delete;
  virtual ~RecordDecoder() = default;

  /// Begins a chunk.
  /// @throws DamagedBytes; Error io_error
  virtual void open(const Chunk& chunk) = 0;
  /// The next points, Layout::given_bytes() each, one after the other. All calls for a chunk
  /// together want no more points than it has.
  /// @throws as open()
  virtual void read(std::span<unsigned char> records) = 0;
  /// Called when all points of the chunk have been read.
  /// @throws DamagedBytes  its bytes are not used up
  virtual void close() = 0;
};

/// @param source  Must outlive the result, as `layout`.
[[nodiscard]] std::unique_ptr<RecordDecoder> make_point_wise_decoder(const Source& source,
                                                                     const Layout& layout);
[[nodiscard]] std::unique_ptr<RecordDecoder> make_layered_decoder(const Source& source,
                                                                  const Layout& layout);

}  // namespace ptin::laz
