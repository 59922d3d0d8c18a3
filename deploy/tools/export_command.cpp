// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <string>

#include "common/base/error.h"
#include "deploy/tools/commands.h"
#include "deploy/tools/export/export.h"
#include "deploy/tools/sequence_argument.h"

namespace coslam {
namespace {

struct ExportArguments {
  std::string result;
  std::string format;
  std::string folder;
  std::string sequence;
};

exporting::Files export_as(const std::string& format, const ResultFolder& result, const ExportArguments& arguments) {
  if (format == "tum") return exporting::export_tum(result, arguments.folder);
  if (format == "euroc") return exporting::export_euroc(result, arguments.folder);
  if (format == "kitti") return exporting::export_kitti(result, arguments.folder);
  if (format == "ply") return exporting::export_ply(result, arguments.folder);
  if (arguments.sequence.empty()) {
    throw UsageError("the export to colmap needs the cameras: add --sequence SEQUENCE, the one that was played");
  }
  return exporting::export_colmap(result, sequence_argument(arguments.sequence), arguments.folder);
}

int export_result(const ExportArguments& arguments) {
  const ResultFolder result(arguments.result);
  if (!std::filesystem::is_directory(result.path()))
    throw UserError(arguments.result + ": there is no such result folder");
  for (const auto& file : export_as(arguments.format, result, arguments)) std::printf("%s\n", file.c_str());
  return 0;
}

}  // namespace

void add_export_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export", "Write a result in the form of another program");
  command->add_option("RESULT", arguments->result, "folder written by a run")->required();
  command->add_option("--format", arguments->format, "form to write")
      ->required()
      ->check(CLI::IsMember({"colmap", "ply", "tum", "euroc", "kitti"}));
  command->add_option("DIR", arguments->folder, "folder to write")->required();
  command->add_option("--sequence", arguments->sequence, "what was played; for colmap, which needs its cameras");
  command->callback([arguments, &chosen] { chosen = [arguments] { return export_result(*arguments); }; });
}

}  // namespace coslam
