// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/greeting.h"

#include <algorithm>

#include "common/base/words.h"

namespace coslam {

Greeting greeting(const WireConfig& wire, const std::vector<std::string>& addresses, const std::string& results) {
  const std::string domain = std::to_string(wire.domain);
  Greeting out;
  out.place = "DDS domain " + domain + " at " + (addresses.empty() ? "no address" : joined(addresses)) +
              (wire.key_file.empty() ? ", without a key" : ", with the fleet's key") +
              (results.empty() ? "; results are not kept (--out DIR)" : "; results go to " + results);
  const bool alone =
      std::ranges::all_of(addresses, [](const std::string& address) { return address.starts_with("127."); });
  out.agent = std::string("coslam-agent ") + (alone ? "--loopback " : "") + "--domain " + domain +
              " --id NAME --source URI --calibration FILE" +
              (wire.key_file.empty() ? "" : " --set wire.key_file=" + wire.key_file);
  return out;
}

}  // namespace coslam
