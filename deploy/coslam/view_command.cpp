// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "common/base/error.h"
#include "deploy/coslam/commands.h"
#include "deploy/coslam/export/export.h"
#include "deploy/coslam/map_result.h"
#include "deploy/coslam/result_argument.h"
#include "server/app/stop_signals.h"
#include "server/show/web/explain_answer.h"
#include "server/show/web/page.h"
#include "server/show/web/web_server.h"

namespace coslam {
namespace {

struct ViewArguments {
  std::string argument;
  int port = 8765;
};

// What is shown: the run as a viewer would have seen it, and where it can be asked about.
struct Shown {
  std::string mcap;
  std::optional<ResultFolder> result;
};

std::string octets_of_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string octets{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw UserError(file.string() + " cannot be read");
  return octets;
}

Shown shown_result(const ResultFolder& result) {
  Shown shown{"", result};
  exporting::write_mcap(contents_of(result), [&](std::string_view octets) { shown.mcap += octets; });
  return shown;
}

// A map file becomes a result for a moment.
Shown shown_map(const std::filesystem::path& file) {
  std::string folder = (std::filesystem::temp_directory_path() / "coslam-view-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) throw UserError("no folder can be made for " + file.string());
  const std::shared_ptr<void> removed(nullptr, [&](void*) {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  });
  write_map_result(file, folder);
  Shown shown = shown_result(ResultFolder(folder));
  shown.result.reset();
  return shown;
}

Shown shown_of(const std::string& argument) {
  if (std::filesystem::is_directory(argument)) return shown_result(result_argument(argument));
  if (!std::filesystem::exists(argument)) throw UserError("there is no " + argument);
  if (std::filesystem::path(argument).extension() == ".mcap") return {octets_of_file(argument), {}};
  return shown_map(argument);
}

WebAnswer nothing_at(const std::string& path) {
  return plain_answer(
      404, "there is nothing at " + path + "; of a run that is over there are /api/v1/explain and /api/v1/run.mcap");
}

WebAnswer answer(const Shown& shown, const std::shared_ptr<const std::string>& mcap, const WebRequest& request) {
  if (request.path == "/healthz" || request.path == "/readyz") return plain_answer(200, "ok");
  if (request.path == "/api/v1/run.mcap") return {200, "application/octet-stream", "", *mcap, mcap};
  if (request.path != "/api/v1/explain") return nothing_at(request.path);
  if (!shown.result) return plain_answer(404, "only a RESULT tells of lives");
  const auto question = question_of(request);
  return question ? explained(*shown.result, *question) : no_question();
}

int view(const ViewArguments& arguments) {
  catch_stop_signals();
  if (page_files().empty()) throw UserError("this coslam was built without the page: see docs/live.md");
  Shown shown = shown_of(arguments.argument);
  const auto mcap = std::make_shared<const std::string>(std::move(shown.mcap));
  ViewConfig config;
  config.port = arguments.port;
  const WebServer web(config, arguments.argument,
                      [&](const WebRequest& request, const WebReply& reply) { reply(answer(shown, mcap, request)); });
  std::printf("view: %s?recorded=1\nCtrl-C ends it\n", web.url().c_str());
  std::fflush(stdout);
  while (!stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return 0;
}

}  // namespace

void add_view_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command = app.add_subcommand("view", "Show a finished run in a browser");
  command->add_option("WHAT", arguments->argument, "a RESULT, a map file, or an MCAP file of a run")->required();
  command->add_option("--port", arguments->port, "TCP port on this machine; 0: a free one")
      ->capture_default_str()
      ->type_name("N")
      ->check(CLI::Range(0, 65535));
  command->callback([arguments, &chosen] { chosen = [arguments] { return view(*arguments); }; });
}

}  // namespace coslam
