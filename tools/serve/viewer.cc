// SPDX-License-Identifier: GPL-3.0-or-later
//
// The files of the viewer, which are packed into the program.
#include <array>
#include <string>
#include <vector>

#include "tools/http/etag.h"
#include "tools/http/gzip.h"
#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"
#include "tools/viewer/viewer_page.h"

namespace ptin::serve {

namespace {

/// A file as it is sent, made once.
struct SentFile {
  tools::ViewerFile file;
  std::string etag, packed;
};

const std::vector<SentFile>& sent_files() {
  static const std::vector<SentFile> all = [] {
    std::vector<SentFile> made;
    for (const tools::ViewerFile& file : tools::viewer_files()) {
      made.push_back({file, http::etag_of(file.content), http::gzip(file.content)});
    }
    return made;
  }();
  return all;
}

http::Response response_of(const SentFile& sent, const http::Request& request) {
  const bool is_packed = http::takes_gzip(request.header("accept-encoding").value_or(""));
  http::Response response;
  response.content_type = sent.file.media_type;
  response.lasting_body = is_packed ? std::string_view(sent.packed) : sent.file.content;
  response.add("ETag", is_packed ? http::gzip_etag_of(sent.etag) : sent.etag);
  response.add("Cache-Control", "no-cache");
  if (is_packed) response.add("Content-Encoding", "gzip");
  if (http::names_etag(request.header("if-none-match").value_or(""), sent.etag)) {
    response.status = 304;
    response.lasting_body = {};
  }
  return response;
}

}  // namespace

/// What the page reads of its own address; the files are the same whatever it says.
ask::Parameters viewer_parameters() {
  ask::Parameters rows;
  ask::add_text(rows, "collection", "The terrain that the page opens", "m");
  ask::add_text(rows, "stream", "The address of a stream, instead of a collection");
  ask::add_text(rows, "service", "The service that has the collection, where it is another one");
  ask::add_text(rows, "embed", "For a frame in another page: the terrain without its card", "1");
  ask::add_text(rows, "vertices", "So many vertices are shown at most", "400000");
  return rows;
}

http::Response answer_viewer(const Asked& asked) {
  const std::string_view name = asked.rest.empty() ? "index.html" : asked.rest;
  for (const SentFile& sent : sent_files()) {
    if (sent.file.name == name) return response_of(sent, asked.request);
  }
  throw http::Problem(404, "the viewer has no such file; begin with /viewer/index.html");
}

}  // namespace ptin::serve
