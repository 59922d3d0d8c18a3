// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>
#include <opencv2/core/utils/logger.hpp>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/version.h"
#include "deploy/tools/commands.h"

namespace {

constexpr int kFailed = 1, kWrongUsage = 2;  // exit codes

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
  coslam::add_view_command(app, chosen);
  coslam::add_calibrate_command(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : kWrongUsage;
  }
  return chosen();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    coslam::init_log("coslam");
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_ERROR);  // we say ourselves what cannot be opened
    return run(argc, argv);
  } catch (const coslam::UsageError& e) {
    std::fprintf(stderr, "coslam: %s\n", e.what());
    return kWrongUsage;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "coslam: %s\n", e.what());
    return kFailed;
  }
}
