// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/gzip.h"

#include <algorithm>
#include <charconv>

#include <zlib.h>

#include "engine/error.h"
#include "tools/http/letters.h"

namespace ptin::http {

namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t from = std::min(text.find_first_not_of(" \t"), text.size());
  const std::size_t to = text.find_last_not_of(" \t");
  return to == std::string_view::npos ? std::string_view() : text.substr(from, to + 1 - from);
}

/// The weight behind the name of a coding; 1 where none is given.
double weight_of(std::string_view parameters) {
  const std::size_t at = parameters.find("q=");
  if (at == std::string_view::npos) return 1.0;
  double weight = 0.0;
  std::from_chars(parameters.data() + at + 2, parameters.data() + parameters.size(), weight);
  return weight;
}

}  // namespace

bool takes_gzip(std::string_view given) {
  // Names of codings have letters of any case (RFC 9110, 8.4.1).
  const std::string low = lower_letters(given);
  std::string_view accept_encoding = low;
  double by_name = -1.0, by_star = 0.0;
  while (!accept_encoding.empty()) {
    const std::size_t end = std::min(accept_encoding.find(','), accept_encoding.size());
    const std::string_view item = accept_encoding.substr(0, end);
    accept_encoding.remove_prefix(std::min(end + 1, accept_encoding.size()));
    const std::size_t semicolon = std::min(item.find(';'), item.size());
    const std::string_view name = trimmed(item.substr(0, semicolon));
    if (name == "gzip" || name == "x-gzip") by_name = weight_of(item.substr(semicolon));
    if (name == "*") by_star = weight_of(item.substr(semicolon));
  }
  return by_name >= 0.0 ? by_name > 0.0 : by_star > 0.0;
}

std::string gzip(std::string_view text, GzipFor use) {
  const int level = use == GzipFor::kManyAnswers ? 9 : 5;
  constexpr int kWindow = 15, kWithGzipHead = 16, kMemory = 8;
  z_stream stream{};
  if (::deflateInit2(&stream, level, Z_DEFLATED, kWindow + kWithGzipHead, kMemory,
                     Z_DEFAULT_STRATEGY) != Z_OK) {
    throw Error(ErrorCode::resource_exhausted, "zlib is refused memory");
  }
  std::string packed(::deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int status = ::deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  ::deflateEnd(&stream);
  if (status != Z_STREAM_END) throw Error(ErrorCode::internal, "zlib did not end its stream");
  return packed;
}

}  // namespace ptin::http
