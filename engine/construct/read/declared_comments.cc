// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/declared_comments.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <set>
#include <span>
#include <utility>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/decimal.h"
#include "engine/construct/read/text_header.h"
#include "engine/crs/height_unit.h"
#include "engine/error.h"
#include "engine/number.h"

namespace ptin {
namespace {

/// In small letters, with blanks for underscores, hyphens and tabs.
std::string plain(std::string_view text) {
  std::string small(text);
  for (char& c : small) {
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    c = c == '_' || c == '-' || c == '\t' ? ' ' : c;
  }
  return small;
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : text + " ") {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      word += c;
    } else if (!word.empty()) {
      words.push_back(std::exchange(word, ""));
    }
  }
  return words;
}

using Names = std::span<const std::string_view>;

bool holds(Names names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool has_any(const std::vector<std::string>& words, Names names) {
  return std::any_of(words.begin(), words.end(),
                     [&](const std::string& word) { return holds(names, word); });
}

/// A subject that a comment may be about; each is known by the words before its value.
enum class Subject { kNone, kCrs, kVerticalCrs, kUnit, kNodata, kOther };

constexpr std::array<std::string_view, 20> kCrsNames = {"crs",
                                                        "srs",
                                                        "cs",
                                                        "epsg",
                                                        "epsg code",
                                                        "srid",
                                                        "proj",
                                                        "proj4",
                                                        "wkt",
                                                        "projection",
                                                        "map projection",
                                                        "coordsys",
                                                        "coordinate system",
                                                        "coordinate reference system",
                                                        "coordinates system",
                                                        "spatial reference",
                                                        "spatial reference system",
                                                        "reference system",
                                                        "grid system",
                                                        "coord system"};
/// Words before such a name that change nothing.
constexpr std::array<std::string_view, 9> kCrsAdjectives = {
    "horizontal", "projected", "geographic", "source", "target", "output", "file", "map", "data"};
constexpr std::array<std::string_view, 8> kVerticalNames = {
    "vertical crs",  "vertical srs", "vertical coordinate system", "vertical datum", "vdatum",
    "height system", "height datum", "vertical reference system"};
constexpr std::array<std::string_view, 4> kUnitNames = {"unit", "units", "uom", "zunits"};
constexpr std::array<std::string_view, 8> kHeightWords = {
    "vertical", "height", "heights", "elevation", "elevations", "z", "altitude", "zunits"};
constexpr std::array<std::string_view, 3> kPlaneWords = {"horizontal", "xy", "planar"};
constexpr std::array<std::string_view, 9> kUnitAdjectives = {
    "file", "linear", "length", "map", "coordinate", "coordinates", "model", "measurement", "data"};
constexpr std::array<std::string_view, 9> kNodataNames = {
    "nodata",         "no data",    "nodata value",       "no data value", "missing value",
    "missing values", "null value", "missing data value", "void value"};
/// Names behind which nothing stands that can be followed.
constexpr std::array<std::string_view, 14> kOtherNames = {"datum",          "horizontal datum",
                                                          "geodetic datum", "ellipsoid",
                                                          "spheroid",       "geoid",
                                                          "geoid model",    "zone",
                                                          "utm zone",       "hemisphere",
                                                          "up axis",        "up",
                                                          "axis up",        "axis order"};
/// And where one of these words and a number stand anywhere, it is reported.
constexpr std::array<std::string_view, 17> kTelling = {
    "shift",       "shifted",    "offset", "offsets", "origin", "translate",
    "translation", "translated", "scale",  "scaled",  "rotate", "rotation",
    "crs",         "projection", "epsg",   "srs",     "datum"};

Subject subject_named(const std::string& name) {
  if (holds(kVerticalNames, name)) {
    return Subject::kVerticalCrs;
  }
  if (holds(kNodataNames, name)) {
    return Subject::kNodata;
  }
  if (holds(kOtherNames, name)) {
    return Subject::kOther;
  }
  std::vector<std::string> words = words_of(name);
  if (words.empty()) {
    return Subject::kNone;
  }
  if (holds(kUnitNames, words.back())) {
    words.pop_back();
    const bool is_known = std::all_of(words.begin(), words.end(), [](const std::string& w) {
      return holds(kHeightWords, w) || holds(kPlaneWords, w) || holds(kUnitAdjectives, w) ||
             w == "xyz";
    });
    return is_known ? Subject::kUnit : Subject::kNone;
  }
  const std::size_t blank = name.find(' ');
  const bool has_adjective =
      blank != std::string::npos && holds(kCrsAdjectives, std::string_view(name).substr(0, blank));
  return holds(kCrsNames, name) || (has_adjective && holds(kCrsNames, name.substr(blank + 1)))
             ? Subject::kCrs
             : Subject::kNone;
}

struct Statement {
  Subject subject = Subject::kNone;
  std::string name;
  std::string_view value;
  bool is_set_apart = false;  ///< By ':' or '='.
};

/// Divides a comment into what it is about and what it says of that.
Statement statement_in(std::string_view comment) {
  const std::string small = plain(comment);
  const std::size_t mark = small.find_first_of(":=");
  if (mark != std::string::npos) {
    const std::string name(trimmed(std::string_view(small).substr(0, mark)));
    if (const Subject subject = subject_named(name); subject != Subject::kNone) {
      return {subject, name, trimmed(comment.substr(mark + 1)), true};
    }
  }
  // "nodata -9999", "unit ft": the longest name that the comment begins with.
  for (std::size_t end = small.size(); end != std::string::npos && end > 0;
       end = small.rfind(' ', end - 1)) {
    const std::string name(trimmed(std::string_view(small).substr(0, end)));
    const Subject subject = name.size() <= 40 ? subject_named(name) : Subject::kNone;
    if (subject != Subject::kNone && end < small.size()) {
      return {subject, name, trimmed(comment.substr(end)), false};
    }
  }
  return {};
}

/// True for a value that says there is nothing: "none", "unknown", 0.
bool says_nothing(std::string_view value) {
  constexpr std::array<std::string_view, 9> kNothing = {
      "", "none", "unknown", "undefined", "unspecified", "local", "n/a", "not set", "arbitrary"};
  return holds(kNothing, plain(value));
}

/// True where numbers say that nothing is moved: shifts of 0, scales of 1. Up is z here.
bool changes_nothing(const std::string& small) {
  constexpr std::array<std::string_view, 3> kScales = {"scale", "scaled", "factor"};
  if (small == "up axis: z" || small == "up axis = z" || small == "up axis z" || small == "up: z") {
    return true;
  }
  const bool is_scale = has_any(words_of(small), kScales);
  bool has_number = false;
  for (std::size_t i = 0; i < small.size();) {
    const std::size_t end = std::min(small.find_first_of(" ,;:=()[]", i), small.size());
    if (const auto number = parse_number<double>(std::string_view(small).substr(i, end - i))) {
      if (*number != (is_scale ? 1.0 : 0.0)) {
        return false;
      }
      has_number = true;
    }
    i = end + 1;
  }
  return has_number;
}

/// The codes in a text, as "EPSG:2154", written "EPSG 2154", "epsg::2154", ".../EPSG/0/2154" too.
std::set<std::string> codes_in(std::string_view text) {
  std::set<std::string> codes;
  std::string small = plain(text);
  for (const std::string_view authority : {"epsg", "esri"}) {
    for (std::size_t at = small.find(authority); at != std::string::npos;
         at = small.find(authority, at + 1)) {
      std::size_t begin = small.find_first_not_of(" :/=", at + authority.size());
      if (begin != std::string::npos && small.compare(begin, 2, "0/") == 0) {
        begin += 2;
      }
      if (begin == std::string::npos || begin == at + authority.size()) {
        continue;
      }
      const std::size_t end = std::min(small.find_first_not_of("0123456789+", begin), small.size());
      if (end > begin) {
        codes.insert((authority == "epsg" ? "EPSG:" : "ESRI:") + small.substr(begin, end - begin));
      }
    }
  }
  return codes;
}

/// True for a number, or for two of a compound CRS: "2154+5720".
bool is_code_of_crs(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789+") == std::string_view::npos;
}

std::string_view without_quotes(std::string_view text) {
  const bool is_quoted = text.size() > 1 && (text.front() == '"' || text.front() == '\'') &&
                         text.front() == text.back();
  return is_quoted ? text.substr(1, text.size() - 2) : text;
}

/// True where a word is a unit of length, but for single letters.
bool has_unit(const std::vector<std::string>& words) {
  return std::any_of(words.begin(), words.end(), [](const std::string& word) {
    return word.size() > 1 && word != "in" && metres_in(height_unit_named(word)).has_value();
  });
}

/// True for WKT and for a text of PROJ.
bool is_text_of_crs(std::string_view value) {
  constexpr std::size_t kLongestKeyword = 20;
  return (value.find('[') < kLongestKeyword && value.back() == ']') ||
         value.starts_with("+proj=") || value.starts_with("+init=");
}

/// The CRS that a value is in one way only; "" for none.
std::string crs_in(std::string_view key, std::string_view value) {
  if ((key.starts_with("epsg") || key.starts_with("srid")) && is_code_of_crs(value)) {
    return "EPSG:" + std::string(value);
  }
  if (is_text_of_crs(value)) {
    return std::string(value);
  }
  const std::set<std::string> codes = codes_in(value);
  return codes.size() == 1 ? *codes.begin() : "";
}

/// True for a CRS in degrees, and for one in this unit.
bool is_geographic_or_in(const std::string& text, const std::string& unit) {
  try {
    const Crs crs = resolve_crs(text, "", "");
    return crs.geographic || height_unit_named(crs.horizontal_unit) == unit;
  } catch (const Error&) {
    return true;  // Whoever uses the CRS says what is wrong with it.
  }
}

}  // namespace

void DeclaredComments::set(Declared& declared, std::string value) {
  if (!declared.value.empty() && declared.value != value) {
    quote(declared.comment);
    quote(comment_);
    declared.is_contradicted = true;
  }
  declared.comment = comment_;
  declared.value = declared.is_contradicted ? "" : std::move(value);
}

void DeclaredComments::quote(std::string_view comment) {
  std::string text(trimmed(comment).substr(0, 80));
  if (std::find(not_followed_.begin(), not_followed_.end(), text) == not_followed_.end()) {
    not_followed_.push_back(std::move(text));
  }
}

bool DeclaredComments::take_crs(std::string_view key, std::string_view value, bool is_vertical) {
  value = without_quotes(value);
  const std::string crs = crs_in(key, value);
  if (!is_vertical && is_crs(crs)) {
    set(crs_, crs);
    return true;
  }
  if (is_vertical_crs(crs)) {
    set(vertical_crs_, crs);
    return true;
  }
  // Names that stand for nothing but a CRS have one behind them, or a text that is to be reported.
  const bool is_sure = key == "crs" || key == "srs" || key == "vertical crs" || key == "epsg";
  if (is_sure && crs.empty() && codes_in(value).empty()) {
    set(is_vertical ? vertical_crs_ : crs_, std::string(value));
    return true;
  }
  return false;
}

bool DeclaredComments::take_unit(std::string_view value, bool is_vertical, bool is_plane) {
  for (const std::string_view word : {"is ", "are ", "in "}) {  // "units are feet"
    value = trimmed(value.starts_with(word) ? value.substr(word.size()) : value);
  }
  const std::string unit = height_unit_named(std::string(value));
  if (!metres_in(unit)) {
    return false;
  }
  set(is_vertical ? heights_ : is_plane ? plane_ : both_, unit);
  return true;
}

bool DeclaredComments::take_nodata(std::string_view value) {
  Decimal ignored;
  if (parse_number(value, ignored) != NumberKind::kNumber) {
    return false;
  }
  set(nodata_, std::string(value));
  return true;
}

/// GMT's comments: "@Je2154", '@Jp"+proj=utm"' and fields that say nothing of coordinates.
bool DeclaredComments::follow_gmt(std::string_view comment) {
  if (!comment.starts_with('@')) {
    return false;
  }
  const std::size_t code = comment.find("@Je");
  if (code != std::string_view::npos) {
    const std::string_view rest = comment.substr(code + 3);
    return take_crs("epsg", rest.substr(0, rest.find_first_of(" \t")), false);
  }
  const std::size_t text = comment.find("@Jp");
  if (text != std::string_view::npos) {
    std::string_view rest = comment.substr(text + 3);
    rest = rest.starts_with('"') ? rest.substr(0, rest.find('"', 1) + 1) : rest;
    return take_crs("proj", rest, false);
  }
  return comment.find("@Jw") == std::string_view::npos;
}

/// A comment that is no statement: a CRS alone, or prose.
bool DeclaredComments::follow_remark(std::string_view comment) {
  const std::string crs = crs_in("", comment);
  if (is_text_of_crs(comment) && is_crs(crs)) {
    set(crs_, crs);
    return true;
  }
  constexpr std::array<std::string_view, 6> kMeasured = {"coordinates", "elevations", "heights",
                                                         "units",       "depths",     "distances"};
  const std::string small = plain(comment);
  const std::vector<std::string> words = words_of(small);
  const bool has_digit = small.find_first_of("0123456789") != std::string::npos;
  const bool tells_a_place = has_digit && has_any(words, kTelling) && !changes_nothing(small);
  return !tells_a_place && !(has_any(words, kMeasured) && has_unit(words));
}

/// True where a comment is followed, or says nothing of coordinates.
bool DeclaredComments::follow(std::string_view comment) {
  if (comment.starts_with('@')) {
    return follow_gmt(comment);
  }
  const Statement s = statement_in(comment);
  if (s.subject == Subject::kNone) {
    return follow_remark(comment);
  }
  if (says_nothing(s.value)) {
    return true;
  }
  const std::string small = plain(comment);
  const std::vector<std::string> words = words_of(small);
  const std::vector<std::string> name = words_of(s.name);
  switch (s.subject) {
    case Subject::kCrs:
      // Without a colon a remark may begin so: "projection of 1998".
      return take_crs(s.name, s.value, false) || (!s.is_set_apart && !has_any(words, kTelling));
    case Subject::kVerticalCrs:
      return take_crs(s.name, s.value, true);
    case Subject::kUnit:
      return take_unit(s.value, is_of_heights_ || has_any(name, kHeightWords),
                       has_any(name, kPlaneWords)) ||
             (!s.is_set_apart && !has_unit(words));
    case Subject::kNodata:
      return take_nodata(s.value) || !s.is_set_apart;
    default:
      return changes_nothing(small) || (!s.is_set_apart && words.size() > 4);
  }
}

void DeclaredComments::note(std::string_view comment) {
  constexpr std::size_t kLongest = 4096;
  comment_ = trimmed(comment.substr(0, kLongest));
  // "crs: EPSG:2154, units: ft": each part is a statement of its own, or the whole is one.
  std::vector<std::string_view> parts;
  for (std::size_t i = 0; i <= comment_.size();) {
    const std::size_t end = std::min(comment_.find_first_of(",;", i), comment_.size());
    parts.push_back(trimmed(comment_.substr(i, end - i)));
    i = end + 1;
  }
  const bool are_statements = std::all_of(parts.begin(), parts.end(), [](std::string_view part) {
    return statement_in(part).is_set_apart;
  });
  if (!are_statements) {
    parts = {comment_};
  }
  is_of_heights_ = are_statements && statement_in(parts.front()).subject == Subject::kVerticalCrs;
  for (const std::string_view part : parts) {
    if (!follow(part)) {
      quote(comment_);
    }
  }
  comment_ = {};
}

DeclaredUnits DeclaredComments::units() const {
  // A unit of heights alone, or of x and y alone, goes before one of all three.
  DeclaredUnits units{plane_.value.empty() ? both_.value : plane_.value,
                      heights_.value.empty() ? both_.value : heights_.value};
  if (!is_crs(crs_.value)) {
    return units;
  }
  units.plane.clear();
  // "units: ft" beside a CRS in metres may be said of heights, or be wrong.
  if (heights_.value.empty() && !both_.value.empty() &&
      !is_geographic_or_in(crs_.value, both_.value)) {
    units.heights.clear();
  }
  return units;
}

std::optional<double> DeclaredComments::nodata() const {
  return parse_number<double>(nodata_.value);
}

void DeclaredComments::tell(const std::string& path, SourceWarnings& warnings) const {
  std::vector<std::string> all = not_followed_;
  if (units().heights.empty() && !both_.value.empty()) {
    DeclaredComments others(*this);
    others.quote(both_.comment);
    all = others.not_followed_;
  }
  if (all.empty()) {
    return;
  }
  constexpr std::size_t kShown = 4;
  std::string quoted;
  for (std::size_t i = 0; i < all.size() && i < kShown; ++i) {
    quoted += (i == 0 ? "'" : ", '") + all[i] + "'";
  }
  quoted += all.size() > kShown ? ", ..." : "";
  warnings.add(
      {.kind = "comment_not_followed",
       .message =
           std::string(all.size() == 1 ? "a comment tells" : "comments tell") +
           " of coordinates what is not followed, " + quoted +
           "; bring the coordinates to their CRS first, and name that with --a-srs, and one of "
           "heights with --vertical-crs",
       .file = path});
}

}  // namespace ptin
