// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <string>

#include "common/base/error.h"
#include "deploy/coslam/commands.h"
#include "deploy/coslam/doctor/doctor.h"
#include "deploy/coslam/doctor/report.h"
#include "deploy/coslam/wire_arguments.h"

namespace coslam {
namespace {

struct DoctorArguments {
  WireArguments wire;
  bool json = false;
  std::string source, calibration, out;
};

doctor::Patient patient_of(const DoctorArguments& arguments) {
  doctor::Patient patient = doctor::patient_of(arguments.wire.config);
  patient.settings.wire = arguments.wire.over(patient.settings.wire);
  patient.named = arguments.wire.peers;
  if (!arguments.source.empty()) patient.settings.source = arguments.source;
  if (!arguments.calibration.empty()) patient.settings.calibration = arguments.calibration;
  patient.out = arguments.out;
  return patient;
}

int examine(const DoctorArguments& arguments) {
  const doctor::Patient patient = patient_of(arguments);
  if (!arguments.calibration.empty() && patient.settings.source.empty()) {
    throw UsageError("--calibration is looked at with the images of --source, which is missing; coslam calibration " +
                     arguments.calibration + " tells of it alone");
  }
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
  a->wire.add_to(*command);
  command->add_option("--source", a->source, "images of an agent, looked at for two seconds")->type_name("URI");
  command->add_option("--calibration", a->calibration, "of that source")->type_name("FILE");
  command->add_option("--out", a->out, "where results are to go: room and rights")->type_name("DIR");
  command->add_flag("--json", a->json, "for programs");
  command->callback([a, &chosen] { chosen = [a] { return examine(*a); }; });
}

}  // namespace coslam
