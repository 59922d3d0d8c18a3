// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/program.h"

#include <filesystem>
#include <iostream>

#include "common/base/error.h"
#include "common/base/text.h"
#include "common/base/version.h"
#include "common/base/words.h"

namespace coslam {
namespace {

constexpr int kFailed = 1, kWrongUsage = 2;

int ended(const std::string& program, const std::exception& e, int code) {
  std::cerr << program << ": " << e.what() << "\n";
  return code;
}

// The command that was being read.
const CLI::App& innermost(const CLI::App& app) {
  const CLI::App* at = &app;
  while (!at->get_subcommands().empty()) at = at->get_subcommands().front();
  return *at;
}

// "coslam map list"
std::string called(const CLI::App& app) {
  const CLI::App* parent = app.get_parent();
  const std::string name = std::filesystem::path(app.get_name()).filename().string();
  return parent == nullptr ? name : called(*parent) + " " + name;
}

std::vector<std::string> commands_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

std::vector<std::string> options_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::string with_nearest(const std::string& problem, const std::string& word, const std::vector<std::string>& known) {
  const std::string nearest = nearest_of(word, known);
  return problem + " '" + word + "'" + (nearest.empty() ? "" : ", did you mean '" + nearest + "'?");
}

// What is unknown goes before what is missing for that reason.
std::string sentence_of(const CLI::App& app, const CLI::ParseError& error) {
  const int code = error.get_exit_code();
  const bool unknown =
      code == static_cast<int>(CLI::ExitCodes::ExtrasError) || code == static_cast<int>(CLI::ExitCodes::RequiredError);
  if (!unknown) return error.what();
  const CLI::App& at = innermost(app);
  const std::vector<std::string> words = app.remaining(true), commands = commands_of(at);
  for (const std::string& word : words) {
    if (word.starts_with("-")) return with_nearest("there is no option", word, options_of(at));
    if (!commands.empty()) return with_nearest("there is no command", word, commands);
  }
  return error.what() + (commands.empty() ? "" : ": one of " + joined(commands));
}

}  // namespace

void CommonArguments::add_to(CLI::App& app, const std::string& name, const std::string& example) {
  app.set_version_flag("--version", version());
  app.add_option("--config", file, name)->type_name("FILE");
  app.add_option("--set", sets, "override a key of the configuration, e.g. " + example)->type_name("KEY=VALUE");
  app.add_flag("--print-config", print, "only print all keys with values, bounds and meaning, as a file for --config");
  app.add_option("--log-format", log_format, "of the lines on standard error: text or json")
      ->type_name("FORMAT")
      ->transform(CLI::Validator(
          [](std::string& word) {
            if (word != "text" && word != "json") return "'" + word + "' is neither text nor json";
            word = std::to_string(static_cast<int>(word == "json" ? LogFormat::kJson : LogFormat::kText));
            return std::string();
          },
          ""));
}

std::optional<int> parse_arguments(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help and --version
    const std::string name = called(innermost(app));
    std::cerr << name << ": " << sentence_of(app, e) << " (see " << name << " --help)\n";
    return kWrongUsage;
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
  } catch (const std::filesystem::filesystem_error& e) {
    return ended(program, UserError(e.path1().string() + ": " + e.code().message()), kFailed);
  } catch (const std::exception& e) {
    return ended(program, e, kFailed);
  }
}

}  // namespace coslam
