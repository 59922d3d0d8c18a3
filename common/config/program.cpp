// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/program.h"

#include <iostream>
#include <map>

#include "common/base/error.h"
#include "common/base/version.h"

namespace coslam {
namespace {

constexpr int kFailed = 1, kWrongUsage = 2;

int ended(const std::string& program, const std::exception& e, int code) {
  std::cerr << program << ": " << e.what() << "\n";
  return code;
}

}  // namespace

void CommonArguments::add_to(CLI::App& app, const std::string& name, const std::string& example) {
  const std::map<std::string, LogFormat> formats = {{"text", LogFormat::kText}, {"json", LogFormat::kJson}};
  app.set_version_flag("--version", version());
  app.add_option("--config", file, name)->type_name("FILE");
  app.add_option("--set", sets, "override a key of the configuration, e.g. " + example)->type_name("KEY=VALUE");
  app.add_flag("--print-config", print, "only print all keys with values, bounds and meaning, as a file for --config");
  app.add_option("--log-format", log_format, "of the lines on standard error: text or json")
      ->type_name("FORMAT")
      ->transform(CLI::CheckedTransformer(formats).description(""));
}

std::optional<int> parse_arguments(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : kWrongUsage;
  }
}

void print_config_text(const std::string& program, const std::string& yaml) {
  std::cout << "# All keys of " << program << "; --config FILE reads them back.\n" << yaml << std::flush;
  if (!std::cout) throw UserError("the configuration cannot be written to standard output");
}

int run_program(const std::string& program, const std::function<int()>& body) {
  try {
    return body();
  } catch (const UsageError& e) {
    return ended(program, e, kWrongUsage);
  } catch (const std::exception& e) {
    return ended(program, e, kFailed);
  }
}

}  // namespace coslam
