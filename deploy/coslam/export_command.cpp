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
#include "deploy/coslam/export/export.h"
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

exporting::MapExport exporter(const ExportArguments& arguments, const ResultFolder& result) {
  if (arguments.format == "tum") return exporting::export_tum;
  if (arguments.format == "euroc") return exporting::export_euroc;
  if (arguments.format == "kitti") return exporting::export_kitti;
  const bool ply = arguments.format == "ply";
  if (ply && arguments.sequence.empty()) return exporting::export_ply;
  if (arguments.sequence.empty()) {
    throw UsageError("the export to colmap needs the cameras: add --sequence SEQUENCE, the one that was played");
  }
  const exporting::ColmapOptions options{.every = checked(arguments.every.value_or(exporting::kTracksOfEvery))};
  const Sequence played = as_played(sequence_argument(arguments.sequence), result);
  if (const std::string other = of_another_sequence(played, result); !other.empty()) log_warn(other);
  return [=, undistort = arguments.undistort, sequence = played](const ResultMap& map,
                                                                 const std::filesystem::path& folder) {
    if (ply) return exporting::export_ply_in_colour(map, sequence, folder);
    return undistort ? exporting::export_colmap_undistorted(map, sequence, folder, options)
                     : exporting::export_colmap(map, sequence, folder, options);
  };
}

int export_result(const ExportArguments& arguments) {
  if (arguments.undistort && arguments.format != "colmap") throw UsageError("--undistort is for --format colmap");
  if (arguments.every && arguments.format != "colmap") throw UsageError("--every is for --format colmap");
  if (!arguments.sequence.empty() && arguments.format != "colmap" && arguments.format != "ply") {
    throw UsageError("--sequence is for --format colmap and ply");
  }
  exporting::MapExport export_map;
  const bool whole = arguments.format == "mcap";  // all maps in one file
  const ResultFolder result = result_argument(arguments.result);
  std::error_code none;
  if (std::filesystem::equivalent(result.path(), arguments.folder, none)) {
    throw UsageError(arguments.folder + " is the result itself: name another folder to export to");
  }
  if (!whole) export_map = exporter(arguments, result);
  const ResultContents contents = contents_of(result);
  const exporting::Files files = whole ? exporting::export_mcap(contents, arguments.folder)
                                       : exporting::export_maps(contents, arguments.folder, export_map);
  for (const auto& file : files) std::printf("%s\n", file.c_str());
  if (arguments.format == "kitti") {
    for (const ResultMap& map : contents.maps) {
      const std::string gaps = exporting::gaps_of(map);
      if (!gaps.empty()) {
        std::fprintf(stderr, "coslam: %s; lines of KITTI have no times: they stand in *.times.txt\n", gaps.c_str());
      }
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
      ->check(CLI::IsMember({"colmap", "ply", "tum", "euroc", "kitti", "mcap"}));
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
