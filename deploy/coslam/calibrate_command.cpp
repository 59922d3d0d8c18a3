// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "agent/capture/source.h"
#include "agent/feed.h"
#include "common/base/error.h"
#include "common/base/text.h"
#include "common/base/time.h"
#include "common/dataset/calibration.h"
#include "deploy/coslam/calibrate/chessboard.h"
#include "deploy/coslam/commands.h"
#include "deploy/coslam/console.h"
#include "server/app/stop_signals.h"

namespace coslam {
namespace {

struct CalibrateArguments {
  std::string source;
  std::string board;
  std::string square, out;
};

double parse_square(const std::string& text) {
  const auto square_m = parse_double(text);
  if (!square_m || !(*square_m > 0) || *square_m > 10)
    throw UsageError("--square takes metres, e.g. 0.03 for 30 mm, not '" + text + "'");
  return *square_m;
}

Chessboard parse_board(const std::string& text, double square_m) {
  const auto sides = split_fields(text, "x");
  if (sides.size() == 2) {
    const auto columns = parse_integer(sides[0]), rows = parse_integer(sides[1]);
    const auto usable = [](const auto& corners) { return corners && *corners >= 3 && *corners <= 50; };
    if (usable(columns) && usable(rows)) return {static_cast<int>(*columns), static_cast<int>(*rows), square_m};
  }
  throw UsageError("--board takes the inner corners as COLSxROWS, 3 to 50 each, e.g. 8x6, not '" + text + "'");
}

// Before the work, so that it is not lost.
void require_writable(const std::filesystem::path& file) {
  const auto folder = std::filesystem::absolute(file).parent_path();
  if (access(folder.c_str(), W_OK) != 0 || std::filesystem::is_directory(file))
    throw UserError(file.string() + ": cannot be written: there has to be a folder " + folder.string() +
                    " in which this user may write");
}

SourceOptions options() {
  SourceOptions o;
  o.rate_hz = 1;  // of folders without times: single photographs
  return o;
}

int count_images(const std::string& uri) {
  const auto source = open_source(uri, options());
  int images = 0;
  while (source->skip()) ++images;
  return images;
}

// From a file all of it, from a camera until there are enough views or Ctrl-C.
ChessboardViews collect_views(const CalibrateArguments& arguments, const Chessboard& board) {
  constexpr TimeNs kPeriod_ns = 200'000'000;  // of the images that are searched: those between show nothing new
  ChessboardViews views(board);
  auto source = open_source(arguments.source, options());
  const bool live = source->live();
  const int images = live ? 0 : count_images(arguments.source);
  const auto feed = live ? real_time_feed(std::move(source), 1, 0) : prefetching_feed(std::move(source));
  Progress progress(live ? "views" : "images");
  std::optional<TimeNs> searched_ns;
  bool is_new = false;  // the image before is a new view
  TimeNs before_ns = 0;
  while (const auto image = feed->next(stop_requested())) {
    if (image->fault != ImageFault::kNone) continue;
    if (is_new) views.add_next(image->grey, to_seconds(image->capture_ns - before_ns));
    is_new = false;
    before_ns = image->capture_ns;
    if (!searched_ns || image->capture_ns - *searched_ns >= kPeriod_ns) {
      searched_ns = image->capture_ns;
      is_new = views.add(image->grey);
    }
    if (live) {
      progress(views.count(), ChessboardViews::kMost);
    } else {
      progress(static_cast<int>(image->frame.value) + 1, images);
    }
    if (live && views.count() == ChessboardViews::kMost && !is_new) break;
  }
  return views;
}

int calibrate(const CalibrateArguments& arguments) {
  const Chessboard board = parse_board(arguments.board, parse_square(arguments.square));
  require_writable(arguments.out);
  catch_stop_signals();
  const ChessboardViews views = collect_views(arguments, board);
  const CalibrationFit fit = views.fit();
  save_calibration(arguments.out, fit.camera);
  const CameraModel& c = fit.camera;
  std::printf("%s: %dx%d pixels, fx %.1f, fy %.1f, cx %.1f, cy %.1f\n", arguments.out.c_str(), c.width_px, c.height_px,
              c.fx, c.fy, c.cx, c.cy);
  std::printf("RMS reprojection error %.3f pixels over %d views%s\n", fit.rms_px, fit.views,
              fit.rms_px > 1 ? ": that is much; is the board flat, and are the images sharp?" : "");
  if (fit.readout_s != 0) {
    std::printf("rolling shutter: %.1f ms from the %s row to the %s; agent.readout_s takes it\n",
                1000 * std::abs(fit.readout_s), fit.readout_s > 0 ? "first" : "last",
                fit.readout_s > 0 ? "last" : "first");
  }
  return 0;
}

}  // namespace

void add_calibrate_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command = app.add_subcommand("calibrate", "Calibrate a camera from views of a chessboard");
  command->add_option("--source", arguments->source, "images, a video or a camera, as for an agent")
      ->type_name("URI")
      ->required();
  command->add_option("--board", arguments->board, "inner corners of the board")->type_name("COLSxROWS")->required();
  command->add_option("--square", arguments->square, "side of one square")->type_name("METRES")->required();
  command->add_option("--out", arguments->out, "calibration to write")->type_name("FILE")->required();
  command->callback([arguments, &chosen] { chosen = [arguments] { return calibrate(*arguments); }; });
}

}  // namespace coslam
