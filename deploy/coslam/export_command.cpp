// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "common/base/error.h"
#include "common/base/log.h"
#include "deploy/coslam/commands.h"
#include "deploy/coslam/export/formats.h"
#include "deploy/coslam/result_argument.h"
#include "deploy/coslam/run/played.h"
#include "deploy/coslam/sequence_argument.h"

namespace coslam {
namespace {

struct ExportArguments {
  std::string result;
  std::string format;
  std::string folder;
  std::string sequence;
  bool undistort = false;
  std::optional<int> every;
};

// Images with tracks are every tenth: one that is asked for is one of these, or between two.
int checked(int every) {
  if (every > 0 && (exporting::kTracksOfEvery % every == 0 || every % exporting::kTracksOfEvery == 0)) return every;
  throw UsageError("--every takes 1, 2, 5 or a multiple of 10: tracks are kept of every tenth image");
}

// What was played, for a format that goes by it.
std::optional<Sequence> sequence_for(const exporting::Format& format, const ExportArguments& arguments,
                                     const ResultFolder& result) {
  if (arguments.sequence.empty()) {
    if (format.sequence != exporting::UsesSequence::kAlways) return std::nullopt;
    throw UsageError("the export to " + arguments.format +
                     " needs the cameras: add --sequence SEQUENCE, the one that was played");
  }
  const Sequence played = as_played(sequence_argument(arguments.sequence), result);
  if (const std::string other = of_another_sequence(played, result); !other.empty()) log_warn(other);
  return played;
}

void require_sense(const exporting::Format& format, const ExportArguments& arguments) {
  const auto only_for = [](const std::string& option, bool (*holds)(const exporting::Format&)) {
    return UsageError(option + " is for --format " + exporting::formats_where(holds));
  };
  const auto takes_options = [](const exporting::Format& f) { return f.takes_options; };
  if (arguments.undistort && !format.takes_options) throw only_for("--undistort", takes_options);
  if (arguments.every && !format.takes_options) throw only_for("--every", takes_options);
  if (!arguments.sequence.empty() && format.sequence == exporting::UsesSequence::kNever) {
    throw only_for("--sequence",
                   [](const exporting::Format& f) { return f.sequence != exporting::UsesSequence::kNever; });
  }
}

int export_result(const ExportArguments& arguments) {
  const exporting::Format& format = exporting::format_of(arguments.format);
  require_sense(format, arguments);
  const ResultFolder result = result_argument(arguments.result);
  std::error_code none;
  if (std::filesystem::equivalent(result.path(), arguments.folder, none)) {
    throw UsageError(arguments.folder + " is the result itself: name another folder to export to");
  }
  exporting::FormatOptions options{.undistort = arguments.undistort, .every = arguments.every};
  if (options.every) options.every = checked(*options.every);
  const std::optional<Sequence> sequence = sequence_for(format, arguments, result);
  const ResultContents contents = contents_of(result);
  for (const auto& file : format.write(contents, arguments.folder, sequence ? &*sequence : nullptr, options)) {
    std::printf("%s\n", file.c_str());
  }
  if (format.lacks != nullptr) {
    for (const ResultMap& map : contents.maps) {
      if (const std::string lacks = format.lacks(map); !lacks.empty())
        std::fprintf(stderr, "coslam: %s\n", lacks.c_str());
    }
  }
  if (contents.maps.front().unit == LengthUnit::kMapUnits) {
    std::fprintf(stderr, "coslam: %s; a baseline, a rig or a printed tag of known size gives metres\n",
                 words_of(LengthUnit::kMapUnits));
  }
  return 0;
}

}  // namespace

void add_export_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export", "Write a result in the form of another program");
  command->add_option("RESULT", arguments->result, "folder of a run, or of a server's runs: the latest")->required();
  command->add_option("--format", arguments->format, "form to write")
      ->required()
      ->check(CLI::IsMember(exporting::names_of_formats()));
  command
      ->add_option("DIR", arguments->folder,
                   "folder to write; what could not be brought together with the largest map goes to DIR/maps/ID")
      ->required();
  command->add_option("--sequence", arguments->sequence,
                      "what was played; for colmap, which needs its cameras, and for ply, which gets its colours");
  command->add_flag("--undistort", arguments->undistort,
                    "for colmap: pinhole cameras, with their images, in the folders that dense stereo and Gaussian "
                    "splatting start from; masks of what moves beside them");
  command->add_option("--every", arguments->every,
                      "for colmap: one of so many images; 1, 2, 5 or a multiple of 10, which is the default");
  command->callback([arguments, &chosen] { chosen = [arguments] { return export_result(*arguments); }; });
}

}  // namespace coslam
