// SPDX-License-Identifier: GPL-3.0-or-later
//
// The files of the viewer, which are packed into the program.
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "tools/http/etag.h"
#include "tools/http/gzip.h"
#include "tools/http/problem.h"
#include "tools/region/serving.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"
#include "tools/viewer/first_mesh.h"
#include "tools/viewer/viewer_page.h"

namespace ptin::serve {

namespace {

/// A file as it is sent, made once.
struct SentFile {
  tools::ViewerFile file;
  std::string etag, packed;
};

/// A page with a first picture.
struct SentPage {
  std::string content, etag, packed;
};

/// What is sent, whose bytes somebody else has.
struct Sent {
  std::string_view media_type, content, packed;
  std::string etag, policy;
};

/// Of the first picture of a collection: some of the first splits, in few bytes. Their number is that
/// of the vertices, nearly.
constexpr std::uint64_t kFirstSplits = 1000, kFirstBytes = std::uint64_t{48} << 10;
/// Where these certify nothing yet, as with many voids: so many that a preview can be made of them.
constexpr std::uint64_t kPreviewSplits = 40'000, kPreviewBytes = std::uint64_t{1} << 20;
/// Of the relief: its error, so that what is looked at for it is little of a large file.
constexpr double kFirstSteps = 40;
constexpr std::uint64_t kPageMemory = std::uint64_t{64} << 20;
/// Pages that are kept, of some ten kilobytes each.
constexpr std::size_t kMostPages = 256;

const std::vector<SentFile>& sent_files() {
  static const std::vector<SentFile> all = [] {
    std::vector<SentFile> made;
    for (const tools::ViewerFile& file : tools::viewer_files()) {
      made.push_back({file, http::etag_of(file.content),
                      http::gzip(file.content, http::GzipFor::kManyAnswers)});
    }
    return made;
  }();
  return all;
}

/// The page of a collection, with its first picture.
using Page = std::shared_ptr<const SentPage>;

/// The first picture, from a stream as a client asks for it. Empty where there is none: what is wrong with
/// the file is told when the page asks for it.
std::string first_mesh_of(const Asked& asked, const Collection& collection,
                          std::uint64_t most_splits, std::uint64_t most_bytes) {
  const StoreFacts& facts = collection.terrain.store().facts();
  tools::Serving wanted;
  wanted.error = std::max((facts.max_height - facts.min_height) / kFirstSteps, 1e-6);
  StreamRequest request;
  request.wanted = tools::predicate_of(wanted, facts, "window");
  request.tolerance = wanted.error;
  request.limits = {kPageMemory, asked.limits.stop};
  request.most_splits = most_splits;
  request.most_bytes = most_bytes;
  request.metadata = tools::metadata_of_stream(collection.terrain.store(), wanted);
  std::vector<std::byte> stream;
  try {
    collection.terrain.stream(request, [&](std::span<const std::byte> bytes) {
      stream.insert(stream.end(), bytes.begin(), bytes.end());
    });
    return tools::first_mesh_element(stream);
  } catch (const Error&) {
    return {};
  }
}

/// The page of a collection, made once for each content of its file.
Page page_of(const Asked& asked, const Collection& collection) {
  static std::mutex mutex;
  static std::map<std::string, Page> pages;
  {
    const std::lock_guard lock(mutex);
    const auto found = pages.find(collection.fingerprint);
    if (found != pages.end()) return found->second;
  }
  auto made = std::make_shared<SentPage>();
  std::string first = first_mesh_of(asked, collection, kFirstSplits, kFirstBytes);
  if (first.empty() || tools::is_preview(first)) {
    first = first_mesh_of(asked, collection, kPreviewSplits, kPreviewBytes);
  }
  made->content = tools::viewer_page_with(first);
  made->etag = http::etag_of(made->content);
  made->packed = http::gzip(made->content, http::GzipFor::kManyAnswers);
  const std::lock_guard lock(mutex);
  if (pages.size() >= kMostPages) pages.clear();
  return pages.emplace(collection.fingerprint, std::move(made)).first->second;
}

http::Response response_of(const Sent& sent, const Asked& asked) {
  const http::Request& request = asked.request;
  const bool is_packed = http::takes_gzip(request.header("accept-encoding").value_or(""));
  http::Response response;
  response.content_type = sent.media_type;
  response.lasting_body = is_packed ? sent.packed : sent.content;
  response.add("ETag", is_packed ? http::gzip_etag_of(sent.etag) : sent.etag);
  response.add("Cache-Control", "no-cache");
  response.add("Content-Security-Policy", sent.policy);
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
  const bool in_frames = asked.question.has("embed");
  if (name == "index.html" && asked.question.has("collection") && !asked.question.has("service")) {
    const auto collection = asked.catalogue.find(asked.question.text("collection"));
    if (collection != nullptr) {
      const Page page = page_of(asked, *collection);
      const std::string policy =
          tools::viewer_policy(in_frames, base_map_of(asked.options, *collection).origin());
      // A browser that has the page keeps the policy that came with it.
      const std::string etag = http::etag_of(page->etag + policy);
      http::Response response = response_of(
          {"text/html; charset=utf-8", page->content, page->packed, etag, policy}, asked);
      response.held = std::const_pointer_cast<SentPage>(page);
      return response;
    }
  }
  for (const SentFile& sent : sent_files()) {
    if (sent.file.name != name) continue;
    return response_of({sent.file.media_type, sent.file.content, sent.packed, sent.etag,
                        tools::viewer_policy(in_frames)},
                       asked);
  }
  throw http::Problem(404, "the viewer has no such file; begin with /viewer/index.html");
}

}  // namespace ptin::serve
