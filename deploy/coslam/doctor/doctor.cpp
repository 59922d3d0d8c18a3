// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/doctor.h"

#include "deploy/coslam/doctor/camera.h"
#include "deploy/coslam/doctor/files.h"
#include "deploy/coslam/doctor/fleet.h"
#include "deploy/coslam/doctor/machine.h"
#include "deploy/coslam/doctor/network.h"

namespace coslam::doctor {

Patient patient_of(const std::string& config_file) {
  Patient patient;
  if (!config_file.empty()) patient.of_config = read_config(config_file, patient.settings);
  return patient;
}

const std::vector<Check>& checks() {
  static const std::vector<Check> all{
      [](const Patient& p) { return judge(look_at_environment(p.settings.wire.domain)); },
      [](const Patient& p) { return p.of_config; },
      [](const Patient& p) { return judge(look_at_key(p.settings.wire)); },
      [](const Patient& p) { return judge(look_at_interfaces(), p.settings.wire); },
      [](const Patient& p) { return judge(look_at_ports(p.settings.wire.domain), p.settings.wire); },
      [](const Patient& p) { return judge(listen_to_fleet(p.settings.wire, look_at_interfaces(), p.named)); },
      [](const Patient&) { return judge(look_at_devices()); },
      [](const Patient& p) { return p.settings.source.empty() ? Findings() : judge(look_at_source(p.settings)); },
      [](const Patient& p) { return p.out.empty() ? Findings() : judge(look_at_disk(p.out)); },
      [](const Patient& p) {
        const WireConfig& wire = p.settings.wire;
        return judge(look_at_buffers(wire.receive_buffer_bytes, wire.send_buffer_bytes));
      },
      [](const Patient&) { return judge(look_at_shared_memory()); },
      [](const Patient&) { return judge(look_at_processor()); },
  };
  return all;
}

}  // namespace coslam::doctor
