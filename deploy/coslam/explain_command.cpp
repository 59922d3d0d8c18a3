// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <string>

#include "common/base/error.h"
#include "deploy/coslam/commands.h"
#include "server/keep/explain/answer.h"

namespace coslam {
namespace {

struct ExplainArguments {
  std::string result;
  explain::Question question;
};

int explain_result(const ExplainArguments& arguments) {
  const ResultFolder result = find_result(arguments.result);
  const explain::Answer answer = explain::answer(result, arguments.question);
  std::fputs(answer.text.c_str(), stdout);
  if (answer.caution.empty()) return 0;
  std::fflush(stdout);
  throw UserError(answer.caution);
}

}  // namespace

void add_explain_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<ExplainArguments>();
  CLI::App* command = app.add_subcommand("explain", "Tell what became of a point, a track or a camera, and why");
  command->add_option("RESULT", arguments->result, "folder of a run, or of a server's runs: the latest")->required();
  command->add_option("KIND", arguments->question.kind, "point, track or camera")
      ->required()
      ->check(CLI::IsMember({"point", "track", "camera"}));
  command->add_option("ID", arguments->question.id, "number of the point, AGENT/TRACK, or AGENT")->required();
  command
      ->add_option("--at", arguments->question.at_s, "seconds of the run: what it was then; otherwise its whole life")
      ->type_name("T")
      ->check(CLI::Range(0.0, 1e9).description(""));
  command->callback([arguments, &chosen] { chosen = [arguments] { return explain_result(*arguments); }; });
}

}  // namespace coslam
