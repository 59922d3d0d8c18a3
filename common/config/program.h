// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/log.h"
#include "common/config/config.h"

// Command line, configuration and exit that all programs share.
namespace coslam {

// --version, --config, --set, --print-config and --log-format.
struct CommonArguments {
  std::string file;
  std::vector<std::string> sets;
  bool print = false;
  LogFormat log_format = LogFormat::kText;

  // name: that of the file in the documents; example: KEY=VALUE.
  void add_to(CLI::App& app, const std::string& name, const std::string& example);

  template <class Options>
  void apply_to(Options& options) const {
    if (!file.empty()) config::load(options, file);
    for (const std::string& s : sets) config::apply_set(options, s);
  }
};

// The exit code of a program that ends with this: after --help, or of wrong usage.
std::optional<int> parse_arguments(CLI::App& app, int argc, char** argv);

// All keys of a program as YAML, on standard output. Throws UserError.
void print_config_text(const std::string& program, const std::string& yaml);
template <class Options>
void print_config(const std::string& program, const Options& options) {
  print_config_text(program, config::dump_yaml(options));
}

// Runs the body of a program and returns its exit code; an exception becomes a sentence on standard error.
int run_program(const std::string& program, const std::function<int()>& body);

}  // namespace coslam
