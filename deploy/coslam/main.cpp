// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <opencv2/core/utils/logger.hpp>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/version.h"
#include "common/config/program.h"
#include "deploy/coslam/commands.h"

namespace {

int run(int argc, char** argv) {
  CLI::App app("CoSLAM: collaborative visual SLAM", "coslam");
  app.set_version_flag("--version", coslam::version());
  app.require_subcommand(1);
  coslam::Command chosen;
  coslam::add_run_command(app, chosen);
  coslam::add_replay_command(app, chosen);
  coslam::add_render_command(app, chosen);
  coslam::add_eval_command(app, chosen);
  coslam::add_explain_command(app, chosen);
  coslam::add_export_command(app, chosen);
  coslam::add_map_command(app, chosen);
  coslam::add_status_command(app, chosen);
  coslam::add_doctor_command(app, chosen);
  coslam::add_fleet_command(app, chosen);
  coslam::add_view_command(app, chosen);
  coslam::add_calibrate_command(app, chosen);
  coslam::add_calibration_command(app, chosen);
  if (const auto code = coslam::parse_arguments(app, argc, argv)) return *code;
  const int code = chosen();
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    throw coslam::UserError("standard output cannot be written");
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  coslam::init_log("coslam");
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_ERROR);  // we say ourselves what cannot be opened
  return coslam::run_program("coslam", [&] { return run(argc, argv); });
}
