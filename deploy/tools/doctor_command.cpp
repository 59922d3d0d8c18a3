// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "deploy/tools/commands.h"
#include "deploy/tools/doctor/doctor.h"
#include "deploy/tools/doctor/report.h"

namespace coslam {
namespace {

struct DoctorArguments {
  std::optional<int> domain;
  bool loopback = false, json = false;
  std::vector<std::string> peers;
  std::string key_file, config, source, calibration, out;
};

doctor::Patient patient_of(const DoctorArguments& arguments) {
  doctor::Patient patient = doctor::patient_of(arguments.config);
  WireConfig& wire = patient.settings.wire;
  if (arguments.loopback) {
    const std::string key_file = wire.key_file;
    wire = loopback_config(wire.domain);
    wire.key_file = key_file;
  }
  if (arguments.domain) wire.domain = *arguments.domain;
  if (!arguments.key_file.empty()) wire.key_file = arguments.key_file;
  patient.named = arguments.peers;
  if (!arguments.source.empty()) patient.settings.source = arguments.source;
  if (!arguments.calibration.empty()) patient.settings.calibration = arguments.calibration;
  patient.out = arguments.out;
  return patient;
}

int examine(const DoctorArguments& arguments) {
  const doctor::Patient patient = patient_of(arguments);
  doctor::Findings findings;
  for (const doctor::Check& check : doctor::checks()) {
    for (doctor::Finding& finding : check(patient)) findings.push_back(std::move(finding));
  }
  std::fputs((arguments.json ? doctor::json_of(findings) : doctor::text_of(findings)).c_str(), stdout);
  return doctor::worst_of(findings) == doctor::Grade::kFail ? 1 : 0;
}

}  // namespace

void add_doctor_command(CLI::App& app, Command& chosen) {
  auto a = std::make_shared<DoctorArguments>();
  CLI::App* command = app.add_subcommand(
      "doctor", "Tell what keeps a fleet from working here, a line each with what mends it; takes a few seconds");
  command->add_option("--domain", a->domain, "DDS domain, 0 to 232")->type_name("N")->check(CLI::Range(0, 232));
  command->add_flag("--loopback", a->loopback, "look on this machine only, as for coslam run");
  command->add_option("--peer", a->peers, "host to ask by address or name; may be repeated")->type_name("HOST");
  command->add_option("--key", a->key_file, "file with the fleet's key, where it has one")->type_name("FILE");
  command->add_option("--config", a->config, "agent.yaml or server.yaml, whose settings are examined")
      ->type_name("FILE");
  command->add_option("--source", a->source, "images of an agent, looked at for two seconds")->type_name("URI");
  command->add_option("--calibration", a->calibration, "of that source")->type_name("FILE");
  command->add_option("--out", a->out, "where results are to go: room and rights")->type_name("DIR");
  command->add_flag("--json", a->json, "for programs");
  command->callback([a, &chosen] { chosen = [a] { return examine(*a); }; });
}

}  // namespace coslam
