// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin viewer: a page that shows a stream, for any web host.
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "storage/file_beginning.h"
#include "storage/layout.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/output/output_file.h"
#include "tools/ptin/command.h"
#include "tools/ptin/query_options.h"
#include "tools/viewer/first_mesh.h"
#include "tools/viewer/viewer_page.h"

namespace ptin::tools {

namespace {

namespace fs = std::filesystem;

struct ViewerOptions {
  OutputOptions out;
  std::string stream;
};

struct WrittenFile {
  std::string name;
  std::uint64_t bytes;
};

std::ifstream open_to_copy(const std::string& path) {
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw system_error(errno != 0 ? errno : EIO, "cannot open", path);
  return in;
}

/// Refuses a file that does not begin like a stream: its page would show an error alone.
void check_stream(const std::string& path) {
  if (fs::is_directory(path)) refuse("this is a folder, not a stream", path);
  std::ifstream in = open_to_copy(path);
  std::array<char, kBeginningBytes> first{};
  in.read(first.data(), first.size());
  const auto bytes = std::as_bytes(std::span(first)).first(static_cast<std::size_t>(in.gcount()));
  const auto begins_with = [&](const auto& magic) {
    return bytes.size() >= magic.size() &&
           std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
  };
  if (begins_with(layout::kMagic)) {
    refuse("this is a store, not a stream; `ptin stream` makes one of it", path);
  }
  if (!begins_with(layout::kStreamMagic)) {
    refuse("this does not begin like a stream: " + beginning_of(bytes), path);
  }
}

/// The name of the stream beside the page.
std::string name_in_folder(const std::string& stream) {
  std::string name = fs::path(stream).filename().string();
  const auto files = viewer_files();
  if (std::any_of(files.begin(), files.end(),
                  [&](const ViewerFile& file) { return file.name == name; })) {
    refuse("a stream cannot have the name of one of the viewer's own files", stream);
  }
  return name;
}

std::string path_in(const ViewerOptions& options, std::string_view name) {
  return (fs::path(options.out.output) / name).string();
}

/// True when the stream lies in the folder already: then it stays as it is.
bool is_in_place(const ViewerOptions& options, const std::string& name) {
  std::error_code error;
  return fs::equivalent(options.stream, path_in(options, name), error) && !error;
}

void make_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directory(folder, error);
  if (error) throw system_error(error.value(), "cannot make the folder", folder);
}

WrittenFile write_file(const ViewerOptions& options, std::string_view name,
                       std::string_view content) {
  OutputFile out(path_in(options, name), options.out.overwrite);
  out.write(content);
  out.publish();
  return {std::string(name), content.size()};
}

WrittenFile copy_stream(const ViewerOptions& options, const std::string& name) {
  std::ifstream in = open_to_copy(options.stream);
  OutputFile out(path_in(options, name), options.out.overwrite);
  std::vector<char> buffer(std::size_t{1} << 20);
  std::uint64_t bytes = 0;
  do {
    in.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    out.write(buffer.data(), static_cast<std::size_t>(in.gcount()));
    bytes += static_cast<std::uint64_t>(in.gcount());
  } while (in);
  if (in.bad()) throw system_error(EIO, "cannot read", options.stream);
  out.publish();
  return {name, bytes};
}

/// The first picture of the stream. A stream that cannot be read tells so when it is opened, with what
/// of it came before the damage in sight; the page is written without a picture then.
std::string first_mesh_of(const ViewerOptions& options) {
  constexpr std::size_t kBeginning = std::size_t{1} << 20;
  std::ifstream in = open_to_copy(options.stream);
  std::vector<char> first(kBeginning);
  in.read(first.data(), static_cast<std::streamsize>(first.size()));
  first.resize(static_cast<std::size_t>(in.gcount()));
  try {
    return first_mesh_element(std::as_bytes(std::span(first)));
  } catch (const Error&) {
    return {};
  }
}

/// The stream first, the page last: a page that is there has all that it needs.
std::vector<WrittenFile> write_all(const ViewerOptions& options, const std::string& name) {
  std::vector<WrittenFile> written;
  if (!name.empty() && !is_in_place(options, name)) written.push_back(copy_stream(options, name));
  for (const ViewerFile& file : viewer_files()) {
    if (file.name != "index.html") written.push_back(write_file(options, file.name, file.content));
  }
  for (const ViewerFile& file : viewer_files()) {
    if (file.name != "index.html") continue;
    written.push_back(name.empty() ? write_file(options, file.name, file.content)
                                   : write_file(options, file.name,
                                                viewer_page_for(name, first_mesh_of(options))));
  }
  return written;
}

void check_options(const ViewerOptions& options, const std::string& name) {
  make_folder(options.out.output);
  for (const ViewerFile& file : viewer_files()) {
    check_output(path_in(options, file.name), options.out.overwrite);
  }
  if (!name.empty() && !is_in_place(options, name)) {
    check_output(path_in(options, name), options.out.overwrite);
  }
}

int run_viewer(const ViewerOptions& options, const Context& context) {
  std::string name;
  if (!options.stream.empty()) {
    check_stream(options.stream);
    name = name_in_folder(options.stream);
  }
  check_options(options, name);
  const std::vector<WrittenFile> written = write_all(options, name);
  if (context.json) {
    nlohmann::json files = nlohmann::json::array();
    for (const WrittenFile& file : written) {
      files.push_back({{"name", file.name}, {"bytes", file.bytes}});
    }
    print_json({{"output", options.out.output},
                {"files", std::move(files)},
                {"stream", name.empty() ? nlohmann::json() : nlohmann::json(name)}});
  } else if (!context.quiet) {
    std::uint64_t bytes = 0;
    for (const WrittenFile& file : written) bytes += file.bytes;
    std::fprintf(stderr,
                 "%s: %s in %s; any web host can give them out, here "
                 "`python3 -m http.server --directory %s`\n",
                 options.out.output.c_str(), human_bytes(bytes).c_str(),
                 counted(written.size(), "file").c_str(), options.out.output.c_str());
  }
  return kExitDone;
}

void add_question(ask::Parameters& rows, ViewerOptions& options) {
  add_output(rows, options.out, "The folder to write into; made where it is missing", true,
             "FOLDER");
  rows.add("stream", &options.stream, "FILE",
           "A stream that `ptin stream` wrote: copied beside the page, which opens it");
}

}  // namespace

Declared declare_viewer(Context& context) { return declared<ViewerOptions>(context, run_viewer); }

}  // namespace ptin::tools
