// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/gdal_session.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <string_view>

#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal.h>

#include "engine/crs/proj_messages.h"
#include "engine/handle.h"

namespace ptin {

struct GdalSessionAccess {
  static void CPL_STDCALL collect(CPLErr severity, CPLErrorNum, const char* text) {
    auto& session = *static_cast<GdalSession*>(CPLGetErrorHandlerUserData());
    if (severity >= CE_Failure) {
      session.note_failure(text);
    } else if (severity == CE_Warning) {
      session.note_warning(text);
    }
  }
};

namespace {

/// Parts of messages that bear neither on where a sample lies nor on how high.
constexpr std::array<const char*, 21> kHarmless = {"couldn't be converted",
                                                   "Recode from",
                                                   "recode",
                                                   "encoding",
                                                   "application_id",
                                                   "user_version",
                                                   "sorted in ascending order",
                                                   "Unknown field with tag",
                                                   "does not end in null byte",
                                                   "ASCII value for",
                                                   "ExtraSamples",
                                                   "Several features with id",
                                                   "GDAL_DATA",
                                                   "is deprecated",
                                                   "winding order",
                                                   "invalid ring",
                                                   "color table",
                                                   "overview",
                                                   "statistics",
                                                   "Statistics",
                                                   "histogram"};

bool is_harmless(const std::string& text) {
  return std::any_of(kHarmless.begin(), kHarmless.end(),
                     [&](const char* part) { return text.find(part) != std::string::npos; });
}

/// On one line, without the final full stop.
std::string as_part_of_sentence(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) {
    text.pop_back();
  }
  return text;
}

}  // namespace

std::optional<std::string> beginning_of_file(const std::string& path, std::size_t most) {
  const Handle<VSILFILE, &VSIFCloseL> file(VSIFOpenL(path.c_str(), "rb"));
  if (file == nullptr) {
    return std::nullopt;
  }
  std::string text(most, '\0');
  text.resize(VSIFReadL(text.data(), 1, text.size(), file.get()));
  return text;
}

GdalSession::GdalSession() {
  CPLPushErrorHandlerEx(&GdalSessionAccess::collect, this);
  static std::once_flag registered;
  std::call_once(registered, [] {
    silence_proj();
    GDALAllRegister();
  });
}

GdalSession::~GdalSession() { CPLPopErrorHandler(); }

void GdalSession::note_failure(const char* text) {
  if (!failed_) {
    first_failure_ = as_part_of_sentence(text);
  }
  failed_ = true;
}

void GdalSession::note_warning(const char* text) {
  constexpr std::size_t kMost = 8;
  std::string warning = as_part_of_sentence(text);
  if (warnings_.size() < kMost && !warning.empty() && !is_harmless(warning) &&
      std::find(warnings_.begin(), warnings_.end(), warning) == warnings_.end()) {
    warnings_.push_back(std::move(warning));
  }
}

void GdalSession::tell_warnings(const std::string& path, SourceWarnings& warnings) const {
  const auto tell = [&](const std::string& text) {
    warnings.add({.kind = "gdal_warning",
                  .message = "GDAL warns when it opens this file, '" + text.substr(0, 300) +
                             "'; see whether places and heights are what they should be",
                  .file = path,
                  .subject = text});
  };
  for (const std::string& text : warnings_) {
    tell(text);
  }
  if (failed_ && !is_harmless(first_failure_)) {
    tell(first_failure_);
  }
}

std::string GdalSession::explain(std::string sentence) const {
  if (!first_failure_.empty()) {
    sentence += " (GDAL: " + first_failure_ + ")";
  }
  return sentence;
}

}  // namespace ptin
