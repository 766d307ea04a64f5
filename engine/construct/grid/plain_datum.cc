// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/plain_datum.h"

#include <cstddef>
#include <vector>

namespace ptin {
namespace {

constexpr std::string_view kEnsemble = "ENSEMBLE[";

/// The first of `wanted` in `text` at or behind `from`, outside quoted names; npos for none. A
/// quote within a name is written twice, which closes the name and opens it again.
std::size_t find_unquoted(std::string_view text, std::string_view wanted, std::size_t from) {
  bool is_quoted = false;
  for (std::size_t i = from; i < text.size(); ++i) {
    if (text[i] == '"') {
      is_quoted = !is_quoted;
    } else if (!is_quoted && text.substr(i, wanted.size()) == wanted) {
      return i;
    }
  }
  return std::string_view::npos;
}

/// The members of the node whose first one begins at `begin`, without the commas between them;
/// `end` becomes the place of the bracket that closes the node. None where nothing closes it.
std::vector<std::string_view> members(std::string_view text, std::size_t begin, std::size_t& end) {
  std::vector<std::string_view> found;
  bool is_quoted = false;
  int depth = 0;
  for (std::size_t i = begin; i < text.size(); ++i) {
    is_quoted = is_quoted != (text[i] == '"');
    if (is_quoted) {
      continue;
    }
    const bool closes = text[i] == ']' && depth == 0;
    if (closes || (text[i] == ',' && depth == 0)) {
      found.push_back(text.substr(begin, i - begin));
      begin = i + 1;
    }
    if (closes) {
      end = i;
      return found;
    }
    depth += text[i] == '[' ? 1 : text[i] == ']' ? -1 : 0;
  }
  return {};
}

/// The datum for an ensemble of these members.
std::string datum_of(const std::vector<std::string_view>& ensemble) {
  std::string name(ensemble.front());
  if (constexpr std::string_view kWord = " ensemble\""; name.ends_with(kWord)) {
    name.replace(name.size() - kWord.size(), kWord.size(), "\"");
  }
  std::string kept;
  bool is_geodetic = false;
  for (std::size_t i = 1; i < ensemble.size(); ++i) {
    const std::string_view member = ensemble[i];
    is_geodetic |= member.starts_with("ELLIPSOID[");
    if (!member.starts_with("MEMBER[") && !member.starts_with("ENSEMBLEACCURACY[")) {
      kept.append(",").append(member);
    }
  }
  return (is_geodetic ? "DATUM[" : "VDATUM[") + name + kept + "]";
}

}  // namespace

std::string with_plain_datums(std::string_view wkt) {
  std::string plain;
  std::size_t copied = 0;
  for (std::size_t at = 0; (at = find_unquoted(wkt, kEnsemble, at)) != std::string_view::npos;) {
    std::size_t end = 0;
    const auto ensemble = members(wkt, at + kEnsemble.size(), end);
    if (ensemble.empty()) {
      break;
    }
    plain.append(wkt.substr(copied, at - copied)).append(datum_of(ensemble));
    at = copied = end + 1;
  }
  return plain.append(wkt.substr(copied));
}

}  // namespace ptin
