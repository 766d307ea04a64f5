// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/gdal_session.h"

#include <mutex>

#include <cpl_error.h>
#include <gdal.h>

#include "engine/crs/proj_messages.h"

namespace ptin {

struct GdalSessionAccess {
  static void note(GdalSession& session, const char* text) { session.note_failure(text); }
};

namespace {

void CPL_STDCALL collect(CPLErr severity, CPLErrorNum, const char* text) {
  if (severity < CE_Failure) {
    return;
  }
  GdalSessionAccess::note(*static_cast<GdalSession*>(CPLGetErrorHandlerUserData()), text);
}

}  // namespace

GdalSession::GdalSession() {
  CPLPushErrorHandlerEx(&collect, this);
  static std::once_flag registered;
  std::call_once(registered, [] {
    silence_proj();
    GDALAllRegister();
  });
}

GdalSession::~GdalSession() { CPLPopErrorHandler(); }

void GdalSession::note_failure(const char* text) {
  if (!failed_) {
    first_failure_ = text;
    while (!first_failure_.empty() &&
           (first_failure_.back() == '.' || first_failure_.back() == '\n')) {
      first_failure_.pop_back();
    }
  }
  failed_ = true;
}

std::string GdalSession::explain(std::string sentence) const {
  if (!first_failure_.empty()) {
    sentence += " (GDAL: " + first_failure_ + ")";
  }
  return sentence;
}

}  // namespace ptin
