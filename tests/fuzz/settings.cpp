// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// bridge.yaml, with all keys of the wire, and words after --set: the first octet says which. What is taken can be used,
// and is the same when it is printed and read again.
#include <cstdlib>
#include <string>

#include "common/base/error.h"
#include "common/config/config.h"
#include "server/show/bridge/bridge_config.h"
#include "tests/fuzz/fuzzer.h"

namespace coslam {

void fuzz::try_octets(Octets octets) {
  if (octets.empty()) return;
  const std::string text(text_of(octets.subspan(1)));
  BridgeOptions options;
  if (octets[0] % 2 == 0) {
    config::load(options, file_of(text));
  } else {
    try {
      config::apply_set(options, text);
    } catch (const UsageError&) {
      return;
    }
  }
  const Px4Odometry odometry(options.bridge.px4, options.bridge.map);
  const std::string printed = config::dump_yaml(options);
  BridgeOptions again;
  config::load_text(again, printed, "printed");
  if (config::dump_yaml(again) != printed) std::abort();
}

void fuzz::write_seeds(const WriteSeed& write) {
  write("file", std::string(1, '\0') +
                    "wire: {domain: 7, peers: [10.0.0.1], bulk_bytes_per_s: 100000}\n"
                    "bridge:\n  interfaces: [127.0.0.1]\n  px4: {agent: cam0, pitch_deg: -30.5}\n");
  write("set", "\1bridge.px4.topic=/uav_1/fmu/in/vehicle_visual_odometry");
  write("set_list", "\1bridge.interfaces=127.0.0.1,10.0.0.1");
  write("set_list_in_brackets", "\1bridge.interfaces=[127.0.0.1, '10.0.0.1']");
}

}  // namespace coslam
