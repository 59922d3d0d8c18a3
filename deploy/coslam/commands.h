// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace coslam {

// Work of the chosen subcommand; returns the exit code. UserError and UsageError are main's to report.
using Command = std::function<int()>;

// Each adds one subcommand, whose parsing sets `chosen`. One file a subcommand: <name>_command.cpp.
void add_calibrate_command(CLI::App& app, Command& chosen);
void add_calibration_command(CLI::App& app, Command& chosen);
void add_doctor_command(CLI::App& app, Command& chosen);
void add_eval_command(CLI::App& app, Command& chosen);
void add_explain_command(CLI::App& app, Command& chosen);
void add_export_command(CLI::App& app, Command& chosen);
void add_fleet_command(CLI::App& app, Command& chosen);
void add_map_command(CLI::App& app, Command& chosen);
void add_run_command(CLI::App& app, Command& chosen);
void add_render_command(CLI::App& app, Command& chosen);
void add_replay_command(CLI::App& app, Command& chosen);
void add_status_command(CLI::App& app, Command& chosen);
void add_view_command(CLI::App& app, Command& chosen);

}  // namespace coslam
