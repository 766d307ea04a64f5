// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/class_names.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cctype>
#include <optional>
#include <string_view>

#include "engine/error.h"
#include "engine/number.h"

namespace ptin {

namespace {

constexpr int kClasses = 256;

/// A name, and the classes that have it.
struct ClassName {
  std::string_view name;
  int first, last;
  int other = -1;  ///< One apart from these; -1: none.
};

/// Those of the specification of LAS 1.4, revision 15.
constexpr std::array kClassNames{ClassName{"never-classified", 0, 0},
                                 ClassName{"unclassified", 1, 1},
                                 ClassName{"ground", 2, 2},
                                 ClassName{"vegetation", 3, 5},
                                 ClassName{"low-vegetation", 3, 3},
                                 ClassName{"medium-vegetation", 4, 4},
                                 ClassName{"high-vegetation", 5, 5},
                                 ClassName{"building", 6, 6},
                                 ClassName{"noise", 7, 7, 18},
                                 ClassName{"low-noise", 7, 7},
                                 ClassName{"key-point", 8, 8},
                                 ClassName{"water", 9, 9},
                                 ClassName{"rail", 10, 10},
                                 ClassName{"road", 11, 11},
                                 ClassName{"overlap", 12, 12},
                                 ClassName{"wire-guard", 13, 13},
                                 ClassName{"wire-conductor", 14, 14},
                                 ClassName{"tower", 15, 15},
                                 ClassName{"wire-connector", 16, 16},
                                 ClassName{"bridge", 17, 17},
                                 ClassName{"high-noise", 18, 18},
                                 ClassName{"overhead-structure", 19, 19},
                                 ClassName{"ignored-ground", 20, 20},
                                 ClassName{"snow", 21, 21},
                                 ClassName{"temporal-exclusion", 22, 22}};

std::vector<int> range_of(int first, int last) {
  std::vector<int> all;
  for (int c = first; c <= last; ++c) {
    all.push_back(c);
  }
  return all;
}

/// In small letters, a blank or an underscore between words as a hyphen.
std::string plain_name(std::string_view item) {
  std::string name(item);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
    return c == '_' || c == ' ' ? '-' : static_cast<char>(std::tolower(c));
  });
  return name;
}

[[noreturn]] void refuse_item(std::string_view item, const std::string& name) {
  std::string names;
  for (const ClassName& n : kClassNames) {
    names += (names.empty() ? "" : ", ") + std::string(n.name);
  }
  const bool is_name = !name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) != 0;
  refuse("'" + std::string(item) +
         "' is no class of LAS: those are numbers from 0 to 255, ranges "
         "as 8-12, " +
         (is_name ? "and the names " + names : "and names as ground or noise"));
}

/// The classes of one item.
std::vector<int> classes_of_item(std::string_view item) {
  const std::string name = plain_name(item);
  for (const ClassName& n : kClassNames) {
    if (name == n.name) {
      std::vector<int> classes = range_of(n.first, n.last);
      if (n.other >= 0) {
        classes.push_back(n.other);
      }
      return classes;
    }
  }
  const std::size_t hyphen = std::min(item.find('-', 1), item.size());
  const std::optional<int> first = parse_number<int>(item.substr(0, hyphen));
  const std::optional<int> last =
      hyphen == item.size() ? first : parse_number<int>(item.substr(hyphen + 1));
  if (!first || !last || *first < 0 || *first > *last || *last >= kClasses) {
    refuse_item(item, name);
  }
  return range_of(*first, *last);
}

}  // namespace

std::vector<int> classes_of(const std::vector<std::string>& words) {
  std::vector<int> kept;
  std::bitset<kClasses> left_out;
  bool keeps_all = true;
  for (const std::string& word : words) {
    std::string_view rest = word;
    bool leaves_out = false, is_last = false;
    while (!is_last) {
      const std::size_t comma = rest.find(',');
      is_last = comma == std::string_view::npos;
      std::string_view item = rest.substr(0, comma);
      rest.remove_prefix(is_last ? rest.size() : comma + 1);
      if (item.starts_with('!')) {
        leaves_out = true;
        item.remove_prefix(1);
      }
      const std::vector<int> classes = classes_of_item(item);
      keeps_all = keeps_all && leaves_out;
      for (const int c : classes) {
        if (leaves_out) {
          left_out.set(static_cast<std::size_t>(c));
        } else {
          kept.push_back(c);
        }
      }
    }
  }
  if (keeps_all) {
    kept = range_of(0, kClasses - 1);
  }
  std::erase_if(kept, [&](int c) { return left_out.test(static_cast<std::size_t>(c)); });
  if (kept.empty()) {
    refuse("this leaves no class");
  }
  return kept;
}

}  // namespace ptin
